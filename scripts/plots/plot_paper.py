#!/usr/bin/env python3
"""Pictures of the figures that `palpate paper` computes.

  plot_paper.py FOLDER      draws FOLDER/figure1.png … figure4.png from the CSV files in FOLDER;
                            figures without their files are left out
"""

import argparse
import csv
import os
import sys
from pathlib import Path

try:
    import matplotlib
    import numpy as np
except ImportError as error:
    sys.exit(f"error: {error.name} is missing (Debian: apt install python3-matplotlib)")

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.collections import LineCollection, PolyCollection  # noqa: E402
from matplotlib.colors import LinearSegmentedColormap  # noqa: E402

METHODS = {
    "mass_spring": ("springs alone", "#c0392b"),
    "implicit_volume": ("implicit volume constraint", "#1f6fb2"),
    "one_correction": ("with one Newton correction", "#2a8f5b"),
}
TISSUE = np.array([0.86, 0.55, 0.50])
MOVED = LinearSegmentedColormap.from_list("moved", [(0.96, 0.78, 0.72), "#d1495b", "#2e1a47"])
AXIS = "#7a1fa2"
FAMILIES = [
    ("structural: mesh edges", "#35506b"),
    ("bending: two edges apart", "#c07a1c"),
    ("inner: to the nearest virtual node", "#1d8a8a"),
]
VIRTUAL = 2  # kind of a node
FRONT = np.array([0.25, 1.0, -0.13])  # looks from the front, a little from the left and above
SMALLEST_ERROR = 1e-16  # rounding of a relative volume: what a logarithmic axis can show of zero
RANGES = 14  # of distance from the probe, in which displacements are averaged
MM = 1e3


def table(file):
    """Columns of a CSV file: numbers where they are, else text."""
    with open(file, newline="", encoding="utf-8") as stream:
        rows = list(csv.reader(stream))
    columns = {}
    for name, *cells in zip(*rows):
        try:
            columns[name] = np.array(cells, dtype=float)
        except ValueError:
            columns[name] = cells
    return columns


class Shape:
    """Nodes and triangles of one organ at one moment."""

    def __init__(self, folder, nodes_name, topology_name):
        columns = table(folder / f"{nodes_name}_nodes.csv")
        self.nodes = np.column_stack([columns[f"{axis}_m"] for axis in "xyz"])
        self.rest = np.column_stack([columns[f"rest_{axis}_m"] for axis in "xyz"])
        self.kind = columns["kind"]
        corners = table(folder / f"{topology_name}_triangles.csv")
        self.triangles = np.column_stack([corners[c] for c in "abc"]).astype(int)

    def displacement(self):
        return np.linalg.norm(self.nodes - self.rest, axis=1)


class View:
    """Parallel projection along `direction`, z up in the picture; millimetres."""

    def __init__(self, direction):
        self.into = direction / np.linalg.norm(direction)
        self.right = np.cross(self.into, [0, 0, 1])
        self.right /= np.linalg.norm(self.right)
        self.up = np.cross(self.right, self.into)

    def flat(self, points):
        return MM * np.column_stack([points @ self.right, points @ self.up])

    def depth(self, points):
        return points @ self.into


def shade(colors, normals, view):
    """Light from the upper left, seen from the eye."""
    light = -view.into + 0.5 * view.up - 0.6 * view.right
    brightness = 0.45 + 0.6 * np.clip(normals @ (light / np.linalg.norm(light)), 0, 1)
    return np.clip(colors * brightness[:, None], 0, 1)


