#!/usr/bin/env python3
"""Pictures of a recording.

  plot_recording.py plots CSV_FOLDER OUT.png [--title TEXT]
      volume error, pressure, force on each probe, rates and input ages over session time, from
      the files that `palpate inspect RECORDING --csv CSV_FOLDER` writes
  plot_recording.py strip FRAMES_FOLDER OUT.png [--count N]
      N frames (frame_<seconds>.png, as the visualizer writes them), evenly spaced, three in a row
"""

import argparse
import csv
import math
import re
import sys
from pathlib import Path

try:
    import matplotlib
except ImportError:
    sys.exit("error: matplotlib is missing (Debian: python3-matplotlib)")

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

FRAME_NAME = re.compile(r"frame_(\d+(?:\.\d+)?)\.png$")
SMALLEST_ERROR = 1e-16  # rounding of a relative volume: what a logarithmic axis can show of zero
SELDOM_WRITTEN = {"scene", "surface", "session_control"}  # old by nature: their age says nothing
MOST_COLUMNS = 3  # of a picture strip: more would be too small to read
MOST_POINTS = 4000  # per curve: more cannot be seen


class BadInput(Exception):
    """Told to the user in one line."""


def read_table(file):
    """Columns of a CSV file as lists of text, of the samples after the session's start."""
    with open(file, newline="", encoding="utf-8", errors="replace") as stream:
        rows = [row for row in csv.DictReader(stream) if float(row["sim_time_s"]) > 0]
    return {name: [row[name] for row in rows] for name in (rows[0] if rows else [])}


def numbers(table, column):
    return [float(value) for value in table[column]]


def tables(folder, topic):
    """(key, table) of each file of a topic that has samples."""
    found = []
    for file in sorted(folder.glob(f"{topic}_*.csv")):
        table = read_table(file)
        if table:
            found.append((file.stem[len(topic) + 1 :], table))
    return found


def draw(axes, times, values, label):
    """A curve of at most MOST_POINTS; of each stretch the largest magnitude is kept."""
    if all(math.isnan(value) for value in values):
        return
    stretch = max(1, math.ceil(len(times) / MOST_POINTS))
    kept = [
        max(range(i, min(i + stretch, len(times))), key=lambda k: abs(values[k]))
        for i in range(0, len(times), stretch)
    ]
    axes.plot([times[k] for k in kept], [values[k] for k in kept], label=label, linewidth=1.2)


def draw_volume_error(axes, folder):
    axes.set_ylabel("|V − V₀| / V₀")
    for organ, table in tables(folder, "node_positions"):
        pairs = zip(numbers(table, "volume_m3"), numbers(table, "target_volume_m3"))
        errors = [max(abs(v - v0) / v0, SMALLEST_ERROR) if v0 > 0 else math.nan for v, v0 in pairs]
        draw(axes, numbers(table, "sim_time_s"), errors, f"organ {organ}")
    axes.set_yscale("log")


def draw_pressure(axes, folder):
    axes.set_ylabel("pressure [Pa]")
    for organ, table in tables(folder, "node_positions"):
        draw(axes, numbers(table, "sim_time_s"), numbers(table, "pressure_pa"), f"organ {organ}")


def draw_force(axes, folder):
    axes.set_ylabel("force on probe [N]")
    for probe, table in tables(folder, "haptic_force"):
        components = (numbers(table, f"force_{axis}_n") for axis in "xyz")
        magnitudes = [math.hypot(*force) for force in zip(*components)]
        draw(axes, numbers(table, "sim_time_s"), magnitudes, f"probe {probe}")


def draw_rates(axes, folder):
    axes.set_ylabel("rate / nominal")
    for module, table in tables(folder, "module_status"):
        nominal = numbers(table, "nominal_rate_hz")
        rates = [r / n if n > 0 else math.nan for r, n in zip(numbers(table, "rate_hz"), nominal)]
        draw(axes, numbers(table, "sim_time_s"), rates, f"{module} ({nominal[-1]:g} Hz)")
    axes.set_ylim(0, 1.1 * max(1, axes.get_ylim()[1]))


