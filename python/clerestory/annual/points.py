"""Irradiance at points: of patches, and with what comes directly from the windows at a finer resolution."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory.photometry import EFFICACY

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from clerestory.annual.arrivals import Light
    from clerestory.annual.cells import SeenWindows
    from clerestory.annual.matrices import Matrix

    Doubles = NDArray[np.float64]
    Floats = NDArray[np.float32]


class Lit:
    """Points in a room with one choice of systems.

    Parameters
    ----------
    view
        Of the points.
    once, whole
        What windows send (groups · patches, groups · patches), without and with what the room returns to them.
    seen
        What the points see of the windows; None for patches alone.
    """

    def __init__(self, view: Matrix, once: Floats, whole: Floats, seen: SeenWindows | None) -> None:
        self._all = view.all @ whole
        self._direct = view.direct @ once
        self._seen = seen

    def illuminance(self, light: Light) -> tuple[Floats, Floats]:
        """Of all light (steps, points) [lx], and of the sun's that has met nothing in the room."""
        found = (self._all @ light.arrives).astype(np.float64)
        if self._seen is None:
            return _in_lux(found), _in_lux((self._direct @ light.directly).astype(np.float64))
        cells = self._seen.light(light)
        by_sun = self._seen.irradiance_of_sun(light, cells)
        every = found - self._direct @ light.arrives + self._seen.from_cells(cells.sky) + by_sun
        return _in_lux(every), _in_lux(by_sun)


def _in_lux(irradiance: Doubles) -> Floats:
    """(steps, points) of (points, steps)."""
    lux: Floats = EFFICACY * np.maximum(irradiance, 0.0).T.astype(np.float32)
    return lux
