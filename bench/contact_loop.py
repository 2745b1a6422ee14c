#!/usr/bin/python3
"""Contact in the loop that people run: tools that go in and out of an organ while they slide, real processes over DDS.

Usage: bench/contact_loop.py [--scene NAME ...] [--tool NAME ...] [--speed M_PER_S ...] [--rate HZ ...]     (after a build)
The motion is that of `palpate contact-loop`, played as a recorded one to `palpate run`, which records all searches and all
positions. A search counts as inside where the winding number of a point of the tool is 1 in every surface that it can have had:
positions of its mesh told within 2 ms before it, and the newest before those, none missing. It is lost where it has no contact that pushes then. Exit code
1 if one is lost or truncated. A machine that does other things at the time is late for real processes, which makes it harder.
"""
import argparse
import itertools
import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, os.environ.get("PYTHONPATH") or str(ROOT / "build" / "release" / "python"))
import numpy as np  # noqa: E402

import palpate  # noqa: E402

SHALLOW, DEEP, HELD, SIDEWAYS = -7e-3, 15e-3, 10e-3, 8e-3  # the tip below the skin at rest, at the end; along x and z [m]
TURN_X, TURN_Z = 0.31, 0.23  # of the rate of presses
WAIT, HOLD = 0.5, 0.3  # before and after the motion [s]
ON_THE_WAY = 2e-3  # positions told so shortly before a search may not have reached it [s]
PLACES = {"stomach": (0.022, -0.004), "liver": (-0.020, 0.013)}  # x, z [m]
ALONG_Y = [-np.sqrt(0.5), 0, 0, np.sqrt(0.5)]  # z of the tool along y, as x, y, z, w
ALONG_X = [0, np.sqrt(0.5), 0, np.sqrt(0.5)]
STRAIGHT = [0, 0, 0, 1]


def capsule(radius, rotation, reach):
    points = np.linspace(-0.02, 0.02, 33)[:, None] * [0, 0, 1]
    return {"capsule": {"radius_m": radius, "length_m": 0.04}}, rotation, reach, points


def ball(radius):
    return {"sphere": {"radius_m": radius}}, STRAIGHT, radius, np.zeros((1, 3))


def box(size):
    corners = np.array(list(itertools.product((-0.5, 0.5), repeat=3))) * size
    return {"box": {"size_m": size}}, STRAIGHT, size[1] / 2, corners


TOOLS = {  # shape, rotation, how far it reaches along y, points that may not be inside
    "ball_0.5mm": ball(5e-4),
    "ball_2mm": ball(2e-3),
    "ball_8mm": ball(8e-3),
    "needle": capsule(5e-4, ALONG_Y, 0.02 + 5e-4),
    "rod": capsule(2e-3, ALONG_X, 2e-3),
    "wire": capsule(5e-4, ALONG_X, 5e-4),
    "box": box([0.01, 0.01, 0.01]),
    "blade": box([1e-3, 0.02, 0.015]),
}


def winding_numbers(points, nodes, triangles):
    """By the solid angles of all triangles (van Oosterom and Strackee 1983)."""
    r = nodes[triangles][None] - points[:, None, None]
    a, b, c = r[:, :, 0], r[:, :, 1], r[:, :, 2]
    la, lb, lc = (np.linalg.norm(x, axis=2) for x in (a, b, c))
    above = np.einsum("ijk,ijk->ij", a, np.cross(b, c))
    below = la * lb * lc + (a * b).sum(2) * lc + (b * c).sum(2) * la + (c * a).sum(2) * lb
    return np.arctan2(above, below).sum(1) / (2 * np.pi)


def turned(rotation, points):
    """By a unit quaternion x, y, z, w."""
    q, w = np.asarray(rotation[:3]), rotation[3]
    return points + 2 * np.cross(q, np.cross(q, points) + w * points)


def skin(nodes, triangles, x, z):
    """Least y where the line along y through x, z meets the surface."""
    a, b, c = (nodes[triangles[:, i]][:, [0, 2]] for i in range(3))
    p = np.array([x, z])
    cross = lambda u, v: u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]  # noqa: E731
    whole = cross(b - a, c - a)
    with np.errstate(divide="ignore", invalid="ignore"):
        weights = np.stack([cross(b - p, c - p), cross(c - p, a - p), cross(a - p, b - p)], 1) / whole[:, None]
    hit = (weights >= 0).all(1)
    return (weights[hit] * nodes[triangles[hit]][:, :, 1]).sum(1).min()


def motion(x, z, front, tool, speed):
    """Rows of time, position and rotation, 1 kHz; and how many presses."""
    _, rotation, reach, _ = TOOLS[tool]
    middle, half = (SHALLOW + DEEP) / 2, (DEEP - SHALLOW) / 2
    rate = speed / np.linalg.norm([half, TURN_X * SIDEWAYS, TURN_Z * SIDEWAYS])
    presses = np.ceil(max(2, rate / 2 / np.pi))
    last = 2 * np.pi * presses + np.arccos((middle - HELD) / half)
    time = np.arange(0, WAIT + last / rate + HOLD, 1e-3)
    turn = np.clip(rate * (time - WAIT), 0, last)
    depth = middle - half * np.cos(turn)
    rows = [time, x + SIDEWAYS * np.sin(TURN_X * turn), front - reach + depth, z + SIDEWAYS * np.sin(TURN_Z * turn)]
    return np.stack(rows + [np.full_like(time, q) for q in rotation], 1), int(presses) + 1


