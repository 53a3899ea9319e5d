"""Schedules: states by clock, weekday and month, or step by step from a table."""

from __future__ import annotations

import csv
import io
import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.annual.control.cut_off import nearest_state
from clerestory.counts import counted
from clerestory.trace.keys import suggestion

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from clerestory.annual.control.states import Operated
    from clerestory.weather import Weather
    from clerestory.weather.weather import Times

    States = NDArray[np.int64]

ALL = "all"
"""Column of a schedule that holds for all groups of windows."""
TIME = "time"
"""Column of a schedule that is compared with the weather's times."""
_STAMP = re.compile(r"(?:\d{4}-)?(\d{1,2})-(\d{1,2})[ T](\d{1,2}):(\d{2})(?::\d{2}(?:\.0*)?)?")

_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?", re.IGNORECASE)


@dataclass(frozen=True)
class Span:
    """Hours with one state."""

    state: int
    """Number of the state."""
    start: float = 0.0
    """Hour of the day at which they begin."""
    end: float = 24.0
    """Hour of the day at which they end; before `start` they go on past midnight."""
    weekdays: tuple[int, ...] = ()
    """Monday is 0; all by default. What goes on past midnight belongs to the day on which it is."""
    months: tuple[int, ...] = ()
    """1 to 12; all by default."""
    groups: tuple[int, ...] = ()
    """Numbers of groups of windows; all by default."""


def from_spans(spans: Sequence[Span], times: Times, groups: int) -> States:
    """States (groups, steps) by the first span that a step lies in; -1 where there is none.

    Parameters
    ----------
    spans
        In order.
    times
        Middle of each step (steps,) on the clock that people live by.
    groups
        How many groups of windows.
    """
    days = times.astype("datetime64[D]")
    hour = (times - days).astype("timedelta64[s]").astype(np.float64) / 3600.0
    weekday = (days.astype(np.int64) + 3) % 7  # 1970 began on a Thursday
    month = times.astype("datetime64[M]").astype(np.int64) % 12 + 1
    found = np.full((groups, len(times)), -1, dtype=np.int64)
    for span in spans:
        if span.start < span.end:
            inside = (hour >= span.start) & (hour < span.end)
        else:
            inside = (hour >= span.start) | (hour < span.end)
        if span.weekdays:
            inside &= np.isin(weekday, span.weekdays)
        if span.months:
            inside &= np.isin(month, span.months)
        for group in span.groups or range(groups):
            found[group, inside & (found[group] < 0)] = span.state
    return found


def read(
    path: Path,
    weather: Weather,
    states: Sequence[str],
    groups: Sequence[str],
    *,
    tilts_deg: Sequence[float | None] = (),
) -> States:
    """States (groups, steps) of a CSV or Parquet file with a row a step of the weather.

    A column bears the name of a group of windows, or `all`, and holds names of states, or angles of slats, for which
    the state with the nearest one is taken. A column `time`, if there is one, is compared with the weather's times.

    Parameters
    ----------
    path
        The file.
    weather
        Its steps.
    states, groups
        Their names.
    tilts_deg
        Angle of the slats in each state [°], where it has one.

    Raises
    ------
    ClerestoryError
        The table does not fit; the text names the row or column and the remedy.
    OSError
        The file cannot be read.
    """
    columns, lines = _columns(path)
    names = list(columns)
    known = [ALL, *groups]
    for name in names:
        if name not in (*known, TIME):
            raise ClerestoryError(f"column {name!r} is no group of windows ({suggestion(name, known)})")
    count = len(lines)
    if count != len(weather):
        less = "shorter" if count < len(weather) else "longer"
        raise ClerestoryError(
            f"{counted(count, 'row')} for {counted(len(weather), 'step')} of the weather: the schedule is {less} than "
            "the year (give a row a step)"
        )
    if TIME in columns:
        _check_times(columns[TIME], lines, weather)
    found = np.empty((len(groups), count), dtype=np.int64)
    for k, group in enumerate(groups):
        name = group if group in columns else ALL
        if name not in columns:
            raise ClerestoryError(f"there is no column for the group of windows {group!r} (add one, or {ALL})")
        numbers = {state: number for number, state in enumerate(states)}
        for row, text in enumerate(columns[name]):
            if text not in numbers:
                where = f"{lines[row]}, column {name}"
                if not _NUMBER.fullmatch(text):
                    raise ClerestoryError(f"{where}: no state {text!r} ({suggestion(text, states)})")
                try:
                    numbers[text] = nearest_state(float(text), tilts_deg)
                except ClerestoryError as error:
                    raise ClerestoryError(f"{where}: {text}: {error}") from None
            found[k, row] = numbers[text]
    return found


