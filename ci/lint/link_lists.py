#!/usr/bin/env python3
"""A library links what it includes. The project's folder is an include path of every library, so a header compiles anywhere and only the
linker, and only for what is not inline, would miss a library that DEPS does not name. hil/app collects every library, so whoever links it has
all; objects of a plug-in folder go to the program itself, and nobody links them; tests name their own."""

import re
from pathlib import PurePosixPath
from common import files, main, text

LIBRARY = re.compile(r"forcegate_(library|plugins)\s*\(\s*NAME\s+(\w+)(.*?)\)", re.S)
DEPENDENCY = re.compile(r"forcegate::(\w+)")
INCLUDE = re.compile(r'^\s*#\s*include\s*"([^"]+)"', re.M)
COLLECTS = "app"
FREE = ("hil/app", "tests", "rigs/firmware")


def libraries(root):
    """Folder -> (name, names that it links, whether it is a folder of plug-ins)."""
    out = {}
    for path in files(root, "CMakeLists.txt"):
        found = LIBRARY.search(re.sub(r"#.*", "", text(root, path)))
        if found:
            out[str(PurePosixPath(path).parent)] = (found.group(2), set(DEPENDENCY.findall(found.group(3))), found.group(1) == "plugins")
    return out


def owner(folders, path):
    for folder in PurePosixPath(path).parents:
        if str(folder) in folders:
            return str(folder)
    return None


def closure(name, links):
    seen, open_ = set(), [name]
    while open_:
        one = open_.pop()
        if one not in seen:
            seen.add(one)
            open_ += links.get(one, ())
    return seen


def check(root):
    folders = libraries(root)
    links = {name: needs for name, needs, _ in folders.values()}
    complaints = []
    for path in files(root, ".h", ".cpp"):
        own = owner(folders, path)
        if own is None or path.startswith(FREE):
            continue
        linked = closure(folders[own][0], links)
        if COLLECTS in linked:
            continue
        for number, line in enumerate(text(root, path).splitlines(), 1):
            for header in INCLUDE.findall(line):
                of = owner(folders, header)
                if of is not None and not folders[of][2] and folders[of][0] not in linked:
                    complaints.append(f"{path}:{number}: includes {header}, but {own}/CMakeLists.txt does not link forcegate::{folders[of][0]}")
    return complaints


if __name__ == "__main__":
    main(check)
