"""The response of a camera by Mitsunaga and Nayar: a polynomial.

T. Mitsunaga and S. Nayar (1999), "Radiometric self calibration", CVPR '99, section 4; the ratios of exposures are known
here and are not sought again.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.photo.response import HIGHEST, LEVELS, LOWEST

if TYPE_CHECKING:
    from numpy.typing import NDArray

HIGHEST_DEGREE = 8
"""The lowest degree up to this one is taken that lies within `SLACK` of the best."""
SLACK = 1.05


def logarithms(levels: NDArray[np.float64], exposures: NDArray[np.float64]) -> NDArray[np.float64]:
    """Logarithms of light (256,) by level, up to a constant; see `debevec.logarithms`.

    Raises
    ------
    ClerestoryError
        No degree gives a curve that rises.
    """
    x = levels / (LEVELS - 1.0)
    known = (levels >= LOWEST) & (levels <= HIGHEST)
    found: list[tuple[float, NDArray[np.float64]]] = []
    for degree in range(1, HIGHEST_DEGREE + 1):
        light = _rising(_fit(x, known, exposures, degree))
        if light is not None:
            found.append((_misfit(light, levels, known, exposures), light))
    if not found:
        raise ClerestoryError("no polynomial that rises fits the series (take --method debevec, or a better series)")
    best = min(error for error, _ in found)
    return np.log(next(light for error, light in found if error <= SLACK * best))


def _fit(
    x: NDArray[np.float64], known: NDArray[np.bool_], exposures: NDArray[np.float64], degree: int
) -> NDArray[np.float64]:
    """Coefficients, the constant first, that make f(x_j) − (t_j/t_k) f(x_k) small with f(1) = 1.

    Each row is divided by its light, estimated from the coefficients before, so that it is the relative misfit that
    becomes small.
    """
    powers = x[..., None] ** np.arange(degree + 1)
    rows, scales = [], []
    for j in range(len(exposures) - 1):
        both = known[:, j] & known[:, j + 1]
        rows.append(powers[both, j] - (exposures[j] / exposures[j + 1]) * powers[both, j + 1])
        scales.append(powers[both, j])
    d, at = np.concatenate(rows), np.concatenate(scales)
    if len(d) < degree + 1:
        raise ClerestoryError("too few spots are well exposed in two neighbours (take smaller steps of exposure)")
    coefficients = np.zeros(degree + 1)
    coefficients[min(2, degree)] = 1.0  # about what cameras do
    for _ in range(8):
        scale = 1.0 / np.maximum(at @ coefficients, 1e-3)
        # The last coefficient follows from f(1) = 1.
        a = (d[:, :-1] - d[:, -1:]) * scale[:, None]
        solved = np.linalg.lstsq(a, -d[:, -1] * scale, rcond=None)[0]
        coefficients = np.append(solved, 1.0 - solved.sum())
    return coefficients


def _rising(coefficients: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """Light by level, with a line through zero below the reliable levels; None where it falls among them."""
    x = np.arange(LEVELS) / (LEVELS - 1.0)
    light = np.polynomial.polynomial.polyval(x, coefficients)
    middle = slice(LOWEST, HIGHEST + 1)
    if light[LOWEST] <= 0.0 or (np.diff(light[middle]) <= 0.0).any():
        return None
    light[:LOWEST] = light[LOWEST] * np.maximum(x[:LOWEST], 0.25 / LEVELS) / x[LOWEST]
    light[HIGHEST:] = np.maximum.accumulate(light[HIGHEST:])
    return np.asarray(light, dtype=np.float64)


def _misfit(
    light: NDArray[np.float64], levels: NDArray[np.float64], known: NDArray[np.bool_], exposures: NDArray[np.float64]
) -> float:
    """Root mean square of the difference of logarithms between neighbours."""
    g = np.interp(levels, np.arange(LEVELS), np.log(light)) - np.log(exposures)
    both = known[:, 1:] & known[:, :-1]
    return float(np.sqrt(np.mean((g[:, 1:] - g[:, :-1])[both] ** 2)))
