#!/usr/bin/python3
"""Contact in the loop that people run: tools that go in and out of an organ while they slide, real processes over DDS.

Usage: bench/contact_loop.py [--scene NAME ...] [--tool NAME ...] [--speed M_PER_S ...] [--rate HZ ...]     (after a build)
The motion is that of `palpate contact-loop`, played as a recorded one to `palpate run`, which records all searches and all positions.
A search is judged on the positions that it had: those on which its contacts have the gaps that they tell. (Its time does not tell
them: one whose cycle is held up at its beginning has positions that were told after it.) One without contacts is judged on all that
it can have had: told before the next search, back to the newest told more than 2 ms before it.
inside: the winding number of a point of the tool is 1 there. lost: of these, no contact pushes. silent: finds nothing, as is said,
because the tool was not heard for 50 ms. unknown: the recorder, or whoever it hears, missed what it had. guarded, unsolved: by the
session's own summary, searches that found a tool inside without contact and pushed it out, and steps whose contacts were not solved.
Exit code 1 if one is lost or truncated. A machine that does other things at the time is late for real processes, which makes it harder.
"""
import argparse
import itertools
import os
import re
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
SILENT = 0.05  # of a tool unheard for longer a search says that it touches nothing [s]
ON_THE_WAY = 2e-3  # positions told so shortly before a search may not have reached it [s]
ROUNDING = 1e-12  # of a gap told [m]; on positions of another advance it is another by 1e-5 and more
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


def pebble():
    """Of 42 corners, no two at one distance from the middle: nodes, as a file holds them, and triangles."""
    golden = (1 + np.sqrt(5)) / 2
    nodes = [np.roll([0, y, z], turn) for turn in range(3) for y in (-1, 1) for z in (-golden, golden)]
    next_to = lambda p, q: np.linalg.norm(nodes[p] - nodes[q]) < 2.1  # noqa: E731
    faces = [t for t in itertools.combinations(range(12), 3) if next_to(*t[:2]) and next_to(*t[1:]) and next_to(t[0], t[2])]
    faces = [(a, b, c) if np.dot(nodes[a], np.cross(nodes[b], nodes[c])) > 0 else (a, c, b) for a, b, c in faces]
    middles = {}
    for p, q in itertools.combinations(range(12), 2):
        if next_to(p, q):
            middles[p, q] = middles[q, p] = len(nodes) + len(middles) // 2
    nodes += [nodes[p] + nodes[q] for p, q in middles if p < q]
    triangles = []
    for a, b, c in faces:
        d, e, f = middles[a, b], middles[b, c], middles[c, a]
        triangles += [(a, d, f), (d, b, e), (f, e, c), (d, e, f)]
    radii = 5e-3 * (1 + 0.1 * np.sin(7.0 * np.arange(len(nodes))))
    nodes = np.array([r * x / np.linalg.norm(x) for r, x in zip(radii, nodes)])
    return nodes.astype(np.float32).astype(float), np.array(triangles)


def mesh(nodes):
    """Its shape is a file of a folder of its own."""
    return None, STRAIGHT, nodes[:, 1].max(), nodes


TOOLS = {  # shape, rotation, how far it reaches along y, points that may not be inside
    "ball_0.5mm": ball(5e-4),
    "ball_2mm": ball(2e-3),
    "ball_8mm": ball(8e-3),
    "needle": capsule(5e-4, ALONG_Y, 0.02 + 5e-4),
    "rod": capsule(2e-3, ALONG_X, 2e-3),
    "wire": capsule(5e-4, ALONG_X, 5e-4),
    "box": box([0.01, 0.01, 0.01]),
    "blade": box([1e-3, 0.02, 0.015]),
    "mesh": mesh(pebble()[0]),
}


