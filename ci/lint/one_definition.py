#!/usr/bin/env python3
"""Refuses two types of one qualified name: where both are linked into one program no compiler sees both, and the linker takes
the inline functions of one for both. What an anonymous namespace holds is its file's own; a folder of tests is a program of its own."""

import re
from common import files, main, text

NOISE = re.compile(r'//[^\n]*|/\*.*?\*/|R"([^(\s]*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|(?<![0-9a-zA-Z])\'(?:\\.|[^\'\\\n])+\'|^[ \t]*#(?:\\\n|[^\n])*',
                   re.S | re.M)
TOKEN = re.compile(r"\bnamespace\s*(?P<namespace>[\w:]*)\s*\{|"
                   r"\b(?:class|struct|union|enum(?:\s+(?:class|struct))?)\s+(?:\[\[[^\]]*\]\]\s*|alignas\([^)]*\)\s*)?(?P<type>\w+(?:::\w+)*)"
                   r"(?P<special><[^;{}]*>)?(?:\s+final)?\s*(?::(?!:)[^;{}()]*)?\{|(?P<open>[{(])|(?P<close>[})])")


def types(source):
    """(line, qualified name) of each type that is defined in a namespace with a name."""
    source = NOISE.sub(lambda m: "\n" * m.group().count("\n"), source)
    scopes, found, line, at = [], [], 1, 0  # a scope is the name of its namespace, "" for whatever else has braces
    for token in TOKEN.finditer(source):
        line, at = line + source.count("\n", at, token.start()), token.start()
        if token["close"]:
            if scopes:
                scopes.pop()
            continue
        if token["namespace"] is not None:
            scopes.append(token["namespace"])
            continue
        if token["type"] and token["special"] is None and all(scopes):
            found.append((line, "::".join(scopes + [token["type"]])))
        scopes.append("")
    return found


def program(name):
    return name.rsplit("/", 1)[0] if name.startswith("tests/") else ""


def check(root):
    complaints, places = [], {}
    for name in files(root, ".h", ".cpp"):
        for line, qualified in types(text(root, name)):
            for other, where in places.setdefault(qualified, []):
                if program(other) in ("", program(name)) or program(name) == "":
                    complaints.append(f"{name}:{line}: {qualified} is another type in {where}; call each what it is, or put it into an "
                                      "anonymous namespace")
                    break
            places[qualified].append((name, f"{name}:{line}"))
    return complaints


if __name__ == "__main__":
    main(check)