def text(weather: Weather, operated: Operated) -> str:
    """A schedule as a CSV file, which `read` takes."""
    made = io.StringIO()
    writer = csv.writer(made, lineterminator="\n")
    writer.writerow([TIME, *operated.groups])
    times = [str(t).replace("T", " ") for t in weather.times.astype("datetime64[s]")]
    names = np.array(operated.names)[operated.states]
    writer.writerows(zip(times, *names.tolist(), strict=True))
    return made.getvalue()


def _columns(path: Path) -> tuple[dict[str, list[str]], list[str]]:
    """Texts by the name of their column, and where each row is."""
    with path.open("rb") as stream:
        is_parquet = stream.read(4) == b"PAR1"
    if is_parquet:
        return _of_parquet(path)
    try:
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise ClerestoryError(f"byte {error.start}: not text in UTF-8 (save it as UTF-8)") from None
    try:
        rows = [(n + 1, row) for n, row in enumerate(csv.reader(io.StringIO(text))) if row and row[0][:1] != "#"]
    except csv.Error as error:
        raise ClerestoryError(f"it is no table: {error} (write it as CSV)") from None
    if not rows:
        raise ClerestoryError("it is empty (give a line of names, and a row a step)")
    names = [cell.strip() for cell in rows[0][1]]
    for k, name in enumerate(names):
        if name in names[:k]:
            raise ClerestoryError(f"column {name!r} is there twice (leave one out)")
    for line, row in rows[1:]:
        if len(row) != len(names):
            raise ClerestoryError(
                f"line {line}: {counted(len(row), 'cell')} for {counted(len(names), 'column')} (correct it)"
            )
    columns = {name: [row[k].strip() for _, row in rows[1:]] for k, name in enumerate(names)}
    return columns, [f"line {line}" for line, _ in rows[1:]]


def _of_parquet(path: Path) -> tuple[dict[str, list[str]], list[str]]:
    try:
        from pyarrow import lib, parquet
    except ImportError:
        raise ClerestoryError("reading Parquet needs pyarrow (pip install pyarrow, or write it as CSV)") from None
    try:
        table = parquet.read_table(path)
    except lib.ArrowException as error:
        raise ClerestoryError(
            f"it is not whole, or no Parquet file: {str(error).splitlines()[0]} (write it again)"
        ) from (error)
    columns = {str(name): [str(v) for v in table[name].to_pylist()] for name in table.column_names}
    return columns, [f"row {k + 1}" for k in range(table.num_rows)]


def _check_times(texts: Sequence[str], lines: Sequence[str], weather: Weather) -> None:
    """Every row has a time inside its step, or at its beginning or end; the year does not count."""
    half = weather.interval / 2.0 + 1e-3
    for k, text in enumerate(texts):
        parts = _STAMP.fullmatch(text.strip())
        if parts is None:
            raise ClerestoryError(f"{lines[k]}: time {text!r} is not understood (write such as 2001-02-21 14:30)")
        month, day, hour, minute = (int(part) for part in parts.groups())
        year = str(weather.times[k].astype("datetime64[Y]"))
        try:
            when = np.datetime64(f"{year}-{month:02d}-{day:02d}") + np.timedelta64(60 * hour + minute, "m")
        except ValueError:
            raise ClerestoryError(f"{lines[k]}: there is no day {day} of month {month} (correct it)") from None
        apart = abs((when - weather.times[k]) / np.timedelta64(1, "s")) / 3600.0
        # The end of a year's last step is the first moment of the next.
        if min(apart, abs(apart - 8760.0), abs(apart - 8784.0)) > half[k]:
            raise ClerestoryError(
                f"{lines[k]}: time {text.strip()} where the weather has {weather.words(k)}, the middle of its step "
                "(write the weather's times in standard time, or leave the column out)"
            )
