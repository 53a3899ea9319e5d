"""Divisions of the outgoing disk for quadrature and for bins of samples.

A model that is a table is constant in the cells of a partition that is a refinement of its own patches, so that one
point a cell integrates it exactly. Points are those of the disk of travel: x and y of an outgoing direction.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

if TYPE_CHECKING:
    from clerestory import Basis


class Partition(Protocol):
    """Cells of the unit disk."""

    @property
    def areas(self) -> np.ndarray:
        """Projected solid angle of each cell (n,) [sr]; the sum is π."""
        ...

    def points(self, u: np.ndarray, cells: np.ndarray | None = None) -> np.ndarray:
        """Points (n, m, 2) of all or some cells, uniform in area, for numbers u (m, 2) in [0, 1)."""
        ...

    def index(self, points: np.ndarray) -> np.ndarray:
        """Cell of each point (..., 2)."""
        ...


MIDDLE = np.array([[0.5, 0.5]])


@dataclass(frozen=True)
class Polar:
    """Rings between limits of sin²θ, each cut into equal azimuths of which the first begins at azimuth 0."""

    limits: tuple[float, ...]
    counts: tuple[int, ...]

    @classmethod
    def of(cls, *bases: Basis) -> Polar:
        """The common refinement of bases; quadrants are unions of its cells."""
        limits = sorted({round(ring[1], 9) for basis in bases for ring in basis.rings})
        counts = []
        for upper in limits:
            rings = [next(r for r in basis.rings if round(r[1], 9) >= upper) for basis in bases]
            counts.append(math.lcm(4, *(2 * ring[3] for ring in rings)))
        return cls((0.0, *np.sin(np.radians(limits)) ** 2), tuple(counts))

    @property
    def areas(self) -> np.ndarray:
        rings = np.pi * np.diff(self.limits) / self.counts
        return np.repeat(rings, self.counts)

    def points(self, u: np.ndarray, cells: np.ndarray | None = None) -> np.ndarray:
        ring = np.repeat(np.arange(len(self.counts)), self.counts)
        within = np.concatenate([np.arange(n) for n in self.counts])
        if cells is not None:
            ring, within = ring[cells], within[cells]
        low, high = np.array(self.limits[:-1])[ring, None], np.array(self.limits[1:])[ring, None]
        r = np.sqrt(low + (high - low) * u[:, 0])
        phi = 2 * np.pi * (within[:, None] + u[:, 1]) / np.array(self.counts)[ring, None]
        return np.stack([r * np.cos(phi), r * np.sin(phi)], axis=-1)

    def index(self, points: np.ndarray) -> np.ndarray:
        sin2 = np.sum(points**2, axis=-1)
        ring = np.clip(np.searchsorted(self.limits, sin2, side="right") - 1, 0, len(self.counts) - 1)
        turns = np.arctan2(points[..., 1], points[..., 0]) / (2 * np.pi) % 1.0
        counts = np.array(self.counts)
        within = np.minimum((turns * counts[ring]).astype(int), counts[ring] - 1)
        return np.concatenate([[0], np.cumsum(counts)])[ring] + within


@dataclass(frozen=True)
class Square:
    """A grid of n × n cells on the unit square of the concentric map (Shirley and Chiu 1997)."""

    n: int

    @property
    def areas(self) -> np.ndarray:
        return np.full(self.n * self.n, np.pi / self.n**2)

    def points(self, u: np.ndarray, cells: np.ndarray | None = None) -> np.ndarray:
        i, j = np.divmod(np.arange(self.n * self.n) if cells is None else cells, self.n)
        return from_square((np.stack([i, j], axis=-1)[:, None, :] + u) / self.n)

    def index(self, points: np.ndarray) -> np.ndarray:
        cell = np.minimum((to_square(points) * self.n).astype(int), self.n - 1)
        return cell[..., 0] * self.n + cell[..., 1]


@dataclass(frozen=True)
class Sectors:
    """Rings of equal width, all of them cut at the same azimuths [rad], which ascend from 0."""

    rings: int
    cuts: tuple[float, ...]

    @classmethod
    def backwards(cls, n: int, r: float) -> Sectors:
        """What a tree of rank 3 and n cells an axis sees backwards, for light at r on the disk travelling toward +x.

        The circle of radius r is the outline of a square whose side the tree's cells cut, and equal azimuths on it are
        equal lengths.
        """
        half = r * n / 2
        if half < 1e-9:
            return cls(n // 2, tuple(np.pi / 4 * np.arange(8)))
        whole = np.arange(math.floor(half) + 1)
        side = np.concatenate([whole, 2 * half - whole])
        cuts = np.unique(np.round(np.concatenate([2 * half * q + side for q in range(4)]), 9))
        return cls(n // 2, tuple(np.pi / 4 * cuts[cuts < 8 * half - 1e-8] / half))

    @property
    def areas(self) -> np.ndarray:
        annuli = np.diff(np.linspace(0, 1, self.rings + 1) ** 2) / 2
        return np.outer(annuli, np.diff([*self.cuts, 2 * np.pi])).ravel()

    def points(self, u: np.ndarray, cells: np.ndarray | None = None) -> np.ndarray:
        ring, within = np.divmod(
            np.arange(self.rings * len(self.cuts)) if cells is None else np.asarray(cells), len(self.cuts)
        )
        cuts = np.array([*self.cuts, 2 * np.pi])
        low, high = (ring[:, None] / self.rings) ** 2, ((ring[:, None] + 1) / self.rings) ** 2
        r = np.sqrt(low + (high - low) * u[:, 0])
        phi = cuts[within, None] + np.diff(cuts)[within, None] * u[:, 1]
        return np.stack([r * np.cos(phi), r * np.sin(phi)], axis=-1)

    def index(self, points: np.ndarray) -> np.ndarray:
        ring = np.minimum((np.hypot(points[..., 0], points[..., 1]) * self.rings).astype(int), self.rings - 1)
        phi = np.arctan2(points[..., 1], points[..., 0]) % (2 * np.pi)
        return ring * len(self.cuts) + np.searchsorted(self.cuts, phi, side="right") - 1


@dataclass(frozen=True)
class Turned:
    """Another partition, mirrored left to right if asked for, then turned counter-clockwise."""

    base: Partition
    angle: float
    mirror: bool = False

    @property
    def areas(self) -> np.ndarray:
        return self.base.areas

    def points(self, u: np.ndarray, cells: np.ndarray | None = None) -> np.ndarray:
        points = self.base.points(u, cells)
        if self.mirror:
            points = points * [-1.0, 1.0]
        return turn(points, self.angle)

    def index(self, points: np.ndarray) -> np.ndarray:
        back = turn(points, -self.angle)
        return self.base.index(back * [-1.0, 1.0] if self.mirror else back)


def turn(points: np.ndarray, angle: float) -> np.ndarray:
    """Points (..., 2) turned counter-clockwise about the centre (radians)."""
    sin, cos = np.sin(angle), np.cos(angle)
    return points @ np.array([[cos, sin], [-sin, cos]])


def to_square(points: np.ndarray) -> np.ndarray:
    """The concentric map from the disk to the square, on points (..., 2); written anew, as a check of the program's."""
    x, y = points[..., 0], points[..., 1]
    r = np.hypot(x, y)
    wide = np.abs(y) <= np.abs(x)
    near, far = np.where(wide, x, y), np.where(wide, y, x)
    along = np.copysign(r, near)
    across = along * np.arctan(np.divide(far, near, out=np.zeros_like(far), where=near != 0)) * 4 / np.pi
    return np.stack([np.where(wide, along, across), np.where(wide, across, along)], axis=-1) / 2 + 0.5


def from_square(square: np.ndarray) -> np.ndarray:
    """The inverse of `to_square`."""
    a, b = np.moveaxis(2 * square - 1, -1, 0)
    wide = np.abs(a) >= np.abs(b)
    r, other = np.where(wide, a, b), np.where(wide, b, a)
    phi = np.pi / 4 * np.divide(other, r, out=np.zeros_like(r), where=r != 0)
    along, across = r * np.cos(phi), r * np.sin(phi)
    return np.stack([np.where(wide, along, across), np.where(wide, across, along)], axis=-1)


def low_discrepancy(n: int) -> np.ndarray:
    """Points (n, 2) of the R2 sequence in the unit square (Roberts 2018)."""
    g = 1.32471795724474602596
    return (0.5 + np.arange(1, n + 1)[:, None] * np.array([1 / g, 1 / g**2])) % 1.0
