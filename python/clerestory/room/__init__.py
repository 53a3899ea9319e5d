"""Rooms with daylight: pictures and illuminance.

A room is described by a recipe (TOML): a rectangular room or files of shapes, windows with their systems, the sky,
views and sensors.

Examples
--------
>>> from clerestory import room
>>> office = room.load("office")
>>> office.windows[0].name
'south'
"""

from clerestory.room.illuminance import Illuminance
from clerestory.room.picture import Rendering
from clerestory.room.recipe import Recipe, View
from clerestory.room.shipped import names
from clerestory.room.state import State
from clerestory.room.world import Room, load

__all__ = ["Illuminance", "Recipe", "Rendering", "Room", "State", "View", "load", "names"]
