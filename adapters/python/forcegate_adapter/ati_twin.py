"""A twin of the ATI F/T controller written with pyserial: answers the commands and streams a slow sine. It is there to
talk to; the twins of `forcegate bench serve` have a whole bench behind them."""

import math
import struct
import time

import serial


def record(error, counts, checksum):
    data = bytes([error]) + struct.pack(">6h", *counts)
    return data + bytes([sum(data) & 0xFF]) if checksum else data


class AtiTwin:
    def __init__(self, port, counts_per_N=1000.0, baud=38400):
        self.line = serial.Serial(port, baudrate=baud, timeout=0)
        self.counts_per_N = counts_per_N
        self.baud = baud
        self.binary = self.checksum = self.streaming = False
        self.text = b""
        self.started_s = time.monotonic()
        self.next_s = 0.0

    def force_N(self, t_s):
        return 2.0 + math.sin(2.0 * math.pi * 0.5 * t_s)

    def _record(self, t_s):
        counts = [3, -2, round(self.force_N(t_s) * self.counts_per_N), 1, 0, -1]
        if self.binary:
            return record(0, counts, self.checksum)
        return b"0" + b"".join(b",%6d" % c for c in counts) + b"\r\n"

    def step(self):
        """Does what is due; returns the time until something is due again, in s."""
        t_s = time.monotonic() - self.started_s
        for byte in self.line.read(4096):
            self.streaming = False
            if byte not in (10, 13):
                self.text += bytes([byte])
            elif byte == 13:
                self._obey(self.text, t_s)
                self.text = b""
        while self.streaming and self.next_s <= t_s:
            self.line.write(self._record(self.next_s))
            self.next_s += (14 if self.checksum else 13) * 10.0 / self.baud if self.binary else 450.0 / self.baud
        return max(0.0, min(0.002, self.next_s - t_s)) if self.streaming else 0.002

    def _obey(self, command, t_s):
        if command == b"QS":
            self.streaming = True
            self.next_s = t_s
            self.line.write(b"QS\r\n")
            return
        known = command.split(b" ")[0] in (b"", b"CD", b"SA", b"SM", b"SB", b"SU", b"SZ", b"CF", b"QR")
        if command.startswith(b"CD "):
            form = command[3:]
            self.binary = {b"A": False, b"B": True}.get(form, self.binary)
            self.checksum = {b"E": True, b"U": False}.get(form, self.checksum)
        answer = self._record(t_s) if command == b"QR" else b"" if known else b"? unknown command\r\n"
        self.line.write(command + b"\r\n" + answer + b"\r\n>")

    def run(self, stop):
        while not stop():
            time.sleep(self.step())
