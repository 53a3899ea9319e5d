"""Tables of weather: TMY3 and NSRDB files, and CSV or Parquet files with named columns."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

from clerestory._core import ClerestoryError, FileFormatError
from clerestory.counts import counted
from clerestory.finding import Finding
from clerestory.weather import lines as of_line
from clerestory.weather.calendar import intervals, laid_out
from clerestory.weather.stamps import Stamps, read_stamps
from clerestory.weather.wea import with_direct_normal
from clerestory.weather.weather import Weather

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from clerestory.sky.position import Place

Stamp = Literal["middle", "begin", "end"]
STAMPS: tuple[Stamp, ...] = ("middle", "begin", "end")

ALIASES: dict[str, tuple[str, ...]] = {
    "time": ("time", "datetime", "timestamp", "date time", "date/time", "time stamp", "index"),
    "date": ("date",),
    "year": ("year",),
    "month": ("month",),
    "day": ("day",),
    "hour": ("hour",),
    "minute": ("minute",),
    "dni": ("dni", "direct normal", "direct normal irradiance", "direct normal radiation", "bni", "beam normal"),
    "dhi": ("dhi", "diffuse horizontal", "diffuse horizontal irradiance", "diffuse horizontal radiation", "dif"),
    "ghi": ("ghi", "global horizontal", "global horizontal irradiance", "global horizontal radiation", "glo"),
    "dew_point": ("dew point", "dew-point", "dewpoint", "dew point temperature", "temp_dew", "t_dew"),
    "dry_bulb": ("dry bulb", "dry-bulb", "temperature", "air temperature", "temp_air", "t_air", "temp"),
}
"""Names of columns in lower case, without units in brackets; underscores count as blanks."""

_MISSING = -9900.0  # of TMY3 and of the NSRDB
_PARQUET = "reading Parquet needs pyarrow (pip install pyarrow, or write the table as CSV)"


@dataclass(frozen=True)
class Table:
    """Columns of text or numbers under their names, and the line of each row."""

    columns: dict[str, Sequence[object]]
    lines: NDArray[np.int64]
    form: str


def read_table(
    text: str, place: Place | None, elevation: float | None, columns: Mapping[str, str], stamp: Stamp | None
) -> Weather:
    """Weather of the text of a CSV file: TMY3, NSRDB, or any with named columns."""
    rows = of_line.cells(text)
    first = [cell.strip().lower() for cell in rows[0]] if rows else []
    second = [cell.strip().lower() for cell in rows[1]] if len(rows) > 1 else []
    if second and second[0].startswith("date (mm/dd/yyyy)"):
        found = rows[0]
        if len(found) < 7:
            raise FileFormatError(f"line 1: {len(found)} fields instead of 7 of a TMY3 file (is the file whole?)")
        zone, latitude, longitude, height = (of_line.number(found[k], "the place", 1) for k in (3, 4, 5, 6))
        place = place or of_line.place(latitude, longitude, zone, found[1].strip(), 1)
        # "24:00" ends the day, and so do all hours: they are named by their end.
        return _weather(
            _table(rows, 1, "TMY3"),
            place,
            height if elevation is None else elevation,
            {"date": "Date (MM/DD/YYYY)", "time": "Time (HH:MM)", **columns},
            stamp or "end",
        )
    if "latitude" in first and "time zone" in first and len(rows) > 2:
        values = dict(zip(first, rows[1], strict=False))
        latitude, longitude, zone = (
            of_line.number(values.get(k, ""), k, 2) for k in ("latitude", "longitude", "time zone")
        )
        height = of_line.number(values.get("elevation", "0"), "elevation", 2)
        name = " ".join(values.get(k, "").strip(" -") for k in ("city", "location id")).strip()
        place = place or of_line.place(latitude, longitude, zone, name, 2)
        return _weather(
            _table(rows, 2, "NSRDB"), place, height if elevation is None else elevation, columns, stamp or "middle"
        )
    start = next((k for k, row in enumerate(rows) if row and not row[0].lstrip().startswith("#")), 0)
    return _plain(_table(rows, start, "CSV"), place, elevation, columns, stamp)


def read_parquet(
    path: Path, place: Place | None, elevation: float | None, columns: Mapping[str, str], stamp: Stamp | None
) -> Weather:
    """Weather of a Parquet file with named columns."""
    try:
        from pyarrow import parquet
    except ImportError as error:
        raise ClerestoryError(_PARQUET) from error
    try:
        data = parquet.read_table(path)
    except (ValueError, OSError) as error:
        raise FileFormatError(f"it is not whole, or no Parquet file ({str(error).splitlines()[0]})") from error
    made = {name: data.column(name).to_pylist() for name in data.column_names}
    rows = np.arange(1, data.num_rows + 1)
    return _plain(Table(made, rows, "Parquet"), place, elevation, columns, stamp)


def _plain(
    table: Table, place: Place | None, elevation: float | None, columns: Mapping[str, str], stamp: Stamp | None
) -> Weather:
    """Weather of a table that says nothing of its place."""
    if not _named(table, columns):
        names = ", ".join(name[:20] for name in list(table.columns)[:6])
        raise FileFormatError(
            f"neither EPW, WEA, TMY3 or NSRDB, nor a table with columns of weather; its first are {names} (give "
            "another file, or name them: --column dni=NAME)"
        )
    if place is None:
        raise FileFormatError(
            "a table with named columns does not say where it is (give --place LAT,LON and --timezone HOURS, or place)"
        )
    return _weather(table, place, elevation or 0.0, columns, stamp)


def _table(rows: list[list[str]], head: int, form: str) -> Table:
    names = [cell.strip() for cell in rows[head]] if head < len(rows) else []
    kept = [(line, row) for line, row in enumerate(rows[head + 1 :], start=head + 2) if any(c.strip() for c in row)]
    for line, row in kept:
        if len(row) < len(names):
            raise FileFormatError(f"line {line}: {counted(len(row), 'field')} instead of {len(names)} (is it whole?)")
    if not kept:
        raise FileFormatError("it has no steps (is the file whole?)")
    return Table(
        {name: [row[k] for _, row in kept] for k, name in enumerate(names) if name},
        np.array([line for line, _ in kept]),
        form,
    )


def plain_name(name: str) -> str:
    """A column's name in lower case, without units in brackets; underscores are blanks."""
    return " ".join(re.sub(r"[\[(].*?[\])]", "", name).replace("_", " ").lower().split())


