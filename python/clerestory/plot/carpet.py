"""Hours of a year as a carpet: a column a day, a row a time of day."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.ticker import FixedLocator, NullLocator

from clerestory._core import ClerestoryError
from clerestory.plot import style

if TYPE_CHECKING:
    from collections.abc import Mapping

    from matplotlib.axes import Axes
    from matplotlib.collections import QuadMesh
    from matplotlib.colors import Colormap, Normalize
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike, NDArray

FEW_DAYS = 60
"""So many days or fewer stand beside each other by name, without the days between them."""
_INITIALS = ("Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec")
_SUN_LINE: dict[str, Any] = {"color": "white", "linewidth": 0.9, "alpha": 0.9}


@dataclass(frozen=True)
class SunHours:
    """Sunrise and sunset of days."""

    days: NDArray[np.datetime64]
    """(m,)"""
    sunrise: NDArray[np.float64]
    """(m,) [h since midnight], NaN where the sun does not rise."""
    sunset: NDArray[np.float64]
    """(m,) [h since midnight], NaN where it does not set."""


def carpet(
    ax: Axes,
    times: NDArray[np.datetime64],
    values: ArrayLike,
    step: float,
    norm: Normalize,
    *,
    cmap: Colormap | None = None,
    sun: SunHours | None = None,
    hours: tuple[float, float] = (0.0, 24.0),
) -> QuadMesh:
    """Draws values by day and hour on axes.

    Parameters
    ----------
    times
        Middle of each interval (n,).
    values
        (n,); what is not finite, or was not given, stays grey.
    step
        Height of a row [h]; the mean of what falls into it is shown.
    norm, cmap
        The scale, and colours if not the usual ones.
    sun
        Lines of sunrise and sunset.
    hours
        Part of the day that is shown.
    """
    v = np.asarray(values, dtype=np.float64)
    if v.shape != times.shape:
        raise ClerestoryError(f"{v.shape} values do not go with {len(times)} times (give one each)")
    days = times.astype("datetime64[D]")
    hour = (times - days).astype("timedelta64[s]").astype(np.float64) / 3600.0
    columns, is_year = _columns(days)
    column = np.searchsorted(columns, days)
    rows = max(1, round(24.0 / step))
    row = np.minimum((hour / 24.0 * rows + 1e-9).astype(np.int64), rows - 1)
    known = np.isfinite(v)
    cell = (row * len(columns) + column)[known]
    count = np.bincount(cell, minlength=rows * len(columns))
    total = np.bincount(cell, v[known], minlength=rows * len(columns))
    with np.errstate(invalid="ignore", divide="ignore"):
        image = np.where(count > 0, total / count, np.nan).reshape(rows, len(columns))
    ax.set_facecolor(style.MISSING["facecolor"])
    mesh = ax.pcolormesh(
        np.arange(len(columns) + 1),
        np.linspace(0.0, 24.0, rows + 1),
        np.ma.masked_invalid(image),
        norm=norm,
        cmap=style.colours() if cmap is None else cmap,
        rasterized=True,
    )
    if sun is not None:
        for line in (sun.sunrise, sun.sunset):
            at = np.searchsorted(columns, sun.days)
            if is_year:
                ax.plot(at + 0.5, line, **_SUN_LINE)
            else:
                ax.hlines(line, at, at + 1, **_SUN_LINE)
    _label(ax, columns, hours, is_year=is_year)
    return mesh


@style.styled
def carpets(
    values: Mapping[str, ArrayLike],
    times: NDArray[np.datetime64],
    step: float,
    *,
    label: str,
    limits: tuple[float, float] | None = None,
    scale: style.Scale = "linear",
    sun: SunHours | None = None,
    hours: tuple[float, float] = (0.0, 24.0),
    title: str = "",
) -> Figure:
    """Carpets of several data sets on one scale.

    As figures 66, 67, 74 and 75 of the report of IEA SHC Task 61 (2021, C.2.2) show illuminance at the eye.

    Parameters
    ----------
    values
        By step (n,), by data set.
    times, step, sun, hours
        As for `carpet`.
    label
        What the values are, with their unit.
    limits, scale
        Of the colours, for all.
    title
        Of the picture.
    """
    if not values:
        raise ClerestoryError("no data set was given (give at least one)")
    every = np.concatenate([np.asarray(v, dtype=np.float64) for v in values.values()])
    norm = style.norm(every, scale, limits)
    across = 1 if len(values) == 1 else 2
    down = -(-len(values) // across)
    figure = style.new_figure(7.6 if across == 1 else 11.0, 0.5 + (3.0 if across == 1 else 1.75) * down)
    axes = figure.subplots(down, across, squeeze=False)
    for k, ax in enumerate(axes.ravel()):
        if k >= len(values):
            ax.set_axis_off()
            continue
        name, v = list(values.items())[k]
        carpet(ax, times, v, step, norm, sun=sun, hours=hours)
        ax.set_title(name, loc="left")
        if k % across:
            ax.set_yticklabels([])
    bar = figure.colorbar(style.mappable(norm), ax=axes, pad=0.015, shrink=0.95, extend=style.extend(every, norm))
    bar.set_label(label)
    if title:
        figure.suptitle(title, x=0.01, ha="left", fontsize=10)
    return figure


def _columns(days: NDArray[np.datetime64]) -> tuple[NDArray[np.datetime64], bool]:
    """Days of the columns: all from the first to the last, or those that there are if they are few."""
    there = np.unique(days)
    if len(there) <= FEW_DAYS:
        return there, False
    return np.arange(there[0], there[-1] + 1), True


def _label(ax: Axes, columns: NDArray[np.datetime64], hours: tuple[float, float], *, is_year: bool) -> None:
    span = hours[1] - hours[0]
    every = 6 if span > 14 else 2
    ax.set_ylim(*hours)
    ticks = [h for h in range(25) if hours[0] <= h <= hours[1] and h % every == 0]
    ax.set_yticks(ticks, [f"{h:02d}:00" for h in ticks])
    if is_year:
        firsts = np.flatnonzero(columns == columns.astype("datetime64[M]").astype("datetime64[D]"))
        edges = np.concatenate([[0], firsts[firsts > 0], [len(columns)]])
        middles = (edges[:-1] + edges[1:]) / 2.0
        months = columns[np.minimum(middles.astype(np.int64), len(columns) - 1)].astype("datetime64[M]")
        ax.xaxis.set_major_locator(FixedLocator(edges[1:-1].tolist()))
        ax.xaxis.set_minor_locator(FixedLocator(middles.tolist()))
        ax.set_xticks(edges[1:-1], [""] * len(edges[1:-1]))
        ax.set_xticks(middles, [_INITIALS[int(m.astype(np.int64) % 12)] for m in months], minor=True)
        ax.tick_params(axis="x", which="minor", length=0)
        return
    ax.xaxis.set_minor_locator(NullLocator())
    most = 10
    shown = range(0, len(columns), -(-len(columns) // most))
    names = [f"{int(str(columns[k])[8:])} {_INITIALS[int(str(columns[k])[5:7]) - 1]}" for k in shown]
    ax.set_xticks([k + 0.5 for k in shown], names)
