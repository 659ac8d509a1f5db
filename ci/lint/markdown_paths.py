#!/usr/bin/env python3
"""Every path that a Markdown file names exists: links, and `code spans` that begin with a folder of the tree. So does every heading that a
page links to, in itself or in another; docs/decisions.md is an index and links to every heading of the pages in docs/decisions."""

import os
import re
from pathlib import Path
from common import files, main, text

LINK = re.compile(r"\]\(([^)#\s]+)")
SPAN = re.compile(r"`([^`\s]+)`")
HEADING = re.compile(r"\]\(([^)#\s]*)#([^)\s]+)\)")
INDEX, INDEXED = "docs/decisions.md", "docs/decisions/"
MADE = ("build",)  # folders that a run makes


def paths_in(line):
    for match in LINK.finditer(line):
        if not re.match(r"[a-z]+:", match.group(1)):
            yield match.group(1), True
    for match in SPAN.finditer(line):
        yield match.group(1), False


def anchor(heading):
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")


def headings(root, name):
    lines = enumerate(text(root, name).splitlines(), 1)
    return {anchor(line.lstrip("#")): number for number, line in lines if re.match(r"#+ ", line)}


def heading_links(root, name):
    """(line, page, heading) of every link to a heading of a page of the tree."""
    for number, line in enumerate(text(root, name).splitlines(), 1):
        for path, heading in HEADING.findall(line):
            page = os.path.normpath(os.path.join(os.path.dirname(name), path)) if path else name
            if not re.match(r"[a-z]+:", path) and page.endswith(".md"):
                yield number, page, heading


def heading_complaints(root, pages):
    at = {name: headings(root, name) for name in pages}
    indexed = set()
    for name in pages:
        for number, page, heading in heading_links(root, name):
            if heading not in at.get(page, {}):
                yield f"{name}:{number}: there is no heading #{heading} in {page}"
            if name == INDEX:
                indexed.add((page, heading))
    for name in pages:
        for heading, number in at[name].items():
            if name.startswith(INDEXED) and number > 1 and (name, heading) not in indexed:
                yield f"{name}:{number}: not in {INDEX}: #{heading}"


def check(root):
    root = Path(root)
    top = {p.name for p in root.iterdir() if p.is_dir()} - {".git"}
    pages = [str(name) for name in files(root, ".md")]
    complaints = list(heading_complaints(root, pages))
    for name in pages:
        fenced = False
        for number, line in enumerate(text(root, name).splitlines(), 1):
            if line.lstrip().startswith("```"):
                fenced = not fenced
            if fenced:
                continue
            for path, is_link in paths_in(line):
                plain = path.removeprefix("./").rstrip("/.,:")
                first = plain.split("/")[0]
                if first.startswith(MADE) or re.search(r"[*<>{}$|=]", plain):
                    continue
                if not is_link and (first not in top or "/" not in plain):
                    continue
                if not (root / plain).exists() and not (root / name).parent.joinpath(plain).exists():
                    complaints.append(f"{name}:{number}: there is no {plain}")
    return complaints


if __name__ == "__main__":
    main(check)
