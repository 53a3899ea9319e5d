"""Measured points over the projected hemisphere, coloured by value."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.patches import Circle

from clerestory.plot import disk, style
from clerestory.plot.measured.subject import scale_of, subject

if TYPE_CHECKING:
    from collections.abc import Iterable

    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.collections import PathCollection
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from clerestory.directions import Scatter, Side
    from clerestory.measure.scan import Scan


@style.styled
def points_figure(
    scans: Iterable[Scan],
    *,
    incident: tuple[float, float] | None = None,
    side: Side | None = None,
    scatter: Scatter | None = None,
    channel: str | None = None,
    label: str = "",
    scale: style.Scale = "log",
    quantity: style.Quantity = "bsdf",
    projection: disk.Projection = "polar",
    limits: tuple[float, float] | None = None,
) -> Figure:
    """The points that were measured, each in its colour; nothing is interpolated.

    Parameters
    ----------
    incident
        Angle to the normal and azimuth of the direction to the source [°]; may be left out if there is only one.
    side, scatter
        Where the light comes from and where it is seen; by default the first that there is.
    channel
        Name of a channel; the visible band, Y, or the first by default.
    label
        Whose data, for the title.
    scale
        Logarithmic over six decades at most, or linear.
    quantity
        `bsdf`, or `dsf` = BSDF·cos θ, both [1/sr].
    projection, limits
        As for `clerestory.plot.hemisphere`.

    Raises
    ------
    MissingDataError
        There is no such scan or channel.
    """
    of = subject(scans, incident=incident, side=side, scatter=scatter, channel=channel, label=label)
    values = of.values(quantity)
    norm = scale_of(values, scale, limits)
    ax = style.new_figure(6.0, 5.8 + 0.18 * of.title().count("\n")).add_subplot()
    marks = scatter_points(ax, of.scan.outgoing, values, norm, projection)
    disk.frame(ax, projection)
    handles: list[Artist] = [style.cross(ax, disk.project(of.through, projection), of.through_words)]
    if scale == "log" and of.below_words():
        handles += ax.plot([], [], linestyle="none", **BELOW, label=of.below_words())
    ax.set_title(of.title())
    bar = style.figure_of(ax).colorbar(marks, ax=ax, shrink=0.82, pad=0.02, extend=style.extend(values, norm))
    bar.set_label(style.UNITS[quantity])
    style.legend_below(
        ax,
        handles,
        f"measured points, light leaving to the {of.scan.side}, as seen from the room",
    )
    return style.figure_of(ax)


BELOW: dict[str, Any] = {
    "marker": "o",
    "markersize": 3.0,
    "markeredgewidth": 0.5,
    "markerfacecolor": "none",
    "color": "#b03060",
}
"""What a value without a logarithm looks like."""


def scatter_points(
    ax: Axes,
    outgoing: NDArray[np.float64],
    values: NDArray[np.float64],
    norm: Normalize,
    projection: disk.Projection,
    *,
    inches: float = 4.6,
) -> PathCollection:
    """Points on a disk so many inches wide, large where they are few, the strongest on top."""
    ax.set_aspect("equal")
    disk.limit(ax)
    ax.axis("off")
    ax.add_patch(Circle((0.0, 0.0), 1.0, facecolor="#f4f4f4", edgecolor="none", zorder=0))
    places = disk.project(outgoing, projection)
    # Points that filled the disk evenly would cover about half of it; a large scan of peaks keeps 0.8 points wide.
    width = np.clip(0.75 * 72.0 * inches / np.sqrt(max(len(values), 1)), 0.8, 9.0)
    below = (values <= 0.0) if norm.vmin is not None and norm.vmin > 0.0 else np.zeros(len(values), dtype=bool)
    if below.any():
        ax.plot(*places[below].T, linestyle="none", zorder=1.5, rasterized=len(values) > 2000, **BELOW)
    order = np.argsort(values[~below], kind="stable")
    shown = places[~below][order]
    return ax.scatter(
        shown[:, 0],
        shown[:, 1],
        s=width**2,
        c=values[~below][order],
        norm=norm,
        cmap=style.colours(),
        linewidths=0.0,
        zorder=1.6,
        rasterized=len(values) > 2000,
    )
