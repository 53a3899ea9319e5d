"""Pictures of measured points.

Each takes scans (`clerestory.measure.Scan`) and returns a matplotlib figure. Those of one incident direction put its
scans together, such as a coarse one of the hemisphere and fine ones of its peaks. Directions are those of someone in
the room.
"""

from clerestory.plot.measured.beside import beside_figure
from clerestory.plot.measured.close_up import close_up_figure
from clerestory.plot.measured.cut import cut_figure
from clerestory.plot.measured.mountain import mountain_figure
from clerestory.plot.measured.overview import overview_figure
from clerestory.plot.measured.points import points_figure
from clerestory.plot.measured.surface import surface_figure

__all__ = [
    "beside_figure",
    "close_up_figure",
    "cut_figure",
    "mountain_figure",
    "overview_figure",
    "points_figure",
    "surface_figure",
]
