"""Where an uncertainty comes from: one line a cause."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

Cause = Literal["noise", "lobes", "cone", "coverage", "interpolation", "level"]
"""Noise of the points; lobes that differ from the points; light across borders by the instrument's cones; light where
nothing was measured; incident directions between the measured ones; and the level of all values."""
CAUSES: tuple[Cause, ...] = get_args(Cause)
COVERAGE_FACTOR = 1.96
"""Standard uncertainties on each side of a value between which the truth lies with 95 %."""


@dataclass(frozen=True)
class Budget:
    """Standard uncertainties of what one incident direction gives, by cause.

    Causes are independent of each other: their squares add (ISO/IEC Guide 98-3, GUM, 5.1).
    """

    theta_deg: float
    """Incident direction, from the normal of its side [°]."""
    phi_deg: float
    measured: bool
    """Whether light from this very direction was measured, itself or as an image under the symmetry."""
    beyond: bool
    """Whether it lies outside of all measured directions."""
    total: float
    """Direct-hemispherical value."""
    fluxes: Floats
    """Light into each outgoing patch per unit of incident light (patches,)."""
    of_total: Mapping[Cause, float]
    """Standard uncertainties of the direct-hemispherical value."""
    of_fluxes: Mapping[Cause, Floats]
    """Standard uncertainties of the fluxes (patches,)."""

    @property
    def total_error(self) -> float:
        """Standard uncertainty of the direct-hemispherical value."""
        return float(np.sqrt(sum(v**2 for v in self.of_total.values())))

    @property
    def flux_errors(self) -> Floats:
        """Standard uncertainties of the fluxes (patches,)."""
        return np.asarray(np.sqrt(sum(v**2 for v in self.of_fluxes.values())))

    @property
    def interval(self) -> tuple[float, float]:
        """Within which the direct-hemispherical value lies with 95 %; never below 0 or above 1."""
        half = COVERAGE_FACTOR * self.total_error
        return max(0.0, self.total - half), min(1.0, self.total + half)
