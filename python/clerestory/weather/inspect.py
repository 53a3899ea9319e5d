"""What is missing, impossible or odd in weather, with its hours.

Limits are those by which a person would look twice; single hours of typical years, which are partly modelled, exceed
the usual ones of measured data.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory.counts import counted
from clerestory.finding import SEVERITIES, Finding, Severity
from clerestory.weather.calendar import spells

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from clerestory.weather.weather import Weather

SOLAR_CONSTANT = 1367.0
"""Irradiance outside of the atmosphere at the mean distance of the sun [W/m²], as Perez's model has it."""
SOLAR_ILLUMINANCE = 133_334.0
"""The same as illuminance [lx]."""
LIT = 5.0
"""Light below this [W/m²] is not worth a finding."""
TWILIGHT_DEG = 6.0
"""Angle of the sun below the horizon at which the sky is dark for Perez's model [°]."""
TURN_DEG = 7.5
"""Most that the sun's altitude changes in half an hour [°]."""
CLOSURE_SHARE, CLOSURE_LEAST, CLOSURE_ALTITUDE_DEG = 0.25, 50.0, 10.0
"""Global light may differ from its parts by this share, and by this much [W/m²], with a sun above this altitude [°]."""
EFFICACY = 110.0
"""Lumens of a watt of daylight, roughly, for limits of files with illuminances."""


def findings(weather: Weather) -> tuple[Finding, ...]:
    """Everything that a person should know, errors first."""
    found = [*weather.notes, *_missing(weather), *_light(weather), *_order(weather), *_extent(weather)]
    return tuple(sorted(found, key=lambda finding: SEVERITIES.index(finding.severity)))


def extraterrestrial(weather: Weather) -> NDArray[np.float64]:
    """Direct normal irradiance [W/m²], or illuminance [lx], outside of the atmosphere by step (n,) (Spencer 1971)."""
    a = 2.0 * np.pi * (weather.days_of_year - 1) / 365.0
    distance = 1.00011 + 0.034221 * np.cos(a) + 0.00128 * np.sin(a)
    distance += 0.000719 * np.cos(2 * a) + 0.000077 * np.sin(2 * a)
    made: NDArray[np.float64] = distance * (SOLAR_ILLUMINANCE if weather.illuminances else SOLAR_CONSTANT)
    return made


def _of(weather: Weather, severity: Severity, check: str, mask: NDArray[np.bool_], what: str, remedy: str) -> Finding:
    return Finding(severity, check, spells(weather, np.flatnonzero(mask)), what, remedy)


def _missing(weather: Weather) -> Iterator[Finding]:
    unknown = ~np.isfinite(weather.direct + weather.diffuse)
    if weather.is_missing.any():
        yield _of(
            weather,
            "error",
            "missing",
            weather.is_missing,
            "direct or diffuse light is missing while the sun is above the horizon",
            "fill short gaps: --fill-hours N, or weather.filled(N)",
        )
    night = unknown & ~weather.is_missing
    if night.any():
        yield _of(weather, "note", "missing", night, "light is missing at night, and taken as 0", "")
    if weather.dew_point is not None:
        dry = ~np.isfinite(weather.dew_point) & weather.is_daylight
        if dry.any() and not dry[weather.is_daylight].all():
            what = "the dew point is missing; that of 2 cm of water vapour is taken"
            yield _of(weather, "note", "dew-point", dry, what, "")


def _light(weather: Weather) -> Iterator[Finding]:
    altitude, _ = weather.sun_positions()
    direct, diffuse = np.nan_to_num(weather.direct), np.nan_to_num(weather.diffuse)
    unit, lit = ("lx", LIT * EFFICACY) if weather.illuminances else ("W/m²", LIT)
    above = direct > 1.02 * extraterrestrial(weather)
    if above.any():
        what = f"more direct light than outside of the atmosphere, up to {direct[above].max():.0f} {unit}"
        yield _of(weather, "warning", "extraterrestrial", above, what, "correct the file, or its units")
    too_light = diffuse > 1.02 * extraterrestrial(weather)
    if too_light.any():
        what = f"more diffuse light than the sun has above the atmosphere, up to {diffuse[too_light].max():.0f} {unit}"
        yield _of(weather, "warning", "extraterrestrial", too_light, what, "correct the file, or its units")
    # The middle of an hour of sunrise may be in twilight; its end is not.
    night = (altitude < -(TWILIGHT_DEG + TURN_DEG * weather.interval)) & (direct + diffuse > lit)
    if night.any():
        what = f"light up to {(direct + diffuse)[night].max():.0f} {unit} in the middle of the night; it is left out"
        remedy = "see whether place, time zone and the hours' names are right"
        yield _of(weather, "warning", "night", night, what, remedy)
    low = (altitude <= 0.0) & ~night & (direct > lit)
    if low.any():
        lost = float((direct * weather.interval)[low].sum())
        what = (
            f"direct light of {lost:.0f} {'lx·h' if weather.illuminances else 'Wh/m²'} in intervals whose middle is "
            "before sunrise or after sunset; the sun is not in their skies"
        )
        severity: Severity = "warning" if lost > 0.02 * float((direct * weather.interval).sum()) else "note"
        yield _of(
            weather, severity, "twilight", low, what, "see whether the hours' names are right" * (severity != "note")
        )
    alone = (altitude > 0.0) & (direct > lit) & (diffuse <= 0.0) & np.isfinite(weather.diffuse)
    if alone.any():
        what = f"direct light up to {direct[alone].max():.0f} {unit} without any of the sky; both are left out"
        yield _of(weather, "warning", "alone", alone, what, "correct the file")
    if weather.global_horizontal is not None:
        yield from _closure(weather, altitude, direct, diffuse, unit)


