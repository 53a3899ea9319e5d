"""Sheets with holes: perforated screens and expanded metal."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal

import numpy as np
from pydantic import Field, model_validator

from clerestory.trace.keys import NotNegative, Positive, Slope, wrong
from clerestory.trace.kinds.common import Kind
from clerestory.trace.shapes import Face, Mesh

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from clerestory.trace.workshop import Workshop

    Floats = NDArray[np.float64]
    Part = tuple[Floats, NDArray[np.int64], Face]

CORNERS = 96
"""Corners of a round hole; its area is exact."""


class PerforatedScreen(Kind):
    """An opaque sheet with holes."""

    kind: Literal["perforated-screen"]
    pitch_mm: Positive
    """Distance of neighbouring holes [mm]."""
    pattern: Literal["square", "triangular"] = "square"
    """Holes in rows one above the other, or every second row shifted by half a pitch, all neighbours equally near."""
    hole: Literal["round", "square"] = "round"
    """Shape of the holes."""
    hole_mm: Positive | None = None
    """Diameter or side of a hole [mm]."""
    openness: float | None = Field(default=None, gt=0.0, lt=1.0)
    """Open share of the area, instead of hole_mm."""
    thickness_mm: NotNegative = 0.0
    """Thickness of the sheet [mm]."""
    exterior: str
    """Material of the exterior face."""
    interior: str | None = None
    """Material of the interior face; that of the exterior one by default."""
    wall: str | None = None
    """Material of the holes' walls; that of the exterior face by default."""

    @model_validator(mode="after")
    def _sound(self) -> PerforatedScreen:
        if (self.hole_mm is None) == (self.openness is None):
            raise wrong("hole_mm", "either the size of the holes or the openness is asked for (give one of them)")
        # Across a hole's cell, and across the hole.
        room = min(self._cell_mm)
        if self._hole_mm >= room * (1.0 - 1e-9):
            key = "hole_mm" if self.openness is None else "openness"
            raise wrong(key, f"holes of {self._hole_mm:.4g} mm touch each other (at most {room:.4g} mm have room)")
        return self

    @property
    def _cell_mm(self) -> tuple[float, float]:
        return (self.pitch_mm, self.pitch_mm * (math.sqrt(0.75) if self.pattern == "triangular" else 1.0))

    @property
    def _hole_mm(self) -> float:
        if self.hole_mm is not None:
            return self.hole_mm
        area = (self.openness or 0.0) * math.prod(self._cell_mm)
        return math.sqrt(area) if self.hole == "square" else math.sqrt(4.0 * area / math.pi)

    @property
    def open_fraction(self) -> float:
        """Open share of the area, seen along the normal."""
        area = self._hole_mm**2 * (1.0 if self.hole == "square" else 0.25 * math.pi)
        return area / math.prod(self._cell_mm)

    def shapes(self, shop: Workshop, key: str) -> list[Mesh]:
        """One cell of it, counted from the exterior face."""
        self._warn_of_size(shop, f"{key}.pitch_mm", self.pitch_mm, "mm", 200.0)
        thickness = self.thickness_mm / 1000.0
        interior = self.interior or self.exterior
        if thickness > 0.0:
            faces = (shop.skin(f"{key}.exterior", self.exterior), shop.skin(f"{key}.interior", interior))
            side = shop.skin(f"{key}.wall", self.wall or self.exterior)
        else:
            sheet = shop.sheet(key, self.exterior, interior, names=("exterior", "interior"))
            faces, side = (sheet, sheet), sheet
        wide, high = (mm / 1000.0 for mm in self._cell_mm)
        size = self._hole_mm / 1000.0
        if self.hole == "square":
            outline = 0.5 * size * np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
        else:
            # The polygon has the circle's area.
            radius = 0.5 * size * math.sqrt(2.0 * math.pi / CORNERS / math.sin(2.0 * math.pi / CORNERS))
            angle = 2.0 * math.pi * (np.arange(CORNERS) + 0.5) / CORNERS
            outline = radius * np.column_stack([np.cos(angle), np.sin(angle)])
        centres = [(0.5 * wide, 0.5 * high)]
        if self.pattern == "triangular":
            centres.append((wide, 1.5 * high))
        parts: list[Part] = []
        for centre in centres:
            parts += _plate(outline, (wide, high), np.array(centre), thickness, faces, side)
        return [Mesh.joined(parts, (wide, high * len(centres)))]


