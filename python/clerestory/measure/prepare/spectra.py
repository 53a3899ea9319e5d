"""Spectra of standards by which wavelengths weigh in a band, and the weights that channels get from them."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

# EN 410 (and ISO 9050), table 1: D65·V(λ)·Δλ from 380 nm in steps of 10 nm, in per cent.
_VISIBLE = (
    "0 .0005 .003 .0103 .0352 .0948 .2274 .4192 .6663 .985 1.5189 2.1336 3.3491 5.1393 7.0523 8.799 9.4427 9.8077 "
    "9.4306 8.6891 7.8994 6.3306 5.3542 4.2491 3.1502 2.0812 1.381 .807 .4612 .2485 .1255 .0536 .0276 .0146 .0057 "
    ".0035 .0021 .0008 .0001 0 0"
)
# EN 410, table 2: global radiation of the sun, air mass 1, S·Δλ.
_SOLAR = (
    "300 .0005 320 .0069 340 .0122 360 .0145 380 .0177 400 .0235 420 .0268 440 .0294 460 .0343 480 .0339 500 .0326 "
    "520 .0318 540 .0321 560 .0312 580 .0294 600 .0289 620 .0289 640 .0280 660 .0273 680 .0246 700 .0237 720 .0220 "
    "740 .0230 760 .0199 780 .0211 800 .0330 850 .0453 900 .0381 950 .0220 1000 .0329 1050 .0306 1100 .0185 1150 "
    ".0136 1200 .0210 1250 .0211 1300 .0166 1350 .0042 1400 .0010 1450 .0044 1500 .0095 1550 .0123 1600 .0110 1650 "
    ".0106 1700 .0093 1750 .0068 1800 .0024 1850 .0005 1900 .0002 1950 .0012 2000 .0030 2050 .0037 2100 .0057 2200 "
    ".0066 2300 .0060 2400 .0041 2500 .0006"
)

SPECTRA = ("visible", "solar", "solar-g173")
"""EN 410 visible (D65 and V(λ)); EN 410 solar (global, air mass 1); ASTM G173-03 (global on 37°, air mass 1.5)."""


@dataclass(frozen=True)
class Weights:
    """How much each channel counts in a band."""

    spectrum: str
    shares: Mapping[str, float]
    """By channel; the sum is 1."""
    outside: float
    """Share of the spectrum that no channel covers and that went to the nearest one."""


@cache
def spectrum(name: str) -> tuple[Floats, Floats]:
    """Wavelengths [nm] of a spectrum and the share of each, which sum to 1.

    Raises
    ------
    ClerestoryError
        There is no such spectrum.
    """
    if name == "visible":
        wavelengths, shares = 380.0 + 10.0 * np.arange(41), np.array(_VISIBLE.split(), dtype=np.float64)
    elif name == "solar":
        wavelengths, shares = np.array(_SOLAR.split(), dtype=np.float64).reshape(-1, 2).T
    elif name == "solar-g173":
        from pvlib.spectrum import get_reference_spectra

        table = get_reference_spectra(standard="ASTM G173-03")["global"]
        wavelengths = table.index.to_numpy(dtype=np.float64)
        shares = table.to_numpy(dtype=np.float64) * np.gradient(wavelengths)
    else:
        raise ClerestoryError(f"spectrum {name!r} is not known (give {', '.join(SPECTRA)})")
    shares = shares / shares.sum()
    for array in (wavelengths, shares):
        array.flags.writeable = False
    return wavelengths, shares


def weights(
    channels: Sequence[str], name: str, *, ranges_nm: Mapping[str, tuple[float, float]] | None = None
) -> Weights:
    """The weights of channels in a band of a standard's spectrum.

    Channels of single wavelengths are the knots of a line between them; channels of a range take the spectrum in it.
    What lies outside of all goes to the nearest.

    Parameters
    ----------
    channels
        Names such as "550 nm" or "500-550 nm", or any with a range in `ranges_nm`.
    name
        One of `SPECTRA`.
    ranges_nm
        First and last wavelength [nm] that a channel's filter and detector pass.

    Raises
    ------
    ClerestoryError
        It is not known what wavelengths a channel has, or wavelengths and ranges are mixed.
    """
    if not channels:
        raise ClerestoryError("no channels to weigh")
    limits = {channel: _limits(channel, ranges_nm or {}) for channel in channels}
    wavelengths, shares = spectrum(name)
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
    return Weights(name, {channel: float(w) for channel, w in zip(channels, found, strict=True)}, outside)


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
