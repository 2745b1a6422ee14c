#!/usr/bin/env python3
"""Pictures of what `palpate certify` measures.

  plot_certify.py FOLDER [TABLE ...]   draws FOLDER/certify_*.png from these tables (law, force,
                                       press, held, slide, timing), else from those that are there
"""

import argparse
import sys
from pathlib import Path

try:
    import matplotlib
except ImportError as error:
    sys.exit(f"error: {error.name} is missing (Debian: apt install python3-matplotlib)")

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

from csv_rows import rows_of  # noqa: E402


def columns(rows, name, scale=1.0):
    return [scale * row[name] for row in rows]


def draw_law(axis, folder, tables):
    rows = rows_of(folder / "law.csv", set())
    axis.plot(columns(rows, "depth_m", 1e3), columns(rows, "organ_n_per_m"), "k.-", label="organ, finite differences")
    axis.plot(columns(rows, "depth_m", 1e3), columns(rows, "law_n_per_m"), "C1.--", label="the hand's law")
    axis.set(xlabel="depth [mm]", ylabel="stiffness [N/m]", title="law", ylim=(0, None))
    axis.legend(fontsize=8)


def draw_press(axis, folder, tables):
    rows = rows_of(folder / "press.csv", set())
    axis.plot(columns(rows, "depth_m", 1e3), columns(rows, "motor_n"), label="pressed and let go")
    if "force" in tables:
        still = rows_of(folder / "force.csv", set())
        axis.plot(columns(still, "depth_m", 1e3), columns(still, "organ_n"), "ko", label="organ at rest")
        axis.plot(columns(still, "depth_m", 1e3), columns(still, "felt_n"), "C1x", label="held")
    axis.set(xlabel="depth [mm]", ylabel="force of the motors [N]", title="press and release")
    axis.legend(fontsize=8)


def draw_held(axis, folder, tables):
    rows = rows_of(folder / "held.csv", set())
    axis.plot(columns(rows, "time_s"), columns(rows, "depth_m", 1e3))
    axis.axvline(2, color="#999", linewidth=0.8)
    axis.set(xlabel="time [s]", ylabel="depth [mm]", title="held by a constant push")


def draw_slide(axis, folder, tables):
    rows = rows_of(folder / "slide.csv", set())
    axis.plot(columns(rows, "time_s"), columns(rows, "force_n"), linewidth=0.8)
    axis.set(xlabel="time [s]", ylabel="force [N]", title="sliding over the organ", ylim=(0, None))
    steps = axis.twinx()
    steps.plot(columns(rows, "time_s"), columns(rows, "over"), "C3", linewidth=0.6)
    steps.axhline(1, color="C3", linewidth=0.8, linestyle=":")
    steps.set_ylabel("step over its limit", color="C3")
    steps.set_ylim(0, None)


def draw_timing(axis, folder, tables):
    rows = rows_of(folder / "timing.csv", set())
    left = [1 - share + 1 / len(rows) for share in columns(rows, "share")]
    axis.loglog(columns(rows, "period_s", 1e3), left, label="loop period")
    axis.loglog(columns(rows, "latency_s", 1e3), left, label="pose to force")
    axis.set(xlabel="time [ms]", ylabel="share that is longer", title="times of the real processes")
    axis.legend(fontsize=8)


PICTURES = {"law": draw_law, "press": draw_press, "held": draw_held, "slide": draw_slide, "timing": draw_timing}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("tables", nargs="*")
    arguments = parser.parse_args()
    folder = arguments.folder
    tables = [name for name in arguments.tables or [*PICTURES, "force"] if (folder / f"{name}.csv").exists()]
    drawn = [name for name in PICTURES if name in tables]
    if not drawn:
        sys.exit(f"error: {folder} holds none of the tables")
    for name in drawn:
        figure, axis = plt.subplots(figsize=(8, 3.2))
        PICTURES[name](axis, folder, tables)
        figure.tight_layout()
        figure.savefig(folder / f"certify_{name}.png", dpi=100)
        plt.close(figure)


if __name__ == "__main__":
    main()
