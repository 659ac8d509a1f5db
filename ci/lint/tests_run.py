#!/usr/bin/env python3
"""Tests that exist but do not run are worse than none: refuses disabled tests, and test sources that no target builds
(by build/compile_commands.json when there is one, else by the folder's CMakeLists.txt); and two styles of names in one file."""

import json
import re
from pathlib import Path
from common import files, main, text

NAME = re.compile(r"^\s*(?:TEST|TEST_F|TEST_P|TYPED_TEST)\(\s*\w+\s*,\s*(\w)", re.M)
DISABLED = re.compile(r'\bDISABLED_\w+|TEST_CASE\s*\([^)]*"\s*,\s*"[^"]*\[(\.|!hide)|^\s*(//|#)\s*add_test|\bGTEST_SKIP\(\)\s*;')


def built_sources(root):
    database = Path(root) / "build" / "compile_commands.json"
    if not database.is_file():
        return None
    base = Path(root).resolve()
    out = set()
    for entry in json.loads(database.read_text()):
        path = Path(entry["file"])
        if path.is_relative_to(base):
            out.add(str(path.relative_to(base)))
    return out


def check(root):
    complaints = []
    built = built_sources(root)
    for name in files(root, ".cpp"):
        if not name.startswith("tests/"):
            continue
        for number, line in enumerate(text(root, name).splitlines(), 1):
            if DISABLED.search(line):
                complaints.append(f"{name}:{number}: disabled test, or skipped without a reason; mend it or remove it")
        if len({letter.islower() for letter in NAME.findall(text(root, name))}) > 1:
            complaints.append(f"{name}:1: some test names are lower_snake and some UpperCamel; one style a file")
        is_test = name.endswith("_test.cpp") or name.startswith(("tests/system/", "tests/scenarios/", "tests/fuzz/"))
        if not is_test:
            continue
        if built is not None:
            if name not in built:
                complaints.append(f"{name}:1: no target builds this test")
        elif not any((Path(root) / folder / "CMakeLists.txt").is_file() for folder in Path(name).parents if len(folder.parts) > 1):
            complaints.append(f"{name}:1: neither its folder nor one above it has a CMakeLists.txt, so nothing builds it")
    return complaints


if __name__ == "__main__":
    main(check)
