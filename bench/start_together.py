#!/usr/bin/python3
"""How long sessions need to start that are started at once: real-time loops of one must not keep another from starting.

Usage: bench/start_together.py [--sessions N] [--domain D]     (after a build)
Prints for each the seconds from the common start until its session's time begins, in order.
"""
import argparse
import os
import subprocess
import threading
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def start(number, options, begin, seconds):
    words = [ROOT / "build/release/bin/palpate", "run", "stomach_probe", "--headless", "--no-visualizer", "--duration", "3"]
    words += ["--session", f"together{os.getpid()}x{number}", "--domain", str(options.domain)]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as run:
        for line in run.stdout:
            if "real time" in line and number not in seconds:  # its first line of a second, with the session's time
                seconds[number] = time.monotonic() - begin - float(line.split()[0])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sessions", type=int, default=8)
    parser.add_argument("--domain", type=int, default=78)
    options = parser.parse_args()
    seconds = {}
    begin = time.monotonic()
    threads = [threading.Thread(target=start, args=(k, options, begin, seconds)) for k in range(options.sessions)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    print(f"{len(seconds)} of {options.sessions} sessions began after", *(f"{s:.1f}" for s in sorted(seconds.values())), "s")


if __name__ == "__main__":
    main()