def _closure(
    weather: Weather,
    altitude: NDArray[np.float64],
    direct: NDArray[np.float64],
    diffuse: NDArray[np.float64],
    unit: str,
) -> Iterator[Finding]:
    total = np.asarray(weather.global_horizontal)
    parts = diffuse + direct * np.sin(np.radians(np.maximum(altitude, 0.0)))
    least = CLOSURE_LEAST * (EFFICACY if weather.illuminances else 1.0)
    apart = np.abs(total - parts) > np.maximum(CLOSURE_SHARE * np.maximum(total, parts), least)
    wrong = apart & (altitude > CLOSURE_ALTITUDE_DEG) & np.isfinite(total + weather.direct + weather.diffuse)
    if wrong.any():
        worst = float(np.abs(total - parts)[wrong].max())
        what = f"global light differs from direct and diffuse together by up to {worst:.0f} {unit}"
        yield _of(weather, "warning", "closure", wrong, what, "see whether time zone and the hours' names are right")


def _order(weather: Weather) -> Iterator[Finding]:
    _, first, counts = np.unique(weather.times, return_index=True, return_counts=True)
    twice = np.sort(first[counts > 1])
    if len(twice):
        where = spells(weather, twice)
        yield Finding("warning", "duplicate", where, "the step is there more than once", "correct the file")
    if (np.diff(weather.times) < np.timedelta64(0, "s")).any():
        back = np.flatnonzero(np.diff(weather.times) < np.timedelta64(0, "s")) + 1
        what = "the steps are not in the order of the year"
        yield Finding("warning", "order", spells(weather, back), what, "sort the file by time")
    if np.ptp(weather.interval) > 0.05 * weather.step:
        what = (
            f"steps are not evenly apart: intervals of {weather.interval.min() * 60:.0f} to "
            f"{weather.interval.max() * 60:.0f} min reach half of the way to their neighbours"
        )
        yield Finding("note", "uneven", "", what, "")


def _extent(weather: Weather) -> Iterator[Finding]:
    """Steps that a year lacks."""
    times = np.unique(weather.times)
    span = float((times[-1] - times[0]) / np.timedelta64(3600, "s")) + weather.step
    # Some files leave the nights out: days with any step are counted as there.
    days = len(np.unique(times.astype("datetime64[D]")))
    step = np.timedelta64(round(weather.step * 3600), "s")
    if days < 360 or span > 367 * 24:
        what = f"{counted(len(weather), 'step')} of {counted(days, 'day')}, not a year"
        yield Finding("note", "extent", "", what, "")
        yield from _gaps(weather, _within_days(times, step))
        return
    first = times[0].astype("datetime64[Y]").astype("datetime64[s]") + (times[0] - times[0].astype("datetime64[h]"))
    last = (times[0].astype("datetime64[Y]") + 1).astype("datetime64[s]")
    if times[-1] >= last:
        return  # a year that begins within one of the calendar
    every = np.arange(first, last, step)
    yield from _gaps(weather, every[~np.isin(every, times)])


def _within_days(times: NDArray[np.datetime64], step: np.timedelta64) -> NDArray[np.datetime64]:
    """Steps that are not there between the first and the last one of their day."""
    days = times.astype("datetime64[D]")
    lacking = [
        np.setdiff1d(np.arange(here[0], here[-1], step), here)
        for day in np.unique(days)
        for here in [times[days == day]]
    ]
    return np.concatenate(lacking)


def _gaps(weather: Weather, lacking: NDArray[np.datetime64]) -> Iterator[Finding]:
    if len(lacking) == 0:
        return
    made = _dark(weather, lacking)
    light = made.is_daylight
    if light.any():
        what = "the file has nothing for these daylight hours"
        yield Finding(
            "warning", "gap", spells(made, np.flatnonzero(light)), what, "take a whole file, or mind the sums"
        )
    if not light.all():
        count = int((~light).sum())
        what = f"{counted(count, 'step')} of the night {'is' if count == 1 else 'are'} not in the file"
        yield Finding("note", "nights", "", what, "")


def _dark(weather: Weather, times: NDArray[np.datetime64]) -> Weather:
    from clerestory.weather.weather import Weather

    zero = np.zeros(len(times))
    return Weather(weather.place, times, np.full(len(times), weather.step), zero, zero)
