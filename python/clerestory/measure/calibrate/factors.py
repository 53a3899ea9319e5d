"""Factors found where a sphere measured, and between."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

PLAUSIBLE = (0.5, 2.0)
"""Factors outside of this mean that something else is wrong."""
_AT_NORMAL_DEG = 0.5


@dataclass(frozen=True)
class Factors:
    """A factor for every incident direction: linear in θ, and in φ around; constant beyond the last angle."""

    theta_deg: Floats
    """Angles from the normal at which it is known [°] (n,)."""
    phi_deg: Floats
    """Azimuths [°] (n,)."""
    values: Floats
    """Factors (n,)."""

    @classmethod
    def of(cls, theta_deg: ArrayLike, phi_deg: ArrayLike, values: ArrayLike) -> Factors:
        """Factors at some directions.

        Raises
        ------
        ClerestoryError
            There are none, or one is not a finite number of 0 or more.
        """
        array = np.asarray(values, dtype=np.float64)
        if len(array) == 0:
            raise ClerestoryError("no factor is known")
        if not (np.isfinite(array) & (array >= 0.0)).all():
            raise ClerestoryError("a factor is not finite: the model has no light where some was measured")
        return cls(np.asarray(theta_deg, np.float64), np.asarray(phi_deg, np.float64) % 360.0, array)

    def at(self, theta_deg: Floats, phi_deg: Floats) -> Floats:
        """Factors at directions (n,); values at the normal belong to all azimuths."""
        normal = self.theta_deg < _AT_NORMAL_DEG
        azimuths = np.unique(np.round(self.phi_deg[~normal], 3))
        if len(azimuths) == 0:
            return np.full(len(theta_deg), float(self.values.mean()))
        along = np.stack([self._at_azimuth(a, theta_deg, normal) for a in azimuths])
        if len(azimuths) == 1:
            return np.asarray(along[0])
        around = np.concatenate([azimuths[-1:] - 360.0, azimuths, azimuths[:1] + 360.0])
        phi = np.asarray(phi_deg) % 360.0
        k = np.clip(np.searchsorted(around, phi, side="right") - 1, 0, len(around) - 2)
        part = (phi - around[k]) / (around[k + 1] - around[k])
        count, each = len(azimuths), np.arange(len(phi))
        return np.asarray((1.0 - part) * along[(k - 1) % count, each] + part * along[k % count, each])

    def _at_azimuth(self, azimuth: float, theta_deg: Floats, normal: NDArray[np.bool_]) -> Floats:
        here = ~normal & (np.abs((self.phi_deg - azimuth + 180.0) % 360.0 - 180.0) < 1e-2)
        theta, values = self.theta_deg[here], self.values[here]
        if normal.any():
            theta = np.concatenate([[0.0], theta])
            values = np.concatenate([[self.values[normal].mean()], values])
        order = np.argsort(theta)
        return np.interp(theta_deg, theta[order], values[order])

    def implausible(self, what: str) -> str | None:
        """A warning where a factor lies outside of `PLAUSIBLE`."""
        low, high = float(self.values.min()), float(self.values.max())
        if low >= PLAUSIBLE[0] and high <= PLAUSIBLE[1]:
            return None
        k = int(np.argmax(np.abs(np.log(np.maximum(self.values, 1e-9)))))
        return (
            f"{what}: the factor is {self.values[k]:.3g} at {self.theta_deg[k]:g}°, outside of {PLAUSIBLE[0]:g} to "
            f"{PLAUSIBLE[1]:g}: rather a wrong side, band, unit or sample than a wrong level"
        )
