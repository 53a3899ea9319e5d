"""Angle bases: divisions of a hemisphere into patches."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory import _core
from clerestory.counts import counted
from clerestory.directions import Side

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import ArrayLike, NDArray


class Basis:
    """A division of a hemisphere into patches, ring by ring from the normal outward.

    Patches are found by the direction in which light *travels*, so that straight transmission and mirror
    reflection keep the patch: the incident patch of a source and the outgoing patch opposite to it have one number.
    Arrays count patches from 0; people count from 1 ("Klems 41" is index 40).
    """

    def __init__(self, core: _core.Basis) -> None:
        self._core = core

    @classmethod
    def named(cls, name: str) -> Basis:
        """A basis by name: klems-full, klems-half, klems-quarter, tregenza, reinhart:N, iea21.

        Raises
        ------
        ClerestoryError
            The name is not known.
        """
        return cls(_core.Basis.named(name))

    @classmethod
    def from_rings(cls, name: str, rings: Iterable[tuple[float, float, float, int]]) -> Basis:
        """A basis of one's own.

        Parameters
        ----------
        name
            Name to write into files.
        rings
            Lower limit, upper limit and nominal polar angle [°] and number of patches, from 0° to 90° without gaps.
            The first patch of a ring is centred on azimuth 0.
        """
        return cls(_core.Basis.from_rings(name, list(rings)))

    @property
    def name(self) -> str:
        """Name as written in files."""
        return self._core.name

    @property
    def rings(self) -> list[tuple[float, float, float, int]]:
        """Lower limit, upper limit, nominal polar angle [°] and number of patches of each ring."""
        return self._core.rings

    def __len__(self) -> int:
        """Number of patches."""
        return len(self._core)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Basis) and self._core == other._core

    def __hash__(self) -> int:
        return hash(tuple(self.rings))

    def __repr__(self) -> str:
        return f"<Basis {self.name!r}: {counted(len(self), 'patch', 'patches')} in {counted(len(self.rings), 'ring')}>"

    def index_of_incident(self, incident: ArrayLike) -> NDArray[np.int64]:
        """0-based patch of directions (..., 3) toward sources."""
        return self._index(-np.asarray(incident, dtype=np.float64)[..., :2])

    def index_of_outgoing(self, outgoing: ArrayLike) -> NDArray[np.int64]:
        """0-based patch of directions (..., 3) along leaving light."""
        return self._index(np.asarray(outgoing, dtype=np.float64)[..., :2])

    def _index(self, points: NDArray[np.float64]) -> NDArray[np.int64]:
        flat = np.ascontiguousarray(points.reshape(-1, 2))
        return self._core.patch_of(flat).reshape(points.shape[:-1])

    def incident_centres(self, side: Side) -> NDArray[np.float64]:
        """Directions (n, 3) toward sources on `side` at the patches' nominal centres."""
        return self._directions(-self._core.centres(), side)

    def outgoing_centres(self, side: Side) -> NDArray[np.float64]:
        """Directions (n, 3) of light leaving to `side` at the patches' nominal centres."""
        return self._directions(self._core.centres(), side)

    def sample_incident(
        self, index: int, u: ArrayLike, side: Side, *, cosine_weighted: bool = True
    ) -> NDArray[np.float64]:
        """Directions (n, 3) toward sources in a patch for uniform numbers `u` (n, 2) in [0, 1)."""
        return self._directions(-self._sample(index, u, cosine_weighted=cosine_weighted), side)

    def sample_outgoing(
        self, index: int, u: ArrayLike, side: Side, *, cosine_weighted: bool = True
    ) -> NDArray[np.float64]:
        """Directions (n, 3) of leaving light in a patch for uniform numbers `u` (n, 2) in [0, 1)."""
        return self._directions(self._sample(index, u, cosine_weighted=cosine_weighted), side)

    def _sample(self, index: int, u: ArrayLike, *, cosine_weighted: bool) -> NDArray[np.float64]:
        return self._core.sample(index, np.ascontiguousarray(u, dtype=np.float64), cosine_weighted)

    @staticmethod
    def _directions(points: NDArray[np.float64], side: Side) -> NDArray[np.float64]:
        z = np.sqrt(np.clip(1.0 - np.sum(points**2, axis=-1), 0.0, None))
        return np.column_stack([points, z if side == "interior" else -z])

    @property
    def solid_angles(self) -> NDArray[np.float64]:
        """Solid angle of each patch [sr]; the sum is 2π."""
        return self._core.solid_angles()

    @property
    def projected_solid_angles(self) -> NDArray[np.float64]:
        """Projected solid angle of each patch [sr]; the sum is π."""
        return self._core.projected_solid_angles()

    @property
    def limits_deg(self) -> NDArray[np.float64]:
        """Lower and upper polar angle, lower and upper azimuth of travel [°] of each patch (n, 4)."""
        return np.degrees(self._core.limits())

    @property
    def reversed(self) -> NDArray[np.int64]:
        """Index of the patch at azimuth + 180°, the same path travelled backwards; -1 where there is none."""
        return self._core.reversed()
