#!/usr/bin/env python3
"""One concept, one file: sources stay below 400 lines."""

from common import files, main, text

LIMIT = 400


def check(root):
    complaints = []
    for name in files(root, ".h", ".cpp", ".c", ".py"):
        lines = text(root, name).count("\n")
        if lines >= LIMIT:
            complaints.append(f"{name}:{LIMIT}: {lines} lines; split it by concept (limit {LIMIT})")
    return complaints


if __name__ == "__main__":
    main(check)
