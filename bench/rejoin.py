#!/usr/bin/python3
"""How long a session that presses an organ is without force when one of its processes is killed or stopped.

Usage: bench/rejoin.py [--repeats N] [--how kill stop] [--modules NAME ...]     (after a build)
Per kind and module: seconds from the signal until its successor says that it runs, and until the force is back (half of what
it was). A stopped process is found out after three seconds. At the end: what is left of all processes.
"""
import argparse
import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, os.environ.get("PYTHONPATH") or str(ROOT / "build" / "release" / "python"))
import numpy as np  # noqa: E402

import palpate  # noqa: E402

KILLS = 4  # of a session: one that fails more often in a row is given up
PATIENCE = 10  # for the first word of each topic [s]: the machine may be busy
HELD = """palpate_scene: 1
organs:
  - {name: stomach, mesh: {file: %s}, tissue: {youngs_modulus_pa: 30e3}, springs: {inner_ratio: 0.5},
     fixed: [{box: {min_m: [-0.2, 0.02, -0.2], max_m: [0.2, 0.2, 0.2]}}]}
probes:
  - {name: tip, shape: {sphere: {radius_m: 0.008}}, device: {scripted: {start_m: [0.008, -0.08, -0.049], moves: [
     {to_m: [0.008, -0.020, -0.049], duration_s: 1.5}]}}}
"""


def force(live):
    return float(np.linalg.norm(live.latest("haptic_force", 0, timeout_s=PATIENCE)["force_n"]))


def status(live, module):
    return live.latest("module_status", module, timeout_s=PATIENCE)


def wait(condition, timeout=20.0):
    begin = time.monotonic()
    while time.monotonic() - begin < timeout:
        if condition():
            return time.monotonic() - begin
        time.sleep(0.002)
    return float("inf")


def held(live, seconds=0.5):
    """The force once it has stayed for a while."""
    while True:
        first = force(live)
        time.sleep(seconds)
        now = force(live)
        if now > 0.05 and abs(now - first) < 0.1 * now:
            return now


def lose(live, module, number):
    before = held(live)
    victim = int(status(live, module)["process_id"])
    begin = time.monotonic()
    os.kill(victim, number)
    runs = wait(lambda: int(status(live, module)["process_id"]) != victim and status(live, module)["state"] in (2, 4, "running", "degraded"))
    since = time.monotonic() - begin
    faded = force(live) < 0.5 * before
    back = since + wait(lambda: force(live) > 0.5 * before)
    return runs, back if faded else since


def leftovers(session):
    found = subprocess.run(["pgrep", "-f", session], capture_output=True, text=True, check=False).stdout.split()
    return [pid for pid in found if pid != str(os.getpid())]


def measure(module, how, repeats, folder):
    scene = Path(folder) / "held.yaml"
    scene.write_text(HELD % palpate.scene_path("stomach_probe").parent.joinpath("meshes/stomach.ply"))
    times = []
    number = {"kill": signal.SIGKILL, "stop": signal.SIGSTOP}[how]
    while len(times) < repeats:
        name = f"rejoin{os.getpid()}x{len(times)}{module}"
        words = [ROOT / "build/release/bin/palpate", "run", scene, "--headless", "--session", name, "--domain", "77"]
        with subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as run:
            try:
                time.sleep(1)
                with palpate.connect(name, 77) as live:
                    for _ in range(min(KILLS, repeats - len(times))):
                        times.append(lose(live, module, number))
            finally:
                run.terminate()
        wait(lambda: not leftovers(name), 3)
        if leftovers(name):
            sys.exit(f"left: {leftovers(name)}")
    return np.array(times)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeats", type=int, default=8)
    parser.add_argument("--how", nargs="+", default=["kill"], choices=["kill", "stop"])
    parser.add_argument("--modules", nargs="+", default=["haptics", "collision", "deformation"])
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        for how in options.how:
            for module in options.modules:
                times = measure(module, how, options.repeats, folder)
                runs, back = np.median(times, axis=0)
                worst_runs, worst_back = np.max(times, axis=0)
                print(f"{how:5} {module:12} {len(times):4} times: runs again after {runs:.2f} s (at most {worst_runs:.2f}),"
                      f" force back after {back:.2f} s (at most {worst_back:.2f})", flush=True)
    print("left of all processes: none")


if __name__ == "__main__":
    main()
