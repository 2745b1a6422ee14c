#!/usr/bin/env python3
"""Maps of what `palpate stability` measures.

  plot_stability.py FOLDER   draws FOLDER/stability_*.png from atlas.csv, frontiers.csv and
                             locking.csv there
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
from matplotlib.colors import ListedColormap  # noqa: E402

from csv_rows import number, rows_of  # noqa: E402

STATES = ["stable", "drifting", "oscillating", "diverged"]
COLORS = ["#cfe8cf", "#f4e7a1", "#f0a35e", "#b5473c"]
TITLES = {
    "step_stiffness": "free ball set swinging, undamped",
    "squeeze": "ball squeezed between plates",
    "probe_speed": "sphere driven 20 mm into the ball and out",
    "mesh_quality": "free ball with one sliver",
    "haptic_loop": "device of 0.1 kg, 0.2 N s/m on a virtual wall",
}
X_NAMES = {
    "step_stiffness": "Young's modulus [Pa]",
    "squeeze": "squeeze, of the diameter",
    "probe_speed": "speed [m/s]",
    "mesh_quality": "edge over height of the sliver",
    "haptic_loop": "delay [ms]",
}
Y_NAMES = {"haptic_loop": "stiffness [N/m]"}
X_SCALES = {"haptic_loop": 1e3}
LOG_X = {"step_stiffness", "probe_speed", "mesh_quality"}


def borders(values, log):
    """Edges of cells with these centres."""
    if log:
        return [math.exp(v) for v in borders([math.log(v) for v in values], False)]
    if len(values) == 1:
        return [values[0] - 0.5, values[0] + 0.5]
    middles = [(a + b) / 2 for a, b in zip(values, values[1:])]
    return [2 * values[0] - middles[0], *middles, 2 * values[-1] - middles[-1]]


def draw_cells(axis, cells, log_x, scale):
    """Each column has rows of its own: the map's, and those the bisection tried."""
    xs = sorted({cell["x"] for cell in cells})
    x_edges = borders(xs, log_x)
    for k, x in enumerate(xs):
        column = sorted((cell["y"], STATES.index(cell["state"])) for cell in cells if cell["x"] == x)
        y_edges = borders([y for y, _ in column], True)
        axis.pcolormesh([scale * x_edges[k], scale * x_edges[k + 1]], y_edges, [[state] for _, state in column],
                        cmap=ListedColormap(COLORS), vmin=-0.5, vmax=3.5)


def draw_frontier(axis, frontiers, scale):
    line = sorted((row for row in frontiers), key=lambda row: row["x"])
    found = [row for row in line if row["edge"] == "found"]
    axis.plot([scale * row["x"] for row in found], [row["frontier"] for row in found], "ko-", markersize=3,
              linewidth=1.2)
    for key, style in (("predicted", "b--"), ("given", "k:")):
        known = [row for row in line if math.isfinite(row[key])]
        axis.plot([scale * row["x"] for row in known], [row[key] for row in known], style, linewidth=1.2)


def draw_legend(figure, cells, frontiers):
    """Of what is in the picture, and nothing else."""
    entries = {state: plt.Rectangle((0, 0), 1, 1, color=color) for state, color in zip(STATES, COLORS)
               if any(cell["state"] == state for cell in cells)}
    if any(row["edge"] == "found" for row in frontiers):
        entries["frontier, measured"] = plt.Line2D([], [], color="k", marker="o", markersize=3)
    if any(math.isfinite(row["predicted"]) for row in frontiers):
        entries["predicted"] = plt.Line2D([], [], color="b", linestyle="--")
    if any(math.isfinite(row["given"]) for row in frontiers):
        entries["largest step the model is given"] = plt.Line2D([], [], color="k", linestyle=":")
    figure.legend(entries.values(), entries.keys(), loc="lower center", ncol=7, fontsize=8, frameon=False)


def draw_map(folder, name, cells, frontiers):
    series = list(dict.fromkeys(cell["series"] for cell in cells))
    columns = min(len(series), 5 if len(series) > 8 else 4)
    rows = math.ceil(len(series) / columns)
    figure, axes = plt.subplots(rows, columns, figsize=(3.3 * columns, 2.9 * rows + 0.8), squeeze=False)
    flat = list(axes.flat)
    for axis in flat[len(series):]:
        axis.set_visible(False)
    for axis, one in zip(flat, series):
        own = [cell for cell in cells if cell["series"] == one]
        scale = X_SCALES.get(name, 1)
        draw_cells(axis, own, name in LOG_X, scale)
        draw_frontier(axis, [row for row in frontiers if row["series"] == one], scale)
        axis.set_yscale("log")
        if name in LOG_X:
            axis.set_xscale("log")
        ys = [cell["y"] for cell in own]
        axis.set_ylim(min(ys), max(ys))
        axis.set_title(one, fontsize=8)
        axis.set_xlabel(X_NAMES[name], fontsize=7)
        axis.set_ylabel(Y_NAMES.get(name, "step [s]"), fontsize=7)
        axis.tick_params(labelsize=7)
    draw_legend(figure, cells, frontiers)
    figure.suptitle(TITLES[name], fontsize=10)
    figure.tight_layout(rect=(0, 0.05, 1, 1))
    figure.savefig(folder / f"stability_{name}.png", dpi=100)
    plt.close(figure)


def locking_label(model, rows):
    """Names the largest Poisson's ratio it computes with, where that is not what it was asked for."""
    capped = [row for row in rows if row["model"] == model and row["computed_poisson_ratio"] != row["poisson_ratio"]]
    return f"{model} (computed with at most {number(capped[0]['computed_poisson_ratio']):.3f})" if capped else model


def draw_locking(folder, rows):
    figure, axis = plt.subplots(figsize=(6, 4))
    for model in dict.fromkeys(row["model"] for row in rows):
        line = [(0.5 - number(row["poisson_ratio"]), 100 * number(row["force_error"]))
                for row in rows if row["model"] == model and row["diverged"] == "0"]
        axis.semilogx(*zip(*line), marker="o", markersize=4,
                      label=locking_label(model, rows))
    axis.invert_xaxis()
    axis.axhline(0, color="#999", linewidth=0.8)
    axis.set_xlabel("½ − Poisson's ratio")
    axis.set_ylabel("error of the force [%]")
    axis.set_title("locking: coarse solid ball squeezed by 10 %", fontsize=10)
    axis.legend(frameon=False, fontsize=8)
    figure.tight_layout()
    figure.savefig(folder / "stability_locking.png", dpi=100)
    plt.close(figure)


def numbers(rows, names):
    return [{key: number(value) if key in names else value for key, value in row.items()} for row in rows]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    folder = parser.parse_args().folder
    cells = numbers(rows_of(folder / "atlas.csv"), {"x", "y"})
    frontiers = numbers(rows_of(folder / "frontiers.csv"), {"x", "frontier", "predicted", "given"})
    locking = rows_of(folder / "locking.csv")
    if not cells and not locking:
        sys.exit(f"error: {folder} holds neither atlas.csv nor locking.csv with rows")
    for name in dict.fromkeys(cell["map"] for cell in cells):
        draw_map(folder, name, [c for c in cells if c["map"] == name], [f for f in frontiers if f["map"] == name])
    if locking:
        draw_locking(folder, locking)


if __name__ == "__main__":
    main()
