#!/usr/bin/env python3
"""Prints what one cycle of each stage really calls, as docs/pipeline.md shows it.

Builds the preset `trace`, runs a scene in lockstep (the real processes) with a tracer preloaded, and
turns the last cycle of each into a tree: functions with a body of more than a line in a .cpp file, in the order of
their first call, with how often they were called; what is taken from the bus (<-) and written to it (->).
"""
import argparse
import os
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
BIN = ROOT / "build/trace/bin"
STAGES = {"haptics": 4, "collision": 4, "deformation": 7, "visualizer": 2, "recorder": 2}  # levels shown
LEFT_OUT = re.compile(r"lambda|operator|(^|::)(\w+)(<.*>)?::~?\2$")  # constructors and destructors, too


def run(*command, **options):
    return subprocess.run([str(word) for word in command], check=True, text=True, **options)


def build(out):
    run("g++", "-std=c++20", "-O1", "-shared", "-fPIC", ROOT / "scripts/trace/cycle_tracer.cpp", "-o", out / "tracer.so")
    run(ROOT / "scripts/build", "trace", "palpate_program", *(f"palpate_{name}_program" for name in STAGES), stdout=sys.stderr)


def root_of(program):
    symbols = run("nm", "-C", BIN / program, capture_output=True).stdout
    return re.search(r"^(\w+) [tT] .*Stage::cycle\(", symbols, re.M).group(1)


def trace(scene, seconds, out):
    roots = " ".join(f"palpate-{name}={root_of(f'palpate-{name}')}" for name in STAGES)
    environment = dict(os.environ, LD_PRELOAD=str(out / "tracer.so"), PALPATE_TRACE_ROOTS=roots,
                       PALPATE_TRACE_FOLDER=str(out))
    run(BIN / "palpate", "run", scene, "--lockstep", "--headless", "--no-realtime", "--duration", seconds,
        "--frames", out / "frames", "--frame-interval-s", 0.01, "--record", out / "recording.mcap", "--overwrite",
        # While a snapshot is due nothing is taken before its cycle, which so shows all that it reads.
        "--snapshot-at", seconds, "--snapshot", out / "snapshot",
        env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


class Call:
    def __init__(self, offset):
        self.offset, self.count, self.below = offset, 0, {}


def tree_of(lines):
    """Calls of the same function by the same caller are one node."""
    top = Call(None)
    stack = [top]
    for line in lines:
        if line == "-":
            stack.pop()
            continue
        call = stack[-1].below.setdefault(line, Call(line))
        call.count += 1
        stack.append(call)
    return next(iter(top.below.values()))


def symbols_of(program, offsets):
    """offset -> (function, file; empty if it is not worth a line)"""
    found = run("addr2line", "-f", "-C", "-e", BIN / program, *offsets, capture_output=True).stdout.splitlines()
    names = {}
    for offset, function, place in zip(offsets, found[::2], found[1::2]):
        file, _, line = place.partition(":")
        path = pathlib.Path(file)
        name = short(function)
        shown = path.suffix == ".cpp" and ROOT in path.parents and begins_at(path, int(line.split()[0]), name)
        names[offset] = (name, os.path.relpath(file, ROOT) if shown and not LEFT_OUT.search(name) else "")
    return names


def begins_at(path, line, name):
    """Whether the function is written there, on more than one line. Where it is inlined, another place is told."""
    lines = path.read_text().splitlines()
    head = " ".join(lines[max(0, line - 3):line])
    return re.search(r"\b" + name.split("::")[-1] + r"\(", head) and not lines[line - 1].endswith("}")


def short(function):
    """palpate::collision::(anonymous namespace)::OrganInputs::take() -> OrganInputs::take"""
    function = re.sub(r"\(anonymous namespace\)::|\[abi:\w+\]|palpate::", "", function).split("(")[0]
    on_bus = re.search(r"bus::(Reader|Writer)<(\w+)>::(take|write)$", function)
    if on_bus:
        return on_bus.group(0)
    while re.search("<[^<>]*>", function):
        function = re.sub("<[^<>]*>", "", function)
    function = function.split("<")[0]
    words = function.split()[-1].split("::")
    while len(words) > 1 and words[0].islower():
        words.pop(0)
    return "::".join(words)


def show(call, names, caller, depth, deepest, rows):
    name, file = names[call.offset]
    on_bus = re.match(r"bus::\w+<(\w+)>::(take|write)$", name)
    if on_bus:
        rows.append((depth, f"{'<-' if on_bus.group(2) == 'take' else '->'} {on_bus.group(1)}", call.count, ""))
        return
    shown = file != "" and name != caller
    if shown:
        rows.append((depth, name, call.count, file))
    if depth + shown > deepest:
        return
    for below in call.below.values():
        show(below, names, name if shown else caller, depth + shown, deepest, rows)


def merged(rows):
    """What was called in the same place through several hidden callers, once."""
    kept = []
    for row in rows:
        same = [i for i, old in enumerate(kept) if old[0] == row[0] and old[1] == row[1]]
        fences = [i for i, old in enumerate(kept) if old[0] < row[0]]
        if same and (not fences or same[-1] > fences[-1]):
            depth, name, count, file = kept[same[-1]]
            kept[same[-1]] = (depth, name, count + row[2], file)
        else:
            kept.append(row)
    return kept


def table(name, out, deepest):
    program = f"palpate-{name}"
    lines = (out / program).read_text().split()
    names = symbols_of(program, sorted(set(lines) - {"-"}))
    rows = []
    show(tree_of(lines), names, "", 0, deepest, rows)
    text = []
    for depth, function, count, file in merged(rows):
        left = "  " * depth + function + (f" x{count}" if count > 1 else "")
        text.append(f"{left:<57} {file}".rstrip())
    return "\n".join(text)


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("scene", nargs="?", default="scenes/stomach_probe.yaml")
    arguments.add_argument("--seconds", type=float, default=4, help="simulated before the cycle that is shown")
    arguments.add_argument("--page", type=pathlib.Path, help="put them there (docs/pipeline.md) instead of printing them")
    options = arguments.parse_args()
    out = ROOT / "out/trace"
    out.mkdir(parents=True, exist_ok=True)
    build(out)
    trace(options.scene, options.seconds, out)
    tables = [f"```trace\n{table(name, out, deepest)}\n```" for name, deepest in STAGES.items()]
    if not options.page:
        print("\n\n".join(tables))
        return
    page, count = re.subn(r"```trace\n.*?```", lambda _: tables.pop(0), options.page.read_text(), count=len(STAGES), flags=re.S)
    if count != len(STAGES):
        sys.exit(f"{options.page} has {count} of {len(STAGES)} traces")
    options.page.write_text(page)


if __name__ == "__main__":
    sys.exit(main())
