#!/usr/bin/python3
"""How long a session that presses an organ is without force when one of its processes is killed or stopped.

Usage: bench/rejoin.py [--repeats N] [--how kill stop pause] [--depth deep shallow] [--tool ball rod wire] [--modules NAME ...]     (after a build)
Per kind and module: seconds from the signal and from the successor's start until it says that it runs (of the recorder: until
its part grows), and until the force is back (half of what it was). A stopped process is found out after three seconds; one that
is paused is stopped for a second, and goes on itself. Each
session is recorded: its parts are read again, and what is missing within them and between them is told. At the end: what is
left of all processes. Of collision and deformation: how often the first search of the successor, or on its tissue, had a contact
that pushes, and the greatest force until a second after it is back, over that before. Deep is with the tip 16 mm behind the skin at
rest (the ball's middle 8 mm), shallow 2 mm. Rod (4 mm thick) and wire (1 mm) lie on the wall.
"""
import argparse
import itertools
import json
import os
import shutil
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
PATIENCE = 60  # for the first word of each topic [s]: real-time loops may leave the listener little of a busy machine
HELD = """palpate_scene: 1
organs:
  - {name: stomach, mesh: {file: %s}, tissue: {youngs_modulus_pa: 30e3}, springs: {inner_ratio: 0.5},
     fixed: [{box: {min_m: [-0.2, 0.02, -0.2], max_m: [0.2, 0.2, 0.2]}}]}
probes:
  - {name: tip, shape: {%s}, device: {scripted: {start_m: [0.008, -0.08, -0.049], moves: [
     {to_m: [0.008, %g, -0.049], duration_s: 1.5}]}}}
"""
HELD_GAP = 1e-8  # [m]: a contact that holds is at 0, but for nodes that travel as float32: half an ulp of 0.13 m is 7e-9
DEPTHS = {"deep": -0.012, "shallow": -0.0264}  # of the tip, along y; the skin is at -0.0284 [m]
TOOLS = {  # its radius [m] and shape
    "ball": (0.008, "sphere: {radius_m: 0.008}"),
    "rod": (0.002, "capsule: {radius_m: 0.002, length_m: 0.04}"),
    "wire": (0.0005, "capsule: {radius_m: 0.0005, length_m: 0.04}"),
}
PAUSE = 1.0  # [s]


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
        if now > 1e-3 and abs(now - first) < 0.1 * now:
            return now


def started(pid):
    """When a process was started, on the clock of time.monotonic() [s]; to a hundredth."""
    fields = Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rsplit(")", 1)[1].split()
    since_boot = int(fields[19]) / os.sysconf("SC_CLK_TCK")
    return since_boot + time.monotonic() - time.clock_gettime(time.CLOCK_BOOTTIME)


def recorder_of(launcher):
    """Its process; 0: none."""
    for child in Path(f"/proc/{launcher}/task/{launcher}/children").read_text(encoding="ascii").split():
        try:
            if Path(f"/proc/{child}/comm").read_text(encoding="ascii").strip() == "palpate-recorder"[:15]:
                return int(child)
        except OSError:
            pass
    return 0


class Module:
    """One process of a session, whoever is it at the moment."""

    def __init__(self, name, live, launcher, recording):
        self.name, self.live, self.launcher, self.recording = name, live, launcher, recording
        self.earlier_parts = self.parts()

    def parts(self):
        return set(self.recording.parent.glob("*.mcap"))

    def process(self):
        return recorder_of(self.launcher) if self.name == "recorder" else int(status(self.live, self.name)["process_id"])

    def runs(self):
        if self.name != "recorder":
            return status(self.live, self.name)["state"] in (2, 4, "running", "degraded")
        return any(part.stat().st_size > 100_000 for part in self.parts() - self.earlier_parts)


class Heard:
    """What searches found, and which force the hand got, since this was made."""

    FIELDS = {"contacts": ("source_time_ns", "deepest_gap_m"), "node_positions": ("source_time_ns",), "haptic_force": ("force_n",)}

    def __init__(self, live):
        self.live, self.heard = live, {topic: [] for topic in self.FIELDS}
        for topic in self.FIELDS:
            live.take(topic)

    def listen(self):
        for topic, fields in self.FIELDS.items():
            came = self.live.take(topic)
            if came.messages:
                self.heard[topic].append(np.vstack([np.array(came[field], dtype=float).T for field in fields]))

    def without_contact(self, module, restart):
        """So many since the module's successor, started at `restart` [s], first searched, or was searched, until one had a contact
        that pushes."""
        if module not in ("collision", "deformation"):
            return float("nan")
        time, gap = np.hstack(self.heard["contacts"])
        if module == "collision":
            gap = gap[time > 1e9 * restart]
        else:
            said = np.hstack(self.heard["node_positions"])[0]
            begin = said[said > 1e9 * restart].min(initial=np.inf)
            # Until collision hears of it, it searches what the dead one left, which rests as the probe does: all find the same.
            left = gap[time < begin][-1:]
            gap = gap[time >= begin]
            gap = gap[np.argmax(np.isinf(gap) | ~np.isin(gap, left)) :]
        return int(np.argmax(gap < HELD_GAP)) if (gap < HELD_GAP).any() else float("inf")

    def greatest_force(self):
        return np.linalg.norm(np.hstack(self.heard["haptic_force"]), axis=0).max()


