"""Weather files: EPW and WEA."""

from __future__ import annotations

import csv
import io
import math
import re
from dataclasses import dataclass, field
from datetime import datetime
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from clerestory._core import ClerestoryError, FileFormatError
from clerestory.counts import counted
from clerestory.sky.model import Sky
from clerestory.sky.position import Method, Place, SunPosition

if TYPE_CHECKING:
    import os
    from collections.abc import Iterator

    from numpy.typing import NDArray

_DAYS = (31, 29, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31)
_MISSING_IRRADIANCE, _MISSING_DEW_POINT = 9999.0, 99.9
_WEA_KEYS = ("place", "latitude", "longitude", "time_zone", "site_elevation", "weather_data_file_units")
_NO_YEAR = 2001  # a year of 365 days, for the sun of files that name none


@dataclass(frozen=True)
class WeatherHour:
    """One step of a weather file."""

    month: int
    day: int
    hour: float
    """Middle of the interval on the file's clock, 0 to 24."""
    direct: float
    """Direct normal irradiance [W/m²] or illuminance [lx]."""
    diffuse: float
    """Diffuse horizontal irradiance [W/m²] or illuminance [lx]."""
    dew_point: float | None
    """[°C], if the file has it."""
    year: int | None
    """Year of the record; typical years are put together from several."""
    line: int
    """Line in the file."""

    @property
    def words(self) -> str:
        """Day and clock, such as 02-21 14:30."""
        minutes = round(self.hour * 60.0)
        return f"{self.month:02d}-{self.day:02d} {minutes // 60:02d}:{minutes % 60:02d}"


@dataclass(frozen=True)
class Weather:
    """A weather file."""

    place: Place
    """Where; its clock has no daylight saving."""
    elevation: float
    """Above the sea [m]."""
    illuminances: bool
    """Whether direct and diffuse are illuminances [lx] rather than irradiances [W/m²]."""
    hours: tuple[WeatherHour, ...]
    """Steps whose light is known, in the file's order."""
    step: float
    """Length of a step [h]."""
    warnings: tuple[str, ...] = field(default=())
    """What was left out, and why."""

    def __len__(self) -> int:
        """Number of steps whose light is known."""
        return len(self.hours)

    def __iter__(self) -> Iterator[WeatherHour]:
        return iter(self.hours)

    @property
    def direct(self) -> NDArray[np.float64]:
        """Direct normal irradiance or illuminance of all steps."""
        return np.array([hour.direct for hour in self.hours])

    @property
    def diffuse(self) -> NDArray[np.float64]:
        """Diffuse horizontal irradiance or illuminance of all steps."""
        return np.array([hour.diffuse for hour in self.hours])

    def at(self, when: str) -> WeatherHour:
        """The step that a time such as `02-21 14:00` lies in; it may be the beginning of the step.

        Raises
        ------
        ClerestoryError
            The text is not a time, or the file has nothing then.
        """
        found = re.fullmatch(r"(?:\d{4}-)?(\d{1,2})-(\d{1,2})[ T](\d{1,2}):(\d{2})", when.strip())
        if found is None:
            raise ClerestoryError(f"time {when!r} is not understood (give month, day and time: 02-21 14:00)")
        month, day, hour, minute = (int(part) for part in found.groups())
        clock = hour + minute / 60.0
        if not (1 <= month <= 12 and 1 <= day <= _DAYS[month - 1] and clock <= 24.0 and minute < 60):
            raise ClerestoryError(f"time {when!r} does not exist (give month, day and time: 02-21 14:00)")
        for row in self.hours:
            if (row.month, row.day) == (month, day) and -1e-6 <= clock - row.hour + self.step / 2.0 < self.step - 1e-6:
                return row
        days = {(row.month, row.day) for row in self.hours}
        if (month, day) in days:
            raise ClerestoryError(f"there is no step of the file at {when} (see its lines of that day)")
        first, last = min(days), max(days)
        raise ClerestoryError(
            f"there is no step of the file on {month:02d}-{day:02d} (it reaches from {first[0]:02d}-{first[1]:02d} to "
            f"{last[0]:02d}-{last[1]:02d})"
        )

    def sun(self, hour: WeatherHour, *, method: Method = "spa") -> SunPosition:
        """The sun in the middle of a step."""
        year = hour.year or _NO_YEAR
        if (hour.month, hour.day) == (2, 29) and not (year % 4 == 0 and (year % 100 != 0 or year % 400 == 0)):
            year = 2000
        minutes = hour.hour * 60.0
        seconds = round(minutes * 60.0) % 86400
        when = datetime(
            year, hour.month, hour.day, seconds // 3600, seconds % 3600 // 60, seconds % 60, tzinfo=self.place.zone
        )
        return SunPosition.at(self.place, when, method=method)

    def sky(self, hour: WeatherHour | str, *, method: Method | None = None, **common: Any) -> Sky:  # noqa: ANN401
        """Perez's sky of a step.

        Parameters
        ----------
        hour
            A step, or a time such as 02-21 14:00.
        method
            How the sun is found, see `SunPosition.at`; by default as the preset's programs find it.
        **common
            See `Sky`. The dew point is the file's, if it has one.

        Raises
        ------
        ClerestoryError
            It is night.
        """
        row = self.at(hour) if isinstance(hour, str) else hour
        if method is None:
            method = "spa" if common.get("preset", "clerestory") == "clerestory" else "radiance"
        sun = self.sun(row, method=method)
        if row.diffuse <= 0.0:
            raise ClerestoryError(
                f"line {row.line}: no light of the sky at {row.words}, sun {sun.words} (choose another time)"
            )
        if row.dew_point is not None and common.get("preset") != "radiance-matrix":
            common.setdefault("dew_point", row.dew_point)
        if self.illuminances:
            return Sky.perez(sun, direct_illuminance=row.direct, diffuse_illuminance=row.diffuse, **common)
        return Sky.perez(sun, direct=row.direct, diffuse=row.diffuse, **common)


