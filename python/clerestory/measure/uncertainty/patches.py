"""Fluxes into the outgoing patches of a basis, as sums over a grid of directions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory.basis import Basis

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from clerestory.bsdf import Bsdf
    from clerestory.directions import Side

    Floats = NDArray[np.float64]

ACROSS = 10
"""Directions along each side of a patch; a Klems patch of the full basis has one every 1° to 2°."""


@dataclass(frozen=True)
class Patches:
    """Outgoing patches with directions that stand for equal parts of each one's projected solid angle."""

    basis: Basis
    directions: Floats
    """Unit vectors along the light (patches, each, 3)."""

    @classmethod
    def of(cls, side: Side, basis: Basis | None = None, across: int = ACROSS) -> Patches:
        """Those of the light that leaves to a side; Klems' full basis by default."""
        basis = basis or Basis.named("klems-full")
        at = (np.arange(across) + 0.5) / across
        u = np.stack(np.meshgrid(at, at), axis=-1).reshape(-1, 2)
        return cls(basis, np.stack([basis.sample_outgoing(n, u, side) for n in range(len(basis))]))

    def __len__(self) -> int:
        return len(self.directions)

    @property
    def shares(self) -> Floats:
        """Projected solid angle that each direction of a patch stands for [sr] (patches,)."""
        return np.asarray(self.basis.projected_solid_angles / self.directions.shape[1])

    def values(self, bsdf: Bsdf, incident: Floats, band: str | None = None) -> Floats:
        """BSDF [1/sr] along all directions (patches, each) for light from one direction (3,)."""
        return bsdf.evaluate(np.broadcast_to(incident, self.directions.shape), self.directions, band)

    def fluxes(self, values: Floats) -> Floats:
        """Flux into each patch (patches,) of values (patches, each)."""
        return np.asarray(values.sum(axis=1) * self.shares)
