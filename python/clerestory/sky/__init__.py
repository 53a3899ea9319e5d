"""Sky and sun: what a window receives, direction by direction.

The world has x east, y north and z up. Azimuths are compass azimuths: clockwise from north, 90° is east.
"""

from clerestory.sky.model import Sky, SkyTable, SunDisc
from clerestory.sky.patches import SkyPatches
from clerestory.sky.position import Place, SunPosition
from clerestory.sky.settings import PARTS, PRESETS, SkySettings

__all__ = [
    "PARTS",
    "PRESETS",
    "Place",
    "Sky",
    "SkyPatches",
    "SkySettings",
    "SkyTable",
    "SunDisc",
    "SunPosition",
]
