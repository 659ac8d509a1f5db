"""An adapter's program that does one thing wrong: scripted_adapter.py DEVICE FAULT. Its third "poll" or "read" is the one."""

import json
import os
import signal
import sys
import time

device, fault = sys.argv[1:3]
calls = 0


def say(reply):
    sys.stdout.write(json.dumps(reply) + "\n")
    sys.stdout.flush()


def raw(text):
    sys.stdout.write(text)
    sys.stdout.flush()


def value():
    now = time.monotonic()
    if device == "reference" and fault == "gap":  # silent for a while, then another force than before
        time.sleep(0.2 if calls == 2 else 0)
        return {"rows": [[time.monotonic() - 0.001, 1.5 if calls < 2 else 9.0, 0]]}
    if device == "reference":
        return {"rows": [[now - 0.001, 1.5, 0]]}
    if device == "board":
        return {"rows": [[calls, 1000 + calls, 2.5, 1]]}
    return {"theta_rad": float(calls), "velocity_rad_per_s": 0.0, "running": fault != "begins_anew" or calls < 3, "fault": False, "fault_code": 0}


def spoil(reply):
    """True when the answer has been given."""
    rows, wrong = reply.get("rows"), None
    if fault == "die":
        sys.exit("the instrument's library has given up")
    elif fault == "killed":
        os.kill(os.getpid(), signal.SIGKILL)
    elif fault == "hang":
        time.sleep(600)
    elif fault == "late":
        time.sleep(2.5)
    elif fault == "silent":
        return True
    elif fault == "garbage":
        raw("\x01\x7f### no JSON\n")
    elif fault == "half":
        raw(json.dumps(reply)[:20])
        return True
    elif fault == "endless":
        raw("x" * 3000000)
    elif fault == "wrong_id":
        reply["id"] += 1000
    elif fault == "old_id":
        reply["id"] -= 1
    elif fault == "twice":
        say(reply)
    elif fault == "no_object":
        raw("[1,2,3]\n")
    elif fault == "not_a_number":
        wrong = float("nan")
    elif fault == "infinite":
        raw(json.dumps(reply).replace("1.5", "1e999").replace("1003", "1e999").replace("3.0", "1e999") + "\n")
        return True
    elif fault == "text":
        wrong = "three"
    elif fault == "error":
        say({"id": reply["id"], "ok": False, "error": "the instrument is off", "hint": "switch it on"})
        return True
    elif fault == "error_without_text":
        say({"id": reply["id"], "ok": False})
        return True
    elif fault == "future" and rows:
        rows[0][0] += 50
        rows[0][1] += 50 if device == "board" else 0
    elif fault == "past" and rows:
        rows[0][0] -= 100
    elif fault == "absurd" and rows:
        rows[0][1] = 1e6
    elif fault == "short_row" and rows:
        rows[0] = rows[0][:2]
    elif fault == "no_clock":
        del reply["clock_s"]
    if wrong is not None:
        if rows:
            rows[0][1] = wrong
        else:
            reply["theta_rad"] = wrong
    return False


for line in sys.stdin:
    request = json.loads(line)
    verb = request["do"]
    reply = {"id": request["id"], "ok": True, "clock_s": time.monotonic()}
    if verb == "open":
        reply["model"] = "scripted"
        if fault == "other_serial":
            reply["serial"] = "X"
        elif fault == "in_folder":
            reply["serial"] = os.path.basename(os.getcwd())
    elif verb == "arm":
        reply["timeout_s"] = request["timeout_s"]
    elif verb == "emergency":
        with open(os.environ["SCRIPTED_STOP"], "a") as file:
            file.write("stopped\n")
    elif verb in ("poll", "read"):
        reply.update(value())
        calls += 1
        if calls == 3 + (device == "motor") and spoil(reply):  # a motor is read once when it is opened
            continue
    say(reply)
