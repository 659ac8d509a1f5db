#!/usr/bin/env python3
"""Kills a gate on a bench of twins at random moments, again and again, and looks at what is left:

    kill_bench.py FORCEGATE FIRMWARE BENCH KILLS [SEED]

Each time: the journal can be read, at most 1 s of the record is lost, the motor is stopped by somebody else than the drive's own
timeout (which is set long for this), nobody holds the bench any more. Then a run is ended by SIGINT, by SIGTERM and by
`forcegate bench park`: the motor stops, the program ends by itself. Exit code 0 when all of that held."""

import json
import os
import pathlib
import random
import re
import signal
import socket
import subprocess
import sys
import tempfile
import time

LOST_MAX_S = 1.0
INTERRUPTED = 130
LATE_ORDERS_MAX = 3


class Twins:
    """A served bench, and a hand on its control socket."""

    def __init__(self, forcegate, bench, folder, environment):
        self.process = subprocess.Popen([forcegate, "bench", "serve", bench, "--folder", folder], stdout=subprocess.PIPE, text=True,
                                        env=environment)
        while "next:" not in (line := self.process.stdout.readline()):
            if not line:
                raise SystemExit("the twins do not start")
        self.line = socket.socket(socket.AF_UNIX)
        self.line.connect(os.path.join(folder, "control"))
        self.text = self.line.makefile("rw")

    def status(self):
        self.text.write("status\n")
        self.text.flush()
        return dict(word.split("=", 1) for word in self.text.readline().split()[1:])

    def end(self):
        self.process.terminate()
        self.process.wait()


def journals(folder):
    return [p for p in pathlib.Path(folder).rglob("*.fgj") if "force_control" in p.name]


class Run:
    """A gate on the served bench, caught somewhere in the recording of its case; `over` when it was done before."""

    def __init__(self, forcegate, firmware, bench, served, environment, folder, wait_s):
        self.folder = folder
        self.gate = subprocess.Popen([forcegate, "gate", firmware, "--rig", bench, "--rig-option", "attach=" + served, "--plan", "twin",
                                      "--calibration", "nominal", "-o", os.path.join(folder, "run")],
                                     stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True, env=environment)
        while not journals(folder) and self.gate.poll() is None:
            time.sleep(0.002)
        time.sleep(wait_s)
        self.over = self.gate.poll() is not None


def wait_until_still(twins):
    """Text of what is wrong, or None."""
    for _ in range(2000):
        state = twins.status()
        if float(state["command_rad_per_s"]) == 0.0 and abs(float(state["velocity_rad_per_s"])) < 0.01:
            return "only the drive's own timeout has stopped the motor" if state["stop_cause"] == "communication-timeout" else None
        time.sleep(0.005)
    return f"the motor turns on: {state}"


def one_kill(forcegate, bench, twins, environment, run):
    """Seconds lost, or text of what went wrong; None when the kill came between two records."""
    os.killpg(run.gate.pid, signal.SIGKILL)
    run.gate.wait()
    at_kill = twins.status()
    if wrong := wait_until_still(twins):
        return wrong
    found = journals(run.folder)
    if not found or float(at_kill["advanced_s"]) < 0.0:
        return None
    who = subprocess.run([forcegate, "bench", "who", bench, "--json"], capture_output=True, text=True, env=environment)
    if json.loads(who.stdout)["held"]:
        return "the bench is still held"
    recovered = subprocess.run([forcegate, "recover", str(found[0]), "-o", os.path.join(run.folder, "r.h5"), "--json"],
                               capture_output=True, text=True, env=environment)
    if recovered.returncode != 0:
        return f"the journal cannot be read: {recovered.stderr}"
    report = json.loads(recovered.stdout)
    if report["closed"]:
        return None
    lost_s = float(at_kill["advanced_s"]) - report["last_s"]
    if lost_s > LOST_MAX_S or report["damaged_places"] > 1:
        return f"{lost_s:.3f} s are lost, {report['damaged_places']} damaged places"
    return lost_s


def one_order(forcegate, bench, served, twins, environment, run, how):
    """Ends a run by a signal or by the emergency stop; text of what went wrong, True when all was well, None when the run was over first."""
    if how == "bench park":
        parked = subprocess.run([forcegate, "bench", "park", bench, "--attach", served], capture_output=True, text=True, env=environment)
        if parked.returncode != 0:
            return f"bench park: {parked.stderr}"
    else:
        os.kill(run.gate.pid, getattr(signal, how))
    try:
        code = run.gate.wait(timeout=60)
    except subprocess.TimeoutExpired:
        os.killpg(run.gate.pid, signal.SIGKILL)
        return f"{how}: the program does not end"
    if wrong := wait_until_still(twins):
        return wrong
    if code == INTERRUPTED:
        return True
    # an interrupted run writes no result: this one had played and judged everything before the order came
    result = pathlib.Path(run.folder) / "run" / "result.json"
    if result.exists() and json.loads(result.read_text(encoding="utf-8"))["decision"]["exit_code"] == code:
        return None
    return f"{how}: exit code {code}"


def main(forcegate, firmware, bench, kills, seed="1"):
    rng = random.Random(int(seed))
    lost, failures, missed, late = [], [], 0, 0
    with tempfile.TemporaryDirectory(prefix="twins") as served:
        environment = {**os.environ, "XDG_RUNTIME_DIR": served}
        patient = os.path.join(served, "bench.toml")
        text = pathlib.Path(bench).read_text(encoding="utf-8")
        pathlib.Path(patient).write_text(re.sub(r"drive_timeout_ms = \d+", "drive_timeout_ms = 5000", text), encoding="utf-8")
        twins = Twins(forcegate, patient, served, environment)
        longest_s = 1.0
        orders = ["SIGINT", "SIGTERM", "bench park"]
        try:
            while len(lost) + len(failures) < int(kills) or orders:
                with tempfile.TemporaryDirectory(prefix="kill") as folder:
                    run = Run(forcegate, firmware, patient, served, environment, folder, rng.uniform(0.0, longest_s))
                    told = None
                    if not run.over and len(lost) + len(failures) < int(kills):
                        told = one_kill(forcegate, patient, twins, environment, run)
                    elif not run.over:
                        ended = one_order(forcegate, patient, served, twins, environment, run, orders[0])
                        if isinstance(ended, str):
                            failures.append(ended)
                        elif ended:
                            print(f"{orders[0]}: motor stopped, program ended")
                        else:
                            late += 1
                            if late == LATE_ORDERS_MAX:
                                ended = f"{orders[0]}: {late} runs were over before it"
                                failures.append(ended)
                        if ended:
                            orders.pop(0)
                            late = 0
                            continue
                if told is None:
                    missed += 1
                    longest_s = max(0.05, 0.8 * longest_s)  # the record was over: come earlier
                    if missed > 20 + 5 * int(kills):
                        failures.append("no kill hits a record")
                        break
                elif isinstance(told, str):
                    failures.append(told)
                else:
                    lost.append(told)
                    longest_s *= 1.1
        finally:
            twins.end()
    for failure in failures:
        print("error:", failure)
    print(f"{len(lost) + len(failures)} kills: {len(lost)} journals readable and motors parked, at most {max(lost, default=0):.3f} s lost "
          f"(mean {sum(lost) / max(1, len(lost)):.3f} s); {missed} kills between two records")
    return 1 if failures else 0


if __name__ == "__main__":
    if len(sys.argv) not in (5, 6):
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
