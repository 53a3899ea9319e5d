"""Mountains of measured points: the triangles between them as a surface over the projected hemisphere."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.colors import LogNorm

from clerestory.directions import angles
from clerestory.plot import style, surface
from clerestory.plot.measured.subject import interpolation, scale_of, subject

if TYPE_CHECKING:
    from collections.abc import Iterable

    from matplotlib.figure import Figure

    from clerestory.directions import Scatter, Side
    from clerestory.measure.scan import Scan

_MOST = 30_000
"""Points that are drawn; of more, the highest of each small cell."""


@style.styled
def mountain_figure(
    scans: Iterable[Scan],
    *,
    incident: tuple[float, float] | None = None,
    side: Side | None = None,
    scatter: Scatter | None = None,
    channel: str | None = None,
    label: str = "",
    scale: style.Scale = "log",
    quantity: style.Quantity = "bsdf",
    limits: tuple[float, float] | None = None,
    clip_deg: float = 5.0,
) -> Figure:
    """A surface over the projected hemisphere, as height and as colour, with a corner at every point.

    The base is the unit disk, right to the right and up to the back, as seen from the room; a direction stands at the
    sine of its polar angle.

    Parameters
    ----------
    incident, side, scatter, channel, label, scale, quantity, limits, clip_deg
        As for `surface_figure`.

    Raises
    ------
    MissingDataError
        There is no such scan or channel.
    ClerestoryError
        The points make no surface.
    """
    from clerestory.measure.delaunay import surface as through_points

    of = subject(scans, incident=incident, side=side, scatter=scatter, channel=channel, label=label)
    title = of.title(through_points(of.scan, clip_deg=clip_deg).integrate())
    shown = through_points(_thinned(of.scan), interpolated=interpolation(scale), clip_deg=clip_deg)
    places = shown.plane.points
    r2 = np.minimum((places**2).sum(axis=1), 1.0)
    base = 2.0 * places / (1.0 + r2)[:, None]
    values = np.exp(shown.values[:, 0]) if shown.interpolated == "log" else shown.values[:, 0]
    if quantity == "dsf":
        values = values * (1.0 - r2) / (1.0 + r2)
    norm = scale_of(of.values(quantity)[of.scan.theta_deg <= 90.0 - clip_deg], scale, limits)
    low, high = float(norm.vmin or 0.0), float(norm.vmax or 1.0)
    log = isinstance(norm, LogNorm)
    heights = np.log10(np.maximum(values, low)) if log else np.maximum(values, low)
    floor, top = (np.log10(low), np.log10(high)) if log else (low, high)
    ax = surface.add_axes(style.new_figure(7.0, 6.1 + 0.2 * title.count("\n")))
    ax.view_init(elev=32, azim=-68)
    surface.circles(ax, floor)
    corners = np.column_stack([base, heights])[shown.plane.simplices[shown.measured_triangles]]
    faces = np.max(values[shown.plane.simplices[shown.measured_triangles]], axis=1)
    surface.draw_triangles(ax, corners, faces, norm, zorder=2, height=(top - floor) / surface.HEIGHT)
    x, y, _ = of.through
    dashes = (0, (4, 3))
    handles = ax.plot(
        [x, x], [y, y], [floor, top], color=style.INK, linewidth=0.9, linestyle=dashes, zorder=3, label=of.through_words
    )
    surface.dress(ax, norm, floor, top, style.UNITS[quantity])
    ax.set_title(title)
    bar = style.figure_of(ax).colorbar(
        style.mappable(norm), ax=ax, shrink=0.6, pad=0.08, extend=style.extend(values, norm)
    )
    bar.set_label(style.UNITS[quantity])
    style.legend_below(
        ax,
        handles,
        f"light leaving to the {of.scan.side}; base as seen from the room, circles at 30°, 60° and 90°",
        low=0.03,
    )
    return style.figure_of(ax)


def _thinned(scan: Scan) -> Scan:
    """The highest point of each cell of a fine grid, so that peaks stay, if there are too many to draw."""
    if len(scan) <= _MOST:
        return scan
    from dataclasses import replace

    theta, phi = angles(scan.outgoing)
    width, kept = 0.25, np.arange(len(scan))
    while len(kept) > _MOST:
        ring = np.floor(theta / width)
        around = np.floor(phi * np.sin(np.radians((ring + 0.5) * width)) / width)
        order = np.lexsort((-scan.values[:, 0], around, ring))
        first = np.ones(len(order), dtype=bool)
        first[1:] = (np.diff(ring[order]) != 0) | (np.diff(around[order]) != 0)
        kept, width = np.sort(order[first]), 1.25 * width
    return replace(scan, theta_deg=scan.theta_deg[kept], phi_deg=scan.phi_deg[kept], values=scan.values[kept])
