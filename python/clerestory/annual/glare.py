"""Glare of an eye over a year without pictures.

What an eye sees of the windows are cells of the square of their directions, at the resolution that is asked for. Each
hour a cell has the sky's light through the system, the sun's at the data set's own resolution, and what the room
returns. Surfaces are seen in coarse pixels: they have the light of the windows' patches, and what beams of the sun
throw on them. The sun that is seen through a beam has its true luminance and size. The illuminance at the eye is the
sum of all that.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from clerestory import _core
from clerestory.picture import View
from clerestory.sky.settings import SOLAR_DIAMETER_DEG

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from clerestory.annual.sun import Eye
    from clerestory.glare import Settings

    Doubles = NDArray[np.float64]

SOLAR_SOLID_ANGLE = 2.0 * math.pi * (1.0 - math.cos(math.radians(SOLAR_DIAMETER_DEG / 2.0)))
"""Of the sun's disc [sr]."""


def rate(
    eye: Eye,
    windows: Doubles,
    surfaces: Doubles,
    straight: Doubles,
    suns: Doubles,
    illuminance: Doubles,
    chosen: NDArray[np.bool_],
    settings: Settings,
) -> dict[str, Doubles]:
    """Indices (chosen steps) by name; not a number where it is dark.

    Parameters
    ----------
    eye
        Who sees.
    windows, surfaces
        Luminances [cd/m²] of the cells of windows that the eye sees, and of its directions of surfaces (n, steps).
    straight
        What it sees of the sun [lx] on a plane that faces it (steps).
    suns
        Unit vectors (steps, 3) toward it.
    illuminance
        At the eye (steps) [lx].
    chosen
        Which of the steps are rated (steps).
    settings
        Of the evaluation.
    """
    view = View.fisheye(eye.point[0], eye.direction[0])
    lights = np.column_stack([suns, straight / SOLAR_SOLID_ANGLE, np.full(len(chosen), SOLAR_SOLID_ANGLE)])
    every = np.concatenate([windows[:, chosen], surfaces[:, chosen]]).T
    return dict(
        _core.rate_glare_hours(
            view._core,
            np.concatenate([eye.seen.direction.astype(np.float64), eye.directions]),
            np.concatenate([eye.seen.solid_angle.astype(np.float64), eye.solid_angles]),
            np.ascontiguousarray(every, dtype=np.float32),
            lights[chosen],
            illuminance[chosen],
            settings,
        )
    )
