"""Direct (normal-normal) values of integrating spheres, as the difference of all light and its diffuse part."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.measure.sphere import SphereValues

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

PORT_MARGIN = 3.0
"""Light spreads sideways in a scattering sample by about its thickness; a port should leave so many of it around."""
SCATTERING = 0.1
"""Share of diffuse light in all light from which a sample counts as scattering."""

_SIGNIFICANT = 2.0
_SMALL = 0.002


@dataclass(frozen=True)
class Direct:
    """Direct values, and what is doubtful about them."""

    values: SphereValues
    warnings: tuple[str, ...]


def direct_values(hemispherical: SphereValues, diffuse: SphereValues) -> Direct:
    """Direct values from a measurement of all light and one without the beam.

    Parameters
    ----------
    hemispherical, diffuse
        Of one sample, side, scatter and incident direction, by wavelength or band. Where wavelengths differ, the
        diffuse values are interpolated linearly to those of all light within their range.

    Returns
    -------
    Values with the standard errors of both, none where one has none; and warnings of negative values and of light that
    is likely lost sideways.

    Raises
    ------
    ClerestoryError
        They do not belong together, or have no wavelength or band in common.

    Notes
    -----
    direct = hemispherical - diffuse; variances add. The port of the beam also lets diffuse light out that leaves close
    to it, so direct values hold what scatters into that cone.
    """
    for name in ("sample", "incident_side", "scatter"):
        if getattr(hemispherical, name) != getattr(diffuse, name):
            raise ClerestoryError(
                f"{name} of hemispherical and diffuse values differ: {getattr(hemispherical, name)!r} and"
                f" {getattr(diffuse, name)!r} (give a pair)"
            )
    if hemispherical.collected != "hemispherical" or diffuse.collected != "diffuse":
        raise ClerestoryError(
            f"{hemispherical.collected} and {diffuse.collected} values give no difference"
            " (give hemispherical and diffuse ones)"
        )
    if not np.isclose(hemispherical.theta_deg, diffuse.theta_deg, atol=0.5) or np.isnan(hemispherical.theta_deg):
        raise ClerestoryError(
            f"light from {hemispherical.theta_deg:g}° and from {diffuse.theta_deg:g}° give no difference"
            " (give values of one angle)"
        )
    kept, wavelengths, bands, other, other_errors = _common(hemispherical, diffuse)
    difference = hemispherical.values[kept] - other
    errors = None
    if hemispherical.standard_errors is not None and other_errors is not None:
        errors = np.hypot(hemispherical.standard_errors[kept], other_errors)
    values = SphereValues(
        hemispherical.sample,
        hemispherical.incident_side,
        hemispherical.scatter,
        hemispherical.theta_deg,
        difference,
        "direct",
        wavelengths,
        bands,
        hemispherical.phi_deg,
        errors,
        {**hemispherical.conditions, "derived": "hemispherical minus diffuse"},
        hemispherical.source,
    )
    warnings = _negative(values) + _lateral(hemispherical, diffuse, hemispherical.values[kept], other)
    return Direct(values, tuple(warnings))


def direct_of_pairs(values: Iterable[SphereValues]) -> list[Direct]:
    """Direct values of every pair of hemispherical and diffuse ones, where none were measured."""
    listed = list(values)

    def key(v: SphereValues) -> tuple[object, ...]:
        place = (round(v.theta_deg, 1), round(v.phi_deg % 360.0, 1), bool(v.bands))
        return (v.sample, v.incident_side, v.scatter, *place)

    measured = {key(v) for v in listed if v.collected == "direct"}
    diffuse = {key(v): v for v in listed if v.collected == "diffuse"}
    return [
        direct_values(v, diffuse[key(v)])
        for v in listed
        if v.collected == "hemispherical" and key(v) in diffuse and key(v) not in measured
    ]


def _common(
    all_light: SphereValues, diffuse: SphereValues
) -> tuple[list[int], Floats | None, tuple[str, ...], Floats, Floats | None]:
    """Places of all light that diffuse values go with, their wavelengths or bands, and the diffuse values there."""
    if all_light.wavelength_nm is not None and diffuse.wavelength_nm is not None:
        waves, known = all_light.wavelength_nm, diffuse.wavelength_nm
        kept = [int(k) for k in np.flatnonzero((waves >= known[0]) & (waves <= known[-1]))]
        if kept:
            at = waves[kept]
            errors = diffuse.standard_errors
            spread = None if errors is None else np.interp(at, known, errors)
            return kept, at, (), np.interp(at, known, diffuse.values), spread
    elif all_light.bands and diffuse.bands:
        kept = [k for k, band in enumerate(all_light.bands) if band in diffuse.bands]
        if kept:
            bands = tuple(all_light.bands[k] for k in kept)
            where = [diffuse.bands.index(band) for band in bands]
            errors = diffuse.standard_errors
            return kept, None, bands, diffuse.values[where], None if errors is None else errors[where]
    raise ClerestoryError(
        f"hemispherical and diffuse values of {all_light.sample} have no wavelength or band in common"
        " (measure both alike)"
    )


def _places(values: SphereValues, chosen: Sequence[int]) -> str:
    if values.wavelength_nm is None:
        return ", ".join(values.bands[k] for k in chosen)
    waves = values.wavelength_nm[list(chosen)]
    return f"{waves[0]:g} nm" if len(waves) == 1 else f"{len(waves)} wavelengths of {waves[0]:g} to {waves[-1]:g} nm"


def _negative(values: SphereValues) -> list[str]:
    """A warning of values below 0 by more than their noise."""
    noise = _SMALL if values.standard_errors is None else _SIGNIFICANT * values.standard_errors
    below = np.flatnonzero(values.values < -noise)
    if not below.size:
        return []
    return [
        f"{values.sample}: direct {values.scatter} is negative at {_places(values, [int(k) for k in below])}, down to"
        f" {values.values.min():.4f} (the diffuse values are too large: check the port of the beam and the reference)"
    ]


def _lateral(all_light: SphereValues, diffuse: SphereValues, total: Floats, scattered: Floats) -> list[str]:
    """A warning where light likely leaves a scattering sample beside the sphere's port."""
    sizes = {key: _millimetres(all_light, diffuse, key) for key in ("thickness_mm", "spot_mm", "port_mm")}
    thickness, spot, port = sizes.values()
    if thickness is None or spot is None or port is None or not (scattered.sum() > SCATTERING * abs(total.sum())):
        return []
    margin = (port - spot) / 2.0
    if margin >= PORT_MARGIN * thickness:
        return []
    return [
        f"{all_light.sample}: light is likely lost sideways: {margin:g} mm from the spot to the edge of the port for a"
        f" scattering sample of {thickness:g} mm (take a port of {spot + 2.0 * PORT_MARGIN * thickness:g} mm"
        " or a smaller spot)"
    ]


def _millimetres(first: SphereValues, second: SphereValues, key: str) -> float | None:
    for values in (first, second):
        try:
            return float(values.conditions[key].split()[0])
        except (KeyError, ValueError, IndexError):
            continue
    return None
