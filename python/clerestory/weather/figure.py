"""The year in a picture: direct and diffuse light by day and hour, and their sums by month."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory.plot import style
from clerestory.plot.carpet import SunHours, carpet
from clerestory.sky.position import spa
from clerestory.weather.calendar import MONTHS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from clerestory.weather.weather import Weather

_SAMPLES = 72


def sun_hours(weather: Weather) -> SunHours:
    """Sunrise and sunset, the sun's centre without refraction, of all days of the weather, in its standard time."""
    days = np.unique(weather.times.astype("datetime64[D]"))
    hours = np.arange(_SAMPLES + 1) * 24.0 / _SAMPLES
    local = days[:, None].astype("datetime64[s]") + np.round(hours * 3600.0).astype("timedelta64[s]")
    universal = local - np.timedelta64(round(weather.time_zone * 3600.0), "s")
    height = np.sin(np.radians(spa(weather.place, universal.ravel())[0])).reshape(local.shape)
    before, after = height[:, :-1], height[:, 1:]
    # Between two samples the sine of the altitude is nearly straight.
    crossing = hours[:-1] + (hours[1] - hours[0]) * before / (before - after)
    rises = np.where((before < 0.0) & (after >= 0.0), crossing, np.nan)
    sets = np.where((before >= 0.0) & (after < 0.0), crossing, np.nan)
    return SunHours(days, _first(rises), _first(sets))


def _first(crossings: NDArray[np.float64]) -> NDArray[np.float64]:
    """The first time of each day that is not NaN."""
    found = np.isfinite(crossings)
    which = np.argmax(found, axis=1)
    return np.where(found.any(axis=1), crossings[np.arange(len(crossings)), which], np.nan)


@style.styled
def year(weather: Weather) -> Figure:
    """Direct normal and diffuse horizontal light by day and hour, with sunrise and sunset, and their monthly sums."""
    unit, sums, scale = ("lx", "klx·h a day", 1e3) if weather.illuminances else ("W/m²", "kWh/m²", 1e3)
    kind = "illuminance" if weather.illuminances else "irradiance"
    figure = style.new_figure(8.6, 7.0)
    axes = figure.subplots(3, 1, height_ratios=(1.0, 1.0, 0.62))
    sun = sun_hours(weather)
    for ax, values, name in (
        (axes[0], weather.direct, f"direct normal {kind}"),
        (axes[1], weather.diffuse, f"diffuse horizontal {kind}"),
    ):
        norm = style.norm(values, "linear")
        mesh = carpet(ax, weather.times, values, weather.step, norm, sun=sun)
        bar = figure.colorbar(mesh, ax=ax, pad=0.015, aspect=14)
        bar.set_label(f"[{unit}]")
        ax.set_title(name, loc="left")
        ax.set_ylabel("standard time")
    _months(axes[2], weather, sums, scale)
    place = weather.place
    north = f"{abs(place.latitude):.2f}° {'N' if place.latitude >= 0 else 'S'}"
    east = f"{abs(place.longitude):.2f}° {'E' if place.longitude >= 0 else 'W'}"
    figure.suptitle(
        f"{place.name or weather.source}: {north}, {east}, {weather.elevation:.0f} m, UTC{weather.time_zone:+g}",
        x=0.01,
        ha="left",
        fontsize=11,
    )
    return figure


def _months(ax: Axes, weather: Weather, unit: str, scale: float) -> None:
    months = weather.months - 1
    sine = np.sin(np.radians(np.maximum(weather.sun_positions()[0], 0.0)))
    direct, diffuse = np.nan_to_num(weather.direct), np.nan_to_num(weather.diffuse)
    days = np.ones(12)
    if weather.illuminances:
        days = np.array([len(np.unique(weather.days[months == m])) or 1 for m in range(12)], dtype=np.float64)
    for k, (name, values) in enumerate(
        (("direct normal", direct), ("diffuse horizontal", diffuse), ("global horizontal", diffuse + direct * sine))
    ):
        total = np.bincount(months, values * weather.interval, minlength=12) / scale / days
        ax.bar(np.arange(12) + 0.27 * (k - 1), total, 0.25, color=style.COLOURS[k], label=name, hatch=style.HATCHES[k])
    ax.set_xticks(np.arange(12), [name[:3] for name in MONTHS])
    ax.tick_params(axis="x", length=0)
    ax.set_xlim(-0.6, 11.6)
    ax.set_ylabel(f"[{unit}]")
    ax.set_title("monthly sums" if not weather.illuminances else "means of the months", loc="left")
    ax.grid(axis="y")
    ax.set_axisbelow(True)
    for edge in ("top", "right"):
        ax.spines[edge].set_visible(False)
    ax.margins(y=0.15)
    ax.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=3)
