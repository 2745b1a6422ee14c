#!/usr/bin/env python3
"""Charts of what `palpate chart` measures.

  plot_accuracy.py FOLDER              draws FOLDER/accuracy_*.png from points.csv, samples.csv and
                                       bullet.csv there, writes results.md, prints Pareto fronts and
                                       slopes
  plot_accuracy.py FOLDER --docs DOCS  also puts pictures and tables into DOCS/accuracy.md
"""

import argparse
import math
import sys
from collections import defaultdict
from pathlib import Path

try:
    import matplotlib
except ImportError as error:
    sys.exit(f"error: {error.name} is missing (Debian: apt install python3-matplotlib)")

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

from accuracy_tables import ERRORS, TITLES, known, nodes_of, put_into_docs, rows_of, write_tables  # noqa: E402
from plot_touch import draw_touch  # noqa: E402

PALETTE = ["#9a9a9a", "#1f6fb2", "#c0392b", "#d98c1f", "#8e5a2b", "#e377c2", "#a23bb0", "#2a8f5b", "#0f9d9d", "#7f8c1f",
           "#111111"]
# By model, from models.csv.
COLORS = {}
OWN_ITERATIONS = {}  # per step, where the scene asks for none of its own
MARKERS = "ovsD^"  # by mesh level


def take_models(folder):
    rows = rows_of(folder / "models.csv")
    if not rows:
        sys.exit(f"error: {folder / 'models.csv'} holds no models; palpate chart writes it")
    for k, row in enumerate(rows):
        COLORS[row["model"]] = PALETTE[k % len(PALETTE)]
        OWN_ITERATIONS[row["model"]] = row["iterations"]


def pareto(points, error):
    """Cheapest first; each next one is dearer and better by a twentieth at least."""
    front = []
    for point in sorted(points, key=lambda p: (p["cost_s_per_s"], p[error])):
        if not front or point[error] < 0.95 * front[-1][error]:
            front.append(point)
    return front


def label(point):
    iterations = f", {point['iterations']:g} iterations" if point["iterations"] else ""
    where = {"near": " where touched", "follow": " following"}.get(point["small"], "")
    return f"{point['model']}{where}, {int(nodes_of(point))} nodes, {point['rate_hz']:g} Hz{iterations}"


def name_front(axis, front):
    """Below the panel, in two columns."""
    names = [f"{k + 1} {label(point)}" for k, point in enumerate(front)]
    half = (len(names) + 1) // 2
    for x, column in ((-0.12, names[:half]), (0.48, names[half:])):
        axis.text(x, -0.2, "\n".join(column), transform=axis.transAxes, va="top", fontsize=6.5, color="#333")


def legend_of_models(figure, models):
    handles = [
        plt.Line2D([], [], marker="o", linestyle="", color=COLORS.get(model, "k"), label=model)
        for model in models
    ]
    figure.legend(handles=handles, loc="lower center", ncol=6 if figure.get_figwidth() > 9 else 4, frameon=False,
                  fontsize=8)


def panels(count, height=3.9):
    columns = min(count, 3 if count > 4 else 2)
    rows = math.ceil(count / columns)
    figure, axes = plt.subplots(rows, columns, figsize=(4.9 * columns, height * rows + 0.6), squeeze=False)
    flat = list(axes.flat)
    for axis in flat[count:]:
        axis.set_visible(False)
    return figure, flat


def scatter(axis, points, x, y, scale):
    for point in points:
        axis.loglog(point[x], scale * point[y], marker=MARKERS[int(point["level"])],
                    color=COLORS.get(point["model"], "k"), markersize=6, alpha=0.85, linestyle="")


