"""Time stamps of tables: text, numbers by column, with a zone or without."""

from __future__ import annotations

import re
from dataclasses import dataclass
from datetime import datetime, timedelta, timezone
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import FileFormatError
from clerestory.weather import lines as of_line

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from clerestory.sky.position import Place

_FORMATS = ("%d.%m.%Y %H:%M", "%d.%m.%Y %H:%M:%S", "%Y/%m/%d %H:%M", "%Y/%m/%d %H:%M:%S")


@dataclass(frozen=True)
class Stamps:
    """Calendar of rows (n,), in standard time."""

    years: NDArray[np.int64] | None
    months: NDArray[np.int64]
    days: NDArray[np.int64]
    hours: NDArray[np.float64]
    """Since midnight [h], 24 at the end of a day."""


def read_stamps(columns: Mapping[str, Sequence[object]], lines: NDArray[np.int64], place: Place) -> Stamps:
    """The calendar of a table.

    Parameters
    ----------
    columns
        `time`; or `date` and `time`; or `month`, `day`, `hour` and, if there are, `minute` and `year`.
    lines
        Line of each row.
    place
        Times with a zone of their own are moved to its standard time.
    """
    numbers = lines.tolist()
    if "date" in columns and "time" in columns:
        pairs = zip(columns["date"], columns["time"], numbers, strict=True)
        return _stacked([_american(str(date), str(time), line) for date, time, line in pairs])
    if "time" in columns:
        zone = timezone(timedelta(hours=float(place.timezone)))
        return _stacked([_written(cell, zone, line) for cell, line in zip(columns["time"], numbers, strict=True)])
    if "date" in columns:
        zone = timezone(timedelta(hours=float(place.timezone)))
        return _stacked([_written(cell, zone, line) for cell, line in zip(columns["date"], numbers, strict=True)])
    lacking = [key for key in ("month", "day", "hour") if key not in columns]
    if lacking:
        raise FileFormatError(
            f"there is no column of times, and none of {lacking[0]} (name one: --column time=NAME, with times such as "
            "2021-02-21 14:00)"
        )
    made = {key: _column(columns[key], key, lines) for key in ("month", "day", "hour")}
    for month, day, hour, line in zip(*made.values(), numbers, strict=True):
        of_line.date(month, day, line)
        if not 0.0 <= hour <= 24.0:
            raise FileFormatError(f"line {line}: hour {hour:g} is not 0 to 24 (correct it)")
    minutes = _column(columns["minute"], "minute", lines) if "minute" in columns else np.zeros(len(lines))
    years = _column(columns["year"], "year", lines).astype(np.int64) if "year" in columns else None
    return Stamps(years, made["month"].astype(np.int64), made["day"].astype(np.int64), made["hour"] + minutes / 60.0)


def _column(cells: Sequence[object], name: str, lines: NDArray[np.int64]) -> NDArray[np.float64]:
    return np.array([of_line.number(str(c), name, line) for c, line in zip(cells, lines.tolist(), strict=True)])


def _stacked(rows: list[tuple[int, int, int, float]]) -> Stamps:
    years, months, days, hours = zip(*rows, strict=True)
    return Stamps(np.array(years), np.array(months), np.array(days), np.array(hours, dtype=np.float64))


def _american(date: str, time: str, line: int) -> tuple[int, int, int, float]:
    """Month/day/year and a clock that reaches to 24:00, as TMY3 has them."""
    found = re.fullmatch(r"(\d{1,2})/(\d{1,2})/(\d{4})", date.strip())
    clock = re.fullmatch(r"(\d{1,2}):(\d{2})(?::(\d{2}))?", time.strip())
    if found is None or clock is None:
        raise FileFormatError(
            f"line {line}: {date.strip()!r} {time.strip()!r} is not a time (give 02/21/2001 and 14:00)"
        )
    month, day, year = (int(part) for part in found.groups())
    of_line.date(month, day, line)
    hour = int(clock[1]) + int(clock[2]) / 60.0 + int(clock[3] or 0) / 3600.0
    if hour > 24.0:
        raise FileFormatError(f"line {line}: {time.strip()} is not a time of the day (correct it)")
    return year, month, day, hour


def _written(cell: object, zone: timezone, line: int) -> tuple[int, int, int, float]:
    """A time as text or as a date's object."""
    when = cell if isinstance(cell, datetime) else _parsed(str(cell).strip())
    if when is None:
        raise FileFormatError(f"line {line}: {cell!r} is not a time (write it as 2021-02-21 14:00)")
    if when.tzinfo is not None:
        when = when.astimezone(zone)
    seconds = when.hour * 3600 + when.minute * 60 + when.second
    return when.year, when.month, when.day, seconds / 3600.0


def _parsed(text: str) -> datetime | None:
    try:
        return datetime.fromisoformat(text)
    except ValueError:
        pass
    for form in _FORMATS:
        try:
            return datetime.strptime(text, form)
        except ValueError:
            continue
    return None