def read_weather(path: str | os.PathLike[str]) -> Weather:
    """Read a weather file, EPW or WEA, by its content.

    Raises
    ------
    FileFormatError
        The file is neither, or a line of it is faulty; the text has the line's number.
    OSError
        The file cannot be read.
    """
    path = Path(path)
    text = path.read_bytes().decode("utf-8-sig", errors="replace")
    try:
        if text.lstrip()[:9].upper().startswith("LOCATION,"):
            return _read_epw(text)
        if text.lstrip()[:5].lower().startswith("place"):
            return _read_wea(text)
    except FileFormatError as error:
        raise FileFormatError(f"{path}: {error}") from error
    raise FileFormatError(
        f"{path}: line 1: neither LOCATION of an EPW file nor place of a WEA file (give one of those)"
    )


def _number(text: str, what: str, line: int) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise FileFormatError(f"line {line}: {what} is {text.strip()!r}, not a number (correct it)")
    return value


def _date(month: float, day: float, line: int) -> tuple[int, int]:
    if not (month == int(month) and 1 <= month <= 12 and day == int(day) and 1 <= day <= _DAYS[int(month) - 1]):
        raise FileFormatError(f"line {line}: there is no day {day:g} of month {month:g} (correct it)")
    return int(month), int(day)


def _place(latitude: float, longitude: float, zone: float, name: str, line: int) -> Place:
    try:
        return Place(latitude, longitude, zone, name)
    except ClerestoryError as error:
        raise FileFormatError(f"line {line}: {error}") from error


def _omitted(lines: list[int], what: str) -> list[str]:
    if not lines:
        return []
    shown = ", ".join(str(line) for line in lines[:5]) + (", …" if len(lines) > 5 else "")
    plural = "s" if len(lines) > 1 else ""
    return [f"{counted(len(lines), 'step')} left out, {what} (line{plural} {shown})"]


def _read_epw(text: str) -> Weather:
    rows = list(csv.reader(io.StringIO(text)))
    head = rows[0]
    if len(head) < 10:
        raise FileFormatError(f"line 1: LOCATION has {len(head)} fields instead of 10 (is the file whole?)")
    latitude, longitude, zone, elevation = (
        _number(head[k], what, 1) for k, what in ((6, "latitude"), (7, "longitude"), (8, "time zone"), (9, "elevation"))
    )
    place = _place(latitude, longitude, zone, head[1].strip(), 1)
    step = 1.0
    for row in rows[:8]:
        if row and row[0].strip().upper() == "DATA PERIODS" and len(row) > 2:
            step = 1.0 / max(1.0, _number(row[2], "records an hour", 8))
    hours: list[WeatherHour] = []
    missing: list[int] = []
    for line, row in enumerate(rows[8:], start=9):
        if not any(cell.strip() for cell in row):
            continue
        if len(row) < 16:
            raise FileFormatError(f"line {line}: {counted(len(row), 'field')} instead of 35 (is the file whole?)")
        year, month, day, hour, minute, dew_point, direct, diffuse = (
            _number(row[k], what, line)
            for k, what in (
                (0, "year"),
                (1, "month"),
                (2, "day"),
                (3, "hour"),
                (4, "minute"),
                (7, "dew point"),
                (14, "direct normal irradiance"),
                (15, "diffuse horizontal irradiance"),
            )
        )
        month_, day_ = _date(month, day, line)
        if not 1.0 <= hour <= 24.0:
            raise FileFormatError(f"line {line}: hour {hour:g} is not 1 to 24 (correct it)")
        if min(direct, diffuse) < 0.0:
            raise FileFormatError(f"line {line}: an irradiance of {min(direct, diffuse):g} W/m² (correct it)")
        if max(direct, diffuse) >= _MISSING_IRRADIANCE:
            missing.append(line)
            continue
        # An hour is named by its end; several records an hour by their minutes, which are their ends, too.
        middle = hour - 0.5 if step == 1.0 else hour - 1.0 + minute / 60.0 - step / 2.0
        known = None if dew_point >= _MISSING_DEW_POINT else dew_point
        hours.append(WeatherHour(month_, day_, middle % 24.0, direct, diffuse, known, int(year), line))
    if not hours:
        raise FileFormatError("no step has both irradiances (take a file with sunshine data)")
    warnings = _omitted(missing, "their direct normal or diffuse horizontal irradiance is missing")
    return Weather(place, elevation, illuminances=False, hours=tuple(hours), step=step, warnings=tuple(warnings))


