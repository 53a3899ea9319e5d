"""Two models and what was measured, in the cells of one table: columns of incident directions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, Protocol

import numpy as np

from clerestory import _core
from clerestory._core import ClerestoryError
from clerestory.basis import Basis
from clerestory.bsdf import Bsdf
from clerestory.directions import outgoing_side
from clerestory.model import Model

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from clerestory.directions import Scatter, Side
    from clerestory.measure.hybrid.reach import Reach

    Floats = NDArray[np.float64]

_ACROSS = 4
"""Directions along each side of a patch over which the share of what was measured is averaged."""
_MOST = {"tensor3": 8, "tensor4": 7}
"""Resolutions: trees begin as a whole grid, and 2^7 cells on each of four axes make 1 GB."""


class Table(Protocol):
    """Cells that a hybrid model is made in."""

    incident_areas: Floats
    """Projected solid angle of each incident cell [sr] (columns,)."""
    outgoing_areas: Floats
    """Projected solid angle of each outgoing cell [sr] (rows,)."""

    def converted(self, bsdf: Bsdf, progress: Callable[[float], object] | None) -> Bsdf:
        """A data set in cells."""

    def column(self, bsdf: Bsdf, band: str, side: Side, scatter: Scatter, k: int) -> Floats:
        """BSDF [1/sr] of a converted data set for one incident cell (rows,)."""

    def weights(self, reach: Reach, side: Side, scatter: Scatter, k: int, blend_deg: float) -> tuple[Floats, float]:
        """Share of the measured model in each outgoing cell (rows,), and whether the incident cell was reached."""

    def model(self, columns: NDArray[np.float32]) -> Model:
        """A model of columns (columns, rows)."""


def table(basis: str, resolution: int, reduce: float | None) -> Table:
    """Patches by the name of their basis, or the cells of a tree: `tensor3` or `tensor4`.

    Raises
    ------
    ClerestoryError
        There is no such basis, or the resolution is not possible.
    """
    if basis not in ("tensor3", "tensor4"):
        return Patches(Basis.named(basis))
    if not 1 <= resolution <= _MOST[basis]:
        raise ClerestoryError(
            f"resolution {resolution} is not possible for a hybrid {basis} (give 1 to {_MOST[basis]})"
        )
    return Cells("tensor3" if basis == "tensor3" else "tensor4", resolution, reduce)


class Patches:
    """A matrix of patches."""

    def __init__(self, basis: Basis) -> None:
        self.basis = basis
        self.incident_areas = self.outgoing_areas = basis.projected_solid_angles
        at = (np.arange(_ACROSS) + 0.5) / _ACROSS
        self._u = np.stack(np.meshgrid(at, at), axis=-1).reshape(-1, 2)
        self._outgoing: dict[Side, Floats] = {}

    def converted(self, bsdf: Bsdf, progress: Callable[[float], object] | None) -> Bsdf:
        """A data set as matrices."""
        return bsdf.to_matrix(self.basis, progress=progress)

    def column(self, bsdf: Bsdf, band: str, side: Side, scatter: Scatter, k: int) -> Floats:
        """BSDF [1/sr] of a patch (rows,)."""
        return np.asarray(np.maximum(bsdf.models[band][side, scatter].values[:, k], 0.0))

    def weights(self, reach: Reach, side: Side, scatter: Scatter, k: int, blend_deg: float) -> tuple[Floats, float]:
        """Means over the patches."""
        leaves = outgoing_side(side, scatter)
        if leaves not in self._outgoing:
            count = range(len(self.basis))
            self._outgoing[leaves] = np.concatenate([self.basis.sample_outgoing(n, self._u, leaves) for n in count])
        incident = self.basis.sample_incident(k, self._u, side)
        found = np.mean([reach.weights(one, self._outgoing[leaves], blend_deg) for one in incident], axis=0)
        reached = float((reach.incident_depth(incident) >= 0.0).mean())
        return found.reshape(len(self.basis), -1).mean(axis=1), reached

    def model(self, columns: NDArray[np.float32]) -> Model:
        """A matrix."""
        return Model.matrix(columns.T.astype(np.float64), self.basis)


@dataclass
class Cells:
    """A tensor tree, as an even grid until it is made."""

    rank: Literal["tensor3", "tensor4"]
    resolution: int
    reduce: float | None

    def __post_init__(self) -> None:
        n = 1 << self.resolution
        self._directions = _core.square_directions(n)
        self.outgoing_areas = np.full(n * n, np.pi / (n * n))
        if self.rank == "tensor4":
            self.incident_areas = self.outgoing_areas
            self._travel = self._directions
        else:
            edges = 1.0 - 2.0 * np.arange(n // 2 + 1) / n
            self.incident_areas = np.pi * (edges[:-1] ** 2 - edges[1:] ** 2)
            r = 0.5 * (edges[:-1] + edges[1:])
            self._travel = np.stack([r, np.zeros_like(r), np.sqrt(1.0 - r * r)], axis=1)

    def converted(self, bsdf: Bsdf, progress: Callable[[float], object] | None) -> Bsdf:
        """A data set as trees that are not reduced."""
        return bsdf.to_tree(self.rank, resolution=self.resolution, reduce=None, progress=progress)

    def column(self, bsdf: Bsdf, band: str, side: Side, scatter: Scatter, k: int) -> Floats:
        """BSDF [1/sr] of an incident cell (rows,)."""
        outgoing = _to(self._directions, outgoing_side(side, scatter))
        incident = np.broadcast_to(self._incident(side, k), outgoing.shape)
        return bsdf.evaluate(incident, outgoing, band)

    def weights(self, reach: Reach, side: Side, scatter: Scatter, k: int, blend_deg: float) -> tuple[Floats, float]:
        """Values at the middles of the outgoing cells; means over a ring of incident directions."""
        outgoing = _to(self._directions, outgoing_side(side, scatter))
        if self.rank == "tensor4":
            incident = self._incident(side, k)[None]
        else:
            n = 1 << self.resolution
            radius = 1.0 - 2.0 * (k + (np.arange(_ACROSS) + 0.5) / _ACROSS) / n
            incident = np.array([_toward(np.array([r, 0.0, np.sqrt(1.0 - r * r)]), side) for r in radius])
        found = np.mean([reach.weights(one, outgoing, blend_deg) for one in incident], axis=0)
        return found, float((reach.incident_depth(incident) >= 0.0).mean())

    def model(self, columns: NDArray[np.float32]) -> Model:
        """A tree, reduced as was asked for."""
        n = 1 << self.resolution
        made = Model.tree_from_grid(columns.reshape((n // 2, n, n) if self.rank == "tensor3" else (n, n, n, n)))
        return made if self.reduce is None else made.reduced(percent=self.reduce)[0]

    def _incident(self, side: Side, k: int) -> Floats:
        return _toward(self._travel[k], side)


def _toward(travel: Floats, side: Side) -> Floats:
    return np.array([-travel[0], -travel[1], travel[2] if side == "interior" else -travel[2]])


def _to(forward: Floats, side: Side) -> Floats:
    return forward if side == "interior" else forward * np.array([1.0, 1.0, -1.0])
