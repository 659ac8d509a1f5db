"""Velocity drive on Modbus RTU: an example of a motor adapter, for drives with a control word.

options: baud = 115200, parity = "N", "E" or "O", slave = 1, and register numbers (wire addresses from 0), by default those of rigs/twin_rtu.toml
"""

import math
import struct
import time

from .base import AdapterError, MotorAdapter, check_options
from .ports import open_port

REGISTERS = {"control": 0x7D, "status": 0x100, "scratch": 0x106, "velocity_set": 0x480, "comm_timeout": 0x1000}
COUNTS_PER_RAD = 131072 / (2.0 * math.pi)
VELOCITY_SCALE = 10000.0  # raw units of 0.0001 rad/s


def crc16(data):
    """Modbus over Serial Line V1.02, appendix B; the low byte travels first."""
    crc = 0xFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = (crc >> 1) ^ 0xA001 if crc & 1 else crc >> 1
    return crc


class RtuDrive(MotorAdapter):
    def open(self, port, options, exclusive):
        check_options(options, ("baud", "parity", "slave", *REGISTERS))
        self.slave = int(options.get("slave", 1))
        self.register = {name: int(options.get(name, number)) for name, number in REGISTERS.items()}
        self.line = open_port(port, int(options.get("baud", 115200)), options.get("parity", "N"), exclusive)
        self.counter = 0
        self.timeout_ms = None  # of a drive that is armed
        self.runs = False
        return {"model": "Modbus RTU drive"}

    def close(self):
        if getattr(self, "line", None) is not None:
            self.line.close()
            self.line = None

    def _exchange(self, function, data, size):
        """One request; the answer's data. Everything that came before the request is thrown away. RTU has no number of the
        request: the answer to a write is held against its address and value or count, or a late one would confirm another."""
        body = bytes([self.slave, function]) + data
        begins = body[:6] if function in (6, 16) else body[:2]
        last = "the drive does not answer"
        for _ in range(3):
            while self.line.read(4096):
                pass
            self.line.write(body + struct.pack("<H", crc16(body)))
            reply = b""
            end = time.monotonic() + 0.2
            while time.monotonic() < end and len(reply) < size + 4:
                reply += self.line.read(size + 4 - len(reply))
                if len(reply) == 5 and reply[1] == function | 0x80 and crc16(reply[:3]) == struct.unpack("<H", reply[3:])[0]:
                    raise AdapterError(f"the drive answers with exception {reply[2]}")
                time.sleep(0.0005)
            if len(reply) == size + 4 and reply.startswith(begins) and crc16(reply[:-2]) == struct.unpack("<H", reply[-2:])[0]:
                return reply[2:-2]
            if reply:
                last = "the drive's answers are damaged, or those to earlier requests"
            time.sleep(0.05)  # a late answer must not meet the next request
        raise AdapterError(last, "check power, cable, baud rate and slave number of the drive")

    def _keeps_timeout(self):
        """A drive that began anew has forgotten its timeout: told to run once more it would run on when the harness dies."""
        kept_ms = self._timeout_ms()
        if kept_ms != self.timeout_ms:
            raise AdapterError(f"the drive has lost its communication timeout while it was armed: {kept_ms} ms, it has begun anew",
                               "look at its supply and emergency switch, and for what resets it")

    def _timeout_ms(self):
        return struct.unpack(">H", self._exchange(3, struct.pack(">HH", self.register["comm_timeout"], 1), 3)[1:])[0]

    def _write(self, name, word):
        self._exchange(6, struct.pack(">HH", self.register[name], word), 4)

    def arm(self, timeout_s):
        state = self.read()
        if state["fault"]:
            raise AdapterError(f"the drive reports fault {state['fault_code']:#x}", "find its cause in the drive's manual, then reset it")
        timeout_ms = round(1000 * timeout_s)
        self._write("comm_timeout", timeout_ms)
        echoed_ms = self._timeout_ms()
        if echoed_ms == timeout_ms:  # else the bench refuses: a drive that would not stop by itself stays off
            self._write("control", 0x20)
            self.timeout_ms = timeout_ms
            self.runs = False
        return echoed_ms / 1000.0

    def velocity(self, rad_per_s):
        raw = struct.pack(">i", round(VELOCITY_SCALE * rad_per_s))
        self._exchange(16, struct.pack(">HHB", self.register["velocity_set"], 2, 4) + raw, 4)
        if not self.runs:
            self._keeps_timeout()
            self._write("control", 0x28)
            self.runs = True

    def read(self):
        self.counter = (self.counter + 1) & 0xFFFF
        self._write("scratch", self.counter)  # the answer must bring this number back: it is fresh
        data = self._exchange(3, struct.pack(">HH", self.register["status"], 7), 15)
        status, code, position, velocity, scratch = struct.unpack(">HHiiH", data[1:])
        if scratch != self.counter:
            raise AdapterError("the drive answers with the reply to an earlier request")
        if not status & 0x20:
            self.runs = False
        return {"theta_rad": position / COUNTS_PER_RAD, "velocity_rad_per_s": velocity / VELOCITY_SCALE,
                "running": bool(status & 0x20), "fault": bool(status & 0x80), "fault_code": code}

    def stop(self):
        self.runs = False
        self._write("control", 0x20)

    def emergency(self):
        self.runs = False
        self._write("control", 0x00)
