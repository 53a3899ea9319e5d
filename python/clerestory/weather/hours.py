"""Hours that count: of a working day, on a clock with or without daylight saving."""

from __future__ import annotations

import re
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import TYPE_CHECKING
from zoneinfo import ZoneInfo

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.sky.position import Place

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from clerestory.weather.weather import Times, Weather


@dataclass(frozen=True)
class Hours:
    """A selection of hours: 08:00 to 18:00 of every day, in standard time, unless something else is said.

    A step counts if its middle lies inside.
    """

    start: float = 8.0
    """Hour of the day at which they begin."""
    end: float = 18.0
    """Hour of the day at which they end."""
    weekdays: bool = False
    """Without Saturdays and Sundays. A typical year begins on the weekday of the year that it is laid into: 2001 on a
    Monday, 2000 on a Saturday."""
    daylight: bool = False
    """Only with the sun above the horizon in the middle of the step."""
    clock: str | tuple[str, str] | None = None
    """Clock that the people live by: an IANA name such as Europe/Vienna, whose daylight saving counts, or the first and
    last day of daylight saving, such as ("03-28", "10-30"). Standard time by default, as weather files have it."""

    def __post_init__(self) -> None:
        if not 0.0 <= self.start < self.end <= 24.0:
            raise ClerestoryError(
                f"hours from {self.start:g} to {self.end:g} are not part of a day (give 0 to 24, the earlier first)"
            )
        if isinstance(self.clock, str):
            Place(0.0, 0.0, self.clock)  # says what is wrong with a name
        elif self.clock is not None:
            for text in self.clock:
                _day(text)

    @classmethod
    def all_daylight(cls) -> Hours:
        """All hours with the sun above the horizon."""
        return cls(0.0, 24.0, daylight=True)

    @property
    def words(self) -> str:
        """In words, for titles."""
        parts = [] if (self.start, self.end) == (0.0, 24.0) else [f"{_clock(self.start)} to {_clock(self.end)}"]
        if self.weekdays:
            parts.append("Monday to Friday")
        if self.daylight:
            parts.append("daylight hours" if not parts else "sun above the horizon")
        if self.clock is not None and (self.start, self.end) != (0.0, 24.0):
            parts.append(f"clock of {self.clock}" if isinstance(self.clock, str) else "daylight saving time")
        return ", ".join(parts) or "all hours"

    def mask(self, weather: Weather) -> NDArray[np.bool_]:
        """Which steps of the weather count (n,)."""
        times = self.clock_times(weather)
        days = times.astype("datetime64[D]")
        hours = (times - days).astype("timedelta64[s]").astype(np.float64) / 3600.0
        chosen: NDArray[np.bool_] = (hours >= self.start) & (hours < self.end)
        if self.weekdays:
            chosen &= np.is_busday(days)
        if self.daylight:
            chosen &= weather.is_daylight
        return chosen

    def weights(self, weather: Weather) -> NDArray[np.float64]:
        """Hours that each step of the weather counts for (n,): the length of its interval, or 0."""
        return np.where(self.mask(weather), weather.interval, 0.0)

    def clock_times(self, weather: Weather) -> Times:
        """Middle of each interval (n,) on the clock that the people live by."""
        if self.clock is None:
            return weather.times
        if isinstance(self.clock, str):
            zone = ZoneInfo(self.clock)
            offsets = [
                datetime.fromtimestamp(second, UTC).astimezone(zone).utcoffset()
                for second in weather.utc.astype("datetime64[s]").astype(np.int64).tolist()
            ]
            seconds = [0 if offset is None else round(offset.total_seconds()) for offset in offsets]
            local: Times = weather.utc + np.array(seconds, dtype="timedelta64[s]")
            return local
        first, last = (_day(text) for text in self.clock)
        today = 100 * weather.months + weather.days
        # South of the equator it spans the turn of the year.
        inside = (today >= first) & (today <= last) if first <= last else (today >= first) | (today <= last)
        moved: Times = weather.times + np.where(inside, 3600, 0).astype("timedelta64[s]")
        return moved


def _day(text: str) -> int:
    found = re.fullmatch(r"(\d{1,2})-(\d{1,2})", text.strip())
    if found is None or not (1 <= int(found[1]) <= 12 and 1 <= int(found[2]) <= 31):
        raise ClerestoryError(f"day {text!r} is not understood (give month and day: 03-28)")
    return 100 * int(found[1]) + int(found[2])


def _clock(hour: float) -> str:
    minutes = round(hour * 60.0)
    return f"{minutes // 60:02d}:{minutes % 60:02d}"
