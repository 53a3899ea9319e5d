"""The surface through measured points, in falsecolour."""

from __future__ import annotations

from typing import TYPE_CHECKING

from clerestory.plot import disk, style
from clerestory.plot.hemisphere import missing_handle, paint
from clerestory.plot.measured.subject import interpolation, scale_of, subject

if TYPE_CHECKING:
    from collections.abc import Iterable

    from matplotlib.artist import Artist
    from matplotlib.figure import Figure

    from clerestory.directions import Scatter, Side
    from clerestory.measure.scan import Scan


@style.styled
def surface_figure(
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
    clip_deg: float = 5.0,
    pixels: int = 540,
) -> Figure:
    """Falsecolour of Delaunay's triangles between the points; what was not measured is hatched.

    Parameters
    ----------
    clip_deg
        Points closer to the horizon than this [°] are left out: their BSDF is noise over a small cosine.
    pixels
        Width of the disk.
    incident, side, scatter, channel, label, scale, quantity, projection, limits
        As for `points_figure`.

    Raises
    ------
    MissingDataError
        There is no such scan or channel.
    ClerestoryError
        The points make no surface.
    """
    from clerestory.measure.delaunay import surface

    of = subject(scans, incident=incident, side=side, scatter=scatter, channel=channel, label=label)
    through = surface(of.scan, interpolated=interpolation(scale), clip_deg=clip_deg)
    outgoing = disk.pixels(pixels, of.scan.side, projection)
    values = through.evaluate(outgoing, dsf=quantity == "dsf", extrapolate=False)[..., 0]
    norm = scale_of(of.values(quantity)[of.scan.theta_deg <= 90.0 - clip_deg], scale, limits)
    title = of.title(surface(of.scan, clip_deg=clip_deg).integrate())
    ax = style.new_figure(6.0, 5.9 + 0.18 * title.count("\n")).add_subplot()
    image = paint(ax, values, norm)
    disk.frame(ax, projection)
    handles: list[Artist] = [style.cross(ax, disk.project(of.through, projection), of.through_words)]
    handles.append(missing_handle("not measured"))
    ax.set_title(title)
    bar = style.figure_of(ax).colorbar(image, ax=ax, shrink=0.82, pad=0.02, extend=style.extend(values, norm))
    bar.set_label(style.UNITS[quantity])
    style.legend_below(
        ax,
        handles,
        f"between measured points, light leaving to the {of.scan.side}, as seen from the room",
    )
    return style.figure_of(ax)
