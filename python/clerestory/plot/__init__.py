"""Pictures of data sets.

Every function returns a matplotlib figure, or draws on axes that are handed to it; `save` writes one as PNG, PDF or
SVG. Directions are those of someone in the room: right is right and up is up, for both sides of the sample.
"""

from clerestory.plot.hemisphere import hemisphere
from clerestory.plot.hemisphere_grid import hemisphere_grid
from clerestory.plot.style import save
from clerestory.plot.transmittance_bars import transmittance_bars

__all__ = ["hemisphere", "hemisphere_grid", "save", "transmittance_bars"]
