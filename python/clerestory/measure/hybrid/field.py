"""Numbers over outgoing directions: a square of nodes that holds the whole sphere, in Lambert's projection."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.ndimage import map_coordinates
from scipy.spatial import cKDTree

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Field = NDArray[np.float32]

NODES = 121
"""Along each side of the square that holds the whole sphere in Lambert's projection: steps of 1.3° at the normal."""
_GAP = 2.5
"""A direction farther from all points than this many times the usual distance is in a hole. On a square grid the usual
(median) distance is 0.4 steps and the largest 0.7, so 2.5 leaves no holes in a grid that is a little uneven."""
_MOST_GAP = np.radians(15.0)
"""Points farther apart than twice this make no area, such as those of a scan along a line."""


def _nodes() -> Floats:
    """Directions (n, 3) of the nodes, +z in the middle and −z in the corners."""
    axis = np.linspace(-1.0, 1.0, NODES)
    y, x = np.meshgrid(axis, axis, indexing="ij")
    r2 = np.minimum(x * x + y * y, 2.0)
    scale = np.sqrt(2.0 - r2)
    return np.stack([x * scale, y * scale, 1.0 - r2], axis=-1).reshape(-1, 3)


AT = _nodes()


def smooth(share: Floats) -> Floats:
    """From 0 to 1 without a kink at either end."""
    t = np.clip(share, 0.0, 1.0)
    return np.asarray(t * t * (3.0 - 2.0 * t))


def at(field: Floats | Field, directions: Floats) -> Floats:
    """A field on the nodes at directions (n, 3)."""
    place = directions[:, :2] / np.sqrt(np.maximum(1.0 + directions[:, 2:], 1e-12))
    row = 0.5 * (place + 1.0) * (NODES - 1)
    return np.asarray(map_coordinates(field, [row[:, 1], row[:, 0]], order=1, mode="nearest"))


def moved(field: Field, move: Floats) -> Field:
    """The field of a sample that was turned or mirrored."""
    back = AT.copy()
    back[:, :2] = AT[:, :2] @ move  # the inverse of an orthogonal matrix is its transpose
    return at(field, back).reshape(NODES, NODES).astype(np.float32)


def turned(field: Field, angle: float) -> Field:
    """The field of a sample that was turned counter-clockwise by an angle [rad]."""
    c, s = np.cos(angle), np.sin(angle)
    return moved(field, np.array([[c, -s], [s, c]]))


def mirrored(field: Field, azimuth: float) -> Field:
    """The deeper one of a field and its mirror image in the plane of an azimuth [rad]."""
    c, s = np.cos(2.0 * azimuth), np.sin(2.0 * azimuth)
    return np.maximum(field, moved(field, np.array([[c, s], [s, -c]])))


def depth_of_points(points: Floats) -> Field:
    """Depth within points (n, 3) at the nodes: they are widened to fill their gaps, and taken back by as much."""
    if len(points) < 3:
        return np.full((NODES, NODES), -np.pi, dtype=np.float32)
    far = 2.0 * np.arcsin(np.clip(0.5 * cKDTree(points).query(AT)[0], 0.0, 1.0))
    lowest = points[:, 2].min()
    usual = float(np.median(far[AT[:, 2] >= lowest]))
    gap = min(_GAP * usual, _MOST_GAP)
    return depth_from(far > gap, gap)


def depth_from(outside: NDArray[np.bool_], gap: float) -> Field:
    """Angle of the nodes to the nearest one that is outside, less what the inside was widened by."""
    chord = cKDTree(AT[outside]).query(AT)[0]
    depth = 2.0 * np.arcsin(np.clip(0.5 * chord, 0.0, 1.0)) - gap
    return np.asarray(depth.reshape(NODES, NODES), dtype=np.float32)
