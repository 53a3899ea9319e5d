"""Mountains: the light that leaves as the height of a surface over the projected hemisphere."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.colors import LogNorm

from clerestory.directions import outgoing_in_words
from clerestory.plot import style, surface
from clerestory.plot.view import View

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from mpl_toolkits.mplot3d import Axes3D
    from numpy.typing import ArrayLike

    from clerestory.bsdf import Bsdf
    from clerestory.directions import Scatter, Side


@style.styled
def mountain(
    bsdf: Bsdf,
    incident: int | ArrayLike,
    *,
    side: Side | None = None,
    scatter: Scatter = "transmission",
    band: str | None = None,
    label: str = "",
    scale: style.Scale = "log",
    quantity: style.Quantity = "bsdf",
    limits: tuple[float, float] | None = None,
    step_deg: float = 1.5,
    ax: Axes3D | None = None,
) -> Figure:
    """A surface over the projected hemisphere, as height and as colour.

    The base is the unit disk, right to the right and up to the back, as seen from the room; a direction stands at
    the sine of its polar angle, so that equal areas are equal projected solid angles.

    Parameters
    ----------
    step_deg
        Step of the polar angle in the mean [°]; that of the azimuth is twice as wide.
    ax
        Axes made with `projection="3d"`; a new figure by default.
    bsdf, incident, side, scatter, band, label, scale, quantity, limits
        As for `hemisphere`.

    Raises
    ------
    MissingDataError
        The data set does not hold this component.
    """
    view = View.of(bsdf, incident, side=side, scatter=scatter, band=band, label=label)
    # Equal steps on the disk, so that the mesh is as fine where sines crowd as elsewhere.
    theta = np.arcsin(np.linspace(0.0, 1.0, round(90.0 / step_deg) + 1))
    directions = surface.grid(theta, round(180.0 / step_deg), view.outgoing_side)
    values = view.evaluate(directions, quantity)
    norm = style.norm(values, scale, limits)
    low, high = float(norm.vmin or 0.0), float(norm.vmax or 1.0)
    heights = np.log10(np.maximum(values, low)) if isinstance(norm, LogNorm) else values
    floor, top = (np.log10(low), np.log10(high)) if isinstance(norm, LogNorm) else (low, high)
    ax = ax or surface.add_axes(style.new_figure(7.0, 6.1 + 0.2 * (view.title.count("\n") + len(view.peaks()))))
    figure = style.figure_of(ax)
    ax.view_init(elev=32, azim=-68)
    surface.circles(ax, floor)
    faces = 0.25 * (values[:-1, :-1] + values[1:, :-1] + values[:-1, 1:] + values[1:, 1:])
    # Slopes are judged as they are drawn: the box is flatter than the values would have it.
    points = np.concatenate([directions[..., :2], heights[..., None]], axis=-1)
    surface.draw(ax, points, faces, norm, zorder=2, height=(top - floor) / surface.HEIGHT)
    x, y, _ = view.through
    handles = ax.plot(
        [x, x],
        [y, y],
        [floor, top],
        color=style.INK,
        linewidth=0.9,
        linestyle=(0, (4, 3)),
        zorder=3,
        label=view.through_words,
    )
    for peak in view.peaks():
        x, y, _ = peak.outgoing
        words = f"peak {style.figures(peak.value)}: {outgoing_in_words(peak.outgoing)}"
        handles += ax.plot([x, x], [y, y], [floor, top], color="#d00000", linewidth=1.8, zorder=3, label=words)
    surface.dress(ax, norm, floor, top, style.UNITS[quantity])
    ax.set_title(view.title)
    bar = figure.colorbar(style.mappable(norm), ax=ax, shrink=0.6, pad=0.08, extend=style.extend(values, norm))
    bar.set_label(style.UNITS[quantity])
    style.legend_below(
        ax,
        handles,
        f"light leaving to the {view.outgoing_side}; base as seen from the room, circles at 30°, 60° and 90°",
        low=0.03,
    )
    return figure
