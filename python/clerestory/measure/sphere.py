"""What an integrating sphere gave: transmittance and reflectance of light from one direction, by wavelength or band."""

from __future__ import annotations

from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, Literal

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.directions import SCATTERS, SIDES

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from clerestory.directions import Scatter, Side
    from clerestory.measure.source import Source

    Floats = NDArray[np.float64]

Collected = Literal["hemispherical", "diffuse", "direct"]
"""All light; what is left with the port of the beam open; or the beam alone, which is their difference."""
COLLECTED: tuple[Collected, ...] = ("hemispherical", "diffuse", "direct")


@dataclass(frozen=True)
class SphereValues:
    """Transmittance or reflectance [-] of light from one direction: a spectrum, or values of bands.

    Raises
    ------
    ClerestoryError
        Numbers do not fit, both or neither of `wavelength_nm` and `bands` are given, or wavelengths do not rise.
    """

    sample: str
    incident_side: Side
    scatter: Scatter
    theta_deg: float
    """Of incident light from the normal [°], 0 to 90; NaN for evenly diffuse light."""
    values: Floats
    """Shares of the incident light (n,)."""
    collected: Collected = "hemispherical"
    wavelength_nm: Floats | None = None
    """Wavelengths [nm] (n,), rising."""
    bands: tuple[str, ...] = ()
    """Names of n bands, where there is no spectrum."""
    phi_deg: float = 0.0
    """Azimuth of incident light [°]."""
    standard_errors: Floats | None = None
    conditions: Mapping[str, str] = field(default_factory=dict)
    """By the keys of `clerestory.measure.scan.CONDITIONS`, and the file's own words."""
    source: Source | None = None

    def __post_init__(self) -> None:
        if self.incident_side not in SIDES or self.scatter not in SCATTERS or self.collected not in COLLECTED:
            raise ClerestoryError(
                f"{self.collected!r} {self.scatter!r} of side {self.incident_side!r} is not known"
                f" (collected: {', '.join(COLLECTED)})"
            )
        if not (np.isnan(self.theta_deg) or 0.0 <= self.theta_deg <= 90.0):
            raise ClerestoryError(f"theta_deg {self.theta_deg:g} is not an angle to the normal (0 to 90°, and a side)")
        object.__setattr__(self, "conditions", MappingProxyType(dict(self.conditions)))
        for name in ("values", "wavelength_nm", "standard_errors"):
            if getattr(self, name) is not None:
                array = np.ascontiguousarray(getattr(self, name), dtype=np.float64)
                array.flags.writeable = False
                object.__setattr__(self, name, array)
        if (self.wavelength_nm is None) == (not self.bands):
            raise ClerestoryError("sphere values are by wavelength or by band (give one of them)")
        count = len(self.bands) if self.wavelength_nm is None else len(self.wavelength_nm)
        if self.values.shape != (count,):
            raise ClerestoryError(f"{self.values.size} values do not go with {count} wavelengths or bands")
        if self.standard_errors is not None and self.standard_errors.shape != (count,):
            raise ClerestoryError(f"{self.standard_errors.size} standard errors do not go with {count} values")
        if self.wavelength_nm is not None and not (np.diff(self.wavelength_nm) > 0.0).all():
            raise ClerestoryError("wavelengths do not rise (sort the values by wavelength)")
