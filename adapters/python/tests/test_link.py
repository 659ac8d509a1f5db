"""Frames, against the worked bytes of docs/protocol.md and against damage."""

import pathlib
import random
import re
import struct
import unittest

from forcegate_adapter import link

PROTOCOL = pathlib.Path(__file__).resolve().parents[3] / "docs" / "protocol.md"


def worked_examples():
    """Title -> bytes of each worked example of the document."""
    lines = PROTOCOL.read_text(encoding="utf-8").splitlines()
    return {lines[i - 1].strip(): bytes.fromhex(line) for i, line in enumerate(lines)
            if re.fullmatch(r" {6}([0-9a-f]{2} )+00", line)}


class Frames(unittest.TestCase):
    def test_the_worked_examples_of_the_document_are_what_we_write_and_read(self):
        examples = worked_examples()
        expected = {
            "HELLO": link.Frame(link.HELLO, 0, 0, struct.pack("<I", 0x12345678)),
            "STREAM": link.Frame(link.STREAM, 3, 0, struct.pack("<BHB", 1, 1, 10)),
            "STREAM state": link.Frame(link.STREAM_STATE, 4, 2500000, struct.pack("<HBHB", 3, 1, 1, 10)),
            "TIME": link.Frame(0x05, 8, 0, struct.pack("<d", 1.5)),
            "TIME reply": link.Frame(0x88, 9, 2500000, struct.pack("<Hd", 8, 1.5)),
            "NAK": link.Frame(link.NAK, 7, 0, bytes([5, 0, 5, 3])),
            "SAMPLES": link.Frame(link.SAMPLES, 6, 640000, struct.pack("<HIBHH", 5, 640, 2, 0, 0)
                                  + 2 * struct.pack("<HfB", 100, 1.5, 1)),
        }
        for name, frame in expected.items():
            raw = next(data for title, data in examples.items() if title.startswith(name + ","))
            self.assertEqual(link.encode(frame), raw, name)
            self.assertEqual(link.Splitter().feed(raw), [frame], name)

    def test_every_flipped_bit_is_seen(self):
        raw = link.encode(link.Frame(link.HELLO, 3, 77, b"\0\1\0\2"))
        for bit in range(8 * (len(raw) - 1)):
            damaged = bytearray(raw)
            damaged[bit // 8] ^= 1 << bit % 8
            self.assertEqual(link.Splitter().feed(damaged), [], bit)

    def test_any_bytes_survive_the_stuffing_whatever_the_cuts(self):
        rng = random.Random(1)
        for _ in range(200):
            payload = bytes(rng.choice((0, 0, rng.randrange(256))) for _ in range(rng.randrange(242)))
            frame = link.Frame(link.SAMPLES, rng.randrange(65536), rng.randrange(2**32), payload)
            raw = b"\0" + link.encode(frame)
            cut = rng.randrange(len(raw))
            splitter = link.Splitter()
            self.assertEqual(splitter.feed(raw[:cut]) + splitter.feed(raw[cut:]), [frame])
            self.assertEqual(splitter.bad, 0)

    def test_a_stream_without_end_is_dropped_and_counted(self):
        splitter = link.Splitter()
        splitter.feed(b"\x55" * 10000)
        self.assertLess(len(splitter.rest), 600)
        self.assertGreater(splitter.bad, 0)


if __name__ == "__main__":
    unittest.main()
