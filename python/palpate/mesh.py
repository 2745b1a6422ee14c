"""Surfaces: read, check, repair, resample, write, as `palpate mesh` does.

A surface is a pair of arrays: nodes (n, 3) [m] and triangles (m, 3), counter-clockwise seen from outside. All that is
returned is a copy of its own.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from palpate import _core
from palpate.numbers import whole
from palpate.paths import path_text


class Surface(NamedTuple):
    """Nodes (n, 3) [m] and triangles (m, 3)."""

    nodes: npt.NDArray[np.float64]
    triangles: npt.NDArray[np.uint32]


@dataclass(frozen=True)
class Report:
    """What a surface measures, and why it could not hold a volume."""

    node_count: int
    triangle_count: int
    component_count: int
    genus: int
    area_m2: float
    volume_m3: float
    shortest_edge_m: float
    longest_edge_m: float
    worst_aspect: float
    """Largest √3/4 · (longest edge)² / area; 1 = equilateral."""
    holds_volume: bool
    """Closed, manifold, one component, outward, without degenerate or crossing triangles."""
    problems: list[str]
    """Most serious first: what is wrong, where, and what to do."""


def read(file: str | os.PathLike[str], unit: str = "m") -> Surface:
    """Reads any surface (ply, stl, obj, …), triangulated and welded, in metres.

    Args:
        unit: of the file's numbers: m, dm, cm, mm, um or in.

    Raises:
        InputError: it is no mesh, or cannot be read.
    """
    return Surface(*_core.read_mesh(path_text(file), unit))


def write(
    file: str | os.PathLike[str], nodes: npt.ArrayLike, triangles: npt.ArrayLike, overwrite: bool = False
) -> None:
    """Writes a surface in metres; the extension says how: ply, stl, obj, off.

    Args:
        overwrite: replace a file of that name.

    Raises:
        InputError: another extension, or there is a file of that name. RuntimeError: it cannot be written.
        TypeError, ValueError, IndexError as check().
    """
    _core.write_mesh(path_text(file), nodes, triangles, overwrite)


def check(nodes: npt.ArrayLike, triangles: npt.ArrayLike) -> Report:
    """Measures a surface and says whether it can hold a volume.

    Raises:
        TypeError, ValueError: not numbers, not finite, another shape, beyond 10 km, or more than 200,000 nodes or
            400,000 triangles.
        IndexError: a triangle names a node that is not there.
    """
    return Report(**_core.check_mesh(nodes, triangles))


def repair(nodes: npt.ArrayLike, triangles: npt.ArrayLike) -> tuple[Surface, list[str]]:
    """Welds, drops what is unused, double or without area, and orients; never changes the shape.

    Returns:
        The surface, and what was done, a line each.

    Raises:
        TypeError, ValueError, IndexError: as check().
    """
    repaired, corners, actions = _core.repair_mesh(nodes, triangles)
    return Surface(repaired, corners), actions


def resample(nodes: npt.ArrayLike, triangles: npt.ArrayLike, node_count: int) -> Surface:
    """A surface of nearly equal edges with this many nodes [4 … 200,000] and the same volume.

    Raises:
        InputError: the surface cannot hold a volume: repair it first.
        TypeError, ValueError, IndexError: as check().
    """
    return Surface(*_core.resample_mesh(nodes, triangles, whole("node_count", node_count, least=4)))
