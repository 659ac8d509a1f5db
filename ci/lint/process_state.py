#!/usr/bin/env python3
"""Refuses a library that reads the environment or writes to the console: the same input would no longer give the same bytes, and a
trace left from a search for a fault would be shipped. The console belongs to hil/cli."""

import re
from common import files, main, text

LIBRARIES = ("hil/", "adapters/", "golden/", "rigs/emulated/", "stimuli/")
# the console itself; the search path of programs that are started or looked for; the folder of leases; what a process of its own says
ALLOWED = ("hil/cli/", "hil/app/help/doctor.cpp", "hil/rig/lease.cpp", "adapters/transport/child_process.cpp")
STATE = re.compile(r"\b(getenv|stderr|stdout|std::cerr|std::cout|printf|puts)\b\s*[(,;)<]")


def check(root):
    complaints = []
    for name in files(root, ".h", ".cpp"):
        if not name.startswith(LIBRARIES) or name.startswith(ALLOWED):
            continue
        for number, line in enumerate(text(root, name).splitlines(), 1):
            match = STATE.search(line.split("//")[0])
            if match:
                complaints.append(f"{name}:{number}: {match.group(1)}: a library neither reads the environment nor writes to the console; "
                                  "return it, or let hil/cli print it")
    return complaints


if __name__ == "__main__":
    main(check)
