"""Scenes as triangles, for pictures: round shapes become many-cornered ones."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from clerestory.trace.shapes import Mesh

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from clerestory.trace.shapes import Solids

    Floats = NDArray[np.float64]

AROUND = 48
"""Corners of a circle."""


def mesh_of(solids: Solids) -> Mesh:
    """What a scene looks like, within its limits [m]."""
    corners, surfaces = solids.scene.triangles()
    parts = [corners.reshape(-1, 3, 3)]
    owners = [surfaces.astype(np.int64)]
    for kind, surface, numbers in solids.scene.round():
        made = _round(kind, np.array(numbers))
        parts.append(made)
        owners.append(np.full(len(made), surface, dtype=np.int64))
    points = np.concatenate(parts) + np.array([0.0, 0.0, solids.z])
    face = np.concatenate(owners)
    origin = np.array([solids.limits[0][0], solids.limits[1][0], 0.0])
    if not solids.repeats:
        inside = np.ones(len(points), dtype=bool)
        for axis, (low, high) in enumerate(solids.limits):
            inside &= (points[..., axis].max(axis=1) >= low) & (points[..., axis].min(axis=1) <= high)
        points, face = points[inside], face[inside]
    count = len(points)
    size = (solids.limits[0][1] - solids.limits[0][0], solids.limits[1][1] - solids.limits[1][0])
    return Mesh(
        (points - origin).reshape(-1, 3), np.arange(3 * count).reshape(-1, 3), solids.faces, face, size, solids.repeats
    )


def _round(kind: str, numbers: Floats) -> Floats:
    """Triangles (n, 3, 3) of a sphere, a ring or a cone."""
    if kind == "sphere":
        centre, radius = numbers[:3], numbers[3]
        polar = np.linspace(0.0, math.pi, AROUND // 2 + 1)
        axis = np.array([0.0, 0.0, 1.0])
        circles = [_circle(centre + radius * math.cos(t) * axis, axis, radius * math.sin(t)) for t in polar]
        return np.concatenate([_band(a, b) for a, b in pairwise(circles)])
    if kind == "ring":
        centre, normal = numbers[:3], numbers[3:6]
        return _band(_circle(centre, normal, numbers[6]), _circle(centre, normal, numbers[7]))
    first, last = numbers[:3], numbers[3:6]
    axis = (last - first) / np.linalg.norm(last - first)
    return _band(_circle(first, axis, numbers[6]), _circle(last, axis, numbers[7]))


def _circle(centre: Floats, normal: Floats, radius: float) -> Floats:
    """Points (n, 3) about a normal."""
    aside = np.array([1.0, 0.0, 0.0]) if abs(normal[0]) < 0.7 else np.array([0.0, 1.0, 0.0])
    u = np.cross(normal, aside)
    u /= np.linalg.norm(u)
    v = np.cross(normal, u)
    angle = 2.0 * math.pi * np.arange(AROUND) / AROUND
    return np.asarray(centre + radius * (np.cos(angle)[:, None] * u + np.sin(angle)[:, None] * v))


def _band(first: Floats, last: Floats) -> Floats:
    """Triangles between two circles."""
    after, beyond = np.roll(first, -1, axis=0), np.roll(last, -1, axis=0)
    return np.concatenate([np.stack([first, after, last], axis=1), np.stack([after, beyond, last], axis=1)])
