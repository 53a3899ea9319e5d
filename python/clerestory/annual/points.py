"""Irradiance at points: of patches, and with what comes directly from the windows at a finer resolution."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory.photometry import EFFICACY

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from clerestory.annual.arrivals import Light
    from clerestory.annual.cells import CellLight, SeenWindows
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

    def irradiance(self, light: Light, cells: CellLight | None) -> tuple[Doubles, Doubles]:
        """(points, steps) of all light, and of the sun's that has met nothing in the room.

        `cells` is what the cells send that the points see, if they are seen by cells.
        """
        found = (self._all @ light.arrives).astype(np.float64)
        if self._seen is None or cells is None:
            return found, (self._direct @ light.directly).astype(np.float64)
        by_sun = self._seen.irradiance_of_sun(light, cells)
        return found - self._direct @ light.arrives + self._seen.from_cells(cells.sky) + by_sun, by_sun

    def illuminance(self, light: Light) -> tuple[Floats, Floats]:
        """The same as illuminance (steps, points) [lx]."""
        cells = None if self._seen is None else self._seen.light(light)
        both = (EFFICACY * np.maximum(e, 0.0).T.astype(np.float32) for e in self.irradiance(light, cells))
        every, direct = both
        return every, direct
