"""Serial ports: which there are, and opening one."""

import glob
import os
from typing import NamedTuple, Optional

try:
    import serial
    from serial.tools import list_ports
except ModuleNotFoundError:  # the harness shows the last line of a program that ends so
    raise ModuleNotFoundError("this Python has no pyserial: apt-get install python3-serial and take /usr/bin/python3, or pip install pyserial") from None

from .base import AdapterError


class Port(NamedTuple):
    path: str  # the stable name where there is one
    device: str
    description: str
    serial_number: Optional[str]
    vendor_product: Optional[str]  # "0403:6001"


def _stable_names(folder="/dev/serial/by-id"):
    return {os.path.realpath(link): link for link in sorted(glob.glob(os.path.join(folder, "*")))}


def find_ports(text="", ports=None, stable=None):
    """Ports whose name, description, serial number or vendor:product contains `text`."""
    stable = _stable_names() if stable is None else stable
    found = []
    for p in sorted(list_ports.comports() if ports is None else ports):
        ids = f"{p.vid:04x}:{p.pid:04x}" if p.vid is not None else None
        port = Port(stable.get(os.path.realpath(p.device), p.device), p.device, p.description or "", p.serial_number, ids)
        if any(text.lower() in (word or "").lower() for word in port):
            found.append(port)
    return found


def open_port(port, baud, parity="N", exclusive=True):
    """8 data bits, one stop bit, reads that do not wait. `port` is a path, or words that fit exactly one port."""
    if not port:
        raise AdapterError("no port is given", "write port = \"...\" into the instrument's table of the bench file")
    if not os.path.exists(port):
        fitting = find_ports(port)
        if len(fitting) != 1:
            raise AdapterError(f"{len(fitting)} ports fit '{port}'", "python3 -m forcegate_adapter ports lists what is connected")
        port = fitting[0].path
    try:
        return serial.Serial(port, baudrate=baud, parity=parity, timeout=0, write_timeout=1.0, exclusive=exclusive or None)
    except (serial.SerialException, ValueError, OSError) as error:
        raise AdapterError(f"cannot open {port}: {error}", "check that it is connected, that you may open it (group dialout), "
                           "and that no other program has it") from error