def _named(table: Table, asked: Mapping[str, str]) -> dict[str, str]:
    """Column of each quantity, as asked for or by its usual names."""
    unknown = sorted(set(asked) - set(ALIASES))
    if unknown:
        raise ClerestoryError(f"column of {unknown[0]!r}: not known (give {', '.join(ALIASES)})")
    found = {}
    plain = {plain_name(name): name for name in table.columns}
    for key, aliases in ALIASES.items():
        if key in asked:
            if asked[key] not in table.columns:
                raise FileFormatError(
                    f"there is no column {asked[key]!r} for {key} (it has {', '.join(list(table.columns)[:12])})"
                )
            found[key] = asked[key]
            continue
        hits = [plain[plain_name(alias)] for alias in aliases if plain_name(alias) in plain]
        if hits:
            found[key] = hits[0]
    return found


def _weather(table: Table, place: Place, elevation: float, columns: Mapping[str, str], stamp: Stamp | None) -> Weather:
    named = _named(table, columns)
    stamps = read_stamps({key: table.columns[name] for key, name in named.items()}, table.lines, place)
    notes = []
    if stamp is None:
        stamp = "middle"
        what = "times of the table are taken as the middle of their intervals"
        notes.append(Finding("note", "stamp", "", what, "say --stamp begin or --stamp end if they are not"))
    given: dict[str, NDArray[np.float64]] = {}
    for key in ("dni", "dhi", "ghi"):
        if key in named:
            values = _numbers(table, named[key])
            given[key], found = of_line.light(values.tolist(), table.lines.tolist(), named[key])
            notes += found
    if len(given) < 2:
        have = f" beside {named[next(iter(given))]}" if given else ""
        names = ", ".join(list(table.columns)[:12])
        raise FileFormatError(
            "two of direct normal (dni), diffuse horizontal (dhi) and global horizontal irradiance (ghi) are needed, "
            f"and there is none{have} among the columns {names} (name them: --column dni=NAME)"
        )
    temperatures = {key: _numbers(table, named[key]) for key in ("dew_point", "dry_bulb") if key in named}
    times, length = _middles(stamps, stamp)
    unknown = np.full(len(times), np.nan)
    weather = Weather(
        place,
        times,
        length,
        given.get("dni", unknown),
        given.get("dhi", unknown),
        elevation=elevation,
        global_horizontal=given["ghi"] if len(given) == 3 else None,
        dew_point=temperatures.get("dew_point"),
        dry_bulb=temperatures.get("dry_bulb"),
        years=stamps.years,
        lines=table.lines,
        source=f"{table.form} with {' and '.join(named[key] for key in given)}",
        notes=tuple(notes),
    )
    return weather if len(given) == 3 or "ghi" not in given else _completed(weather, given)