def _read_wea(text: str) -> Weather:
    lines = text.splitlines()
    start = next(k for k, content in enumerate(lines) if content.strip())
    head: dict[str, str] = {}
    for k, key in enumerate(_WEA_KEYS, start=start):
        word, _, rest = lines[k].strip().partition(" ") if k < len(lines) else ("", "", "")
        if word.lower() != key:
            raise FileFormatError(
                f"line {k + 1}: {word!r} instead of {key} (WEA files begin with {', '.join(_WEA_KEYS)})"
            )
        head[key] = rest.strip()
    values = {key: _number(head[key], key, start + 2 + k) for k, key in enumerate(_WEA_KEYS[1:])}
    units = values["weather_data_file_units"]
    if units not in (1, 2, 3):
        raise FileFormatError(
            f"line {start + 6}: weather_data_file_units {units:g} is not known (1: W/m², 2: direct horizontal, 3: lx)"
        )
    # The file counts degrees west, of the place and of its clock's meridian.
    place = _place(values["latitude"], -values["longitude"], -values["time_zone"] / 15.0, head["place"], start + 2)
    hours: list[WeatherHour] = []
    missing: list[int] = []
    for line, content in enumerate(lines[start + 6 :], start=start + 7):
        cells = content.split()
        if not cells:
            continue
        if len(cells) < 5:
            raise FileFormatError(f"line {line}: {counted(len(cells), 'value')} instead of 5 (is the file whole?)")
        names = ("month", "day", "hour", "the first value", "the second value")
        month, day, hour, direct, diffuse = (
            _number(cell, what, line) for cell, what in zip(cells, names, strict=False)
        )
        month_, day_ = _date(month, day, line)
        if not 0.0 <= hour <= 24.0:
            raise FileFormatError(f"line {line}: hour {hour:g} is not 0 to 24 (correct it)")
        if min(direct, diffuse) < 0.0 or (units != 3 and max(direct, diffuse) >= _MISSING_IRRADIANCE):
            missing.append(line)
            continue
        hours.append(WeatherHour(month_, day_, hour % 24.0, direct, diffuse, None, None, line))
    if not hours:
        raise FileFormatError("it has no steps (is the file whole?)")
    step = _step(hours)
    warnings = _omitted(missing, "their light is missing")
    weather = Weather(
        place,
        values["site_elevation"],
        illuminances=units == 3,
        hours=tuple(hours),
        step=step,
        warnings=tuple(warnings),
    )
    return _direct_normal(weather) if units == 2 else weather


def _step(hours: list[WeatherHour]) -> float:
    """The commonest distance of lines of a day [h]."""
    gaps = [
        round(b.hour - a.hour, 4)
        for a, b in pairwise(hours)
        if (a.month, a.day) == (b.month, b.day) and b.hour > a.hour
    ]
    return max(set(gaps), key=gaps.count) if gaps else 1.0


def _direct_normal(weather: Weather) -> Weather:
    """Direct horizontal irradiances as normal ones, by the sun in the middle of each step."""
    made, low = [], []
    for hour in weather.hours:
        direct = hour.direct
        if direct > 0.0:
            sine = math.sin(math.radians(weather.sun(hour).altitude_deg))
            if sine < 0.01:
                low.append(hour.line)
                continue
            direct /= sine
        made.append(WeatherHour(hour.month, hour.day, hour.hour, direct, hour.diffuse, None, None, hour.line))
    warnings = _omitted(low, "their direct horizontal irradiance has no sun above the horizon")
    return Weather(
        weather.place,
        weather.elevation,
        illuminances=False,
        hours=tuple(made),
        step=weather.step,
        warnings=(*weather.warnings, *warnings),
    )
