"""Frames of the board link (docs/protocol.md): header, payload, CRC-32, COBS, a zero byte behind each."""

import struct
import zlib
from typing import NamedTuple

HELLO, STREAM, PARAM, RESET = 0x01, 0x02, 0x04, 0x06
INFO, SAMPLES, EVENT, NAK, PARAM_VALUE, RESET_DONE, STREAM_STATE = 0x81, 0x82, 0x83, 0x84, 0x85, 0x86, 0x89
VERSION = 0x10
LONGEST = 253


class Frame(NamedTuple):
    type: int
    sequence: int
    t_us: int
    payload: bytes
    version: int = VERSION


def cobs_encode(data):
    out, block = bytearray(), bytearray()
    for byte in data:
        if byte:
            block.append(byte)
        else:
            out += bytes([len(block) + 1]) + block
            block.clear()
    return bytes(out + bytes([len(block) + 1]) + block)  # at most 253 bytes: a block is never split


def cobs_decode(data):
    out, at = bytearray(), 0
    while at < len(data):
        code = data[at]
        if code == 0 or at + code > len(data) or 0 in data[at + 1 : at + code]:
            raise ValueError("COBS")
        out += data[at + 1 : at + code]
        at += code
        if at < len(data):
            out.append(0)
    return bytes(out)


def encode(frame):
    body = struct.pack("<BBHI", frame.version, frame.type, frame.sequence & 0xFFFF, frame.t_us & 0xFFFFFFFF) + frame.payload
    return cobs_encode(body + struct.pack("<I", zlib.crc32(body))) + b"\0"


def decode(stretch):
    """Frame of the bytes between two zeros; ValueError when they are none."""
    body = cobs_decode(stretch)
    if not 12 <= len(body) <= LONGEST:
        raise ValueError("length")
    if zlib.crc32(body[:-4]) != struct.unpack("<I", body[-4:])[0]:
        raise ValueError("CRC")
    version, kind, sequence, t_us = struct.unpack("<BBHI", body[:8])
    return Frame(kind, sequence, t_us, body[8:-4], version)


class Splitter:
    """Cuts a byte stream at its zeros."""

    def __init__(self):
        self.rest = bytearray()
        self.bad = 0

    def feed(self, data):
        self.rest += data
        frames = []
        while (end := self.rest.find(0)) >= 0:
            stretch = bytes(self.rest[:end])
            del self.rest[: end + 1]
            if not stretch:
                continue
            try:
                frames.append(decode(stretch))
            except ValueError:
                self.bad += 1
        if len(self.rest) > 2 * LONGEST:  # no zero for so long: no frame of ours
            self.rest.clear()
            self.bad += 1
        return frames
