"""What every adapter has in common: its verbs, and the loop that serves them on standard input and output."""

import difflib
import json
import math
import sys
import time
from typing import NamedTuple

SATURATED = 1 << 0  # bits of Reading.status
FAULT = 1 << 1


class AdapterError(Exception):
    """What went wrong and how to mend it; the bench shows both."""

    def __init__(self, text, hint=""):
        super().__init__(text)
        self.hint = hint


def check_options(options, known, required=()):
    """AdapterError for an option that is none of `known`, which nobody would hear, and for one of `required` that is missing."""
    for key in options:
        if key not in known:
            near = difflib.get_close_matches(key, known, 1)
            raise AdapterError(f"this adapter has no option '{key}'", f"did you mean '{near[0]}'?" if near else "it has: " + ", ".join(known))
    for key in required:
        if key not in options:
            raise AdapterError(f"the option '{key}' is missing", f"write options = {{ {key} = ... }} into the instrument's table of the bench file")


class Reading(NamedTuple):
    t_s: float  # time.monotonic() of the measurement
    force_N: float  # None or NaN: not valid
    status: int = 0  # SATURATED, FAULT


class Sample(NamedTuple):
    index: int  # from 0 at the start of the stream
    adc: int
    force_N: float
    flags: int = 0


class Adapter:
    """Life of an instrument. Every method may raise AdapterError or OSError; the bench stops the motor and reports it."""

    def open(self, port, options, exclusive):
        """Connects, identifies, configures; nothing moves. Returns a dict with 'model' and, when the instrument knows
        them, 'serial', 'firmware', 'calibration'. `port` is a path or None, `options` the table of the bench file."""
        raise NotImplementedError

    def close(self):
        """Leaves the instrument quiet. Called at the end, whatever the end is."""

    def verbs(self):
        """What the bench may ask for beside open and close: verb -> function of the request that returns the fields of
        the answer. An adapter with a verb of its own extends the table."""
        return {}

    def handle(self, verb, request):
        verbs = self.verbs()
        if verb not in verbs:
            raise AdapterError(f"this adapter knows no '{verb}'")
        return verbs[verb](request)


class ReferenceAdapter(Adapter):
    def start(self):
        raise NotImplementedError

    def poll(self):
        """All readings since the last call, oldest first. Never waits."""
        raise NotImplementedError

    def stop(self):
        raise NotImplementedError

    def verbs(self):
        return {
            "start": lambda request: _done(self.start()),
            "stop": lambda request: _done(self.stop()),
            "poll": lambda request: {"rows": [[r.t_s, r.force_N, int(r.status)] for r in self.poll()]},
        }


class BoardAdapter(Adapter):
    def load(self, session):
        """A new record: `session` has nonce, rate_Hz, gain_N_per_V, offset_N, v_range_V, b_scale, q_scale, adc_bits,
        calibration_id. Returns nonce, rate_Hz, adc_bits, protocol_major, protocol_minor, board, build_id, algorithm_id
        as the board has echoed them."""
        raise NotImplementedError

    def start(self, rate_Hz):
        raise NotImplementedError

    def poll(self):
        """(samples since the last call, dict of frames_bad, frames_dropped, overruns so far)."""
        raise NotImplementedError

    def stop(self):
        raise NotImplementedError

    def verbs(self):
        return {
            "load": self.load,
            "start": lambda request: _done(self.start(request["rate_Hz"])),
            "stop": lambda request: _done(self.stop()),
            "poll": lambda request: self._rows(*self.poll()),
        }

    @staticmethod
    def _rows(samples, counts):
        return {"rows": [[s.index, s.adc, s.force_N, s.flags] for s in samples], **counts}


class MotorAdapter(Adapter):
    def arm(self, timeout_s):
        """Sets the drive's own communication timeout, reads it back, switches the drive on. Returns the timeout read."""
        raise NotImplementedError

    def velocity(self, rad_per_s):
        raise NotImplementedError

    def read(self):
        """Dict of theta_rad, velocity_rad_per_s, running, fault, fault_code. Also the heartbeat of the drive."""
        raise NotImplementedError

    def stop(self):
        """Decelerates; stays armed."""
        raise NotImplementedError

    def emergency(self):
        """Stops at once and switches off, in any state."""
        raise NotImplementedError

    def verbs(self):
        return {
            "arm": lambda request: {"timeout_s": self.arm(request["timeout_s"])},
            "read": lambda request: self.read(),
            "velocity": lambda request: _done(self.velocity(request["rad_per_s"])),
            "stop": lambda request: _done(self.stop()),
            "emergency": lambda request: _done(self.emergency()),
        }


def _done(_):
    """The answer of a verb that has nothing to tell, whatever its method returns."""
    return {}


def _plain(value):
    """As JSON takes it: numbers that are none become null, scalars of numpy numbers of Python."""
    if isinstance(value, dict):
        return {key: _plain(one) for key, one in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(one) for one in value]
    if value is None or isinstance(value, (bool, int, str)):
        return value
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    if hasattr(value, "item"):
        return _plain(value.item())
    raise TypeError(f"{value!r} is no number, text, list or dict")


def answer(adapter, line):
    """The answer to one line of the bench; None when it is no request."""
    try:
        request = json.loads(line)
        identity, verb = request["id"], request["do"]
    except (ValueError, KeyError, TypeError):
        return None
    try:
        if verb == "open":
            told = adapter.open(request.get("port"), request.get("options", {}), request.get("exclusive", True))
        elif verb == "close":
            adapter.close()
            told = {}
        else:
            told = adapter.handle(verb, request)
        return {"id": identity, "ok": True, "clock_s": time.monotonic(), **_plain(told)}
    except AdapterError as error:
        return {"id": identity, "ok": False, "error": str(error), "hint": error.hint}
    except NotImplementedError:
        return {"id": identity, "ok": False, "error": f"{type(adapter).__name__} has no '{verb}'"}
    except Exception as error:  # of the instrument's library, or of the adapter: told with its kind
        return {"id": identity, "ok": False, "error": f"{type(error).__name__}: {error}"}


def serve(adapter, requests=None, answers=None):
    """Serves the bench until it closes the input. Whatever else the program prints goes to standard error."""
    requests = requests or sys.stdin
    answers = answers or sys.stdout
    own_output, sys.stdout = sys.stdout, sys.stderr
    try:
        for line in requests:
            told = answer(adapter, line)
            if told is None:
                print(f"no request: {line[:80]!r}", file=sys.stderr)
                continue
            answers.write(json.dumps(told, allow_nan=False) + "\n")
            answers.flush()
    finally:
        sys.stdout = own_output
        adapter.close()
