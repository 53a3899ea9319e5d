"""How far a model is off between measured incident directions, told by a model of half of them.

Where light goes smoothly from one measured direction to the next, the error grows with the square of the gap; where
lobes are matched by chance, it does not. The model of half of the directions has gaps twice as wide: its difference to
the model of all is the error of both. For direct-hemispherical values, which go smoothly, it is taken down by the root
of the ratio of their squared gaps; for single patches it is not, but for what is close to a measured direction.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from clerestory.basis import Basis
    from clerestory.directions import Side
    from clerestory.measure.uncertainty.neighbours import Between

    Floats = NDArray[np.float64]

_NEAR_DEG = 12.0
"""Patches whose centres are this close tell of each other's error (one standard deviation of a Gaussian)."""
_LEAST_SHARE = 1e-6


@dataclass(frozen=True)
class LeftOut:
    """One direction that a model of the others foretold."""

    found: float
    """Direct-hemispherical value."""
    measured: float
    spread_deg2: float
    """Of `Between`."""


def per_gap(left_out: Sequence[LeftOut]) -> float | None:
    """Relative error of direct-hemispherical values over squared distance [1/°²]; None where none was left out."""
    ratios = [(o.found / o.measured - 1.0) / o.spread_deg2 for o in left_out if o.spread_deg2 > 0.0 < o.measured]
    return float(np.sqrt(np.mean(np.square(ratios)))) if ratios else None


def nearness(basis: Basis, side: Side) -> Floats:
    """How much patches tell of each other's error (patches, patches); rows sum to 1."""
    centres = basis.outgoing_centres(side)
    chord2 = ((centres[:, None] - centres) ** 2).sum(axis=-1)
    made = np.exp(-0.5 * chord2 / np.radians(_NEAR_DEG) ** 2)
    return np.asarray(made / made.sum(axis=1, keepdims=True))


def pooled(off: Floats, fluxes: Floats, near: Floats) -> Floats:
    """Standard uncertainties of fluxes (patches,) by differences of single patches and of those near them.

    A single difference can be small by chance; that of its neighbours, relative to their light, says how small it may
    be taken.
    """
    held = fluxes + _LEAST_SHARE * float(fluxes.sum())
    relative = np.abs(off) / held
    return np.asarray(np.sqrt(0.5 * off**2 + 0.5 * held**2 * (near @ np.minimum(relative, 1.0) ** 2)))


def shrunk(inner: Between, outer: Between) -> float:
    """What the difference to a model of wider gaps is multiplied by."""
    if inner.beyond or inner.spread_deg2 <= 0.0:
        return 0.0
    return 1.0 if outer.beyond else float(np.sqrt(min(1.0, inner.spread_deg2 / outer.spread_deg2)))


def by_chance(inner: Between, outer: Between) -> float:
    """The same for single patches, whose errors are no smaller in the middle of a narrow gap than of a wide one."""
    return min(1.0, float(np.sqrt(3.0)) * shrunk(inner, outer))


def contrast(fluxes: Sequence[Floats], between: Between) -> Floats:
    """How far neighbours differ in each patch (patches,): their standard deviation by shares.

    Parameters
    ----------
    fluxes
        Into each patch (patches,), for each neighbour of `between`.
    """
    held = np.stack(fluxes)
    return np.asarray(np.sqrt(between.shares @ (held - between.shares @ held) ** 2))
