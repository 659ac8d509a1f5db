"""ATI stand-alone F/T controller on RS-232 (ATI 9620-05-CTL): an example of a reference adapter.

options: baud = 38400, counts_per_force, units = "N" or "lbf" of the calibration sheet, axis = "Fz", sign = 1 or -1 (pressing the
sensor reads negative), checksum = true
"""

import struct
import time

from .base import FAULT, SATURATED, AdapterError, Reading, ReferenceAdapter, check_options
from .ports import open_port

AXES = ("Fx", "Fy", "Fz")
NEWTONS = {"N": 1.0, "lbf": 4.4482216152605}


def parse_record(data, checksum):
    """(error, counts) of the record that begins `data`; None when bytes are missing; ValueError when it is none.

    error u8 | six i16 big-endian | sum of these 13 bytes modulo 256
    """
    size = 14 if checksum else 13
    if len(data) < size:
        return None
    if checksum and sum(data[:13]) & 0xFF != data[13]:
        raise ValueError("checksum")
    if data[0] > 9:
        raise ValueError("error byte")
    return data[0], struct.unpack(">6h", bytes(data[1:13]))


def _choice(options, key, otherwise, choices):
    value = options.get(key, otherwise)
    if value not in choices:
        raise AdapterError(f"the option {key} cannot be {value!r}", "choose one of: " + ", ".join(map(str, choices)))
    return value


class AtiSerial(ReferenceAdapter):
    def open(self, port, options, exclusive):
        check_options(options, ("baud", "counts_per_force", "units", "axis", "sign", "checksum"), ("counts_per_force",))
        self.baud = int(options.get("baud", 38400))
        newtons, sign = NEWTONS[_choice(options, "units", "N", NEWTONS)], _choice(options, "sign", 1, (1, -1))
        self.newtons_per_count = sign * newtons / float(options["counts_per_force"])
        self.axis = AXES.index(_choice(options, "axis", "Fz", AXES))
        self.checksum = bool(options.get("checksum", True))
        self.line = open_port(port, self.baud, exclusive=exclusive)
        self.data = bytearray()
        self.period_s = (14 if self.checksum else 13) * 10.0 / self.baud
        self._rest()
        for command in ("CD B", "CD R", "CD E" if self.checksum else "CD U", "SM 1"):
            self._command(command)
        return {"model": "ATI F/T controller"}

    def close(self):
        if getattr(self, "line", None) is not None:
            try:
                self.line.write(b"\r")
            finally:
                self.line.close()
                self.line = None

    def _until_prompt(self, echo=b"", patience_s=1.0):
        """What comes from the echo on up to the prompt: a prompt before it answers something older, such as the CR with
        which the line was closed the last time."""
        reply = b""
        end = time.monotonic() + patience_s
        while time.monotonic() < end:
            more = self.line.read(4096)
            reply += more
            answer = reply[reply.find(echo):].rstrip() if echo in reply else b""
            if more and answer.endswith(b">"):
                return answer[:-1]
            time.sleep(0.001)
        if echo and reply:
            return reply
        raise AdapterError("the ATI controller does not answer", "check power, cable and baud rate")

    def _rest(self):
        """A CR stops a stream; it has stopped when the next CR gives the prompt alone."""
        for _ in range(3):
            self.line.write(b"\r")
            self._until_prompt()
            self.line.write(b"\r")
            if not self._until_prompt().strip():
                self.data.clear()
                return
        raise AdapterError("the ATI controller does not come to rest", "check the baud rate")

    def _command(self, text):
        self.line.write(text.encode() + b"\r")
        echo = self._until_prompt(text.encode()).strip()
        if not echo.startswith(text.encode()) or b"?" in echo:
            raise AdapterError(f"the ATI controller refuses '{text}': {echo!r}")

    def start(self):
        self._rest()
        self.bad_in_a_row = 0
        self.last_s = -1e300
        self._ask()

    def _ask(self):
        self.line.write(b"QS\r")
        self.data.clear()
        self.echo = True
        self.stopping_s = None
        self.late_s = None
        self.count = 0

    def _stop(self):
        """There is no sync byte: a stream that cannot be read is stopped, and asked for again when it has come to rest."""
        self.line.write(b"\r")
        self.data.clear()
        self.stopping_s = time.monotonic()

    def _rests(self):
        """Whether a stream that was told to stop has done so: a prompt alone. Never waits, unlike _rest()."""
        if self.data.strip() == b">":
            return True
        if self.data.rstrip().endswith(b">"):  # of the stream, or a byte of a record: the next CR tells
            self.line.write(b"\r")
            self.data.clear()
        if time.monotonic() - self.stopping_s > 1.0:
            raise AdapterError("the ATI controller does not come to rest", "check the baud rate")
        return False

    def stop(self):
        self._rest()

    def poll(self):
        now_s = time.monotonic()
        self.data += self.line.read(65536)
        if self.stopping_s is not None:
            if self._rests():
                self._ask()
            return []
        if self.echo:
            while self.data and self.data[0:1] in (b"Q", b"S", b"\r", b"\n"):
                del self.data[0]
            if not self.data:
                return []
            self.echo = False
        readings = []
        while True:
            try:
                record = parse_record(self.data, self.checksum)
            except ValueError:
                self.bad_in_a_row += 1
                if self.bad_in_a_row > 10:
                    raise AdapterError("the ATI stream is unreadable", "check baud rate and cable") from None
                self._stop()
                return readings
            if record is None:
                return readings
            del self.data[: 14 if self.checksum else 13]
            self.bad_in_a_row = 0
            error, counts = record
            # No record comes before it was measured: the earliest arrivals carry the controller's clock.
            lag_s = now_s - self.count * self.period_s
            if self.late_s is None or lag_s - self.late_s > 0.025:  # records were lost, or come late: the next ones tell
                self.settled_s = now_s + 0.05 if self.late_s is not None else now_s
                self.late_s = lag_s
            self.late_s = min(self.late_s + 1e-4 * self.period_s, lag_s)
            t_s = self.count * self.period_s + self.late_s - self.period_s
            self.count += 1
            if now_s < self.settled_s or t_s <= self.last_s:
                continue
            self.last_s = t_s
            force_N = None if error else counts[self.axis] * self.newtons_per_count
            readings.append(Reading(t_s, force_N, SATURATED if error == 1 else FAULT if error else 0))
