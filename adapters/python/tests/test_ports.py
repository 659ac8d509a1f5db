import os
import unittest

from serial.tools.list_ports_common import ListPortInfo

from forcegate_adapter import AdapterError, find_ports, open_port
from forcegate_adapter.null_modem import NullModem


def port(device, description, vid=None, pid=None, number=None):
    info = ListPortInfo(device)
    info.description, info.vid, info.pid, info.serial_number = description, vid, pid, number
    return info


class Ports(unittest.TestCase):
    def setUp(self):
        self.ports = [port("/dev/ttyUSB0", "FT232R USB UART", 0x0403, 0x6001, "A9XYZ"), port("/dev/ttyACM0", "Arduino Due", 0x2341, 0x003E)]

    def test_a_port_is_found_by_name_number_or_maker(self):
        for words in ("ft232", "a9xyz", "0403:6001", "ttyUSB0"):
            self.assertEqual([p.device for p in find_ports(words, self.ports, {})], ["/dev/ttyUSB0"], words)
        self.assertEqual(find_ports("nothing like it", self.ports, {}), [])
        self.assertEqual(len(find_ports("", self.ports, {})), 2)

    def test_the_stable_name_stands_for_the_device(self):
        stable = {os.path.realpath("/dev/ttyACM0"): "/dev/serial/by-id/usb-Arduino"}
        self.assertEqual(find_ports("due", self.ports, stable)[0].path, "/dev/serial/by-id/usb-Arduino")

    def test_a_port_that_is_not_there_is_an_error_with_a_remedy(self):
        with self.assertRaises(AdapterError) as caught:
            open_port("/dev/no-such-port", 9600)
        self.assertIn("lists what is connected", caught.exception.hint)

    def test_two_programs_cannot_have_one_port(self):
        with NullModem() as cable:
            with open_port(cable.ports[0], 38400):
                with self.assertRaises(AdapterError):
                    open_port(cable.ports[0], 38400)

    def test_bytes_cross_the_cable_at_any_rate(self):
        with NullModem() as cable:
            with open_port(cable.ports[0], 1250000) as a, open_port(cable.ports[1], 1250000) as b:
                a.write(b"\x00\x11\x13\x7f\xff\r\n")
                b.timeout = 2
                self.assertEqual(b.read(7), b"\x00\x11\x13\x7f\xff\r\n")


if __name__ == "__main__":
    unittest.main()
