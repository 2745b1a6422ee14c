#!/usr/bin/env python3
"""Lockstep of the real processes beside the same session in one process.

  bench/lockstep_identity.py identity [SCENE…]   each scene: one run in process, then --runs runs of
      the real processes, any of which is stopped (SIGSTOP) and continued at random. The recordings
      must be the same bytes. Exit code 1 if any differs.
  bench/lockstep_identity.py cost [SCENE…]       what a deformation period costs more between processes than in
      one process [ms]: difference of two durations, so that starting and ending drop out.
"""
import argparse
import filecmp
import os
import pathlib
import random
import re
import signal
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent


def children(pid):
    try:
        return [int(c) for c in pathlib.Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]
    except OSError:
        return []


def run(palpate, scene, mode, duration, record=None, stops=None):
    """@returns seconds it took, processes stopped on the way."""
    command = [palpate, "run", scene, "--duration", str(duration), *mode]
    command += ["--record", record, "--overwrite"] if record else []
    began, stopped = time.monotonic(), 0
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    while stops and process.poll() is None:
        time.sleep(stops.uniform(0, 0.3))
        living = children(process.pid)
        if not living:
            continue
        chosen = stops.choice(living)
        try:
            os.kill(chosen, signal.SIGSTOP)
            time.sleep(stops.uniform(0, 0.15))
            os.kill(chosen, signal.SIGCONT)
            stopped += 1
        except ProcessLookupError:
            pass
    errors = process.communicate()[1]
    if process.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: exit code {process.returncode}\n{errors}")
    return time.monotonic() - began, stopped


def lockstep(seed):
    return ["--lockstep", "--headless", "--session", f"identity_{os.getpid()}_{seed}",
            "--domain", str(random.Random(os.getpid()).randrange(1, 200))]


def identity(arguments):
    different = 0
    for scene in arguments.scenes:
        with tempfile.TemporaryDirectory() as folder:
            one, four = f"{folder}/one.mcap", f"{folder}/four.mcap"
            run(arguments.palpate, scene, ["--in-process"], arguments.duration, one)
            same, stops = 0, 0
            for seed in range(arguments.runs):
                stops += run(arguments.palpate, scene, lockstep(seed), arguments.duration, four,
                             random.Random(seed))[1]
                if filecmp.cmp(one, four, shallow=False):
                    same += 1
                else:
                    subprocess.run([arguments.palpate, "diff", one, four])
                os.remove(four)
            different += arguments.runs - same
            print(f"{scene.stem}: {arguments.duration:g} s, {same} of {arguments.runs} runs the same "
                  f"{os.path.getsize(one)} bytes, {stops} stops", flush=True)
    return 1 if different else 0


def deformation_rate(palpate, scene):
    resolved = subprocess.run([palpate, "check", "--resolved", scene], capture_output=True, text=True).stdout
    return float(re.search(r"deformation_hz: ([\d.]+)", resolved).group(1))


def cost(arguments):
    short, long = arguments.duration, 4 * arguments.duration
    for scene in arguments.scenes:
        periods = (long - short) * deformation_rate(arguments.palpate, scene)

        def per_period(mode):
            slow = run(arguments.palpate, scene, mode, long)[0]
            return 1e3 * (slow - run(arguments.palpate, scene, mode, short)[0]) / periods

        pairs = [(per_period(["--in-process"]), per_period(lockstep(n))) for n in range(arguments.runs)]
        inside = statistics.median(a for a, _ in pairs)
        more = sorted(b - a for a, b in pairs)
        print(f"{scene.stem}: a period in one process {inside:.3f} ms; between processes "
              f"{statistics.median(more):.3f} ms more ({more[0]:.3f} to {more[-1]:.3f}, "
              f"{arguments.runs} pairs)", flush=True)
    return 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("what", choices=["identity", "cost"])
    parser.add_argument("scenes", nargs="*", type=pathlib.Path, help="default: all shipped")
    parser.add_argument("--runs", type=int, default=10)
    parser.add_argument("--duration", type=float, default=1, help="simulated seconds (default 1)")
    parser.add_argument("--palpate", default=ROOT / "build/release/bin/palpate", type=pathlib.Path)
    arguments = parser.parse_args()
    arguments.scenes = arguments.scenes or sorted((ROOT / "scenes").glob("*.yaml"))
    return {"identity": identity, "cost": cost}[arguments.what](arguments)


if __name__ == "__main__":
    sys.exit(main())
