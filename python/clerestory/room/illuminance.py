"""Illuminance at sensors."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.photometry import EFFICACY, LUMINANCE

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from clerestory import _core

LEAST, MOST = 256, 1 << 24
"""Paths a sensor: of the first run, and at most."""


@dataclass(frozen=True)
class Illuminance:
    """Illuminance at points."""

    points: NDArray[np.float64]
    """(n, 3) [m]."""
    normals: NDArray[np.float64]
    """(n, 3)."""
    values: NDArray[np.float64]
    """(n,) [lx]."""
    standard_errors: NDArray[np.float64]
    """(n,) [lx]."""
    irradiance: NDArray[np.float64]
    """(n, 3) [W/m²] of Radiance's channels."""
    samples: int
    """Paths a sensor."""


def measure(
    room: _core.Room,
    points: NDArray[np.float64],
    normals: NDArray[np.float64],
    *,
    error: float,
    samples: int | None,
    seed: int,
    progress: Callable[[float], object] | None,
) -> Illuminance:
    """Illuminance of a room at points (n, 3) along normals (n, 3); see `Room.illuminance`."""
    points = np.ascontiguousarray(points, dtype=np.float64)
    normals = np.ascontiguousarray(normals, dtype=np.float64)
    if points.ndim != 2 or points.shape[1:] != (3,) or points.shape != normals.shape or not len(points):
        raise ClerestoryError(f"points {points.shape} and normals {normals.shape} do not fit (give (n, 3) of each)")
    if samples is not None and not 1 <= samples <= MOST:
        raise ClerestoryError(f"{samples} paths a sensor cannot be (give 1 to {MOST})")
    if not 0.0 < error < 1.0:
        raise ClerestoryError(f"an error of {error:g} is not one to reach (give 0.01 for one per cent)")
    # Sixteen replications give the errors.
    paths = LEAST if samples is None else 16 * max(math.ceil(samples / 16), 1)
    while True:
        last = samples is not None or paths >= MOST
        values, errors = room.irradiance(points, normals, paths, seed, progress if last else None)
        lux = EFFICACY * values @ LUMINANCE
        # The channels share their paths, so that their errors add up.
        lux_errors = EFFICACY * errors @ LUMINANCE
        reached = float(np.sqrt(np.mean(lux_errors**2)) / max(lux.mean(), 1e-12))
        if last or reached <= error or lux.mean() == 0.0:
            if progress is not None:
                progress(1.0)
            return Illuminance(points, normals, lux, lux_errors, values, paths)
        if progress is not None:
            progress(min((error / reached) ** 2, 1.0))
        # Errors fall with the square root of the paths; a little more, so that the next run is the last.
        wanted = paths * min(1.2 * (reached / error) ** 2, 64.0)
        paths = min(int(np.ceil(max(wanted, 2 * paths) / 16.0)) * 16, MOST)
