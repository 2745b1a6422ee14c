#!/usr/bin/env python3
"""The force under a small sphere at many places of an organ: error against cost.

  plot_touch.py OUT.png TABLE.csv [TABLE.csv ...]   a panel for each table that palpate-bench-touch --out wrote
"""

import argparse
import math
import sys
from pathlib import Path

try:
    import matplotlib
except ImportError as error:
    sys.exit(f"error: {error.name} is missing (Debian: apt install python3-matplotlib)")

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

from csv_rows import rows_of  # noqa: E402

COLORS = {"springs": "#9a9a9a", "linear": "#1f6fb2", "quadratic": "#c0392b"}
LEAST = 0.4  # [%], below which errors are drawn there


def quantile(values, part):
    """What so many of 100 do not exceed."""
    ordered = sorted(values)
    return ordered[max(0, math.ceil(part * len(ordered) / 100) - 1)]


def draw(axis, rows):
    by_mesh = {}
    for row in rows:
        by_mesh.setdefault(row["mesh"], []).append(row)
    medians = {}
    for mesh, points in by_mesh.items():
        kind = mesh.split(",")[0]
        errors = [max(LEAST, 100 * abs(p["force_n"] / p["true_force_n"] - 1)) for p in points]
        costs = [p["cost_s_per_s"] for p in points]
        cost, median = quantile(costs, 50), quantile(errors, 50)
        axis.plot(costs, errors, ".", color=COLORS[kind], alpha=0.25, markersize=4, markeredgewidth=0)
        axis.plot([cost, cost], [median, quantile(errors, 95)], color=COLORS[kind], linewidth=1.4)
        axis.plot(cost, median, "o" if "as shipped" not in mesh else "s", color=COLORS[kind], markersize=7)
        below = kind == "quadratic"
        axis.annotate(mesh.split(", ")[1], (cost, median), textcoords="offset points",
                      xytext=(-7, -4) if below else (7, 4), ha="right" if below else "left", va="top" if below else "bottom",
                      fontsize=8, color=COLORS[kind])
        medians.setdefault(kind, []).append((cost, median))
    for kind, line in medians.items():
        axis.plot(*zip(*sorted(line)), color=COLORS[kind], linewidth=0.8, alpha=0.6, zorder=0)
    axis.axhline(10, color="#555", linewidth=0.7, linestyle=":")
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.set_xlabel("processor seconds of one core per second, at 100 Hz")
    ticks = [1, 3, 10, 30, 100, 300]
    axis.set_yticks(ticks, [f"{t:g} %" for t in ticks])
    axis.minorticks_off()
    axis.set_xlim(0.008, 1)
    axis.set_xticks([0.01, 0.03, 0.1, 0.3, 1], ["0.01", "0.03", "0.1", "0.3", "1"])
    places = len({row["place"] for row in rows})
    axis.set_title(f"{rows[0]['organ']}: {places} places, 3, 6 and 9 mm deep", fontsize=10)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("tables", type=Path, nargs="+")
    arguments = parser.parse_args()
    figure, axes = plt.subplots(1, len(arguments.tables), figsize=(5.4 * len(arguments.tables), 4.6), sharey=True,
                                squeeze=False)
    for axis, table in zip(axes.flat, arguments.tables):
        rows = rows_of(table, words={"organ", "mesh"})
        if not rows:
            sys.exit(f"error: {table} holds no points; palpate-bench-touch --out writes it")
        draw(axis, rows)
    axes[0][0].set_ylabel("error of the force on a sphere of 8 mm")
    handles = [plt.Line2D([], [], marker="o", linestyle="", color=c, label=k) for k, c in COLORS.items()]
    handles.append(plt.Line2D([], [], marker="s", linestyle="", color="#555", label="as shipped"))
    figure.legend(handles=handles, loc="lower center", ncol=4, frameon=False, fontsize=9)
    figure.tight_layout(rect=(0, 0.06, 1, 1))
    figure.savefig(arguments.out, dpi=130)


if __name__ == "__main__":
    main()
