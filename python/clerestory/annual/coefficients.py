"""Daylight coefficients: what each patch of the sky gives to a point through the windows as they stand.

Two phases: E = C s (Tregenza and Waters 1983, Lighting Research and Technology 15). The sun is spread over patches.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory.photometry import EFFICACY

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from clerestory.annual.arrivals import Arrivals, Light
    from clerestory.annual.cells import SeenWindows
    from clerestory.annual.matrices import Matrix

    Floats = NDArray[np.float32]


class Coefficients:
    """Of points in a room with one choice of systems.

    Parameters
    ----------
    arrivals
        What arrives at the windows.
    view
        Of the points.
    once, whole
        What windows send (groups · patches, groups · patches), without and with what the room returns to them.
    seen
        What the points see of the windows' cells.
    """

    def __init__(self, arrivals: Arrivals, view: Matrix, once: Floats, whole: Floats, seen: SeenWindows) -> None:
        daylight, directly = arrivals.matrix
        direct = view.direct @ once
        # What comes directly from a window is found by cells, and their beams show the patches of the sky themselves.
        cells = seen.sky.radiance(daylight, np.eye(daylight.shape[1], dtype=np.float32))
        self.all: Floats = ((view.all @ whole - direct) @ daylight + seen.from_cells(cells)).astype(np.float32)
        """(points, patches of the sky) irradiance by radiance [sr]."""
        self.direct: Floats = np.asarray(direct @ directly, dtype=np.float32)
        """The same of what has met nothing, in patches of the windows."""

    def illuminance(self, light: Light) -> tuple[Floats, Floats]:
        """(steps, points) [lx] of all light, and of the sun's that has met nothing in the room."""
        every, direct = self.all @ (light.sky + light.sun), self.direct @ light.sun
        every, direct = (EFFICACY * np.maximum(e, 0.0).T.astype(np.float32) for e in (every, direct))
        return every, direct
