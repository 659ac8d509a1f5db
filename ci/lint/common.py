"""What the lints share: the tracked files and the way to complain."""

import subprocess
import sys
from pathlib import Path


def files(root, *suffixes):
    """Files below root that belong to the project (tracked, or new and not ignored), sorted."""
    root = Path(root)
    if (root / ".git").exists():
        out = subprocess.run(["git", "-c", "safe.directory=*", "-C", str(root), "ls-files", "-co", "--exclude-standard", "-z"],
                             check=True, capture_output=True).stdout.decode()
        names = sorted(set(name for name in out.split("\0") if name))
    else:
        names = sorted(str(p.relative_to(root)) for p in root.rglob("*") if p.is_file()
                       and not p.relative_to(root).parts[0].startswith("build"))
    return [n for n in names if n.endswith(suffixes) and (root / n).is_file()]


def text(root, name):
    return (Path(root) / name).read_text(encoding="utf-8", errors="replace")


def main(check):
    """check(root) -> list of "file:line: what is wrong"; code 1 when there are any."""
    root = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parents[2]
    complaints = check(root)
    for complaint in complaints:
        print(complaint, file=sys.stderr)
    sys.exit(1 if complaints else 0)
