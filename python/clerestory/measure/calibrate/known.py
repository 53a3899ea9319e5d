"""What a sphere says, band by band: spectra weighed, direct light by difference."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.system.spectrum import standard as of_standard

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from clerestory.directions import Scatter, Side
    from clerestory.measure.sphere import Collected, SphereValues
    from clerestory.system.spectrum import Standard

LEAST_COVERED = 0.9
"""Share of a standard's spectrum that must have been measured for a band's value."""
_SAME_DEG = 0.05


@dataclass(frozen=True)
class Known:
    """Transmittance or reflectance of light from one direction in one band, as a sphere gave it."""

    side: Side
    scatter: Scatter
    band: str
    theta_deg: float
    phi_deg: float
    hemispherical: float | None
    diffuse: float | None
    direct: float | None
    standard_error: float | None
    """Of the hemispherical value."""
    conditions: Mapping[str, str]

    @property
    def where(self) -> str:
        """Component and direction in words."""
        return f"{self.band}, {self.scatter} from the {self.side}, {self.theta_deg:g}° at azimuth {self.phi_deg:g}°"


def known_values(
    values: Iterable[SphereValues], bands: Sequence[str], *, standard: str = "en410"
) -> tuple[list[Known], list[str]]:
    """Values of a sphere in the bands of a data set, and what could not be used, in words.

    Hemispherical, diffuse and direct light of one direction come together; two of them give the third.

    Parameters
    ----------
    values
        As read: spectra or bands.
    bands
        Names of the bands that are asked for.
    standard
        By whose spectra wavelengths are weighed: en410, iso9050 or nfrc300.
    """
    found: dict[tuple[Side, Scatter, str, float, float], dict[Collected, tuple[float, float | None]]] = {}
    conditions: dict[tuple[Side, Scatter, str, float, float], Mapping[str, str]] = {}
    left: list[str] = []
    light = of_standard(standard)
    for one in values:
        if np.isnan(one.theta_deg):
            left.append("values for evenly diffuse light calibrate no single direction")
            continue
        for band in bands:
            read = _in_band(one, band, light)
            if isinstance(read, str):
                left.append(read)
                continue
            if read is None:
                continue
            phi = round(one.phi_deg % 360.0, 3) if one.theta_deg > _SAME_DEG else 0.0
            key = (one.incident_side, one.scatter, band, round(one.theta_deg, 3), phi)
            held = found.setdefault(key, {})
            if one.collected in held:
                raise ClerestoryError(
                    f"two {one.collected} values of {band}, {one.scatter} from the {one.incident_side}, "
                    f"{one.theta_deg:g}° (average them, or leave one out)"
                )
            held[one.collected] = read
            conditions[key] = one.conditions
    return [_known(key, held, conditions[key]) for key, held in sorted(found.items())], list(dict.fromkeys(left))


def _known(
    key: tuple[Side, Scatter, str, float, float],
    held: Mapping[Collected, tuple[float, float | None]],
    conditions: Mapping[str, str],
) -> Known:
    def value(which: Collected) -> float | None:
        return held[which][0] if which in held else None

    whole, diffuse, direct = value("hemispherical"), value("diffuse"), value("direct")
    if whole is None and diffuse is not None and direct is not None:
        whole = diffuse + direct
    if direct is None and whole is not None and diffuse is not None:
        direct = whole - diffuse
    if diffuse is None and whole is not None and direct is not None:
        diffuse = whole - direct
    error = held["hemispherical"][1] if "hemispherical" in held else None
    return Known(*key, whole, diffuse, direct, error, conditions)


def _in_band(one: SphereValues, band: str, light: Standard) -> tuple[float, float | None] | str | None:
    """Value and standard error in a band; why a spectrum gives none, in words; or None where it is not of that band."""
    if one.wavelength_nm is None:
        names = [name.lower() for name in one.bands]
        if band.lower() not in names:
            return None
        k = names.index(band.lower())
        return float(one.values[k]), None if one.standard_errors is None else float(one.standard_errors[k])
    if band not in light.bands:
        return f"spectra give {', '.join(light.bands)}, not {band}"
    wavelengths, shares = light.bands[band].wavelength_nm, light.bands[band].weights
    inside = (wavelengths >= one.wavelength_nm[0]) & (wavelengths <= one.wavelength_nm[-1])
    covered = float(shares[inside].sum())
    if covered < LEAST_COVERED:
        return (
            f"a spectrum from {one.wavelength_nm[0]:g} to {one.wavelength_nm[-1]:g} nm holds {100.0 * covered:.0f} % of"
            f" {band} light and gives no value of it"
        )
    rows = np.interp(wavelengths[inside], one.wavelength_nm, one.values)
    value = float(rows @ shares[inside] / covered)
    error = None
    if one.standard_errors is not None:
        # Errors of neighbouring wavelengths come from the same sphere and lamp: taken as fully correlated.
        error = float(np.interp(wavelengths[inside], one.wavelength_nm, one.standard_errors) @ shares[inside] / covered)
    return value, error
