#!/usr/bin/python3
"""What driving a session from Python costs: to a first curve, a step, and a sweep on two cores beside one.

Usage: bench/python_cost.py [--pairs N]     (after a build, on an idle machine; least and median of N pairs)
"""
import argparse
import collections
import importlib.util
import os
import statistics
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, os.environ.get("PYTHONPATH") or str(ROOT / "build" / "release" / "python"))
os.environ["MPLBACKEND"] = "Agg"
import palpate  # noqa: E402

STOMACH = palpate.scene_path("stomach_probe")
CURVE = """import numpy as np
import palpate
session = palpate.Session(palpate.scene_path("stomach_probe"))
said = session.run(20, keep=["probe_state", "haptic_force"])
force = np.linalg.norm(said["haptic_force"]["force_n"], axis=1)
touch, deepest = np.argmax(force > 0), np.searchsorted(said["probe_state"].time, 4.0)
position = said["probe_state"]["position_m"][touch:deepest]
depth, force = np.linalg.norm(position - position[0], axis=1), force[touch:deepest]
"""


def curve():
    """Seconds of processor, of a fresh interpreter."""
    script = CURVE + "import time\nprint(time.process_time())"
    environment = {**os.environ, "PYTHONPATH": sys.path[0]}
    return float(subprocess.run([sys.executable, "-c", script], env=environment, check=True, capture_output=True).stdout)


def step_overhead(steps=5000):
    """Seconds a step: those called one by one less those called at once, and the latter."""
    one_by_one, at_once = palpate.Session(STOMACH), palpate.Session(STOMACH)
    singly, together = 0.0, 0.0
    for _ in range(steps // 50):  # alternately, so that both meet the same machine
        begin = time.process_time()
        for _ in range(50):
            one_by_one.step()
        middle = time.process_time()
        at_once.step(50)
        singly, together = singly + middle - begin, together + time.process_time() - middle
    return (singly - together) / steps, together / steps


def timed(task):
    """Which process did it, and in how many seconds of processor."""
    module, stiffness = task
    begin = time.process_time()
    module_named(module).pressed(stiffness)
    return os.getpid(), time.process_time() - begin


def module_named(name):
    """An example, loaded once a process."""
    if name not in sys.modules:
        spec = importlib.util.spec_from_file_location(name, ROOT / "examples" / "python" / f"{name}.py")
        sys.modules[name] = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(sys.modules[name])
    return sys.modules[name]


def sweep():
    """One worker's seconds over two workers': by the clock, and of processor of the one that had more to do, which
    other programs on the cores lengthen less."""
    module_named("sweep")
    tasks = [("sweep", 5e3 * 20 ** (i / 199)) for i in range(200)]
    clock, busiest = [], []
    for workers in (1, 2):
        begin, spent = time.perf_counter(), collections.Counter()
        with ProcessPoolExecutor(workers) as pool:
            for process, seconds in pool.map(timed, tasks, chunksize=5):
                spent[process] += seconds
        clock.append(time.perf_counter() - begin)
        busiest.append(max(spent.values()))
    return clock[0] / clock[1], busiest[0] / busiest[1]


def told(values, scale=1.0):
    return f"least {scale * min(values):.2f}, median {scale * statistics.median(values):.2f}, most {scale * max(values):.2f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pairs", type=int, default=5)
    pairs = parser.parse_args().pairs
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        print(f"import to force-depth curve of stomach_probe, 20 s simulated, {len(CURVE.splitlines())} lines [s]: "
              f"{told([curve() for _ in range(pairs)])}")
        overheads, steps = zip(*(step_overhead() for _ in range(pairs)))
        print(f"a step called from Python over one within C++, 550 nodes [µs]: {told(overheads, 1e6)}")
        print(f"such a step itself [µs]: {told(steps, 1e6)}")
        by_clock, by_processor = zip(*(sweep() for _ in range(pairs)))
        print(f"200-point sweep, one worker's seconds over two workers', by the clock: {told(by_clock)}")
        print(f"the same, processor of the busier worker: {told(by_processor)}")


main()
