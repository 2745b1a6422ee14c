#!/usr/bin/env python3
"""Organs in one deformation process beside the same organs in two, in lockstep on two cores.

  bench/processes.py [--organs N] [--nodes N] [--model WORD] [--rate HZ]   N stomachs side by side, each with a
      probe that presses it; 100 Hz of deformation unless told otherwise, as shipped scenes of two organs, of folds
      and of solids have, the other rates a scene's own. Simulated per wall time of both, run in turns, as the
      runs tell it, from where all are ready; what each process computes in a period of deformation, its start too,
      of the first pair; whether both said the same of nodes, probes and forces (palpate diff).
      The ratio is the median of pairs. Beside it what deformation says of the wall time between its cycles: that of
      the median cycles, and of the fastest tenths, for whatever else runs on these cores only ever slows one down.
      Yardstick, in the same turns: two simulators of half of the organs, each all in one process, that share nothing,
      beside one alone. A machine whose cores are not its own gives them less than two.
"""
import argparse
import json
import os
import pathlib
import random
import re
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
PRESSED_S = 3.3  # from then on the probes rest in the tissue
SAME = ("surface", "node_positions", "probe_state", "contacts", "haptic_force")


def scene_text(arguments, processes):
    organs, probes = [], []
    for i in range(arguments.organs):
        x = 0.3 * i
        organs.append({"name": f"organ_{i}", "model": arguments.model, "position_m": [x, 0, 0],
                       "mesh": {"file": str(ROOT / "scenes/meshes/stomach.ply"), "nodes": arguments.nodes},
                       "fixed": [{"box": {"min_m": [x - 0.05, 0.02, -0.08], "max_m": [x + 0.06, 0.05, 0.05]}}],
                       "process": 1 + i * processes // arguments.organs})
        moves = [{"to_m": [x - 0.029, -0.015, -0.059], "duration_s": 1}, {"wait_s": 0.2},
                 {"to_m": [x + 0.008, -0.02, -0.049], "duration_s": 2}]
        probes.append({"shape": {"sphere": {"radius_m": 0.008}},
                       "device": {"scripted": {"start_m": [x - 0.06, -0.064, -0.093], "moves": moves}}})
    return json.dumps({"palpate_scene": 1, "organs": organs, "probes": probes,
                       "rates": {"deformation_hz": arguments.rate}})


def factor_told(text):
    """@returns simulated per wall time, of the summary of a run."""
    return float(re.search(r"real-time factor ([\d.]+)", text)[1])


def run(palpate, scene, duration, *options):
    """@returns simulated per wall time, the median and fastest tenth of the times from one of deformation's cycles to the
    next, as it tells them [ms], and the time that each child computed [s]."""
    command = [palpate, "run", scene, "--lockstep", "--headless", "--duration", str(PRESSED_S + duration),
               "--domain", str(random.Random(os.getpid()).randrange(1, 200)), *options]
    computed = {}
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    while process.poll() is None:
        time.sleep(0.05)
        try:
            listed = pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
            for child in listed:
                words = pathlib.Path(f"/proc/{child}/cmdline").read_text().split("\0")
                module = pathlib.Path(words[0]).name
                if not module.startswith("palpate-"):
                    continue
                module = module.removeprefix("palpate-")
                if "--process" in words:
                    module += "_" + words[words.index("--process") + 1]
                ticks = pathlib.Path(f"/proc/{child}/stat").read_text().rsplit(") ")[1].split()[11:13]
                computed[module] = sum(map(int, ticks)) / os.sysconf("SC_CLK_TCK")
        except (OSError, IndexError):
            pass
    errors = process.stderr.read()
    if process.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: exit code {process.returncode}\n{errors}")
    told = re.search(r"\[deformation\].* ([\d.]+) ms in the median, ([\d.]+) ms in the fastest", errors)
    return factor_told(process.stdout.read()), tuple(map(float, told.groups())), computed


def speed_at_once(palpate, scene, duration, count):
    """@returns simulated per wall time of so many simulators together that know nothing of each other."""
    command = [palpate, "run", scene, "--in-process", "--headless", "--duration", str(duration)]
    running = [subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
               for _ in range(count)]
    told = [process.communicate()[0] for process in running]
    if any(process.returncode for process in running):
        sys.exit(f"{' '.join(map(str, command))}: failed")
    return sum(map(factor_told, told))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--organs", type=int, default=8)
    parser.add_argument("--nodes", type=int, default=550)
    parser.add_argument("--model", default="implicit_volume")
    parser.add_argument("--rate", type=float, default=100, help="of deformation [Hz]")
    parser.add_argument("--pairs", type=int, default=5)
    parser.add_argument("--duration", type=float, default=8, help="of each run, from where the probes press [simulated s]")
    parser.add_argument("--palpate", default=ROOT / "build/release/bin/palpate", type=pathlib.Path)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        scenes, records, snapshots = {}, {}, {}
        for processes in (1, 2):
            scenes[processes] = pathlib.Path(folder) / f"{processes}.yaml"
            records[processes] = pathlib.Path(folder) / f"{processes}.mcap"
            scenes[processes].write_text(scene_text(arguments, processes))
            snapshots[processes] = pathlib.Path(folder) / f"{processes}.snapshot"
            run(arguments.palpate, scenes[processes], 0.1, "--record", records[processes],
                "--snapshot-at", str(PRESSED_S), "--snapshot", snapshots[processes])
        told = subprocess.run([arguments.palpate, "diff", records[1], records[2]], capture_output=True, text=True)
        rows = dict(re.findall(r"^(\w+) +(\d+ +\d+ +\d+ +\d+)$", told.stdout, re.M))
        same = all(rows[topic].split()[1:] == ["0", "0", "0"] for topic in SAME)

        half = pathlib.Path(folder) / "half.yaml"
        half.write_text(scene_text(argparse.Namespace(**{**vars(arguments), "organs": arguments.organs // 2}), 1))
        ratios, speeds, cycles, shares, unconnected = [], {1: [], 2: []}, {1: [], 2: []}, {}, []
        for pair in range(arguments.pairs):
            speed = {}
            for processes in ((1, 2), (2, 1))[pair % 2]:
                speed[processes], times, computed = run(arguments.palpate, scenes[processes], arguments.duration,
                                                        "--from-snapshot", snapshots[processes])
                speeds[processes].append(speed[processes])
                cycles[processes].append(times)
                periods = arguments.rate * arguments.duration
                shares.setdefault(processes, {m: 1e3 * t / periods for m, t in computed.items()})
            ratios.append(speed[2] / speed[1])
            alone, both = (speed_at_once(arguments.palpate, half, arguments.duration, count) for count in (1, 2))
            unconnected.append(both / alone)
    for processes, modules in shares.items():
        print(f"{processes}: {statistics.median(speeds[processes]):.2f} times real time; computed per period: "
              + ", ".join(f"{module} {ms:.2f} ms" for module, ms in sorted(modules.items())))
    ratios.sort()
    of_one, of_two = ([statistics.median(times) for times in zip(*cycles[processes])] for processes in (1, 2))
    half, tenth = (one / two for one, two in zip(of_one, of_two))
    print(f"{arguments.organs} organs of {arguments.nodes} nodes, {arguments.model} at {arguments.rate:g} Hz: two "
          f"processes simulate {statistics.median(ratios):.2f} times what one does ({ratios[0]:.2f} to {ratios[-1]:.2f}, "
          f"{arguments.pairs} pairs); by the median cycle {half:.2f} times, by the fastest tenth {tenth:.2f}; "
          f"{'the same bits' if same else 'DIFFERENT BITS'}")
    unconnected.sort()
    print(f"two simulators of half of them that share nothing: {statistics.median(unconnected):.2f} times what one does alone "
          f"({unconnected[0]:.2f} to {unconnected[-1]:.2f})")
    return 0 if same else 1


if __name__ == "__main__":
    sys.exit(main())