def draw_error_cost(folder, points, cases):
    """The main chart: error against cost with the Pareto front."""
    figure, axes = panels(len(cases), height=4.3)
    for axis, case in zip(axes, cases):
        error, scale, words = ERRORS[case]
        here = [p for p in points if p["case"] == case and not p["diverged"]
                and known(p["cost_s_per_s"], p[error])]
        scatter(axis, here, "cost_s_per_s", error, scale)
        front = pareto(here, error)
        axis.plot([p["cost_s_per_s"] for p in front], [scale * p[error] for p in front],
                  color="#555", linewidth=0.8, zorder=0)
        axis.axvline(1, color="#bbb", linewidth=0.8, zorder=0)
        axis.set_title(TITLES[case], fontsize=9)
        axis.set_xlabel("cost [processor s per simulated s]", fontsize=8)
        axis.set_ylabel(words, fontsize=8)
        if front:
            print(f"\n{case}: Pareto front, {words}")
        for k, point in enumerate(front):
            print(f"  {point['cost_s_per_s']:10.4g} s/s  {scale * point[error]:8.3g}  {label(point)}")
            axis.annotate(str(k + 1), (point["cost_s_per_s"], scale * point[error]), fontsize=7,
                          xytext=(4, 4), textcoords="offset points")
        name_front(axis, front)
    figure.suptitle("error against cost; right of the line: slower than real time on one core", fontsize=10)
    legend_of_models(figure, [m for m in COLORS if any(p["model"] == m for p in points)])
    figure.tight_layout(rect=(0, 0.06, 1, 0.98))
    figure.savefig(folder / "accuracy_cost.png", dpi=110)
    plt.close(figure)


def slope(xs, ys):
    """Of log y over log x, least squares."""
    lx, ly = [math.log(x) for x in xs], [math.log(y) for y in ys]
    mx, my = sum(lx) / len(lx), sum(ly) / len(ly)
    spread = sum((x - mx) ** 2 for x in lx)
    return sum((x - mx) * (y - my) for x, y in zip(lx, ly)) / spread if spread > 0 else math.nan


def draw_mesh(folder, points, cases, y, scale_of, words, name):
    figure, axes = panels(len(cases))
    for axis, case in zip(axes, cases):
        column, scale = (ERRORS[case][0], ERRORS[case][1]) if y is None else (y, scale_of)
        lines = defaultdict(list)
        for p in points:
            if p["case"] == case and not p["diverged"] and not p["iterations"] and known(p[column]):
                lines[(p["model"], p["rate_hz"], p["small"])].append(p)
        best = {}
        for (model, rate, small), line in lines.items():
            if len(line) >= 2 and rate <= best.get((model, small), (math.inf,))[0]:
                best[(model, small)] = (rate, line)
        for (model, small), (rate, line) in best.items():
            line.sort(key=nodes_of)
            xs, ys = [nodes_of(p) for p in line], [scale * p[column] for p in line]
            axis.loglog(xs, ys, marker="o", markersize=4, color=COLORS.get(model, "k"), linewidth=1)
            print(f"{case:11} {model:20} {small:6} {words}: slope {slope(xs, ys):+.2f} in nodes ({rate:g} Hz)")
        axis.set_title(TITLES[case], fontsize=9)
        axis.set_xlabel("nodes", fontsize=8)
        axis.set_ylabel(ERRORS[case][2] if y is None else words, fontsize=8)
    legend_of_models(figure, [m for m in COLORS if any(p["model"] == m for p in points)])
    figure.tight_layout(rect=(0, 0.06, 1, 1))
    figure.savefig(folder / name, dpi=110)
    plt.close(figure)


def draw_volume(folder, points, bullet):
    """Volume error against cost on the squeezed ball; Bullet's settings beside."""
    figure, axis = plt.subplots(figsize=(7, 4.6))
    here = [p for p in points if p["case"] == "ball" and not p["diverged"]
            and known(p["cost_s_per_s"], p["volume_error"])]
    scatter(axis, here, "cost_s_per_s", "volume_error", 1)
    for row in bullet:
        theirs = row["solver"].lower().startswith("bullet") and known(row["us_per_step"], row["volume_error_peak"])
        if theirs and row["volume_error_peak"] < 1:  # more has blown up
            axis.loglog(row["us_per_step"] * 1e-6 / 2e-3, row["volume_error_peak"], "x", color="#e67e22", markersize=6)
    axis.set_xlabel("cost [processor s per simulated s]")
    axis.set_ylabel("largest |V − V*| / V*")
    axis.set_title("squeezed ball: volume error against cost (× Bullet's soft body, 642 nodes, h = 2 ms)", fontsize=9)
    legend_of_models(figure, [m for m in COLORS if any(p["model"] == m for p in here)])
    figure.tight_layout(rect=(0, 0.13, 1, 1))
    figure.savefig(folder / "accuracy_volume.png", dpi=110)
    plt.close(figure)


