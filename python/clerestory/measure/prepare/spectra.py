"""How much a detector's channels count in a band: its spectrum in a standard, shared out among them."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.system.spectrum import standard as of_standard

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Weights:
    """How much each channel counts in a band."""

    standard: str
    """EN 410, ISO 9050 or NFRC 300."""
    shares: Mapping[str, float]
    """By channel; the sum is 1."""
    outside: float
    """Share of the spectrum that no channel covers and that went to the nearest one."""


def weights(
    channels: Sequence[str],
    band: str,
    *,
    standard: str = "en410",
    ranges_nm: Mapping[str, tuple[float, float]] | None = None,
) -> Weights:
    """The weights of channels in a band of a standard's spectrum.

    Channels of single wavelengths are the knots of a line between them; channels of a range take the spectrum in it.
    What lies outside of all goes to the nearest.

    Parameters
    ----------
    channels
        Names such as "550 nm" or "500-550 nm", or any with a range in `ranges_nm`.
    band
        visible, solar or nir.
    standard
        en410, iso9050 or nfrc300.
    ranges_nm
        First and last wavelength [nm] that a channel's filter and detector pass.

    Raises
    ------
    ClerestoryError
        It is not known what wavelengths a channel has, wavelengths and ranges are mixed, or there is no such band.
    """
    light = of_standard(standard)
    if band not in light.bands:
        raise ClerestoryError(f"{light.name} has no spectrum of {band!r} (there are {', '.join(light.bands)})")
    if not channels:
        raise ClerestoryError("no channels to weigh")
    limits = {channel: _limits(channel, ranges_nm or {}) for channel in channels}
    wavelengths, shares = light.bands[band].wavelength_nm, light.bands[band].weights
    single = [low == high for low, high in limits.values()]
    if any(single) and not all(single):
        raise ClerestoryError("wavelengths and ranges of wavelengths cannot be weighed together (give ranges for all)")
    first, last = min(low for low, _ in limits.values()), max(high for _, high in limits.values())
    if all(single):
        knots = np.array([low for low, _ in limits.values()])
        order = np.argsort(knots)
        if len(np.unique(knots)) < len(knots):
            raise ClerestoryError("two channels have the same wavelength")
        hats = np.stack([np.interp(wavelengths, knots[order], row) for row in np.eye(len(knots))])
        found = np.empty(len(knots))
        found[order] = hats @ shares
        outside = float(shares[(wavelengths < first) | (wavelengths > last)].sum())
    else:
        edges = np.array(list(limits.values()))
        far = np.maximum(0.0, np.maximum(edges[:, :1] - wavelengths, wavelengths - edges[:, 1:]))
        # A wavelength in several ranges, or as near to several, is shared among them.
        nearest = far <= far.min(axis=0) + 1e-9
        found = (nearest / nearest.sum(axis=0)) @ shares
        outside = float(shares[far.min(axis=0) > 0.0].sum())
    return Weights(light.name, {channel: float(w) for channel, w in zip(channels, found, strict=True)}, outside)


_NUMBERS = re.compile(r"^\s*(\d+(?:\.\d+)?)\s*(?:(?:-|–|to)\s*(\d+(?:\.\d+)?)\s*)?nm\s*$")


def _limits(channel: str, ranges_nm: Mapping[str, tuple[float, float]]) -> tuple[float, float]:
    if channel in ranges_nm:
        low, high = ranges_nm[channel]
    else:
        found = _NUMBERS.match(channel)
        if found is None:
            raise ClerestoryError(
                f"it is not known what wavelengths channel {channel!r} has (give its range, such as {channel}=380-780)"
            )
        low = float(found[1])
        high = float(found[2]) if found[2] else low
    if not (np.isfinite([low, high]).all() and 0.0 < low <= high):
        raise ClerestoryError(f"channel {channel!r} has no range of wavelengths from {low:g} to {high:g} nm")
    return low, high