def lose(module, how):
    """Seconds until it runs again and until the force is back, from the signal and from the start of its successor; searches
    without a contact; the greatest force over that before."""
    live = module.live
    before = held(live)
    victim = module.process()
    said = Heard(live)
    begin = time.monotonic()
    os.kill(victim, signal.SIGKILL if how == "kill" else signal.SIGSTOP)

    def heard(condition):
        said.listen()
        return condition()

    if how == "pause":
        wait(lambda: heard(lambda: False), PAUSE)
        restart = time.monotonic() - begin
        os.kill(victim, signal.SIGCONT)
        runs = restart + wait(lambda: heard(module.runs))
    else:
        runs = wait(lambda: heard(lambda: module.process() not in (0, victim) and module.runs()))
        restart = started(module.process()) - begin
    since = time.monotonic() - begin
    faded = force(live) < 0.5 * before
    back = since + wait(lambda: heard(lambda: force(live) > 0.5 * before)) if faded else since
    wait(lambda: heard(lambda: False), 1)
    # Its start is known to a hundredth: it cannot have been before the signal.
    lost = said.without_contact(module.name, begin + max(restart, 0))
    return runs, back, runs - restart, back - restart, lost, said.greatest_force() / before


def read_again(recording):
    """Parts that there are, those that inspect takes up, and samples missing."""
    words = [ROOT / "build/release/bin/palpate", "inspect", recording, "--json"]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{recording}: cannot be read: {done.stderr}")
    told = json.loads(done.stdout)
    missing = sum(topic["missing"] for topic in told["topics"] if not topic["thinned"])
    return len(list(recording.parent.glob("*.mcap"))), told.get("parts", 1), missing


def leftovers(session):
    found = subprocess.run(["pgrep", "-f", session], capture_output=True, text=True, check=False).stdout.split()
    return [pid for pid in found if pid != str(os.getpid())]


def measure(module, how, depth, tool, repeats, folder):
    scene = Path(folder) / "held.yaml"
    stomach = palpate.scene_path("stomach_probe").parent.joinpath("meshes/stomach.ply")
    radius, shape = TOOLS[tool]
    scene.write_text(HELD % (stomach, shape, DEPTHS[depth] - radius))
    times, parts = [], []
    while len(times) < repeats:
        name = f"rejoin{os.getpid()}x{len(times)}{module}{how}{depth}{tool}"
        recording = Path(folder) / name / "held.mcap"
        recording.parent.mkdir()
        log = Path(folder) / "log"
        words = [ROOT / "build/release/bin/palpate", "run", scene, "--headless", "--session", name, "--domain", "77"]
        with open(log, "wb") as said, subprocess.Popen([*words, "--record", recording], stdout=said, stderr=said) as run:
            try:
                time.sleep(1)
                with palpate.connect(name, 77) as live:
                    for _ in range(min(KILLS, repeats - len(times))):
                        times.append(lose(Module(module, live, run.pid, recording), how))
            except Exception:
                print(log.read_text(errors="replace"))
                raise
            finally:
                run.terminate()
        wait(lambda: not leftovers(name), 3)
        if leftovers(name):
            sys.exit(f"left: {leftovers(name)}")
        parts.append(read_again(recording))
        shutil.rmtree(recording.parent)
    return np.array(times), np.sum(parts, axis=0)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeats", type=int, default=8)
    parser.add_argument("--how", nargs="+", default=["kill"], choices=["kill", "stop", "pause"])
    parser.add_argument("--depth", nargs="+", default=["deep"], choices=list(DEPTHS))
    parser.add_argument("--tool", nargs="+", default=["ball"], choices=list(TOOLS))
    parser.add_argument("--modules", nargs="+", default=["haptics", "collision", "deformation", "recorder"])
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        for how, tool, depth, module in itertools.product(options.how, options.tool, options.depth, options.modules):
            times, (files, read, missing) = measure(module, how, depth, tool, options.repeats, folder)
            middle, worst = np.median(times, axis=0), np.max(times, axis=0)
            lost = times[:, 4]
            searches = "" if np.isnan(lost).all() else f"; contact at the first search {np.sum(lost == 0)} times (at most {worst[4]:.0f} without)"
            searches += f"; force at most {worst[5]:.2f} of that before"
            print(
                f"{how:5} {tool:4} {depth:8} {module:12} {len(times):4} times: runs again after {middle[0]:.2f} s (at most {worst[0]:.2f}),"
                f" force back after {middle[1]:.2f} s (at most {worst[1]:.2f}); from its restart {middle[2]:.2f} s"
                f" ({worst[2]:.2f}) and {middle[3]:.2f} s ({worst[3]:.2f}); {files} files recorded, {read} read, {missing} samples missing{searches}",
                flush=True,
            )
    print("left of all processes: none")


if __name__ == "__main__":
    main()
