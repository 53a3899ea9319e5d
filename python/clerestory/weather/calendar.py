"""Days and clocks of weather: which year typical years are laid into, and hours in words."""

from __future__ import annotations

from itertools import groupby
from typing import TYPE_CHECKING

import numpy as np

from clerestory.counts import counted

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from clerestory.weather.weather import Times, Weather

COMMON_YEAR, LEAP_YEAR = 2001, 2000
"""Years that typical years are laid into."""
MONTHS = (
    "January",
    "February",
    "March",
    "April",
    "May",
    "June",
    "July",
    "August",
    "September",
    "October",
    "November",
    "December",
)
_SHOWN = 4


def is_leap(years: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Whether years (n,) have a 29 February."""
    leap: NDArray[np.bool_] = (years % 4 == 0) & ((years % 100 != 0) | (years % 400 == 0))
    return leap


def nominal(
    years: NDArray[np.int64], months: NDArray[np.int64], days: NDArray[np.int64], hours: NDArray[np.float64]
) -> Times:
    """Times (n,) of calendar days and hours since midnight [h]; a 29 February that a year lacks is put into 2000."""
    lacking = (months == 2) & (days == 29) & ~is_leap(years)
    years = np.where(lacking, LEAP_YEAR, years)
    month = (12 * (years - 1970) + months - 1).astype("datetime64[M]")
    day = month.astype("datetime64[D]") + (days - 1)
    times: Times = day.astype("datetime64[s]") + np.round(hours * 3600.0).astype("timedelta64[s]")
    return times


def laid_out(
    years: NDArray[np.int64] | None,
    months: NDArray[np.int64],
    days: NDArray[np.int64],
    hours: NDArray[np.float64],
) -> Times:
    """Times (n,) in the year of the records, if they go forward in it; else in one common or leap year."""
    if years is not None:
        times = nominal(years, months, days, hours)
        span = (times.max() - times.min()) / np.timedelta64(366 * 24 * 3600, "s")
        if span <= 1.0 or (len(times) > 1 and bool((np.diff(times) > np.timedelta64(0, "s")).all())):
            return times
    leap = bool(((months == 2) & (days == 29)).any())
    return nominal(np.full(len(months), LEAP_YEAR if leap else COMMON_YEAR), months, days, hours)


def intervals(times: Times) -> NDArray[np.float64]:
    """Lengths (n,) [h] of the intervals whose middles are given.

    Where all distances of neighbours are whole multiples of the commonest one, that is the length of all. Else an
    interval reaches half of the way to its neighbours, and no further than half of the commonest distance at a gap.
    """
    if len(times) < 2:
        return np.ones(len(times))
    apart = np.diff(times).astype("timedelta64[s]").astype(np.float64) / 3600.0
    forward = apart[apart > 0.0]
    if len(forward) == 0:
        return np.ones(len(times))
    values, counts = np.unique(np.round(forward, 3), return_counts=True)
    step = float(forward[np.isclose(forward, values[np.argmax(counts)], atol=1e-3)].mean())
    multiples = forward / step
    if np.abs(multiples - np.round(multiples)).max() < 0.02:
        return np.full(len(times), step if abs(step * 60 - round(step * 60)) > 0.02 else round(step * 60) / 60)
    halves = np.where((apart > 0.0) & (apart <= 1.5 * step), apart, step) / 2.0
    lengths: NDArray[np.float64] = np.concatenate([[halves[0]], halves]) + np.concatenate([halves, [halves[-1]]])
    return lengths


def stamp(time: np.datetime64) -> str:
    """Day and clock, such as 02-21 14:30."""
    return str(time.astype("datetime64[m]"))[5:].replace("T", " ")


def spells(weather: Weather, steps: Sequence[int] | NDArray[np.int64]) -> str:
    """Steps in words, neighbours together: `3 steps: 14 March 10:00 to 13:00`, from their begin to their end."""
    order = [int(k) for k in steps]
    runs = [[k for _, k in run] for _, run in groupby(enumerate(order), key=lambda pair: pair[1] - pair[0])]
    shown = "; ".join(_spell(weather, run[0], run[-1]) for run in runs[:_SHOWN])
    more = f"; and {counted(len(runs) - _SHOWN, 'more spell')}" if len(runs) > _SHOWN else ""
    return f"{counted(len(order), 'step')}: {shown}{more}"


def _spell(weather: Weather, first: int, last: int) -> str:
    half = (weather.interval * 1800.0).round().astype("timedelta64[s]")
    begin = weather.times[first] - half[first]
    # An end at midnight belongs to the day before.
    end = weather.times[last] + half[last]
    whole = (end - end.astype("datetime64[D]")) == np.timedelta64(0, "s")
    last_day = end.astype("datetime64[D]") - (1 if whole else 0)
    day, clock = _day(begin.astype("datetime64[D]")), _clock(begin)
    ending = "24:00" if whole else _clock(end)
    if last_day == begin.astype("datetime64[D]"):
        return f"{day} {clock} to {ending}"
    return f"{day} {clock} to {_day(last_day)} {ending}"


def _clock(time: np.datetime64) -> str:
    return str(time.astype("datetime64[m]"))[11:]


def _day(day: np.datetime64) -> str:
    _, month, number = str(day).split("-")
    return f"{int(number)} {MONTHS[int(month) - 1]}"
