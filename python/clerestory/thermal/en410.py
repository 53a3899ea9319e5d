"""Total solar energy transmittance g of glazing by EN 410:2011: a calculation by hand."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.counts import counted
from clerestory.thermal.en673 import UNCOATED

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

OUTDOOR = 23.0
"""Coefficient outdoors [W/(m² K)]."""


def g_value(
    transmittance: float,
    absorptances: ArrayLike,
    gaps: ArrayLike,
    *,
    panes_m: ArrayLike | None = None,
    conductivity: float = 1.0,
    emissivity_interior: float = UNCOATED,
) -> tuple[float, float]:
    """Total solar energy transmittance, and the secondary part of it (5.4).

    Parameters
    ----------
    transmittance
        Solar direct transmittance of the whole.
    absorptances
        Of each pane (panes,), from the exterior, in the whole.
    gaps
        Conductance of each gap by EN 673 (panes − 1,) [W/(m² K)].
    panes_m
        Thicknesses (panes,): Λ is the conductance between the middles of panes. Without them it is the gap's.
    conductivity
        Of glass [W/(m K)].
    emissivity_interior
        Of the face toward the room, corrected.

    Raises
    ------
    ClerestoryError
        Numbers do not fit, or there is more than all light.
    """
    taken = np.asarray(absorptances, dtype=np.float64)
    between = 1.0 / np.asarray(gaps, dtype=np.float64)
    if taken.ndim != 1 or between.shape != (len(taken) - 1,):
        raise ClerestoryError(f"{counted(between.size, 'gap')} for {counted(taken.size, 'pane')} (give one fewer)")
    if transmittance + taken.sum() > 1.0 + 1e-6:
        raise ClerestoryError(f"transmittance and absorptances sum to {transmittance + taken.sum():.4f} (1 at most)")
    if panes_m is not None:
        thicknesses = np.asarray(panes_m, dtype=np.float64)
        between = between + (thicknesses[:-1] + thicknesses[1:]) / (2.0 * conductivity)
    indoor = 3.6 + 4.4 * emissivity_interior / UNCOATED
    # What a pane absorbs flows inward by the resistance that lies outside of it.
    outside = 1.0 / OUTDOOR + np.concatenate([[0.0], np.cumsum(between)])
    secondary = float(taken @ outside / (outside[-1] + 1.0 / indoor))
    return transmittance + secondary, secondary