def draw_curves(folder, samples):
    """Shape of the answer: force over Hertz, bulge over force, radius of contact, against compression."""
    figure, axes = plt.subplots(1, 3, figsize=(15.5, 4.4))
    ball = [s for s in samples if s["case"] == "ball" and not s["iterations"] and known(s["force"])]
    # Two equal contacts: each gives way by half of the whole approach, d = load · R.
    hertz = {load: 4 / 3 * (5e3 / 0.75) * math.sqrt(0.05) * (load * 0.05) ** 1.5
             for load in {s["load"] for s in ball}}
    reference = sorted({(s["load"], s["reference_force"], s["reference_shape_m"], s["reference_contact_radius_m"])
                    for s in ball})
    axes[0].plot([t[0] for t in reference], [t[1] / hertz[t[0]] for t in reference], "k--", label="reference (finite elements)")
    axes[1].plot([t[0] for t in reference], [1e3 * t[2] / t[1] for t in reference], "k--", label="reference")
    axes[2].plot([t[0] for t in reference], [1e3 * t[3] for t in reference], "k--", label="reference")
    finest = {}
    for s in ball:
        key = s["model"]
        finest[key] = max(finest.get(key, (-1, -1)), (s["level"], -s["rate_hz"]))
    for model, color in COLORS.items():
        line = sorted((s for s in ball if s["model"] == model and (s["level"], -s["rate_hz"]) == finest.get(model)),
                      key=lambda s: s["load"])
        if not line:
            continue
        loads = [s["load"] for s in line]
        axes[0].plot(loads, [s["force"] / hertz[s["load"]] for s in line], marker="o", markersize=3, color=color, label=model)
        axes[1].plot(loads, [1e3 * s["shape_m"] / s["force"] for s in line], marker="o", markersize=3, color=color)
        axes[2].plot(loads, [1e3 * s["contact_radius_m"] for s in line], marker="o", markersize=3, color=color)
    axes[0].set_ylabel("force / Hertz")
    axes[1].set_ylabel("growth of the equator / force [mm/N]")
    axes[1].set_yscale("log")
    axes[2].set_ylabel("radius of contact [mm]")
    for axis in axes:
        axis.set_xlabel("compression")
    axes[0].legend(fontsize=7, frameon=False)
    figure.suptitle("solid ball: how the answer grows with compression", fontsize=10)
    figure.tight_layout()
    figure.savefig(folder / "accuracy_curves.png", dpi=110)
    plt.close(figure)


def draw_iterations(folder, points):
    """What more iterations per step buy, and cost: one line per model, a point per count."""
    figure, axis = plt.subplots(figsize=(7, 4.6))
    error, scale, words = ERRORS["ball"]
    swept = {(p["model"], p["level"], p["rate_hz"]) for p in points if p["case"] == "ball" and p["iterations"]}
    for key in sorted(swept):
        line = [p for p in points if p["case"] == "ball" and not p["diverged"] and known(p[error])
                and (p["model"], p["level"], p["rate_hz"]) == key]
        line.sort(key=lambda p: p["iterations"] or OWN_ITERATIONS[p["model"]])
        axis.loglog([p["cost_s_per_s"] for p in line], [scale * p[error] for p in line], marker="o",
                    color=COLORS.get(key[0], "k"), linewidth=1)
        for p in line:
            count = p["iterations"] or OWN_ITERATIONS[p["model"]]
            axis.annotate(f"{count:g}", (p["cost_s_per_s"], scale * p[error]), fontsize=7, xytext=(4, 4),
                          textcoords="offset points")
            print(f"ball, {key[0]}, level {key[1]:g}, {key[2]:g} Hz, {count:g} iterations: {p['cost_s_per_s']:.3g} s/s, "
                  f"force {scale * p[error]:.2f} %")
    axis.set_xlabel("cost [processor s per simulated s]")
    axis.set_ylabel(words)
    axis.set_title("squeezed ball: number of iterations per step, beside the points", fontsize=9)
    legend_of_models(figure, [m for m in COLORS if any(key[0] == m for key in swept)])
    figure.tight_layout(rect=(0, 0.07, 1, 1))
    figure.savefig(folder / "accuracy_iterations.png", dpi=110)
    plt.close(figure)


