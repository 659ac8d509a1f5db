#!/usr/bin/env python3
"""Refuses a check of the gate that `forcegate explain` does not know. A run shows only the checks that its records call for, so no test of
runs sees all of them: here the ids are those of the sources, a word before a title or after "id ="."""

import re
from common import files, main, text

EXPLAINED = "hil/app/help/explain_checks.cpp"
JUDGES = ("hil/gate/", "hil/rig/self_check.cpp", "hil/app/gate/", "hil/characterize/capacitance/")
TITLED = re.compile(r'"([a-z][a-z0-9_]*)",\s*(?:case_id,\s*)?"[A-Z]')
NAMED = re.compile(r'\.id\s*=(?!=)\s*([^;,]*)')
WORD = re.compile(r'(?<![\[(])"([a-z][a-z0-9_]*)"')
NO_CHECK = {"prelude"}  # the id of a calibration


def ids(source):
    """(id, offset) of every check that a source names."""
    for match in TITLED.finditer(source):
        yield match.group(1), match.start()
    for match in NAMED.finditer(source):
        for word in WORD.findall(match.group(1)):
            yield word, match.start()


def check(root):
    if EXPLAINED not in files(root, "explain_checks.cpp"):
        return []
    explained = set(re.findall(r'\{"([a-z0-9_]+)", "check"', text(root, EXPLAINED)))
    complaints = []
    for name in files(root, ".cpp"):
        if not name.startswith(JUDGES):
            continue
        source = text(root, name)
        for word, at in ids(source):
            if word not in explained | NO_CHECK:
                line = source.count("\n", 0, at) + 1
                complaints.append(f"{name}:{line}: forcegate explain does not know the check {word}; give it a row in {EXPLAINED}")
    return complaints


if __name__ == "__main__":
    main(check)
