"""Pictures of data sets.

Every picture is a function that returns a matplotlib figure, or draws on axes that are handed to it. `save` writes one
as PNG, PDF or SVG, and `render` gives the bytes. Directions are those of someone in the room: right is right and up is
up, for both sides of the sample.
"""

from clerestory.plot.close_up import close_up
from clerestory.plot.hemisphere import hemisphere
from clerestory.plot.hemisphere_grid import hemisphere_grid
from clerestory.plot.mountain import mountain
from clerestory.plot.patches import basis_patches, patches
from clerestory.plot.photometric_solid import photometric_solid
from clerestory.plot.slices import slices
from clerestory.plot.style import render, save
from clerestory.plot.transmittance_bars import transmittance_bars, transmittances
from clerestory.plot.transmittance_map import transmittance_map

__all__ = [
    "basis_patches",
    "close_up",
    "hemisphere",
    "hemisphere_grid",
    "mountain",
    "patches",
    "photometric_solid",
    "render",
    "save",
    "slices",
    "transmittance_bars",
    "transmittance_map",
    "transmittances",
]