def run(scene, tool, speed, rate, folder):
    """Searches, of these inside, of these without a contact that pushes, truncated; presses."""
    loaded = palpate.Scene.load(palpate.scene_path(scene))
    organ = loaded["organs[0].name"]
    if organ not in PLACES:
        sys.exit(f"{scene}: its first organ is {organ!r}; places are known on {', '.join(PLACES)}")
    x, z = PLACES[organ]
    rest = Path(folder) / "rest.mcap"
    program = ROOT / "build/release/bin/palpate"
    words = [program, "run", scene, "--in-process", "--duration", "0.01", "--record", rest, "--overwrite"]
    subprocess.run(words, check=True, capture_output=True)
    at_rest = palpate.recording.read(rest, ["surface"])["surface"]
    nodes, triangles = at_rest["rest_positions_m"][0].reshape(-1, 3), at_rest["triangle_nodes"][0].reshape(-1, 3)
    rows, presses = motion(x, z, skin(nodes, triangles, x, z), tool, speed)
    table, mcap = Path(folder) / "motion.csv", Path(folder) / "run.mcap"
    header = "t,x,y,z,qx,qy,qz,qw"
    np.savetxt(table, rows, delimiter=",", header=header, comments="", fmt="%.9g")
    loaded["probes"] = [{"name": "tool", "shape": TOOLS[tool][0], "device": {"trajectory": {"file": str(table)}}}]
    loaded["rates.deformation_hz"] = rate
    file = Path(folder) / "scene.yaml"
    loaded.save(file)
    words = [program, "run", file, "--headless", "--no-visualizer", "--duration", f"{rows[-1, 0]:g}", "--session", f"loop{os.getpid()}"]
    words += ["--record", mcap, "--overwrite", "--record-topics", "contacts", "surface", "node_positions"]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(done.stdout + done.stderr)
    return (*judge(palpate.recording.read(mcap), TOOLS[tool][3]), presses)


def judge(recording, points):
    surfaces, told, found = recording["surface"], recording["node_positions"], recording["contacts"]
    meshes = {int(surfaces["generation"][i]): surfaces["triangle_nodes"][i].reshape(-1, 3) for i in range(len(surfaces["generation"]))}
    of_first = np.flatnonzero(np.asarray(told["organ"]) == 0)
    came = 1e-9 * np.asarray(told["source_time_ns"])[of_first]
    number = np.asarray(told["sequence_number"])[of_first]
    inside = lost = 0
    for i, time in enumerate(1e-9 * np.asarray(found["source_time_ns"])):
        last = np.searchsorted(came, time)
        first = max(np.searchsorted(came, time - ON_THE_WAY) - 1, 0)
        at = found["probe_position_m"][i] + turned(found["probe_rotation_xyzw"][i], points)
        generation = int(found["generations"][i][0])
        mine = [k for k in of_first[first:last] if int(told["generation"][k]) == generation]
        # Where the recorder, or whoever it hears, missed positions nobody knows what was searched.
        whole = last < len(number) and (np.diff(number[first : last + 1]) == 1).all()
        possible = whole and generation in meshes and len(mine) > 0
        for k in mine:
            if not possible:
                break
            x = told["positions_m"][k].reshape(-1, 3).astype(float)
            near = ((at > x.min(0)) & (at < x.max(0))).all(1)
            possible = bool(near.any()) and bool((winding_numbers(at[near], x, meshes[generation]) > 0.5).any())
        if not possible:
            continue
        inside += 1
        gaps = np.concatenate([np.ravel(found[f"{kind}.gap_m"][i]) for kind in ("contacts", "faces")])
        lost += not (gaps < 0).any()
    return len(found["truncated"]), inside, lost, int(np.sum(found["truncated"]))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scene", nargs="+", default=["stomach_probe", "liver_solid", "liver_touch"])
    parser.add_argument("--tool", nargs="+", default=list(TOOLS), choices=list(TOOLS))
    parser.add_argument("--speed", nargs="+", type=float, default=[0.1, 0.63, 2.5])
    parser.add_argument("--rate", nargs="+", type=float, default=[50, 100, 250])
    options = parser.parse_args()
    sums = np.zeros(5, dtype=int)
    print("scene            tool        v [m/s] [Hz] searches inside   lost truncated presses")
    with tempfile.TemporaryDirectory() as folder:
        for scene, tool, speed, rate in itertools.product(options.scene, options.tool, options.speed, options.rate):
            one = run(scene, tool, speed, rate, folder)
            sums += one
            print(f"{scene:16} {tool:11} {speed:7g} {rate:4g} {one[0]:8} {one[1]:6} {one[2]:6} {one[3]:9} {one[4]:7}", flush=True)
    print(f"{sums[0]} searches, {sums[1]} inside, {sums[2]} of them without a contact that pushes, {sums[3]} truncated, {sums[4]} presses")
    return 1 if sums[2] or sums[3] else 0


if __name__ == "__main__":
    sys.exit(main())