def draw_ages(axes, folder):
    axes.set_ylabel("age of inputs [ms]")
    axes.set_prop_cycle(color=matplotlib.colormaps["tab20"].colors)  # more lines than ten
    goodbyes = {
        (module, sequence)
        for module, table in tables(folder, "module_status")
        for sequence, state in zip(table["sequence"], table["state"])
        if state == "stopped"
    }
    for module, table in tables(folder, "module_inputs"):
        times = numbers(table, "sim_time_s")
        ages = [1e3 * age if math.isfinite(age) else math.nan for age in numbers(table, "age_s")]
        for topic in dict.fromkeys(table["topic"]):
            if topic in SELDOM_WRITTEN:
                continue
            rows = [
                i
                for i, name in enumerate(table["topic"])
                if name == topic and (module, table["sequence"][i]) not in goodbyes
            ]
            draw(axes, [times[i] for i in rows], [ages[i] for i in rows], f"{module} ← {topic}")
    axes.set_yscale("log")


PANELS = [draw_volume_error, draw_pressure, draw_force, draw_rates, draw_ages]


def plot(folder, out, title):
    if not folder.is_dir():
        raise BadInput(f"{folder}: no such folder")
    figure, panels = plt.subplots(len(PANELS), 1, sharex=True, figsize=(9, 12), dpi=110)
    for panel, axes in zip(PANELS, panels):
        panel(axes, folder)
        axes.grid(True, alpha=0.3)
        if axes.lines:
            axes.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), fontsize=8, frameon=False)
        else:
            axes.text(0.5, 0.5, "not recorded", transform=axes.transAxes, ha="center", va="center")
    if not any(axes.lines for axes in panels):
        raise BadInput(f"{folder}: holds no samples from after the start of a session")
    panels[-1].set_xlabel("session time [s]")
    panels[0].set_title(title)
    figure.align_ylabels(panels)
    figure.savefig(out, bbox_inches="tight")


def frames_in(folder):
    """(time [s], file) of each frame, in order of time."""
    named = ((FRAME_NAME.search(file.name), file) for file in folder.glob("frame_*.png"))
    return sorted((float(match.group(1)), file) for match, file in named if match)


def evenly_spaced(frames, count):
    """First, last, and between them those nearest to equal steps of time."""
    if count >= len(frames):
        return frames
    first, last = frames[0][0], frames[-1][0]
    wanted = [first + (last - first) * i / max(count - 1, 1) for i in range(count)]
    return [min(frames, key=lambda frame: abs(frame[0] - time)) for time in wanted]


def strip(folder, out, count):
    frames = frames_in(folder)
    if not frames:
        raise BadInput(f"{folder}: holds no frame_<seconds>.png")
    chosen = evenly_spaced(frames, count)
    images = [plt.imread(file) for _, file in chosen]
    height, width = images[0].shape[:2]
    inches = 4.0
    columns = min(len(chosen), MOST_COLUMNS)
    rows = math.ceil(len(chosen) / columns)
    figure, panels = plt.subplots(
        rows,
        columns,
        squeeze=False,
        figsize=(inches * columns, (inches * height / width + 0.25) * rows),
        dpi=120,
        gridspec_kw={"wspace": 0.02, "hspace": 0.1},
    )
    for axes in panels.flat:
        axes.axis("off")
    for axes, (time, _), image in zip(panels.flat, chosen, images):
        axes.imshow(image)
        axes.set_title(f"{time:.1f} s", fontsize=9, pad=3)
    figure.savefig(out, bbox_inches="tight", pad_inches=0.05)


def parse_arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    kinds = parser.add_subparsers(dest="kind", required=True)
    plots = kinds.add_parser("plots", help="curves over time from a folder of CSV files")
    plots.add_argument("--title", default="")
    strip_of = kinds.add_parser("strip", help="frames side by side")
    strip_of.add_argument("--count", type=int, default=5, help="frames to show, at least 1")
    for kind in (plots, strip_of):
        kind.add_argument("folder", type=Path)
        kind.add_argument("out", type=Path)
    return parser.parse_args()


def main():
    arguments = parse_arguments()
    try:
        arguments.out.parent.mkdir(parents=True, exist_ok=True)
        if arguments.kind == "plots":
            plot(arguments.folder, arguments.out, arguments.title or arguments.folder.name)
        else:
            strip(arguments.folder, arguments.out, max(arguments.count, 1))
    except BadInput as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
