"""python3 -m forcegate_adapter ports [WORDS]        serial ports that are connected
python3 -m forcegate_adapter ati | board | drive     serves the bench on standard input and output (docs/adapters.md)
python3 -m forcegate_adapter watch ati PORT [KEY=VALUE ...]    prints readings for a person, without a bench
python3 -m forcegate_adapter twin                    an ATI controller to talk to, on a pseudo terminal
"""

import sys
import time

from .ati import AtiSerial
from .base import AdapterError, serve
from .board import LinkBoard
from .drive import RtuDrive
from .ports import find_ports

ADAPTERS = {"ati": AtiSerial, "board": LinkBoard, "drive": RtuDrive}


def _option(word):
    key, _, value = word.partition("=")
    try:
        return key, float(value) if "." in value else int(value, 0)
    except ValueError:
        return key, {"true": True, "false": False}.get(value, value)


def _ports(words):
    found = find_ports(" ".join(words))
    for port in found:
        print(f"{port.path}\n    {port.description}  {port.vendor_product or ''}  {port.serial_number or ''}")
    if not found:
        print("no serial port is connected" if not words else "no serial port fits")
    return 0


def _watch(name, port, options, seconds):
    adapter = ADAPTERS[name]()
    try:
        print(adapter.open(port, dict(map(_option, options)), True))
        if name == "drive":
            print(adapter.read())
            return 0
        adapter.start(1000.0) if name == "board" else adapter.start()
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            time.sleep(0.2)
            told = adapter.poll()
            rows = told[0] if name == "board" else told
            print(f"{len(rows)} in 0.2 s, last: {rows[-1] if rows else 'none'}")
        adapter.stop()
        return 0
    finally:
        adapter.close()


def _twin():
    from .ati_twin import AtiTwin
    from .null_modem import NullModem

    with NullModem() as cable:
        print(f"ATI F/T controller, 1000 counts per N, on {cable.ports[0]}; Ctrl-C ends it", flush=True)
        AtiTwin(cable.ports[1]).run(lambda: False)
    return 0


def main(words):
    if words[:1] == ["ports"]:
        return _ports(words[1:])
    if len(words) == 1 and words[0] in ADAPTERS:
        serve(ADAPTERS[words[0]]())
        return 0
    if words == ["twin"]:
        return _twin()
    if len(words) >= 3 and words[0] == "watch" and words[1] in ADAPTERS:
        return _watch(words[1], words[2], words[3:], 2.0)
    print(__doc__.strip(), file=sys.stdout if words in (["--help"], ["-h"]) else sys.stderr)
    return 0 if words in (["--help"], ["-h"]) else 2


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except KeyboardInterrupt:
        sys.exit(130)
    except AdapterError as error:
        print(f"error: {error}" + (f"\n  help: {error.hint}" if error.hint else ""), file=sys.stderr)
        sys.exit(4)
