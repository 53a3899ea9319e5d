"""Directions in which beams are tabled, so that a system's beams are as sharp as its layers'."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from clerestory import _core
from clerestory.basis import Basis
from clerestory.directions import direction
from clerestory.model import Model

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from clerestory.directions import Side

    Floats = NDArray[np.float64]

STEPS = 2048
"""Steps of cosθ for beams that are the same for all azimuths, linear between them."""
LEAST_COSINE = 1e-6
"""Stands for grazing incidence, where light between panes has no end."""
STEP_DEG = 0.5
"""Greatest width of a ring of patches for beams that depend on the azimuth."""
LEVELS = 7
"""Cells an axis of such beams beside tensor trees, as a power of 2."""


@dataclass(frozen=True)
class Grid:
    """Directions, and how a beam's values there become a model."""

    basis: Basis | None = None
    """Patches of a value each."""
    levels: int | None = None
    """Cells of the concentric square, 2^levels an axis; cosθ alone where there is neither."""

    @classmethod
    def of(cls, beams: Iterable[Model]) -> Grid:
        """The grid whose cells lie in those of all beams, as far as there is one.

        Beams on one basis have its patches, cut into narrow rings; beams of tensor trees have squares; a mixture of
        them has fine patches of its own.
        """
        bases: list[Basis] = []
        levels = 0
        other = False
        for model in beams:
            kind, numbers, held, _, _ = model._core.to_parts()
            if kind in ("specular-patches", "beam"):
                basis = Basis(held[0])
                if basis not in bases:
                    bases.append(basis)
            elif kind == "beam-cells":
                if dict(numbers)["rank"] == 4.0:
                    levels = max(levels, int(dict(numbers)["levels"]))
            elif kind == "turned":
                other = True
        if other or len(bases) > 1 or (bases and levels):
            return cls(basis=_narrow([(2.0 * k, 2.0 * k + 2.0, 2.0 * k + 1.0, 180) for k in range(45)]))
        if bases:
            return cls(basis=_narrow(bases[0].rings))
        return cls(levels=max(levels, LEVELS)) if levels else cls()

    def incident(self, side: Side) -> Floats:
        """Directions (m, 3) toward sources on a side; the same points of the disk from both."""
        if self.basis is not None:
            return self.basis.incident_centres(side)
        if self.levels is not None:
            points = -_disk_of_square(self.levels)
            z = np.sqrt(np.clip(1.0 - (points**2).sum(axis=1), 0.0, None))
            return np.column_stack([points, z if side == "interior" else -z])
        cosine = np.clip(np.linspace(0.0, 1.0, STEPS + 1), LEAST_COSINE, 1.0)
        return direction(np.degrees(np.arccos(cosine)), 90.0, side=side)

    def model(self, values: Floats) -> Model:
        """A beam of values (m,) in the directions of `incident`."""
        values = np.ascontiguousarray(np.clip(values, 0.0, None))
        if self.basis is not None:
            return Model.specular(values, basis=self.basis)
        if self.levels is not None:
            numbers = [("rank", 4.0), ("levels", float(self.levels))]
            return Model(_core.Model.from_parts("beam-cells", numbers, [], [("values", values)], []))
        return Model.specular(values, by="cosine")


def _narrow(rings: list[tuple[float, float, float, int]]) -> Basis:
    """The same sectors in rings of at most half a degree."""
    narrow = []
    for low, high, _, count in rings:
        # A ring of one patch is a cap; panes change by little over it.
        steps = max(1, round((high - low) / STEP_DEG)) if count > 1 else 1
        edges = np.linspace(low, high, steps + 1)
        narrow += [(float(a), float(b), float(a + b) / 2.0 if a > 0.0 else 0.0, count) for a, b in pairwise(edges)]
    return Basis.from_rings("beams", narrow)


def _disk_of_square(levels: int) -> Floats:
    """Middles of the cells of the concentric map (Shirley and Chiu 1997), the first axis fastest (m, 2)."""
    n = 1 << levels
    steps = 2.0 * (np.arange(n) + 0.5) / n - 1.0
    b, a = np.meshgrid(steps, steps, indexing="ij")
    wide = np.abs(a) >= np.abs(b)
    radius, other = np.where(wide, a, b), np.where(wide, b, a)
    angle = np.pi / 4.0 * other / radius
    near, far = radius * np.cos(angle), radius * np.sin(angle)
    return np.column_stack([np.where(wide, near, far).ravel(), np.where(wide, far, near).ravel()])
