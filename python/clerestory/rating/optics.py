"""Transmittance and reflectance in the combinations that EN 14500 has.

Light comes along the normal or from everywhere; it goes straight on, is scattered, or both.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory.directions import direction
from clerestory.integrals import hemispherical

if TYPE_CHECKING:
    from clerestory.bsdf import Bsdf
    from clerestory.directions import Scatter, Side

NEAR_NORMAL_DEG = 8.0
"""Angle at which reflection along the normal is measured [°]."""


@dataclass(frozen=True)
class Optics:
    """Shares of light from one side in one band; the first word is how light comes, the second how it leaves."""

    band: str
    side: Side
    scatter: Scatter
    normal_normal: float
    """Straight on, or mirrored: the openness of cloth whose yarn is opaque."""
    normal_diffuse: float
    """Scattered."""
    normal_hemispherical: float
    diffuse_hemispherical: float
    """Of evenly diffuse light."""

    @property
    def words(self) -> str:
        """How it was found."""
        at = "along the normal" if self.scatter == "transmission" else f"at {NEAR_NORMAL_DEG:g}° from the normal"
        return f"light {at}; beams are told from scattered light by the criterion of Ward and others (2021)"


def optics(bsdf: Bsdf, scatter: Scatter, side: Side = "exterior", band: str | None = None) -> Optics:
    """The four figures of a component (EN 14500:2021; notation of EN 14501).

    Parameters
    ----------
    bsdf
        Any data set. What goes straight through its tables is taken apart from what they scatter.
    scatter, side, band
        Which component.

    Raises
    ------
    MissingDataError
        It is not in the data.
    """
    chosen = band or ("visible" if "visible" in bsdf.bands else bsdf.bands[0])
    apart = bsdf.separate_peaks() if scatter == "transmission" else bsdf
    theta = 0.0 if scatter == "transmission" else NEAR_NORMAL_DEG
    incident = direction(theta, 90.0, side=side)
    whole = float(np.asarray(apart.integrate(incident, scatter, band=chosen)))
    straight = float(np.asarray(apart.integrate(incident, scatter, band=chosen, part="direct")))
    even = hemispherical(bsdf, scatter, side=side, band=chosen).value
    return Optics(chosen, side, scatter, straight, whole - straight, whole, even)
