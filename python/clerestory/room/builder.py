"""A rectangular room: walls with openings, floor, ceiling and boxes."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory.trace.keys import RecipeError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from clerestory.room.recipe import Box, Opening

NEAR = 1e-6
"""Edges nearer than this are one [m]."""


@dataclass(frozen=True)
class Quads:
    """Flat four-sided pieces of one surface."""

    name: str
    """What it is called in messages."""
    material: str | float
    """A material's name, or a reflectance."""
    corners: NDArray[np.float64]
    """(n, 4, 3) [m], counter-clockwise as seen from the room."""


@dataclass(frozen=True)
class Wall:
    """One of the four walls: its lower left corner as seen from the room, along it, and out of the room."""

    origin: tuple[float, float]
    along: tuple[float, float]
    out: tuple[float, float]
    length: float

    def at(self, s: float, z: float, depth: float = 0.0) -> tuple[float, float, float]:
        """The point at a distance along the wall, a height, and a depth into it."""
        x, y = (o + s * a + depth * n for o, a, n in zip(self.origin, self.along, self.out, strict=True))
        return (x, y, z)


def walls(box: Box) -> dict[str, Wall]:
    """The walls of a room by the side that they are on."""
    w, d = box.width_m, box.depth_m
    return {
        "south": Wall((w, 0.0), (-1.0, 0.0), (0.0, -1.0), w),
        "north": Wall((0.0, d), (1.0, 0.0), (0.0, 1.0), w),
        "east": Wall((w, d), (0.0, -1.0), (1.0, 0.0), d),
        "west": Wall((0.0, 0.0), (0.0, 1.0), (-1.0, 0.0), d),
    }


def build(box: Box) -> tuple[list[Quads], list[tuple[str, list[tuple[float, float, float]], str]]]:
    """The surfaces of a room; and its windows: name, corners as seen from the room, and system.

    Raises
    ------
    RecipeError
        An opening lies beyond its wall, or two overlap.
    """
    w, d, h, t = box.width_m, box.depth_m, box.height_m, box.wall_thickness_m
    made = [
        Quads("floor", box.floor, np.array([[(0, 0, 0), (w, 0, 0), (w, d, 0), (0, d, 0)]], dtype=float)),
        Quads("ceiling", box.ceiling, np.array([[(0, 0, h), (0, d, h), (w, d, h), (w, 0, h)]], dtype=float)),
    ]
    windows: list[tuple[str, list[tuple[float, float, float]], str]] = []
    for side, wall in walls(box).items():
        openings = [(k, o) for k, o in enumerate(box.openings) if o.wall == side]
        rectangles: list[tuple[int, tuple[float, float, float, float]]] = []
        for k, opening in openings:
            rectangle = _rectangle(k, opening, wall, h)
            for other, (left, right, low, high) in rectangles:
                if rectangle[0] < right and left < rectangle[1] and rectangle[2] < high and low < rectangle[3]:
                    raise RecipeError(
                        f"room.openings[{k + 1}]: overlaps room.openings[{other + 1}] (move one of them along the wall)"
                    )
            rectangles.append((k, rectangle))
            left, right, low, high = rectangle
            corners = [wall.at(left, low, t), wall.at(right, low, t), wall.at(right, high, t), wall.at(left, high, t)]
            number = sum(name.startswith(side) for name, _, _ in windows) + 1
            windows.append((side if len(openings) == 1 else f"{side} {number}", corners, opening.system))
            if t > 0.0:
                made.append(Quads(f"reveal of {side}", box.walls, _reveal(wall, rectangle, t)))
        made.append(Quads(f"{side} wall", box.walls, _with_holes(wall, h, [r for _, r in rectangles])))
    for k, piece in enumerate(box.furniture):
        made.append(Quads(f"furniture {k + 1}", piece.material, _solid(piece.corner_m, piece.size_m)))
    return made, windows


def _rectangle(k: int, opening: Opening, wall: Wall, height: float) -> tuple[float, float, float, float]:
    """Left, right, low, high of an opening in its wall."""
    left = (wall.length - opening.width_m) / 2 if opening.left_m is None else opening.left_m
    right, low, high = left + opening.width_m, opening.sill_m, opening.sill_m + opening.height_m
    if left < -NEAR or right > wall.length + NEAR:
        raise RecipeError(
            f"room.openings[{k + 1}]: reaches from {left:g} m to {right:g} m along a wall of {wall.length:g} m "
            "(make it narrower, or move it with left_m)"
        )
    if high > height + NEAR:
        raise RecipeError(
            f"room.openings[{k + 1}]: its head is at {high:g} m, above the ceiling at {height:g} m "
            "(lower sill_m or height_m)"
        )
    return max(left, 0.0), min(right, wall.length), low, min(high, height)


def _with_holes(wall: Wall, height: float, holes: Sequence[tuple[float, float, float, float]]) -> NDArray[np.float64]:
    """A wall in columns between all edges of its holes, each cut at the holes that it meets."""
    edges = sorted({0.0, wall.length, *(e for hole in holes for e in hole[:2])})
    quads = []
    for left, right in itertools.pairwise(edges):
        if right - left < NEAR:
            continue
        z = 0.0
        for _, _, low, high in sorted((h for h in holes if h[0] <= left and right <= h[1]), key=lambda hole: hole[2]):
            if low - z > NEAR:
                quads.append((left, right, z, low))
            z = high
        if height - z > NEAR:
            quads.append((left, right, z, height))
    corners = [[wall.at(a, low), wall.at(b, low), wall.at(b, high), wall.at(a, high)] for a, b, low, high in quads]
    return np.array(corners, dtype=float).reshape(-1, 4, 3)


def _reveal(wall: Wall, rectangle: tuple[float, float, float, float], depth: float) -> NDArray[np.float64]:
    """The four faces between the inner face of a wall and a window in its outer one."""
    left, right, low, high = rectangle
    outline = [(left, low), (right, low), (right, high), (left, high)]
    faces = []
    for (a, za), (b, zb) in zip(outline, [*outline[1:], outline[0]], strict=True):
        faces.append([wall.at(a, za), wall.at(b, zb), wall.at(b, zb, depth), wall.at(a, za, depth)])
    return np.array(faces, dtype=float)


def _solid(corner: Sequence[float], size: Sequence[float]) -> NDArray[np.float64]:
    """The six faces of a box, seen from outside."""
    low = np.array(corner, dtype=float)
    faces = []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for at_end in (0, 1):
            start = low.copy()
            start[axis] += at_end * size[axis]
            a, b = np.zeros(3), np.zeros(3)
            a[u], b[v] = size[u], size[v]
            face = [start, start + a, start + a + b, start + b]
            faces.append(face if at_end else face[::-1])
    return np.array(faces, dtype=float)
