"""Glare of an eye over a year without pictures.

What an eye sees of the windows are cells of the square of their directions, at the resolution that is asked for. Each
hour a cell has the sky's light through the system, the sun's at the data set's own resolution, and what the room
returns; the sun that is seen through a beam is a source of its own, with its true luminance and size, and what it
lights in the room can be a source. The illuminance at the eye is that of the five-phase method; other surfaces of the
room count in it, and are no sources.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from clerestory import _core
from clerestory.picture import View
from clerestory.sky.model import SOLAR_DIAMETER_DEG

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from clerestory.annual.sun import Eye, SunSeen
    from clerestory.glare import Settings

    Doubles = NDArray[np.float64]
    Floats = NDArray[np.float32]

SOLAR_SOLID_ANGLE = 2.0 * math.pi * (1.0 - math.cos(math.radians(SOLAR_DIAMETER_DEG / 2.0)))
"""Of the sun's disc [sr]."""


def rate(
    eye: Eye,
    numbers: NDArray[np.int64],
    luminances: Floats,
    sun: SunSeen,
    illuminance: Doubles,
    chosen: NDArray[np.bool_],
    settings: Settings,
) -> dict[str, Doubles]:
    """Indices (chosen steps) by name; not a number where it is dark.

    Parameters
    ----------
    eye
        Who sees.
    numbers, luminances
        Of cells, and their luminances (cells, steps) [cd/m²].
    sun
        What the eye sees of the sun [lx, cd/m²].
    illuminance
        At the eye (steps) [lx].
    chosen
        Which of the steps are rated (steps).
    settings
        Of the evaluation.
    """
    seen = luminances[np.searchsorted(numbers, eye.seen.number)]
    in_windows = eye.seen.projected @ seen + sun.straight * np.maximum(sun.directions @ eye.direction[0], 0.0)
    around = np.maximum(illuminance - in_windows, 0.0) / np.pi
    # A sunlit surface has the room's light besides the sun's.
    surfaces = np.where(sun.surfaces > 0.0, sun.surfaces + around, 0.0)
    view = View.fisheye(eye.point[0], eye.direction[0])
    lights = np.column_stack(
        [sun.directions, sun.straight / SOLAR_SOLID_ANGLE, np.full(len(chosen), SOLAR_SOLID_ANGLE)]
    )
    every = np.concatenate([seen[:, chosen], surfaces[:, chosen]]).T
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