def winding_numbers(points, nodes, triangles):
    """By the solid angles of all triangles (van Oosterom and Strackee 1983)."""
    r = nodes[triangles][None] - points[:, None, None]
    a, b, c = r[:, :, 0], r[:, :, 1], r[:, :, 2]
    la, lb, lc = (np.linalg.norm(x, axis=2) for x in (a, b, c))
    above = np.einsum("ijk,ijk->ij", a, np.cross(b, c))
    below = la * lb * lc + (a * b).sum(2) * lc + (b * c).sum(2) * la + (c * a).sum(2) * lb
    return np.arctan2(above, below).sum(1) / (2 * np.pi)


def has_both_sides(p, lower, upper):
    """Is there, along y, something of the triangles in these boxes on either side? If not, p is outside."""
    along = ((lower <= p) & (p <= upper))[:, [0, 2]].all(1)
    return bool((upper[along, 1] >= p[1]).any() and (lower[along, 1] <= p[1]).any())


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
    """As Judge.sums(); presses; and of the summary guarded searches and steps not solved."""
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
    shape, ply = TOOLS[tool][0], Path(folder) / "tool.ply"
    if shape is None:
        palpate.mesh.write(ply, *pebble(), overwrite=True)
        shape = {"mesh": {"file": str(ply)}}
    np.savetxt(table, rows, delimiter=",", header=header, comments="", fmt="%.9g")
    loaded["probes"] = [{"name": "tool", "shape": shape, "device": {"trajectory": {"file": str(table)}}}]
    loaded["rates.deformation_hz"] = rate
    file = Path(folder) / "scene.yaml"
    loaded.save(file)
    words = [program, "run", file, "--headless", "--no-visualizer", "--duration", f"{rows[-1, 0]:g}", "--session", f"loop{os.getpid()}"]
    words += ["--record", mcap, "--overwrite", "--record-topics", "contacts", "surface", "node_positions", "probe_state"]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(done.stdout + done.stderr)
    counted = re.search(r"contacts: \d+ searches truncated, (\d+) with a probe inside without contact, (\d+) steps not solved", done.stdout)
    if not counted:
        sys.exit("the summary has no line of contacts:\n" + done.stdout)
    return (*Judge(palpate.recording.read(mcap), TOOLS[tool][3]).sums(), presses, int(counted[1]), int(counted[2]))