def _numbers(table: Table, name: str) -> NDArray[np.float64]:
    """A column as numbers; what is empty or marked as missing is NaN."""
    made = np.empty(len(table.lines))
    for k, (cell, line) in enumerate(zip(table.columns[name], table.lines.tolist(), strict=True)):
        text = "" if cell is None else str(cell).strip()
        made[k] = np.nan if text.lower() in ("", "nan", "na", "null", "none") else of_line.number(text, name, line)
    made[made <= _MISSING] = np.nan
    return made


def _middles(stamps: Stamps, stamp: Stamp) -> tuple[NDArray[np.datetime64], NDArray[np.float64]]:
    """Middles of intervals and their lengths, of times that name their begin, middle or end."""
    times = laid_out(stamps.years, stamps.months, stamps.days, stamps.hours)
    length = intervals(times)
    shift = {"middle": 0.0, "begin": 0.5, "end": -0.5}[stamp]
    moved = stamps.hours + shift * length
    # The first or last hour of a day may be called 24:00 or 00:00 of its neighbour.
    days = nominal_days(stamps, np.floor(moved).astype(np.int64) // 24)
    return laid_out(days.years, days.months, days.days, moved % 24.0), length


def nominal_days(stamps: Stamps, later: NDArray[np.int64]) -> Stamps:
    """The same moved by whole days; the last of a year without a name is followed by its first."""
    years = np.full(len(stamps.months), 2001) if stamps.years is None else stamps.years
    leap = (stamps.months == 2) & (stamps.days == 29)
    month = (12 * (np.where(leap, 2000, years) - 1970) + stamps.months - 1).astype("datetime64[M]")
    moved = month.astype("datetime64[D]") + (stamps.days - 1) + later
    months = moved.astype("datetime64[M]")
    return replace(
        stamps,
        years=None if stamps.years is None else np.where(later != 0, 1970 + months.astype(np.int64) // 12, years),
        months=months.astype(np.int64) % 12 + 1,
        days=(moved - months.astype("datetime64[D]")).astype(np.int64) + 1,
    )


def _completed(weather: Weather, given: Mapping[str, NDArray[np.float64]]) -> Weather:
    """The third kind of light by the other two and the sun in the middle of each step."""
    total = given["ghi"]
    if "dhi" in given:
        beam = np.maximum(total - given["dhi"], 0.0)
        what = "direct normal light is made from global and diffuse light, by the sun's altitude"
        made = with_direct_normal(weather, beam, what="global light beyond the diffuse")
    else:
        sine = np.sin(np.radians(np.maximum(weather.sun_positions()[0], 0.0)))
        what = "diffuse light is made from global and direct light, by the sun's altitude"
        made = replace(weather, diffuse=np.maximum(total - given["dni"] * sine, 0.0))
    return replace(made, notes=(*made.notes, Finding("note", "completed", "", what, "")))
