#!/usr/bin/env python3
"""The force under a small sphere at many places of an organ: error against cost.

  plot_touch.py FOLDER   draws FOLDER/touch.png from what `palpate chart --case liver,stomach` left there
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

from accuracy_tables import known, rows_of  # noqa: E402

# What is drawn, by model and where its tetrahedra are small: color, marker, words.
LINES = {
    ("implicit_volume", ""): ("#9a9a9a", "s", "springs (implicit_volume), as shipped"),
    ("nodal_pressure", ""): ("#9ec5e8", "s", "linear, as shipped"),
    ("nodal_pressure", "near"): ("#1f6fb2", "v", "linear, small where it is touched"),
    ("nodal_pressure", "follow"): ("#1f6fb2", "o", "linear, following"),
    ("quadratic_pressure", ""): ("#e8a79e", "s", "quadratic, as shipped"),
    ("quadratic_pressure", "near"): ("#c0392b", "v", "quadratic, small where it is touched"),
    ("quadratic_pressure", "follow"): ("#c0392b", "o", "quadratic, following"),
}
PANELS = {"liver": "liver", "stomach": "stomach", "liver_4mm": "liver, 4 mm sphere", "stomach_4mm": "stomach, 4 mm sphere"}
LEAST = 0.4  # [%], below which errors are drawn there


def draw(axis, case, points, samples):
    for (model, small), (color, marker, _) in LINES.items():
        line = []
        for p in points:
            if (p["case"], p["model"], p["small"]) != (case, model, small) or not known(p["cost_s_per_s"], p["force_median"]):
                continue
            cost = p["cost_s_per_s"]
            mine = [s for s in samples if (s["case"], s["model"], s["small"], s["level"]) == (case, model, small, p["level"])]
            errors = [100 * abs(s["force"] / s["reference_force"] - 1) for s in mine if known(abs(s["reference_force"]))]
            axis.plot([cost] * len(errors), [max(LEAST, e) for e in errors], ".", color=color, alpha=0.25, markersize=4,
                      markeredgewidth=0)
            median, most = 100 * p["force_median"], 100 * p["force_95"]
            bar = 100 * p["force_95_bar"]
            axis.plot([cost, cost], [max(LEAST, median), max(LEAST, most)], color=color, linewidth=1.4)
            axis.plot([cost, cost], [max(LEAST, most - bar), most + bar], color=color, linewidth=4, alpha=0.35)
            line.append((cost, max(LEAST, median)))
        if line:
            axis.plot(*zip(*sorted(line)), marker=marker, color=color, linewidth=0.8, markersize=6)
    axis.axhline(10 if "4mm" not in case else 15, color="#555", linewidth=0.7, linestyle=":")
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.set_xlabel("processor seconds of one core per second, at 100 Hz")
    ticks = [1, 3, 10, 30, 100, 300]
    axis.set_yticks(ticks, [f"{t:g} %" for t in ticks])
    axis.minorticks_off()
    axis.set_xlim(0.008, 1.5)
    axis.set_xticks([0.01, 0.03, 0.1, 0.3, 1], ["0.01", "0.03", "0.1", "0.3", "1"])
    places = len({s["place"] for s in samples if s["case"] == case})
    axis.set_title(f"{PANELS[case]}: {places} places, 3, 6 and 9 mm deep", fontsize=10)


def draw_touch(folder, points, samples):
    """FOLDER/touch.png, if organs were pressed."""
    cases = [case for case in PANELS if any(p["case"] == case for p in points)]
    if not cases:
        return
    columns = min(2, len(cases))
    rows = (len(cases) + columns - 1) // columns
    figure, axes = plt.subplots(rows, columns, figsize=(5.4 * columns, 4.2 * rows + 0.8), sharey=True, squeeze=False)
    for axis in list(axes.flat)[len(cases):]:
        axis.set_visible(False)
    for axis, case in zip(axes.flat, cases):
        draw(axis, case, points, samples)
    for row in axes:
        row[0].set_ylabel("error of the force on the sphere")
    handles = [plt.Line2D([], [], marker=marker, color=color, linestyle="", label=words)
               for key, (color, marker, words) in LINES.items()
               if any((p["model"], p["small"]) == key for p in points if p["case"] in cases)]
    figure.legend(handles=handles, loc="lower center", ncol=3, frameon=False, fontsize=8)
    figure.tight_layout(rect=(0, 0.16 / rows, 1, 1))
    figure.savefig(folder / "touch.png", dpi=130)
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    folder = parser.parse_args().folder
    points, samples = rows_of(folder / "points.csv"), rows_of(folder / "samples.csv")
    if not points:
        sys.exit(f"error: {folder / 'points.csv'} holds no points; palpate chart writes it")
    draw_touch(folder, points, samples)


if __name__ == "__main__":
    main()