class Judge:
    """Of a recording's searches, by what they had of the first organ."""

    def __init__(self, recording, points):
        surface, told, self.found, self.state = (recording[name] for name in ("surface", "node_positions", "contacts", "probe_state"))
        self.points = points
        self.time, self.sampled = 1e-9 * np.append(self.found["source_time_ns"], 2**63), 1e-9 * np.asarray(self.state["source_time_ns"])
        of_first = [j for j, organ in enumerate(surface["organ"]) if organ == 0]
        meshes = {int(surface["generation"][j]): surface["triangle_nodes"][j].reshape(-1, 3) for j in of_first}
        known = [k for k, organ in enumerate(told["organ"]) if organ == 0 and int(told["generation"][k]) in meshes]
        # Until positions are told the organ is at rest.
        self.came = 1e-9 * np.append(0, told["source_time_ns"][known])
        self.number = np.append(0, told["sequence_number"][known])
        self.generation = [int(surface["generation"][of_first[0]])] + [int(told["generation"][k]) for k in known]
        self.triangles = [meshes[generation] for generation in self.generation]
        nodes = [surface["rest_positions_m"][of_first[0]]] + [told["positions_m"][k] for k in known]
        self.nodes = [np.reshape(x, (-1, 3)).astype(float) for x in nodes]

    def fits(self, i, k):
        """Do the contacts of a search have their gaps on these positions?"""
        triangle, of_probe = np.asarray(self.found["contacts.triangle"][i]), self.found["probe_rotation_xyzw"][i]
        if triangle.max() >= len(self.triangles[k]):
            return False
        point, normal, weights = (
            np.asarray(self.found[f"contacts.{name}"][i]).reshape(-1, 3) for name in ("point_P_m", "normal_P", "barycentric")
        )
        tissue = (weights[:, :, None] * self.nodes[k][self.triangles[k][triangle]]).sum(1)
        apart = self.found["probe_position_m"][i] + turned(of_probe, point) - tissue
        return bool(np.abs((turned(of_probe, normal) * apart).sum(1) - self.found["contacts.gap_m"][i]).max() < ROUNDING)

    def had(self, i):
        """All positions that a search can have had."""
        time, generation = self.time[i], int(self.found["generations"][i][0])
        last = np.searchsorted(self.came, self.time[i + 1])
        if len(self.found["contacts.triangle"][i]) > 0:
            fitting = (k for k in range(last - 1, -1, -1) if self.generation[k] == generation and self.fits(i, k))
            return list(itertools.islice(fitting, 1))
        first = max(np.searchsorted(self.came, time - ON_THE_WAY) - 1, 0)
        whole = last < len(self.number) and (np.diff(self.number[first : last + 1]) == 1).all()
        return [k for k in range(first, last) if self.generation[k] == generation] if whole else []

    def is_inside(self, i, k):
        nodes, triangles = self.nodes[k], self.triangles[k]
        at = self.found["probe_position_m"][i] + turned(self.found["probe_rotation_xyzw"][i], self.points)
        near = at[((at > nodes.min(0)) & (at < nodes.max(0))).all(1)]
        if len(near) == 0:
            return False
        lower, upper = nodes[triangles].min(1), nodes[triangles].max(1)
        return any(winding_numbers(p[None], nodes, triangles)[0] > 0.5 for p in near if has_both_sides(p, lower, upper))

    def is_silent(self, i):
        """Was the pose it has so old that a search says so and finds nothing?"""
        if len(self.found["contacts.triangle"][i]) > 0:
            return False
        at = self.found["probe_position_m"][i]
        same = np.flatnonzero((self.state["position_m"] == at).all(1) & (self.sampled < self.time[i + 1]))
        return len(same) > 0 and self.time[i] - self.sampled[same[-1]] > SILENT

    def pushes(self, i):
        return any((np.ravel(self.found[f"{kind}.gap_m"][i]) < 0).any() for kind in ("contacts", "faces"))

    def sums(self):
        """Searches, of these inside, of these without a contact that pushes; silent, unknown, truncated."""
        inside = lost = silent = unknown = 0
        for i in range(len(self.found["truncated"])):
            if self.is_silent(i):
                silent += 1
                continue
            had = self.had(i)
            unknown += not had
            if not had or not all(self.is_inside(i, k) for k in had):
                continue
            inside += 1
            lost += not self.pushes(i)
        return len(self.found["truncated"]), inside, lost, silent, unknown, int(np.sum(self.found["truncated"]))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scene", nargs="+", default=["stomach_probe", "liver_solid", "liver_touch"])
    parser.add_argument("--tool", nargs="+", default=list(TOOLS), choices=list(TOOLS))
    parser.add_argument("--speed", nargs="+", type=float, default=[0.1, 0.63, 2.5])
    parser.add_argument("--rate", nargs="+", type=float, default=[50, 100, 250])
    options = parser.parse_args()
    sums = np.zeros(9, dtype=int)
    print("scene            tool        v [m/s] [Hz] searches inside   lost silent unknown truncated presses guarded unsolved")
    with tempfile.TemporaryDirectory() as folder:
        for scene, tool, speed, rate in itertools.product(options.scene, options.tool, options.speed, options.rate):
            one = run(scene, tool, speed, rate, folder)
            sums += one
            print(f"{scene:16} {tool:11} {speed:7g} {rate:4g} {one[0]:8} {one[1]:6} {one[2]:6} {one[3]:6} {one[4]:7} {one[5]:9} {one[6]:7} {one[7]:7} {one[8]:8}", flush=True)
    print(f"{sums[0]} searches, {sums[1]} inside, {sums[2]} of them without a contact that pushes")
    print(f"{sums[3]} silent, {sums[4]} of which is not known what they had, {sums[5]} truncated; {sums[6]} presses; {sums[7]} guarded, {sums[8]} steps not solved")
    return 1 if sums[2] or sums[5] else 0


if __name__ == "__main__":
    sys.exit(main())