def _plate(
    outline: Floats, cell: tuple[float, float], centre: Floats, thickness: float, faces: tuple[Face, Face], wall: Face
) -> list[Part]:
    """A rectangular plate about a hole: an outline (n, 2) about the middle, counter-clockwise."""
    half = 0.5 * np.array(cell)
    corners = half * np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
    angles = np.arctan2(*outline.T[::-1])
    wanted = np.concatenate([angles, np.arctan2(*corners.T[::-1])])
    # A row that is shifted by half a cell has its corners where this one has them.
    border = _at(corners, wanted)
    level = border[np.abs(np.abs(border[:, 1]) - half[1]) < 1e-9 * half[1], 0]
    across = np.concatenate([level, np.where(level > 0.0, level - half[0], level + half[0])])
    wanted = np.concatenate([wanted, np.arctan2(half[1], across), np.arctan2(-half[1], across)])
    wanted.sort()
    wanted = wanted[np.diff(wanted, prepend=-10.0) > 1e-9]
    inner = _at(outline, wanted)
    outer = _at(corners, wanted)
    n = len(wanted)
    k, after = np.arange(n), (np.arange(n) + 1) % n
    flat = np.concatenate([inner, outer]) + centre
    # Counter-clockwise seen from the room.
    room = np.concatenate([np.stack(t, axis=-1) for t in ((k, k + n, after + n), (k, after + n, after))])

    def at(z: float) -> Floats:
        return np.column_stack([flat, np.full(len(flat), z)])

    if thickness == 0.0:
        return [(at(0.0), room[:, ::-1], faces[0])]
    walls = np.concatenate([at(0.0)[:n], at(thickness)[:n]])
    around = np.concatenate([np.stack(t, axis=-1) for t in ((k, after + n, after), (k, k + n, after + n))])
    return [
        (at(0.0), room[:, ::-1], faces[0]),
        (at(thickness), room, faces[1]),
        # The front of the wall is in the hole.
        (walls, around, wall),
    ]


def _at(outline: Floats, angles: Floats) -> Floats:
    """Points of a convex outline about the origin at angles [rad]."""
    ends = np.roll(outline, -1, axis=0)
    way = np.column_stack([np.cos(angles), np.sin(angles)])
    normal = np.column_stack([(ends - outline)[:, 1], -(ends - outline)[:, 0]])
    # The edge that the way leaves through is the nearest of those that it meets from inside.
    reach = np.einsum("ij,ij->i", normal, outline)[None, :] / np.maximum(way @ normal.T, 1e-300)
    reach[way @ normal.T <= 0.0] = np.inf
    return np.asarray(way * reach.min(axis=1)[:, None])


class ExpandedMetal(Kind):
    """Expanded metal: strands in a pattern of diamonds, long ways level, tilted out of the plane."""

    kind: Literal["expanded-metal"]
    long_mm: Positive
    """Length of a diamond, along x [mm]."""
    short_mm: Positive
    """Height of a diamond, along y [mm]."""
    strand_mm: Positive
    """Width of a strand [mm]."""
    thickness_mm: Positive
    """Thickness of the metal [mm]."""
    tilt_deg: Slope = 0.0
    """Angle that the strands are turned out of the plane by [°]; positive with the outer edge below, 0 flattened."""
    material: str
    """What the surface does with light."""

    @model_validator(mode="after")
    def _sound(self) -> ExpandedMetal:
        if self._sway_mm <= 0.0:
            raise wrong(
                "strand_mm", f"strands of {self.strand_mm:g} mm leave no diamonds of {self.short_mm:g} mm height"
            )
        return self

    @property
    def _upright_mm(self) -> float:
        """Height of a strand's section, upright."""
        slope = math.atan2(self.short_mm, self.long_mm)
        return self.strand_mm / math.cos(slope)

    @property
    def _sway_mm(self) -> float:
        """How much a strand's middle goes up and down."""
        tilt = math.radians(self.tilt_deg)
        section = self._upright_mm * math.cos(tilt) + self.thickness_mm * abs(math.sin(tilt))
        return 0.5 * self.short_mm - section

    def shapes(self, shop: Workshop, key: str) -> list[Mesh]:
        """One diamond, counted from its middle."""
        self._warn_of_size(shop, f"{key}.long_mm", self.long_mm, "mm", 500.0)
        face = shop.skin(f"{key}.material", self.material)
        long, short, upright, thick = (
            mm / 1000.0 for mm in (self.long_mm, self.short_mm, self._upright_mm, self.thickness_mm)
        )
        sway = self._sway_mm / 1000.0
        tilt = math.radians(self.tilt_deg)
        # A tilted strand has its outer (exterior) edge below.
        up, out = np.array([math.cos(tilt), math.sin(tilt)]), np.array([-math.sin(tilt), math.cos(tilt)])
        corners = [
            0.5 * (a * upright * up + b * thick * out) for a, b in ((1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0))
        ]
        parts: list[Part] = []
        for middle, sign in ((0.25 * short, 1.0), (0.75 * short, -1.0)):
            xs = np.array([0.0, 0.5, 1.0]) * long
            ys = middle + sign * 0.5 * sway * np.array([-1.0, 1.0, -1.0])
            points = np.array([[x, y + c[0], c[1]] for x, y in zip(xs, ys, strict=True) for c in corners])
            i, j = (v.ravel() for v in np.meshgrid(np.arange(2), np.arange(4), indexing="ij"))
            a, b = 4 * i + j, 4 * i + (j + 1) % 4
            triangles = np.concatenate([np.stack(t, axis=-1) for t in ((a, b, a + 4), (b, b + 4, a + 4))])
            parts.append((points, triangles, face))
        return [Mesh.joined(parts, (long, short))]
