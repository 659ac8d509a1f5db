"""Sensor board on a serial line, link protocol of docs/protocol.md: an example of a board adapter.

options: baud = 460800, batch = 10
"""

import struct
import time

from . import link
from .base import AdapterError, BoardAdapter, Sample, check_options
from .ports import open_port


class LinkBoard(BoardAdapter):
    def open(self, port, options, exclusive):
        check_options(options, ("baud", "batch"))
        self.batch = int(options.get("batch", 10))
        self.line = open_port(port, int(options.get("baud", 460800)), exclusive=exclusive)
        self.splitter = link.Splitter()
        self.sequence = 0
        self.expected = None
        self.dropped = self.overruns = 0
        self.stream = None
        self.line.write(b"\0")  # ends whatever half a frame the board has in its buffer
        self.stop()
        info = self._info(0)
        return {"model": info["board"], "firmware": info["build_id"]}

    def close(self):
        if getattr(self, "line", None) is not None:
            try:
                self._send(link.STREAM, struct.pack("<BHB", 0, 1, 1))
            finally:
                self.line.close()
                self.line = None

    def _send(self, kind, payload=b""):
        sequence = self.sequence
        self.sequence = (self.sequence + 1) & 0xFFFF
        self.line.write(link.encode(link.Frame(kind, sequence, 0, payload)))
        return sequence

    def _frames(self):
        for frame in self.splitter.feed(self.line.read(65536)):
            if frame.version >> 4 != link.VERSION >> 4:
                raise AdapterError(f"unknown protocol major {frame.version >> 4}")
            if self.expected is not None:
                gap = (frame.sequence - self.expected) & 0xFFFF
                self.dropped += gap if gap < 0x8000 else 0
            self.expected = (frame.sequence + 1) & 0xFFFF
            if frame.type == link.EVENT:
                self.overruns += 1
            yield frame

    def _ask(self, kind, payload, answer):
        for _ in range(3):
            request = self._send(kind, payload)
            end = time.monotonic() + 0.25
            while time.monotonic() < end:
                for frame in self._frames():
                    if len(frame.payload) < 2 or struct.unpack_from("<H", frame.payload)[0] != request:
                        continue
                    if frame.type == link.NAK:
                        raise AdapterError(f"the board refuses a request with code {frame.payload[2]}")
                    if frame.type == answer:
                        return frame
                time.sleep(0.001)
        raise AdapterError("the board does not answer", "check power, cable and baud rate of the sensor board")

    def _info(self, nonce):
        frame = self._ask(link.HELLO, struct.pack("<I", nonce), link.INFO)
        _, echoed, bits, rate, _, _, build, board, algorithm = struct.unpack("<HIBHBI20s24s32s", frame.payload)
        text = lambda raw: raw.split(b"\0")[0].decode("ascii", "replace")
        return {"nonce": echoed, "adc_bits": bits, "rate_Hz": rate, "build_id": build.hex(), "board": text(board),
                "algorithm_id": text(algorithm), "protocol_major": frame.version >> 4, "protocol_minor": frame.version & 15}

    def load(self, session):
        self.stop()
        info = self._info(int(session["nonce"]))
        calibration = struct.pack("<5fB16s", session["gain_N_per_V"], session["offset_N"], session["v_range_V"],
                                  session["b_scale"], session["q_scale"], int(session["adc_bits"]),
                                  session["calibration_id"].encode("ascii", "replace")[:16])
        frame = self._ask(link.PARAM, b"\x01\x01" + calibration, link.PARAM_VALUE)
        if frame.payload[3:] != calibration:
            raise AdapterError("the board does not echo the calibration")
        self._ask(link.RESET, b"", link.RESET_DONE)
        self.dropped = self.overruns = self.splitter.bad = 0
        return {**info, "adc_bits": int(session["adc_bits"])}

    def start(self, rate_Hz):
        frame = self._ask(link.STREAM, struct.pack("<BHB", 1, 1, self.batch), link.STREAM_STATE)
        if not frame.payload[2]:
            raise AdapterError("the board does not start its stream")
        self.stream = struct.unpack_from("<H", frame.payload)[0]
        self.next_index = 0

    def stop(self):
        self.stream = None
        self._ask(link.STREAM, struct.pack("<BHB", 0, 1, 1), link.STREAM_STATE)

    def poll(self):
        samples = []
        for frame in self._frames():
            if frame.type != link.SAMPLES:
                continue
            request, first, n, _, _ = struct.unpack_from("<HIBHH", frame.payload)
            if len(frame.payload) != 11 + 7 * n:
                raise AdapterError("the board sends a malformed SAMPLES frame")
            if request != self.stream or first < self.next_index:
                continue  # of a stream that was stopped before, or a repetition
            for i in range(n):
                samples.append(Sample(first + i, *struct.unpack_from("<HfB", frame.payload, 11 + 7 * i)))
            self.next_index = first + n
        return samples, {"frames_bad": self.splitter.bad, "frames_dropped": self.dropped, "overruns": self.overruns}