def draw_profile(folder, profiles):
    """The surface beside the indenter, at the smallest and the largest depth, on each model's finest mesh."""
    here = [p for p in profiles if p["case"] == "indent" and not p["iterations"]]
    loads = sorted({p["load"] for p in here})
    figure, axes = plt.subplots(1, 2, figsize=(12, 4.4))
    for axis, load in zip(axes, (loads[0], loads[-1])):
        at = [p for p in here if p["load"] == load]
        reference = sorted({(p["distance_m"], p["reference_m"]) for p in at if math.isfinite(p["reference_m"])})
        axis.plot([1e3 * t[0] for t in reference], [1e3 * t[1] for t in reference], "k--", label="quadratic elements at rest")
        for model, color in COLORS.items():
            mine = [p for p in at if p["model"] == model]
            if not mine:
                continue
            finest = max((p["level"], -p["rate_hz"]) for p in mine)
            line = sorted((p["distance_m"], p["displacement_m"]) for p in mine
                          if (p["level"], -p["rate_hz"]) == finest)
            if all(abs(u) < 1e-6 for _, u in line):  # the tip has slipped through
                continue
            axis.plot([1e3 * x for x, _ in line], [1e3 * u for _, u in line], marker="o", markersize=3, color=color,
                      label=model)
        axis.set_title(f"{1e3 * load:g} mm deep", fontsize=9)
        axis.set_xlabel("distance from the axis [mm]")
        axis.set_ylabel("displacement along the axis [mm]")
    axes[0].legend(fontsize=7, frameon=False)
    figure.suptitle("block under a sphere of 5 mm: the surface beside it", fontsize=10)
    figure.tight_layout()
    figure.savefig(folder / "accuracy_profile.png", dpi=110)
    plt.close(figure)


def compare_bullet(bullet):
    """Which settings of Bullet are both slower and less accurate than one of ours."""
    theirs = [r for r in bullet if r["solver"].lower().startswith("bullet") and r["verdict"] == "stable"]
    ours = [r for r in bullet if not r["solver"].lower().startswith("bullet") and r["verdict"] == "stable"]
    for nodes in sorted({r["nodes"] for r in theirs}):
        left = []
        here = [r for r in theirs if r["nodes"] == nodes]
        for r in here:
            if not any(o["nodes"] == nodes and o["us_per_step"] < r["us_per_step"]
                       and o["volume_error_held"] < r["volume_error_held"] for o in ours):
                left.append(r["setting"])
        print(f"Bullet, {nodes:g} nodes: {len(here) - len(left)} of {len(here)} stable settings are slower and keep the "
              f"volume worse than one of ours" + (f"; not: {', '.join(left)}" if left else ""))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--docs", type=Path)
    arguments = parser.parse_args()
    folder = arguments.folder
    take_models(folder)
    points, samples = rows_of(folder / "points.csv"), rows_of(folder / "samples.csv")
    if not points:
        sys.exit(f"error: {folder / 'points.csv'} holds no points")
    cases = [case for case in TITLES if any(p["case"] == case for p in points)]
    draw_error_cost(folder, points, cases)
    print()
    draw_mesh(folder, points, cases, None, None, "error", "accuracy_mesh.png")
    draw_mesh(folder, points, cases, "cost_s_per_s", 1, "cost [s/s]", "accuracy_cost_mesh.png")
    write_tables(folder, points, samples, cases)
    draw_touch(folder, points, samples)
    if "ball" in cases:
        bullet = rows_of(folder / "bullet.csv")
        draw_volume(folder, points, bullet)
        compare_bullet(bullet)
        draw_curves(folder, samples)
        draw_iterations(folder, points)
    if "indent" in cases:
        draw_profile(folder, rows_of(folder / "profiles.csv"))
    if arguments.docs:
        put_into_docs(folder, arguments.docs)


if __name__ == "__main__":
    main()