def draw_surface(axes, shape, view, values=None, scale=None, opacity=1.0):
    """Triangles that face the eye, far ones first; coloured by node values on `scale`."""
    corners = shape.nodes[shape.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    facing = np.flatnonzero(normals @ view.into < 0)
    order = facing[np.argsort(-view.depth(corners[facing].mean(axis=1)))]
    colors = np.tile(TISSUE, (len(order), 1))
    if values is not None:
        means = values[shape.triangles[order]].mean(axis=1)
        colors = scale.to_rgba(means)[:, :3]
    faces = shade(colors, normals[order], view)
    polygons = view.flat(corners[order].reshape(-1, 3)).reshape(-1, 3, 2)
    edges = faces if opacity == 1 else "none"
    axes.add_collection(
        PolyCollection(polygons, facecolors=faces, edgecolors=edges, linewidths=0.2, alpha=opacity)
    )


def frame_on(axes, points, view):
    flat = view.flat(points)
    low, high = flat.min(axis=0), flat.max(axis=0)
    margin = 0.04 * (high - low).max()
    axes.set_xlim(low[0] - margin, high[0] + margin)
    axes.set_ylim(low[1] - margin, high[1] + margin)
    axes.set_aspect("equal")
    axes.axis("off")


def save(figure, file):
    """Whole file or nothing."""
    part = file.with_name(file.name + ".part")
    try:
        figure.savefig(part, format="png", dpi=130, bbox_inches="tight")
        os.replace(part, file)
    finally:
        part.unlink(missing_ok=True)
    plt.close(figure)


def draw_springs(axes, shape, springs, family, view):
    chosen = springs["family"] == family
    ends = np.column_stack([springs["a"][chosen], springs["b"][chosen]]).astype(int)
    lines = view.flat(shape.nodes[ends].reshape(-1, 3)).reshape(-1, 2, 2)
    label, color = FAMILIES[family]
    axes.add_collection(LineCollection(lines, colors=color, linewidths=0.35))
    axes.set_title(f"{label} ({len(ends):,})", fontsize=9)


def draw_virtual_nodes(axes, shape, view):
    """And the dominant axis, dashed: the surface nodes' largest principal component."""
    surface = shape.nodes[shape.kind != VIRTUAL]
    middle = surface.mean(axis=0)
    axis = np.linalg.svd(surface - middle, full_matrices=False)[2][0]
    reach = (surface - middle) @ axis
    ends = view.flat(middle + np.outer([reach.min(), reach.max()], axis))
    axes.plot(*ends.T, "--", color=AXIS, linewidth=1)
    virtual = view.flat(shape.nodes[shape.kind == VIRTUAL])
    axes.plot(*virtual.T, "o", color=AXIS, markersize=7, zorder=3)
    words = f"{len(virtual)} virtual nodes, one per section of the dominant axis (dashed)"
    axes.text(0.5, -0.02, words, color=AXIS, transform=axes.transAxes, ha="center", fontsize=8)


def figure1(folder, out):
    organs = ["stomach", "liver"]
    figure, panels = plt.subplots(2, 4, figsize=(15, 8), gridspec_kw={"wspace": 0.02})
    for row, organ in zip(panels, organs):
        name = f"figure1_{organ}"
        shape, springs = Shape(folder, name, name), table(folder / f"{name}_springs.csv")
        view = View(FRONT)
        draw_surface(row[0], shape, view)
        row[0].set_title(f"{organ}: {int((shape.kind != VIRTUAL).sum())} surface nodes", fontsize=9)
        for family, axes in enumerate(row[1:]):
            draw_surface(axes, shape, view, opacity=0.12)
            draw_springs(axes, shape, springs, family, view)
        draw_virtual_nodes(row[3], shape, view)
        for axes in row:
            frame_on(axes, shape.nodes, view)
    save(figure, out)


def draw_method_curve(axes, columns, x, values, method, **style):
    label, color = METHODS[method]
    axes.plot(columns[x], values, color=color, label=label, linewidth=1.4, **style)


def visible_error(columns):
    return np.maximum(np.abs(columns["volume_error"]), SMALLEST_ERROR)


def finish_curves(panels, xlabel):
    for axes in panels:
        axes.set_xlabel(xlabel)
        axes.grid(True, alpha=0.3)
    panels[0].legend(fontsize=8)


def figure2(folder, out):
    curves = {m: table(folder / f"figure2_{m}.csv") for m in METHODS}
    figure, panels = plt.subplots(2, 3, figsize=(14, 7.6), constrained_layout=True)
    view = View(np.array([0.0, 1.0, 0.0]))
    for axes, method in zip(panels[0], METHODS):
        shape = Shape(folder, f"figure2_{method}", f"figure2_{method}")
        draw_surface(axes, shape, view)
        frame_on(axes, np.vstack([shape.nodes, 1.3 * shape.rest * [1, 1, 0.5]]), view)
        surface = shape.nodes[shape.kind != VIRTUAL]
        for height in (surface[:, 2].min(), surface[:, 2].max()):
            axes.axhline(MM * height, color="#555555", linewidth=3)
        ratio = curves[method]["volume_ratio"][-1]
        axes.set_title(f"{METHODS[method][0]}\niteration 800: V/V₀ = {ratio:.6f}", fontsize=9)
    for method, columns in curves.items():
        draw_method_curve(panels[1, 0], columns, "iteration", columns["volume_ratio"], method)
        draw_method_curve(panels[1, 1], columns, "iteration", visible_error(columns), method)
        draw_method_curve(panels[1, 2], columns, "iteration", columns["upper_force_n"], method)
    panels[1, 0].set_ylabel("V / V₀")
    panels[1, 1].set_ylabel("|V − V₀| / V₀")
    panels[1, 1].set_yscale("log")
    panels[1, 2].set_ylabel("force of the upper plane [N]")
    finish_curves(panels[1], "iteration (step of 2 ms)")
    save(figure, out)


def figure3(folder, out):
    figure, panels = plt.subplots(2, 3, figsize=(14, 7.5), constrained_layout=True)
    for row, organ in zip(panels, ["stomach", "liver"]):
        for method in ("mass_spring", "implicit_volume"):
            columns = table(folder / f"figure3_{organ}_{method}.csv")
            draw_method_curve(row[0], columns, "time_s", columns["volume_ratio"], method)
            draw_method_curve(row[1], columns, "time_s", visible_error(columns), method)
            draw_method_curve(row[2], columns, "time_s", columns["force_n"], method)
        row[0].set_ylabel(f"{organ}: V / V₀")
        row[0].ticklabel_format(axis="y", useOffset=False)
        row[1].set_ylabel("|V − V₀| / V₀")
        row[1].set_yscale("log")
        row[2].set_ylabel("force on the probe [N]")
        finish_curves(row, "simulated time [s]")
    save(figure, out)


def draw_moments(folder, panels, moments):
    """The organ at each moment, coloured by displacement on one scale, and the probe's tip."""
    view = View(FRONT)
    shapes = [Shape(folder, f"figure4_{name}", "figure4") for name in moments["moment"]]
    top = max(np.percentile(MM * shape.displacement(), 99.5) for shape in shapes)
    scale = plt.cm.ScalarMappable(plt.Normalize(0, max(top, 1e-3)), MOVED)
    everything = np.vstack([shape.nodes for shape in shapes])
    for i, (axes, shape) in enumerate(zip(panels, shapes)):
        draw_surface(axes, shape, view, MM * shape.displacement(), scale)
        frame_on(axes, everything, view)
        probe = view.flat(probe_at(moments, i)[None])[0]
        radius = MM * float(moments["probe_radius_m"][i])
        axes.add_patch(plt.Circle(probe, radius, facecolor="#dddddd", edgecolor="k", zorder=3))
        name = moments["moment"][i].replace("_", " ")
        axes.set_title(f"{name}, {float(moments['time_s'][i]):.2f} s", fontsize=9)
    for axes in panels[len(shapes):]:
        axes.axis("off")
    plt.colorbar(scale, ax=panels, label="displacement [mm]", shrink=0.8, pad=0.01)
    return shapes


def probe_at(moments, i):
    return np.array([float(moments[f"probe_{axis}_m"][i]) for axis in "xyz"])


def draw_reach(axes, shape, probe, label):
    """Mean displacement of the nodes that move, by their distance from the probe at rest."""
    free = shape.kind == 0
    distance = MM * np.linalg.norm(shape.rest[free] - probe, axis=1)
    moved = MM * shape.displacement()[free]
    edges = np.linspace(distance.min(), distance.max() + 1e-9, RANGES + 1)
    place = np.digitize(distance, edges) - 1
    filled = [k for k in range(RANGES) if (place == k).any()]
    middle = [0.5 * (edges[k] + edges[k + 1]) for k in filled]
    axes.plot(middle, [moved[place == k].mean() for k in filled], "o-", markersize=3, label=label)


def figure4(folder, out):
    moments, columns = table(folder / "figure4_moments.csv"), table(folder / "figure4.csv")
    figure = plt.figure(figsize=(16, 8.5), constrained_layout=True)
    above, below = figure.subfigures(2, 1, height_ratios=[1.25, 1])
    count = len(moments["moment"]) if moments else 0
    if count:
        shapes = draw_moments(folder, above.subplots(1, max(count, 2)), moments)
    panels = below.subplots(1, 4)
    time = columns["time_s"]
    panels[0].plot(time, columns["force_n"], color="#333333")
    panels[0].set_ylabel("force on the probe [N]")
    panels[1].plot(time, visible_error(columns), color=METHODS["implicit_volume"][1])
    panels[1].set_yscale("log")
    panels[1].set_ylabel("|V − V₀| / V₀")
    panels[2].plot(time, MM * columns["far_displacement_m"], color="#1d8a8a")
    panels[2].set_ylabel("mean far-field displacement [mm]")
    for axes in panels[:3]:
        axes.set_xlabel("simulated time [s]")
    for i in range(count):
        name = moments["moment"][i].replace("_", " ")
        draw_reach(panels[3], shapes[i], probe_at(moments, i), name)
    panels[3].set_xlabel("distance from the probe at rest [mm]")
    panels[3].set_ylabel("mean displacement [mm]")
    if count:
        panels[3].legend(fontsize=8)
    for axes in panels:
        axes.grid(True, alpha=0.3)
    save(figure, out)


FIGURES = {
    "figure1": (figure1, "figure1_liver_springs.csv"),
    "figure2": (figure2, "figure2_one_correction_nodes.csv"),
    "figure3": (figure3, "figure3_liver_implicit_volume.csv"),
    "figure4": (figure4, "figure4.csv"),
}  # the file is the last one written: with it a figure is complete


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path)
    folder = parser.parse_args().folder
    if not folder.is_dir():
        print(f"error: {folder}: no such folder", file=sys.stderr)
        return 2
    for name, (draw, last_file) in FIGURES.items():
        if (folder / last_file).exists():
            draw(folder, folder / f"{name}.png")
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit(130)
