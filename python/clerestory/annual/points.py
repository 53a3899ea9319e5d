"""Irradiance at points: of patches, and with what comes directly from the windows at a finer resolution."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory.photometry import EFFICACY

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from clerestory.annual.cells import CellLight, SeenWindows
    from clerestory.annual.matrices import Matrix
    from clerestory.weather import SkyYear

    Doubles = NDArray[np.float64]
    Floats = NDArray[np.float32]


@dataclass(frozen=True)
class Light:
    """What comes from outside at some steps."""

    sky: Floats
    """(patches of the sky, steps) radiance without the sun."""
    diffuse: Floats
    """(groups · patches, steps) radiance that arrives at windows, but for the sun's that has met nothing."""
    directly: Floats
    """(groups · patches, steps) the sun's that has met nothing, spread over patches."""
    suns: Doubles
    """(steps, 3) toward the sun."""
    irradiance: Doubles
    """(steps) of a plane that faces it."""

    @classmethod
    def of(cls, sky: SkyYear, daylight: Sequence[Matrix], steps: NDArray[np.int64]) -> Light:
        """Of steps of a year, by the daylight matrix of each group of windows."""
        by_sky = np.asarray(sky.columns(steps, part="sky"), dtype=np.float32)
        by_sun = np.asarray(sky.columns(steps, part="sun"), dtype=np.float32)
        return cls(
            sky=by_sky,
            diffuse=np.concatenate([d.all @ by_sky + (d.all - d.direct) @ by_sun for d in daylight]),
            directly=np.concatenate([d.direct @ by_sun for d in daylight]),
            suns=sky.suns.directions[steps],
            irradiance=sky.suns.irradiance[steps],
        )

    def part(self, steps: slice) -> Light:
        """Some of the steps."""
        sky, diffuse, directly = (array[:, steps] for array in (self.sky, self.diffuse, self.directly))
        return Light(sky, diffuse, directly, self.suns[steps], self.irradiance[steps])

    @property
    def steps(self) -> int:
        """How many."""
        return len(self.irradiance)

    @property
    def arrives(self) -> Floats:
        """(groups · patches, steps) all that arrives at windows."""
        return self.diffuse + self.directly


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
