#!/usr/bin/env python3
"""Pictures per second of the window at 1280 x 720 with software OpenGL, the whole session running beside it.

Usage: bench/frame_rate.py [--seconds S] [--repeats N] [SCENE ...]    (needs Xvfb)
Prints per scene and repeat: pictures per second, haptics on time, and beside it, at the same time and with the same
priority, an empty loop of 1 kHz on time: what the machine itself keeps. --without: the same without the window.
"""
import argparse
import os
import re
import signal
import subprocess
import sys

FOLDER = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
SCENES = ["stomach_probe", "stomach_probe_refined"]


def start_display():
    read, write = os.pipe()
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", str(write), "-screen", "0", "1920x1200x24", "-nolisten", "tcp", "-noreset"],
        pass_fds=[write], stderr=subprocess.DEVNULL)
    os.close(write)
    with os.fdopen(read) as answer:
        return server, ":" + answer.readline().strip()


def measure(palpate, scene, options, display):
    words = [palpate, "run", scene, "--duration", str(options.seconds), "--domain", str(100 + os.getpid() % 90)]
    with subprocess.Popen([palpate + "-bench-empty-loop"], stdout=subprocess.PIPE, text=True) as bare:
        text = subprocess.run(words + ["--headless" if options.without else "--close"],
                              env={**os.environ, "DISPLAY": display}, capture_output=True, text=True, check=False)
        bare.send_signal(signal.SIGTERM)
        bare_on_time = float(bare.communicate()[0].split()[0])
    said = text.stdout + text.stderr

    def line(module):
        found = re.search(rf"^{module} +(\d+) cycles, ([\d.]+) % on time", said, re.M)
        if not found:
            sys.exit(f"frame_rate.py: no line of {module} in the summary:\n{said}")
        return int(found[1]), float(found[2])

    pictures, _ = (0, 0) if options.without else line("visualizer")
    _, on_time = line("haptics")
    wall = re.search(r"in ([\d.]+) s", said)
    return pictures / (float(wall[1]) if wall else options.seconds), on_time, bare_on_time


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", metavar="SCENE")
    parser.add_argument("--seconds", type=float, default=10)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--without", action="store_true", help="no window")
    parser.add_argument("--palpate", default=os.path.join(FOLDER, "build/release/bin/palpate"))
    options = parser.parse_args()
    scenes = options.scenes or [os.path.join(FOLDER, f"scenes/{name}.yaml") for name in SCENES]
    server, display = start_display()
    try:
        for repeat in range(options.repeats):
            for scene in scenes:  # in turn: what the machine does beside meets all alike
                rate, on_time, bare = measure(options.palpate, scene, options, display)
                print(f"{os.path.basename(scene):32} {rate:5.1f} pictures/s   on time: haptics {on_time:7.3f} %"
                      f"   empty loop {bare:7.3f} %   load {os.getloadavg()[0]:.1f}", flush=True)
    finally:
        server.terminate()
        server.wait()


if __name__ == "__main__":
    main()
