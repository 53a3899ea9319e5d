"""Photographs of different exposure put together to one map of light."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory.photo.debevec import hat
from clerestory.photo.response import HIGHEST, LOWEST

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from clerestory.photo.response import Response
    from clerestory.photo.series import Series

NOMINAL = 78.0 / 0.65
"""Luminance [cd/m²] times the exposure value [s] that just saturates a sensor: ISO 12232's speed by saturation (78/H),
and 0.65 of the light that an ideal lens would pass (ISO 2720). Real cameras are within half a stop or so."""
GHOST = 0.25
"""Spread of the logarithms of light, weighted, above which the pictures contradict each other at a pixel."""
# Noise of linear pictures, of full scale: photons of a sensor that holds 40,000 electrons, and of reading.
PHOTONS, READING = 1.0 / 40000.0, 2.0**-12
_ROWS = 256


@dataclass(frozen=True)
class Merged:
    """Light of each pixel, in cd/m² of a camera that keeps its nominal speed, until it is calibrated."""

    pixels: NDArray[np.float32]
    """Red, green and blue (height, width, 3) in the camera's primaries, each worth its share of the luminance."""
    saturated: NDArray[np.bool_]
    """Pixels (height, width) that are too bright in the shortest exposure: their light is a lower limit."""
    dark: NDArray[np.bool_]
    """Pixels that are too dark in the longest exposure."""
    between: NDArray[np.bool_]
    """Pixels that are too dark in one exposure and too bright in the next."""
    ghosts: NDArray[np.bool_]
    """Pixels where exposures contradict each other, mostly because something moved."""
    most: float
    """Nominal luminance [cd/m²] of white that can just be measured."""
    least: float
    """Nominal luminance [cd/m²] of grey that can just be measured."""


def merge(series: Series, response: Response, progress: Callable[[float], object] | None = None) -> Merged:
    """Merge a series.

    Parameters
    ----------
    series
        What `read_series` gave.
    response
        The camera's, recovered, read or linear.
    progress
        Called with the share that is done, 0 to 1.

    Notes
    -----
    With a camera's response, ln E = Σ w(Z) (g(Z) − ln t)/Σ w(Z), where the hat w is 0 below 5 and above 250 of 255
    (Debevec and Malik 1997, equation 6). Linear pictures are averaged with the weights that give the least noise,
    t²/(P E t + R²) with photon noise P and reading noise R. Where no picture counts, the longest that is not too bright
    does, or else the highest reliable level of the shortest.
    """
    shape, count = series.shape, len(series.photographs)
    darkest, brightest = _limits(response, series.bits)
    total, weights, fallback = (np.zeros((*shape, 3), dtype=np.float32) for _ in range(3))
    sums, squares = np.zeros(shape, dtype=np.float32), np.zeros(shape, dtype=np.float32)  # of green, for ghosts
    too_bright = too_dark = np.zeros((*shape, 3), dtype=bool)
    for number, photograph in enumerate(series.photographs):
        levels = photograph.levels()
        lights = response.table(series.bits) / np.float32(photograph.exposure.value)
        for c in range(3):
            table = _Table.of(lights[c], response, photograph.exposure.value, darkest, brightest)
            for start in range(0, shape[0], _ROWS):
                rows = slice(start, start + _ROWS)
                z = levels[rows, :, c].astype(np.intp)
                total[rows, :, c] += _at(table.weighted, z)
                weights[rows, :, c] += _at(table.weight, z)
                held = fallback[rows, :, c]
                np.copyto(held, _at(table.limited, z), where=(z <= brightest) | (number == 0))
                if c == 1:
                    sums[rows] += _at(table.logarithm, z)
                    squares[rows] += _at(table.square, z)
        if number == 0:
            too_bright = np.asarray(levels > brightest)
        if number == count - 1:
            too_dark = np.asarray(levels < darkest)
        if progress is not None:
            progress((number + 1) / count)
    known = weights > 0.0
    mean = np.divide(total, weights, out=np.zeros_like(total), where=known)
    pixels = np.where(known, mean if response.is_linear else np.exp(mean), fallback)
    green, seen = weights[:, :, 1], known[:, :, 1]
    for part in (sums, squares):
        np.divide(part, green, out=part, where=seen)
    ends = response.table(series.bits)
    return Merged(
        pixels=pixels * np.float32(NOMINAL),
        saturated=np.any(too_bright, axis=2),
        dark=np.all(too_dark, axis=2),
        between=np.any(~known & ~too_bright & ~too_dark, axis=2),
        ghosts=seen & (squares - sums**2 > GHOST**2),
        most=float(NOMINAL * ends[:, brightest].min() / series.values[0]),
        least=float(NOMINAL * ends[1, darkest] / series.values[-1]),
    )


def _at(values: NDArray[np.float32], levels: NDArray[np.intp]) -> NDArray[np.float32]:
    """Values of a table by level; "clip", which never happens, spares the check of each index."""
    return np.take(values, levels, mode="clip")


def _limits(response: Response, bits: int) -> tuple[int, int]:
    """The darkest and the brightest reliable level of a file."""
    top = 2**bits - 1
    darkest = 3.0 * READING * top if response.is_linear else LOWEST / 255.0 * top
    return max(1, round(darkest)), round(HIGHEST / 255.0 * top)


@dataclass(frozen=True)
class _Table:
    """What each level of one picture adds, for one channel."""

    weight: NDArray[np.float32]
    weighted: NDArray[np.float32]
    """Weight times light, or times its logarithm."""
    logarithm: NDArray[np.float32]
    """Weight times the logarithm of light."""
    square: NDArray[np.float32]
    """Weight times its square."""
    limited: NDArray[np.float32]
    """Light, at most that of the brightest reliable level."""

    @classmethod
    def of(
        cls, light: NDArray[np.float32], response: Response, exposure: float, darkest: int, brightest: int
    ) -> _Table:
        x = light.astype(np.float64)
        level = np.arange(x.size)
        if response.is_linear:
            weight = exposure**2 / (PHOTONS * x * exposure + READING**2)
            weight = np.where((level >= darkest) & (level <= brightest), weight, 0.0)
        else:
            weight = hat(np.linspace(0.0, 255.0, x.size))
        # Levels without light have no weight either.
        ln = np.log(np.maximum(x, 1e-30))
        rows = (weight, weight * (x if response.is_linear else ln), weight * ln, weight * ln**2, x)
        made = [row.astype(np.float32) for row in rows]
        made[-1] = np.minimum(made[-1], made[-1][brightest])
        return cls(*made)
