"""The examples against instruments that are played with pyserial."""

import struct
import threading
import time
import unittest

import serial

from forcegate_adapter import AdapterError
from forcegate_adapter.base import FAULT, SATURATED
from forcegate_adapter.board import LinkBoard
from forcegate_adapter.ati import AtiSerial, parse_record
from forcegate_adapter.ati_twin import AtiTwin, record
from forcegate_adapter.drive import RtuDrive, crc16
from forcegate_adapter.null_modem import NullModem


class Played(unittest.TestCase):
    """An instrument in a thread, at the other end of a cable. Its port is opened before anybody writes: opening one discards
    what has come."""

    def setUp(self):
        self.cable = NullModem()
        self.addCleanup(self.cable.close)

    def play(self, run):
        self.over = threading.Event()
        self.thread = threading.Thread(target=run, args=(self.over.is_set,), daemon=True)
        self.thread.start()
        self.addCleanup(self.finish)

    def finish(self):
        self.over.set()
        self.thread.join()


class Ati(Played):
    def test_the_record_is_the_one_of_the_manual(self):
        raw = bytes.fromhex("00 0003 fffe 05dc 0001 0000 ffff e0")
        self.assertEqual(record(0, (3, -2, 1500, 1, 0, -1), True), raw)
        self.assertEqual(parse_record(raw, True), (0, (3, -2, 1500, 1, 0, -1)))
        self.assertIsNone(parse_record(raw[:13], True))
        for bit in range(8 * len(raw)):
            damaged = bytearray(raw)
            damaged[bit // 8] ^= 1 << bit % 8
            with self.assertRaises(ValueError):
                parse_record(damaged, True)

    def test_forces_come_as_they_were_played(self):
        twin = AtiTwin(self.cable.ports[1])
        self.play(twin.run)
        ati = AtiSerial()
        self.addCleanup(ati.close)
        ati.open(self.cable.ports[0], {"counts_per_force": 1000}, True)
        ati.start()
        readings = []
        end = time.monotonic() + 30
        while len(readings) < 100 and time.monotonic() < end:
            time.sleep(0.01)
            readings += ati.poll()
        ati.stop()
        self.assertGreaterEqual(len(readings), 100)
        errors = sorted(abs(r.force_N - twin.force_N(r.t_s - twin.started_s)) for r in readings)
        self.assertLess(errors[len(errors) // 2], 0.05)  # 3 N/s and some ms of a busy machine
        self.assertEqual([r.t_s for r in readings], sorted(r.t_s for r in readings))

    def test_prompts_that_come_late_do_not_put_commands_and_answers_out_of_step(self):
        line = serial.Serial(self.cable.ports[1], timeout=0.01)
        self.addCleanup(line.close)
        heard = []

        def run(stop):
            data = b""
            while not stop():
                data += line.read(64)
                while b"\r" in data:
                    text, data = data.split(b"\r", 1)
                    if text and not heard:
                        line.write(3 * b"\r\n\r\n>")
                        time.sleep(0.02)
                    heard.extend([text] if text else [])
                    line.write(text + b"\r\n\r\n>")

        self.play(run)
        ati = AtiSerial()
        self.addCleanup(ati.close)
        ati.open(self.cable.ports[0], {"counts_per_force": 1000}, True)
        self.assertEqual(heard, [b"CD B", b"CD R", b"CD E", b"SM 1"])

    def test_a_stream_that_cannot_be_read_is_asked_for_again_and_no_poll_waits(self):
        line = serial.Serial(self.cable.ports[1], timeout=0.005)
        self.addCleanup(line.close)
        asked = []

        def run(stop):
            data, streaming = b"", False
            while not stop():
                data += line.read(64)
                while b"\r" in data:
                    text, data = data.split(b"\r", 1)
                    if text == b"QS":
                        asked.append(text)
                        line.write(b"QS\r\n")
                        if len(asked) == 1:
                            line.write(14 * b"\xff")
                        streaming = True
                        continue
                    if asked:
                        time.sleep(0.4)  # answers take their time
                    streaming = False
                    line.write(text + b"\r\n\r\n>")
                if streaming and len(asked) > 1:
                    line.write(record(0, (0, 0, 1500, 0, 0, 0), True))

        self.play(run)
        ati = AtiSerial()
        self.addCleanup(ati.close)
        ati.open(self.cable.ports[0], {"counts_per_force": 1000}, True)
        ati.start()
        waits = []
        readings = []
        end = time.monotonic() + 30
        while len(readings) < 5 and time.monotonic() < end:
            time.sleep(0.01)
            begun_s = time.monotonic()
            readings += ati.poll()
            waits.append(time.monotonic() - begun_s)
        self.assertEqual(len(asked), 2)
        self.assertEqual({r.force_N for r in readings}, {1.5})
        self.assertLess(max(waits), 0.3)  # an answer of the controller takes longer

    def test_a_silent_line_is_an_error_not_a_hang(self):
        with self.assertRaises(AdapterError) as caught:
            AtiSerial().open(self.cable.ports[0], {"counts_per_force": 1000}, True)
        self.assertIn("does not answer", str(caught.exception))


    def readings(self, data, options):
        """What a stream with these bytes is read as, by an adapter that is past its echo."""
        twin = AtiTwin(self.cable.ports[1])
        self.play(twin.run)
        ati = AtiSerial()
        self.addCleanup(ati.close)
        ati.open(self.cable.ports[0], options, True)
        ati.start()
        end = time.monotonic() + 30
        while not ati.poll() and time.monotonic() < end:
            time.sleep(0.01)
        ati.line.reset_input_buffer()
        ati.data[:] = data
        ati.late_s, ati.last_s = time.monotonic() - ati.count * ati.period_s - 0.02, -1e300  # none of them comes before its time
        return ati.poll()

    def test_units_and_sign_of_the_sheet_count(self):
        read = self.readings(record(0, (0, 0, 1000, 0, 0, 0), True), {"counts_per_force": 1000, "units": "lbf", "sign": -1})
        self.assertAlmostEqual(read[0].force_N, -4.4482216, 6)

    def test_an_error_that_is_no_overload_is_none(self):
        read = self.readings(record(1, (0,) * 6, True) + record(2, (0,) * 6, True), {"counts_per_force": 1000})
        self.assertEqual([r.status for r in read[:2]], [SATURATED, FAULT])

    def test_options_that_nobody_reads_are_refused_before_anything_is_opened(self):
        for adapter, options, words in ((AtiSerial(), {"counts_per_force": 1000, "unit": "lbf"}, "'unit'"), (AtiSerial(), {}, "'counts_per_force' is missing"),
                                        (AtiSerial(), {"counts_per_force": 1000, "units": "kg"}, "cannot be 'kg'"), (LinkBoard(), {"bauds": 9600}, "'bauds'"),
                                        (RtuDrive(), {"comm_timout": 0x1100}, "'comm_timout'")):
            with self.assertRaises(AdapterError) as caught:
                adapter.open("/dev/none", options, True)
            self.assertIn(words, str(caught.exception))
            self.assertTrue(caught.exception.hint)


class Drive(Played):
    def open_drive(self, reply_to):
        """A drive whose answers, without CRC, are what `reply_to` makes of the requests."""
        line = serial.Serial(self.cable.ports[1], timeout=0.005)
        self.addCleanup(line.close)

        def run(stop):
            data = b""
            while not stop():
                data += line.read(64)
                while len(data) >= 8:
                    size = 8 if data[1] != 16 else 9 + data[6]
                    request, data = data[: size - 2], data[size:]
                    reply = reply_to(request)
                    line.write(reply + struct.pack("<H", crc16(reply)))

        self.play(run)
        drive = RtuDrive()
        self.addCleanup(drive.close)
        drive.open(self.cable.ports[0], {}, True)
        return drive

    def test_the_echo_of_another_write_confirms_none(self):
        drive = self.open_drive(lambda request: b"\x01\x06" + struct.pack(">HH", 0x7D, 0x28))  # the last velocity's, late
        with self.assertRaises(AdapterError) as caught:
            drive.emergency()
        self.assertIn("earlier requests", str(caught.exception))
        with self.assertRaises(AdapterError):
            drive.velocity(1.0)

    def test_a_drive_that_keeps_another_timeout_is_not_switched_on(self):
        written = []

        def reply_to(request):
            if request[1] == 6:
                written.append(struct.unpack(">HH", request[2:6]))
                return request[:6]
            if request[2:4] == b"\x10\x00":
                return b"\x01\x03\x02" + struct.pack(">H", 0)
            scratch = [word for register, word in written if register == 0x106][-1]
            return b"\x01\x03\x0e" + struct.pack(">HHiiH", 0, 0, 0, 0, scratch)

        drive = self.open_drive(reply_to)
        self.assertEqual(drive.arm(0.2), 0.0)
        self.assertIn((0x1000, 200), written)
        self.assertNotIn((0x7D, 0x20), written)

    def test_a_drive_that_began_anew_is_not_started_without_its_timeout(self):
        register = {}

        def reply_to(request):
            if request[1] == 6:
                number, word = struct.unpack(">HH", request[2:6])
                register[number] = word
                return request[:6]
            if request[1] == 16:
                return request[:6]
            if request[2:4] == b"\x10\x00":
                return b"\x01\x03\x02" + struct.pack(">H", register.get(0x1000, 0))
            running = 0x20 if register.get(0x7D) == 0x28 else 0
            return b"\x01\x03\x0e" + struct.pack(">HHiiH", running, 0, 0, 0, register[0x106])

        drive = self.open_drive(reply_to)
        self.assertEqual(drive.arm(0.2), 0.2)
        drive.velocity(1.0)
        self.assertTrue(drive.read()["running"])
        register.clear()  # it begins anew behind a reading
        drive.velocity(1.0)
        self.assertFalse(drive.read()["running"])
        with self.assertRaises(AdapterError) as caught:
            drive.velocity(1.0)
        self.assertIn("communication timeout", str(caught.exception))
        self.assertNotEqual(register.get(0x7D), 0x28)

    def test_the_checksum_is_the_one_of_the_specification(self):
        self.assertEqual(crc16(bytes.fromhex("11 03 00 6b 00 03")), 0x8776)

    def test_an_answer_to_an_earlier_request_is_refused(self):
        line = serial.Serial(self.cable.ports[1], timeout=0.01)
        self.addCleanup(line.close)

        def run(stop):  # echoes writes, reads always give the same registers
            data = b""
            while not stop():
                data += line.read(64)
                while len(data) >= 8:
                    request, data = data[:8], data[8:]
                    reply = request[:-2] if request[1] == 6 else b"\x01\x03\x0e" + struct.pack(">HHiiH", 1, 0, 0, 0, 4711)
                    line.write(reply + struct.pack("<H", crc16(reply)))

        self.play(run)
        drive = RtuDrive()
        self.addCleanup(drive.close)
        drive.open(self.cable.ports[0], {}, True)
        with self.assertRaises(AdapterError) as caught:
            drive.read()
        self.assertIn("earlier request", str(caught.exception))


if __name__ == "__main__":
    unittest.main()
