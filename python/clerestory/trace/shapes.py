"""Shapes as recipes make them, before the core takes them: sections of segments and arcs, meshes, solids.

Lengths are metres, in the sample's frame: z into the room, y up, x to the right as seen from the room.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from clerestory import _core

AIR = "air"
Point = tuple[float, float]


@dataclass(frozen=True)
class Face:
    """A surface: the material that light from the front meets and that from the back, and the media there."""

    front: str
    back: str
    before: str = AIR
    behind: str = AIR


@dataclass(frozen=True)
class Piece:
    """A stretch of a section. Its front is on the left of the way, seen with z to the right and y up."""

    start: Point
    """(z, y) [m]."""
    end: Point
    """(z, y) [m]."""
    turn: float
    """Angle that the way turns through [rad], counter-clockwise positive; 0 for a straight segment."""
    face: Face

    def points(self, step: float = math.radians(4.0)) -> NDArray[np.float64]:
        """Points (n, 2) along it, for pictures."""
        (z0, y0), (z1, y1) = self.start, self.end
        if self.turn == 0.0:
            return np.array([self.start, self.end])
        centre, radius = self.circle()
        first = math.atan2(y0 - centre[1], z0 - centre[0])
        angles = first + np.linspace(0.0, self.turn, max(3, int(abs(self.turn) / step) + 2))
        points = np.column_stack([centre[0] + radius * np.cos(angles), centre[1] + radius * np.sin(angles)])
        points[0], points[-1] = self.start, (z1, y1)
        return points

    def circle(self) -> tuple[Point, float]:
        """Centre and radius of an arc."""
        (z0, y0), (z1, y1) = self.start, self.end
        chord_z, chord_y = z1 - z0, y1 - y0
        # The centre lies on the left of the chord for a way that turns left by less than half a circle.
        reach = 0.5 / math.tan(self.turn / 2.0)
        centre = (0.5 * (z0 + z1) - chord_y * reach, 0.5 * (y0 + y1) + chord_z * reach)
        return centre, math.hypot(z0 - centre[0], y0 - centre[1])


@dataclass(frozen=True)
class Section:
    """An extruded section: infinite in x, repeated in y."""

    pieces: tuple[Piece, ...]
    period: float
    """Along y [m]."""
    everywhere: bool = False
    """It is the same at every y, so that any period will do."""

    def repeated(self, period: float) -> Section:
        """With another period, if it is the same everywhere."""
        if not self.everywhere:
            return self
        pieces = (
            replace(p, start=(p.start[0], p.start[1] and period), end=(p.end[0], p.end[1] and period))
            for p in self.pieces
        )
        return replace(self, pieces=tuple(pieces), period=period)

    def moved(self, z: float) -> Section:
        """The same, shifted along z [m]."""
        if z == 0.0:
            return self
        pieces = (replace(p, start=(p.start[0] + z, p.start[1]), end=(p.end[0] + z, p.end[1])) for p in self.pieces)
        return replace(self, pieces=tuple(pieces))

    def depth(self) -> tuple[float, float]:
        """Least and greatest z [m]."""
        z = np.concatenate([p.points()[:, 0] for p in self.pieces])
        return float(z.min()), float(z.max())


@dataclass(frozen=True)
class Mesh:
    """Triangles, repeated along x and y. The front of a triangle is where its corners run counter-clockwise."""

    corners: NDArray[np.float64]
    """Points (n, 3): x, y, z [m]."""
    triangles: NDArray[np.int64]
    """Corners of the triangles (m, 3)."""
    faces: tuple[Face, ...]
    """The surfaces that occur."""
    face: NDArray[np.int64]
    """The surface of each triangle (m,)."""
    periods: Point
    """Along x and y [m]."""
    repeats: bool = True
    """False for a picture of something that is not repeated."""

    @classmethod
    def joined(cls, parts: Iterable[tuple[NDArray[np.float64], NDArray[np.int64], Face]], periods: Point) -> Mesh:
        """From corners, triangles and surface of each part."""
        corners, triangles, faces, face, count = [], [], [], [], 0
        for points, chosen, own in parts:
            corners.append(points)
            triangles.append(chosen + count)
            count += len(points)
            if own not in faces:
                faces.append(own)
            face.append(np.full(len(chosen), faces.index(own)))
        return cls(np.concatenate(corners), np.concatenate(triangles), tuple(faces), np.concatenate(face), periods)

    def moved(self, z: float) -> Mesh:
        """The same, shifted along z [m]."""
        return self if z == 0.0 else replace(self, corners=self.corners + np.array([0.0, 0.0, z]))

    def depth(self) -> tuple[float, float]:
        """Least and greatest z [m]."""
        return float(self.corners[:, 2].min()), float(self.corners[:, 2].max())

    @property
    def period(self) -> float:
        """Along y [m]."""
        return self.periods[1]

    def repeated(self, period: float) -> Mesh:
        """The same: it has periods of its own."""
        del period
        return self


@dataclass(frozen=True)
class Solids:
    """The scene of a file."""

    scene: _core.Scene
    faces: tuple[Face, ...]
    """Of each surface of the scene."""
    limits: tuple[Point, Point]
    """Part of the plane where rays start, along x and y [m]."""
    repeats: bool
    """The limits are a period."""
    z: float = 0.0
    """How far it is shifted along z [m]."""

    def moved(self, z: float) -> Solids:
        """The same, shifted along z [m]."""
        return replace(self, z=self.z + z)

    def depth(self) -> tuple[float, float]:
        """Least and greatest z [m]."""
        bounds = self.scene.bounds() or [[0.0] * 3, [0.0] * 3]
        return bounds[0][2] + self.z, bounds[1][2] + self.z

    @property
    def period(self) -> float:
        """Along y [m]."""
        return self.limits[1][1] - self.limits[1][0]

    def repeated(self, period: float) -> Solids:
        """The same: it has periods of its own, or none."""
        del period
        return self


Shape = Section | Mesh | Solids
"""What a sample is made of."""


@dataclass
class Way:
    """A way along which a section's pieces are laid, one after the other."""

    at: Point
    face: Face
    pieces: list[Piece] = field(default_factory=list)

    def line(self, to: Point) -> Way:
        """Straight on to a point [m]."""
        return self.arc(to, 0.0)

    def arc(self, to: Point, turn: float) -> Way:
        """On an arc that turns by an angle [rad], left positive, to a point [m]; long arcs become several."""
        parts = max(1, math.ceil(abs(turn) / (0.75 * math.pi)))
        whole = Piece(self.at, to, turn, self.face)
        if parts > 1:
            (z, y), radius = whole.circle()
            first = math.atan2(self.at[1] - y, self.at[0] - z)
            for k in range(1, parts):
                angle = first + turn * k / parts
                middle = (z + radius * math.cos(angle), y + radius * math.sin(angle))
                self._add(middle, turn / parts)
        self._add(to, turn / parts)
        return self

    def _add(self, to: Point, turn: float) -> None:
        if to != self.at:
            self.pieces.append(Piece(self.at, to, turn, self.face))
        self.at = to


def turned(pieces: Iterable[Piece], angle: float) -> list[Piece]:
    """Pieces turned about the origin, counter-clockwise seen with z to the right and y up [rad]."""
    cos, sin = math.cos(angle), math.sin(angle)

    def place(p: Point) -> Point:
        return (cos * p[0] - sin * p[1], sin * p[0] + cos * p[1])

    return [replace(p, start=place(p.start), end=place(p.end)) for p in pieces]


def shifted(pieces: Iterable[Piece], z: float, y: float) -> list[Piece]:
    """Pieces shifted [m]."""
    return [replace(p, start=(p.start[0] + z, p.start[1] + y), end=(p.end[0] + z, p.end[1] + y)) for p in pieces]
