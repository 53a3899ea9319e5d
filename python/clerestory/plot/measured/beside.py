"""Measured points beside the model that was made of them: both over the hemisphere, and in the plane of scattering."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory.plot import disk, style
from clerestory.plot.hemisphere import missing_handle, paint
from clerestory.plot.measured.cut import label_plane, near_plane
from clerestory.plot.measured.points import scatter_points
from clerestory.plot.measured.subject import scale_of, subject
from clerestory.plot.slices import in_plane
from clerestory.plot.view import View

if TYPE_CHECKING:
    from collections.abc import Iterable

    from matplotlib.figure import Figure

    from clerestory.bsdf import Bsdf
    from clerestory.directions import Scatter, Side
    from clerestory.measure.scan import Scan


@style.styled
def beside_figure(
    scans: Iterable[Scan],
    bsdf: Bsdf,
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
    azimuth_deg: float | None = None,
    aside_deg: float = 1.0,
    pixels: int = 400,
) -> Figure:
    """Points as they were measured, the model in the same colours, and a cut with the points near its plane.

    Parameters
    ----------
    bsdf
        A data set whose bands are the scans' channels.
    incident, side, scatter, channel, label, scale, quantity, limits, clip_deg, azimuth_deg, aside_deg
        As for `cut_figure`.
    pixels
        Width of the model's disk.

    Raises
    ------
    MissingDataError
        There is no such scan, channel or band.
    """
    of = subject(scans, incident=incident, side=side, scatter=scatter, channel=channel, label=label)
    scan = of.scan
    # A data set of one band may call it otherwise than the instrument does.
    band = scan.channels[0] if len(bsdf.bands) > 1 or scan.channels[0] in bsdf.bands else None
    view = View.of(bsdf, scan.incident, scatter=scan.scatter, band=band)
    kept = scan.theta_deg <= 90.0 - clip_deg
    norm = scale_of(of.values(quantity)[kept], scale, limits)
    title = of.title()
    figure = style.new_figure(7.4, 6.6 + 0.16 * title.count("\n"))
    grid = figure.add_gridspec(2, 2, height_ratios=[1.25, 1.0])
    left, right = (figure.add_subplot(grid[0, c]) for c in range(2))
    scatter_points(left, scan.outgoing[kept], of.values(quantity)[kept], norm, "polar", inches=2.7)
    shown = disk.pixels(pixels, scan.side, "polar")
    painted = np.where(np.abs(shown[..., 2:]) >= np.sin(np.radians(clip_deg)), shown, np.nan)
    values = view.evaluate(painted, quantity)
    paint(right, values, norm)
    for ax, name in ((left, "measured"), (right, "model")):
        disk.frame(ax, "polar", small=True)
        style.cross(ax, disk.project(of.through, "polar"), size=5.0)
        ax.set_title(name, fontsize=9)
    bar = figure.colorbar(
        style.mappable(norm), ax=[left, right], shrink=0.86, pad=0.02, extend=style.extend(values, norm)
    )
    bar.set_label(style.UNITS[quantity])
    ax = figure.add_subplot(grid[1, :])
    azimuth = of.plane_azimuth_deg if azimuth_deg is None else azimuth_deg
    alpha = np.linspace(clip_deg - 90.0, 90.0 - clip_deg, 1441)
    outgoing = in_plane(np.clip(alpha, -89.999, 89.999), azimuth, scan.side)
    line = view.evaluate(outgoing, quantity)
    along, dots = near_plane(of, azimuth, aside_deg, quantity, clip_deg)
    ax.plot(
        along, dots, ".", markersize=4.0, color=style.COLOURS[1], label=f"measured, within {aside_deg:g}° of the plane"
    )
    ax.plot(alpha, line, color=style.COLOURS[0], label="model")
    label_plane(ax, of, azimuth, norm, np.concatenate([line, dots]), quantity, straight=azimuth_deg is None)
    ax.legend(loc="best")
    figure.suptitle(title, fontsize=10)
    figure.legend(
        handles=[missing_handle(f"closer than {clip_deg:g}° to the horizon: left out")] if clip_deg > 0.0 else [],
        loc="outside lower center",
        title=f"light leaving to the {scan.side}, as seen from the room",
        title_fontsize=8,
    )
    return figure
