#!/usr/bin/env python3
"""Every path that a Markdown file names exists: links, and `code spans` that begin with a folder of the tree. So does every heading that a
page links to within itself; in docs/decisions.md, whose head is an index, every heading is linked."""

import re
from pathlib import Path
from common import files, main, text

LINK = re.compile(r"\]\(([^)#\s]+)")
SPAN = re.compile(r"`([^`\s]+)`")
WITHIN = re.compile(r"\]\(#([^)\s]+)\)")
INDEXED = "docs/decisions.md"
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
    lines = text(root, name).splitlines()
    at = {anchor(line.lstrip("#")): number for number, line in enumerate(lines, 1) if re.match(r"#+ ", line)}
    linked = {found: number for number, line in enumerate(lines, 1) for found in WITHIN.findall(line)}
    complaints = [f"{name}:{number}: there is no heading #{found}" for found, number in linked.items() if found not in at]
    if name == INDEXED:
        complaints += [f"{name}:{number}: not in the index: #{heading}" for heading, number in at.items() if heading not in linked and number > 1]
    return complaints


def check(root):
    root = Path(root)
    top = {p.name for p in root.iterdir() if p.is_dir()} - {".git"}
    complaints = []
    for name in files(root, ".md"):
        complaints += headings(root, name)
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
