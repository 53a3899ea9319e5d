"""A measured peak from near by, in arc-minutes, with its points."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError, MissingDataError
from clerestory.counts import counted
from clerestory.directions import direction, outgoing_in_words
from clerestory.plot import style
from clerestory.plot.close_up import around, axes_at, offset
from clerestory.plot.hemisphere import missing_handle
from clerestory.plot.measured.subject import interpolation, scale_of, subject

if TYPE_CHECKING:
    from collections.abc import Iterable

    from matplotlib.artist import Artist
    from matplotlib.figure import Figure

    from clerestory.directions import Scatter, Side
    from clerestory.measure.scan import Scan

_CELLS = 300
_SCALES: tuple[style.Scale, style.Scale] = ("linear", "log")


@style.styled
def close_up_figure(
    scans: Iterable[Scan],
    *,
    centre: tuple[float, float] | None = None,
    half_width_arcmin: float | None = None,
    incident: tuple[float, float] | None = None,
    side: Side | None = None,
    scatter: Scatter | None = None,
    channel: str | None = None,
    label: str = "",
    quantity: style.Quantity = "bsdf",
    limits: tuple[float, float] | None = None,
) -> Figure:
    """The surroundings of an outgoing direction in arc-minutes, linear and logarithmic side by side.

    Dots are the points that were measured, the ring is where the value is half of the largest; the width of a circle
    of its area is in the legend.

    Parameters
    ----------
    centre
        Angle to the normal and azimuth of the outgoing direction in the middle [°]; the highest point by default.
    half_width_arcmin
        Half the width of the picture [arc-minutes]; by default two and a half widths of the peak.
    incident, side, scatter, channel, label, quantity, limits
        As for `points_figure`.

    Raises
    ------
    MissingDataError
        There is no such scan or channel, or no point in the picture.
    ClerestoryError
        The width is not possible, or the points make no surface.
    """
    from clerestory.measure.delaunay import surface

    if half_width_arcmin is not None and not 0.1 <= half_width_arcmin <= 5400.0:
        raise ClerestoryError(f"a close-up of ±{half_width_arcmin:g}' is not possible (give 0.1 to 5400)")
    of = subject(scans, incident=incident, side=side, scatter=scatter, channel=channel, label=label)
    linear = surface(of.scan, clip_deg=0.0)
    highest = int(np.argmax(of.values(quantity)))
    outgoing = of.scan.outgoing
    middle = outgoing[highest] if centre is None else direction(*centre, side=of.scan.side)
    right, up = axes_at(middle)
    half = half_width_arcmin or _fitting(of.scan, of.values(quantity), middle)
    offsets = (np.arange(_CELLS) + 0.5 - _CELLS / 2) * (2.0 * half / _CELLS)
    grid = around(middle, right, up, offsets / 60.0)
    near = np.flatnonzero(outgoing @ middle > np.cos(np.radians(min(1.5 * half / 60.0, 90.0))))
    at = np.array([offset(outgoing[n], middle, right, up) for n in near]).reshape(-1, 2) * 60.0
    shown = np.abs(at).max(axis=1) <= half if len(at) else np.zeros(0, dtype=bool)
    if not shown.any():
        raise MissingDataError(f"no point was measured within {half:g}' of the centre (widen the picture)")
    of_points = of.values(quantity)[near][shown]
    figure = style.new_figure(10.2, 4.9 + 0.18 * of.title().count("\n"))
    panels = list(figure.subplots(1, 2, squeeze=False).flat)
    figure.suptitle(of.title(), fontsize=9.5)
    handles: list[Artist] = []
    for panel, kind in zip(panels, _SCALES, strict=True):
        through = linear if kind == "linear" else surface(of.scan, interpolated=interpolation(kind), clip_deg=0.0)
        values = through.evaluate(grid, dsf=quantity == "dsf", extrapolate=False)[..., 0]
        norm = scale_of(np.concatenate([of_points, values[np.isfinite(values)]]), kind, limits)
        image = style.square_image(panel, values, half, norm)
        size = float(np.clip(60.0 / np.sqrt(shown.sum()), 0.7, 3.5))
        handles = panel.plot(
            *at[shown].T,
            linestyle="none",
            marker=".",
            markersize=size,
            color="#ff7f50",
            label=counted(int(shown.sum()), "point"),
            rasterized=bool(shown.sum() > 2000),
        )
        top = float(of_points.max())
        if top > 0.0 and np.nanmin(values) < 0.5 * top < np.nanmax(values):
            panel.contour(offsets, offsets, values, levels=[0.5 * top], colors=["white"], linewidths=1.1)
            if kind == "linear":
                cell = (2.0 * half / _CELLS) ** 2
                width = 2.0 * np.sqrt(cell * float((values >= 0.5 * top).sum()) / np.pi)
                rim = np.concatenate([values[0], values[-1], values[:, 0], values[:, -1]])
                whole = not (np.nan_to_num(rim, nan=np.inf) >= 0.5 * top).any()
                said = f": {width:.3g}' wide" if whole else ", beyond the picture"
                kept_ring = panel.plot([], [], color="#909090", linewidth=1.1, label=f"half of the largest{said}")
            handles += kept_ring
        place = offset(of.through, middle, right, up) * 60.0
        if np.all(np.abs(place) <= half):
            handles.append(style.cross(panel, place, of.through_words))
        if np.isnan(values).any():
            handles.append(missing_handle("not measured"))
        bar = figure.colorbar(image, ax=panel, shrink=0.85, pad=0.02, extend=style.extend(values, norm))
        bar.set_label(f"{style.UNITS[quantity]}, {'logarithmic' if kind == 'log' else 'linear'}")
        panel.set(xlabel="to the right [arc-minutes]", ylabel="upward [arc-minutes]")
        panel.set(xlim=(-half, half), ylim=(-half, half))
    words = f"around {outgoing_in_words(middle)}, leaving to the {of.scan.side}, as seen from the room"
    figure.legend(handles=handles, loc="outside lower center", title=words, ncols=2)
    return figure


def _fitting(scan: Scan, values: np.ndarray, middle: np.ndarray) -> float:
    """Half a width [arc-minutes] that shows the peak at a direction and its feet."""
    away = 60.0 * np.degrees(np.arccos(np.clip(scan.outgoing @ middle, -1.0, 1.0)))
    top = float(values[np.argmin(away)])
    lower = away[values < 0.5 * top]
    # The nearest point that is lower than half ends the peak.
    radius = float(lower.min()) if lower.size else 600.0
    return float(np.clip(5.0 * radius, 1.0, 1800.0))
