"""Cuts through the plane of scattering: several sets of measured points on one axis."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.colors import LogNorm

from clerestory._core import ClerestoryError, MissingDataError
from clerestory.directions import outgoing_in_words
from clerestory.plot import style
from clerestory.plot.measured.subject import interpolation, scale_of, subject
from clerestory.plot.slices import in_plane
from clerestory.plot.view import component_words

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from matplotlib.axes import Axes
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from clerestory.directions import Scatter, Side
    from clerestory.measure.scan import Scan
    from clerestory.plot.measured.subject import Subject

    Floats = NDArray[np.float64]


@style.styled
def cut_figure(
    sets: Mapping[str, Sequence[Scan]],
    *,
    incident: tuple[float, float] | None = None,
    side: Side | None = None,
    scatter: Scatter | None = None,
    channel: str | None = None,
    scale: style.Scale = "log",
    quantity: style.Quantity = "bsdf",
    limits: tuple[float, float] | None = None,
    clip_deg: float = 5.0,
    azimuth_deg: float | None = None,
    aside_deg: float = 1.0,
) -> Figure:
    """BSDF along the plane that holds the incident direction and the normal, a line and dots for each set.

    Dots are points that were measured close to the plane; the line runs through the surface between all points, and
    is left out where nothing was measured or where the points are those of a line. Angles are positive on the side
    where light that goes straight on, or is mirrored, arrives.

    Parameters
    ----------
    sets
        Scans by label.
    azimuth_deg
        Azimuth of the plane's positive end as seen from the room [°]; by default that of light that goes straight on,
        and downward for light along the normal.
    aside_deg
        Points no farther from the plane than this [°] are dots.
    incident, side, scatter, channel, scale, quantity, limits, clip_deg
        As for `surface_figure`.

    Raises
    ------
    MissingDataError
        A set has no such scan or channel, or no points near the plane.
    """
    if not sets:
        raise ClerestoryError("no scans were given (give at least one set)")
    of = {
        name: subject(scans, incident=incident, side=side, scatter=scatter, channel=channel, label=name)
        for name, scans in sets.items()
    }
    first = next(iter(of.values()))
    azimuth = first.plane_azimuth_deg if azimuth_deg is None else azimuth_deg
    columns, rows = style.columns(of, 6.6)
    figure = style.new_figure(7.0, 4.3 + 0.19 * rows)
    ax = figure.add_subplot()
    every = []
    for n, (name, one) in enumerate(of.items()):
        alpha, dots = near_plane(one, azimuth, aside_deg, quantity, clip_deg)
        look = style.line(n)
        line = _line(one, azimuth, scale, quantity, clip_deg)
        if not len(dots) and line is None:
            raise MissingDataError(f"{name}: no points within {aside_deg:g}° of the plane (widen that)".lstrip(": "))
        if line is not None:
            ax.plot(line[0], line[1], label=name or None, **look)
            every.append(line[1])
        ax.plot(
            alpha,
            dots,
            marker=".",
            markersize=3.5,
            linestyle="none",
            color=look["color"],
            label=(name or None) if line is None else None,
            rasterized=len(dots) > 5000,
        )
        every.append(dots)
    together = np.concatenate(every)
    norm = scale_of(together, scale, limits)
    label_plane(ax, first, azimuth, norm, together, quantity, straight=azimuth_deg is None)
    component = component_words(first.scan.channels[0], first.scan.incident_side, first.scan.scatter)
    ax.set_title(f"{component}\nincident {first.incident_words}")
    if any(of):
        figure.legend(loc="outside lower center", ncols=columns)
    return figure


def label_plane(
    ax: Axes,
    one: Subject,
    azimuth_deg: float,
    norm: Normalize,
    values: Floats,
    quantity: style.Quantity,
    *,
    straight: bool,
) -> None:
    """Axes of a cut: angles from −90° to 90° with the ends in words, values on a scale, straight light dashed."""
    low, high = float(norm.vmin or 0.0), float(norm.vmax or 1.0)
    if isinstance(norm, LogNorm):
        ax.set_yscale("log", nonpositive="mask")
        ax.set_ylim(0.7 * low, 1.6 * high)
    else:
        ax.set_ylim(min(low, float(np.nanmin(values))), 1.06 * high)
    ax.set_ylabel(style.UNITS[quantity])
    if straight:
        at = float(np.degrees(np.arcsin(np.clip(np.hypot(*one.through[:2]), 0.0, 1.0))))
        ax.axvline(at, color="#909090", linewidth=0.8, linestyle=(0, (2, 2)), zorder=0)
    leaving = one.scan.side
    ends = [outgoing_in_words(in_plane(np.array(a), azimuth_deg, leaving)).split(",")[0] for a in (-45.0, 45.0)]
    ax.set_xlim(-90.0, 90.0)
    ticks = [f"−90\n{ends[0]}", "−60", "−30", "0", "30", "60", f"90\n{ends[1]}"]
    ax.set_xticks(np.arange(-90, 91, 30), ticks)
    ax.set_xlabel(f"angle to the normal [°], leaving to the {leaving}", labelpad=-8)
    ax.grid(visible=True)


def near_plane(
    one: Subject, azimuth_deg: float, aside_deg: float, quantity: style.Quantity, clip_deg: float
) -> tuple[Floats, Floats]:
    """Angles along the plane and values of the points close to it."""
    phi = np.radians(azimuth_deg)
    d = one.scan.outgoing
    away = np.degrees(np.arcsin(np.clip(np.abs(d @ [-np.sin(phi), np.cos(phi), 0.0]), 0.0, 1.0)))
    kept = (away <= aside_deg) & (one.scan.theta_deg <= 90.0 - clip_deg)
    along = np.degrees(np.arctan2(d @ [np.cos(phi), np.sin(phi), 0.0], np.abs(d[:, 2])))
    order = np.argsort(along[kept], kind="stable")
    return along[kept][order], one.values(quantity)[kept][order]


def _line(
    one: Subject, azimuth_deg: float, scale: style.Scale, quantity: style.Quantity, clip_deg: float
) -> tuple[Floats, Floats] | None:
    """Angles and values of the surface along the plane, NaN where not measured; None for points on one line."""
    from clerestory.measure.delaunay import NoSurfaceError, surface

    alpha = np.linspace(-90.0, 90.0, 3601)
    outgoing = in_plane(np.clip(alpha, -89.999, 89.999), azimuth_deg, one.scan.side)
    try:
        through = surface(one.scan, interpolated=interpolation(scale), clip_deg=clip_deg)
    except NoSurfaceError:
        return None
    return alpha, through.evaluate(outgoing, dsf=quantity == "dsf", extrapolate=False)[:, 0]
