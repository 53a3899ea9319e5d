"""Falsecolour of the light that leaves into a hemisphere, lit from one direction."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import matplotlib.patheffects as effects
import numpy as np
from matplotlib.patches import Patch

from clerestory.directions import outgoing_in_words
from clerestory.plot import disk, style
from clerestory.plot.view import View

if TYPE_CHECKING:
    from collections.abc import Iterable

    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure
    from matplotlib.image import AxesImage
    from matplotlib.lines import Line2D
    from numpy.typing import ArrayLike, NDArray

    from clerestory.bsdf import Bsdf, Peak, Region
    from clerestory.directions import Scatter, Side


@style.styled
def hemisphere(
    bsdf: Bsdf,
    incident: int | ArrayLike,
    *,
    side: Side | None = None,
    scatter: Scatter = "transmission",
    band: str | None = None,
    label: str = "",
    scale: style.Scale = "log",
    quantity: style.Quantity = "bsdf",
    projection: disk.Projection = "polar",
    regions: Iterable[Region] = (),
    limits: tuple[float, float] | None = None,
    pixels: int = 720,
    ax: Axes | None = None,
) -> Figure:
    """Falsecolour of an outgoing hemisphere, as seen from the room.

    The scattered light is looked up at the centre of every pixel; nothing is interpolated. Peaks are not part of
    it: they are drawn as rings, with their value in the legend.

    Parameters
    ----------
    bsdf
        Data set.
    incident
        Number of a patch of Klems' full basis (from 1), or a direction (3,) toward the source.
    side
        Where a patch's light comes from: exterior by default.
    scatter
        Transmission or reflection.
    band
        Name of a band; visible, or the first, by default.
    label
        Name of the data set for the title.
    scale
        Logarithmic over four decades at most, or linear from 0.
    quantity
        `bsdf`, or `dsf` = BSDF·cos θ, both [1/sr].
    projection
        `polar`: the distance from the centre is the polar angle; `orthographic`: its sine, so that equal areas are
        equal projected solid angles.
    regions
        Cones, rings or sets of patches to outline; the share of the incident flux that goes there is in the legend.
    limits
        Ends of the colour scale [1/sr].
    pixels
        Width of the disk in pixels.
    ax
        Axes to draw on; a new figure by default.

    Raises
    ------
    MissingDataError
        The data set does not hold this component.
    """
    view = View.of(bsdf, incident, side=side, scatter=scatter, band=band, label=label)
    outgoing = disk.pixels(pixels, view.outgoing_side, projection)
    values = view.evaluate(outgoing, quantity)
    norm = style.norm(values, scale, limits)
    chosen, peaks = list(regions), view.peaks()
    if ax is None:
        lines = view.title.count("\n") + len(chosen) + len(peaks)
        ax = style.new_figure(6.0, 5.7 + 0.18 * lines).add_subplot()
    figure = style.figure_of(ax)
    image = paint(ax, values, norm)
    disk.frame(ax, projection)
    handles: list[Artist] = [style.cross(ax, disk.project(view.through, projection), view.through_words)]
    handles += mark_peaks(ax, peaks, projection)
    handles += disk.outlines(ax, chosen, view, projection)
    if np.isnan(values[np.isfinite(outgoing[..., 2])]).any():
        handles.append(missing_handle())
    ax.set_title(view.title)
    bar = figure.colorbar(image, ax=ax, shrink=0.82, pad=0.02, extend=style.extend(values, norm))
    bar.set_label(style.UNITS[quantity])
    style.legend_below(
        ax,
        handles,
        f"light leaving to the {view.outgoing_side}, as seen from the room",
    )
    return figure


def paint(ax: Axes, values: NDArray[np.float64], norm: Normalize) -> AxesImage:
    """The pixels of a disk, cut off at its edge."""
    ground = disk.prepare(ax)
    image = ax.imshow(
        values,
        origin="lower",
        extent=(-1.0, 1.0, -1.0, 1.0),
        interpolation="nearest",
        cmap=style.colours(),
        norm=norm,
        zorder=1,
    )
    image.set_clip_path(ground)
    disk.limit(ax)
    return image


def mark_peaks(ax: Axes, peaks: Iterable[Peak], projection: disk.Projection, *, size: float = 9.0) -> list[Line2D]:
    """Rings around the directions of peaks; they are no part of the colours."""
    marks = []
    for peak in peaks:
        (mark,) = ax.plot(
            *disk.project(peak.outgoing, projection),
            label=f"peak {style.figures(peak.value)}: {outgoing_in_words(peak.outgoing)}",
            **peak_style(size),
        )
        marks.append(mark)
    return marks


def peak_style(size: float) -> dict[str, Any]:
    """The ring that marks a peak."""
    return {
        "marker": "o",
        "markersize": size,
        "markerfacecolor": "none",
        "markeredgecolor": "#d00000",
        "markeredgewidth": 1.6,
        "linestyle": "none",
        "zorder": 7,
        "path_effects": [effects.withStroke(linewidth=3.2, foreground="white")],
    }


def missing_handle(label: str = "no data") -> Patch:
    """Legend for what is not known."""
    return Patch(label=label, **style.MISSING)
