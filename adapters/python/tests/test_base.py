"""The loop that serves a bench."""

import io
import json
import pathlib
import textwrap
import unittest

from forcegate_adapter import AdapterError, Reading, ReferenceAdapter, base, serve


class Scale(ReferenceAdapter):
    def __init__(self):
        self.closed = 0

    def open(self, port, options, exclusive):
        if port == "nowhere":
            raise AdapterError("there is no such port", "plug it in")
        return {"model": "scale", "serial": str(options.get("serial", ""))}

    def close(self):
        self.closed += 1

    def start(self):
        print("a word to whoever reads the log")

    def poll(self):
        return [Reading(1.0, 2.5), Reading(1.1, float("nan"), base.SATURATED)]


def talk(adapter, *lines):
    out = io.StringIO()
    serve(adapter, io.StringIO("".join(line + "\n" for line in lines)), out)
    return [json.loads(line) for line in out.getvalue().splitlines()]


class Loop(unittest.TestCase):
    def test_every_request_has_one_answer_with_its_number(self):
        told = talk(Scale(), '{"id":1,"do":"open","port":"x","options":{"serial":7}}', '{"id":2,"do":"start"}',
                    '{"id":3,"do":"poll","now_s":0.5}')
        self.assertEqual([t["id"] for t in told], [1, 2, 3])
        self.assertEqual(told[0]["serial"], "7")
        self.assertEqual(told[2]["rows"], [[1.0, 2.5, 0], [1.1, None, 1]])
        self.assertTrue(all(t["ok"] and t["clock_s"] > 0 for t in told))

    def test_an_error_is_told_with_its_remedy(self):
        told = talk(Scale(), '{"id":1,"do":"open","port":"nowhere"}', '{"id":2,"do":"stop"}', '{"id":3,"do":"jump"}')
        self.assertEqual(told[0], {"id": 1, "ok": False, "error": "there is no such port", "hint": "plug it in"})
        self.assertEqual(told[1]["error"], "Scale has no 'stop'")
        self.assertIn("knows no 'jump'", told[2]["error"])

    def test_lines_that_are_no_request_are_passed_over(self):
        self.assertEqual([t["id"] for t in talk(Scale(), "hello", '{"do":"poll"}', "[1]", '{"id":9,"do":"poll"}')], [9])

    def test_numbers_that_json_does_not_know_are_none_and_end_nobody(self):
        class Scalar:  # of numpy, as it were
            def item(self):
                return 2.25

        class Wild(Scale):
            def poll(self):
                return [Reading(1.0, float("inf")), Reading(1.1, Scalar()), Reading(1.2, float("nan"), 2)]

            def verbs(self):
                return {**super().verbs(), "tell": lambda request: {"told": object()}}

        told = talk(Wild(), '{"id":1,"do":"poll"}', '{"id":2,"do":"tell"}', '{"id":3,"do":"start"}')
        self.assertEqual(told[0]["rows"], [[1.0, None, 0], [1.1, 2.25, 0], [1.2, None, 2]])
        self.assertFalse(told[1]["ok"])
        self.assertIn("is no number", told[1]["error"])
        self.assertTrue(told[2]["ok"])

    def test_the_end_of_the_input_closes_the_instrument(self):
        scale = Scale()
        talk(scale)
        self.assertEqual(scale.closed, 1)

    def test_the_example_of_the_document_weighs(self):
        from forcegate_adapter.null_modem import NullModem

        guide = pathlib.Path(__file__).resolve().parents[3] / "docs" / "adapters.md"
        block = guide.read_text(encoding="utf-8").split("    # scale.py", 1)[1].split("\nIn the bench file:", 1)[0]
        names = {"__name__": "scale"}
        exec(compile(textwrap.dedent(block.split("\n", 1)[1]), "scale.py", "exec"), names)
        with NullModem() as cable, open(cable.ports[1], "wb", buffering=0) as instrument:
            scale = names["Scale"]()
            self.assertEqual(scale.open(cable.ports[0], {}, True), {"model": "laboratory scale"})
            scale.start()
            instrument.write(b"  100.000 g\r\n  50.0")
            readings = []
            while not readings:
                readings = scale.poll()
            self.assertAlmostEqual(readings[0].force_N, 0.980665)
            instrument.write(b"00 oz\r\n")
            with self.assertRaises(AdapterError):
                while not scale.poll():
                    pass
            scale.close()


if __name__ == "__main__":
    unittest.main()
