#!/usr/bin/env python3
"""Refuses an #include that crosses a wall. A header compiles anywhere, so this is the wall; the link lists (link_lists.py) follow it.

Folder -> what it may include of the project, and which third-party headers (in .cpp files only, save where a
header is named under HEADERS). hil/base is free for all except the firmware. A folder names only folders above it, so there is no circle."""

import re
from common import files, main, text

EVERY = "every library"


def app(*rooms):
    """hil/app joins what no other folder may join; its rooms stand in an order."""
    return [EVERY, "hil/app/files"] + [f"hil/app/{room}" for room in rooms]


WALLS = {
    "hil/base": [],
    "hil/trace": [],
    "hil/interface": ["hil/trace"],
    "hil/model": ["hil/trace"],
    "hil/rig": ["hil/trace", "hil/interface"],
    "hil/diagnose": ["hil/trace", "hil/model", "hil/interface"],
    "hil/gate": ["hil/trace", "hil/interface", "hil/rig"],
    "hil/characterize": ["hil/trace", "hil/interface", "hil/rig", "hil/gate", "hil/model/impedance"],
    "hil/report": ["hil/trace", "hil/interface", "hil/model", "hil/diagnose", "hil/characterize"],
    "adapters": ["hil/trace", "hil/interface"],
    "stimuli": ["hil/trace", "hil/interface"],
    "golden/compare": ["hil/trace", "hil/interface"],
    "rigs/emulated": ["hil/trace", "hil/interface", "adapters/transport"],
    "rigs/firmware": None,  # the device under test: nothing of the harness
    "hil/app/files": [EVERY],
    "hil/app/play": app(),
    "hil/app/gate": app("play"),
    "hil/app/stored": app("play", "gate"),
    "hil/app/power": app("gate"),
    "hil/app/bench": app("gate"),
    "hil/app/recording": app(),
    "hil/app/characterize": app(),
    "hil/app/pictures": app(),
    "hil/app/model": app("pictures"),
    "hil/app/export": app("model"),
    "hil/app/mystery": app(),
    "hil/app/league": app("model", "mystery"),
    "hil/app/diagnose": app("recording", "pictures", "model", "export", "mystery"),
    "hil/app/help": app(),
    "hil/app": [],  # no room: what stands here is refused
    "hil/cli": ["hil/app", "hil/report", "hil/interface"],  # interface: names of the plug-ins as choices
}

WHY = {
    ("rigs/emulated", "hil/model"): "truth must not see belief: an engine that only knows its own formulas proves nothing",
    ("rigs/emulated", "hil/diagnose"): "truth must not see belief",
    ("hil/model", "rigs/emulated"): "belief must not see truth",
    ("hil/diagnose", "rigs/emulated"): "belief must not see truth",
    ("rigs/emulated", "hil/characterize"): "the rig must not see what is read off it",
    ("hil/characterize", "rigs/emulated"): "a characterisation sees a rig, never what it is made of",
    ("rigs/emulated", "adapters"): "a twin's encoder and an adapter's decoder share no code",
    ("rigs/firmware", "*"): "the firmware is judged by the harness and may share nothing with it",
}

THIRD_PARTY = {  # first directory or name of the header -> folders whose .cpp files may include it
    "toml++": ["hil/rig", "hil/gate", "hil/model", "hil/diagnose", "hil/app", "golden/compare", "rigs/emulated",
               "adapters"],
    "nlohmann": ["hil/report", "hil/app", "hil/cli", "hil/gate", "hil/trace", "hil/diagnose",
                 "golden/compare", "adapters", "rigs/emulated"],
    "pugixml": ["hil/report"],
    "hdf5": ["hil/trace"],
    "matio": ["hil/trace"],
    "muParser": ["hil/model"],
    "modbus": ["adapters", "rigs/emulated"],
    "hidapi": ["adapters"],
    "openssl": ["hil/base"],
}
# The handle of HDF5 is private to the three files that read and write it.
HEADERS = {("hdf5", "hil/trace")}

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


def within(path, folders):
    return any(path == folder or path.startswith(folder + "/") for folder in folders)


def folder_of(path):
    """Longest wall that holds the path."""
    return max((wall for wall in WALLS if within(path, [wall])), key=len, default="")


def complaint_of(name, header, quoted):
    own = folder_of(name)
    if not own:
        return None
    if quoted:
        target = folder_of(header)
        if own == "rigs/firmware":
            outside = target and target != own
            return WHY[("rigs/firmware", "*")] if outside or header.startswith(("../..", "hil/")) else None
        if header.startswith(".."):
            return "includes start at the root"
        if not target or target in (own, "hil/base"):
            return None
        allowed = WALLS[own]
        if EVERY in allowed and not target.startswith(("hil/app", "hil/cli", "rigs/firmware")):
            return None
        if any(header.startswith(a + "/") for a in allowed):
            return None
        return WHY.get((own, target), f"{own} may include only hil/base and {', '.join(allowed) or 'nothing else'}")
    library = re.split(r"[/.]", header)[0]
    if library not in THIRD_PARTY:
        return None
    if not within(own, THIRD_PARTY[library]):
        return f"{library} belongs to {', '.join(THIRD_PARTY[library])}"
    if name.endswith(".h") and (library, own) not in HEADERS:
        return f"{library} stays inside one .cpp file, never in a header"
    return None


def check(root):
    complaints = []
    for name in files(root, ".h", ".cpp", ".c"):
        if folder_of(name) == "hil/app":
            complaints.append(f"{name}:1: stands in no room of hil/app (WALLS names them)")
        for number, line in enumerate(text(root, name).splitlines(), 1):
            match = INCLUDE.match(line)
            if match:
                why = complaint_of(name, match.group(2), match.group(1) == '"')
                if why:
                    complaints.append(f"{name}:{number}: must not include {match.group(2)}: {why}")
    return complaints


if __name__ == "__main__":
    main(check)
