"""Reading weather files, whatever their format."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from clerestory._core import ClerestoryError, FileFormatError
from clerestory.weather.epw import read_epw
from clerestory.weather.tables import STAMPS, Stamp, read_parquet, read_table
from clerestory.weather.wea import read_wea
from clerestory.weather.weather import standard_hours

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping

    from clerestory.sky.position import Place
    from clerestory.weather.weather import Weather


def read_weather(
    path: str | os.PathLike[str],
    *,
    place: Place | None = None,
    elevation: float | None = None,
    columns: Mapping[str, str] | None = None,
    stamp: Stamp | None = None,
    fill_hours: float = 0.0,
) -> Weather:
    """Read a weather file: EPW, WEA, TMY3 or NSRDB CSV, CSV or Parquet with named columns; by its content.

    What is missing or odd is in `Weather.findings`; a file with missing light is read, and refused where its skies are
    asked for.

    Parameters
    ----------
    path
        The file.
    place
        Where it is, for tables that do not say; its time zone is that of the table's clock, in hours ahead of UTC.
    elevation
        Above the sea [m], for tables.
    columns
        Names of columns by quantity (`time`, `dni`, `dhi`, `ghi`, `dew_point`, `dry_bulb`, …), for tables whose names
        are not the usual ones. Of the three kinds of irradiance two are enough.
    stamp
        Whether the times of a table name the `middle`, the `begin` or the `end` of their intervals. TMY3 names the end,
        NSRDB the middle; for others the middle is taken.
    fill_hours
        Longest gap of daylight without light that is filled by interpolation [h].

    Raises
    ------
    FileFormatError
        The file is none of these, or a line of it is faulty; the text has the line's number.
    OSError
        The file cannot be read.

    Examples
    --------
    >>> from clerestory.weather import read_weather
    >>> weather = read_weather("innsbruck.epw")  # doctest: +SKIP
    """
    path = Path(path)
    if stamp is not None and stamp not in STAMPS:
        raise ClerestoryError(f"stamp {stamp!r} is not known (give {', '.join(STAMPS)})")
    if place is not None:
        standard_hours(place)
    try:
        weather = _read(path, place, elevation, columns or {}, stamp)
        made = replace(weather, source=f"{path.name} ({weather.source})")
        return made.filled(fill_hours) if fill_hours > 0.0 else made
    except ClerestoryError as error:
        raise type(error)(f"{path}: {error}") from error


def _read(
    path: Path, place: Place | None, elevation: float | None, columns: Mapping[str, str], stamp: Stamp | None
) -> Weather:
    data = path.read_bytes()
    if data[:4] == b"PAR1":
        return read_parquet(path, place, elevation, columns, stamp)
    text = data.decode("utf-8-sig", errors="replace")
    is_epw = text.lstrip()[:9].upper().startswith("LOCATION,")
    if is_epw or text.lstrip()[:5].lower().startswith("place"):
        if place is not None or elevation is not None or columns or stamp is not None:
            raise ClerestoryError(
                f"{'an EPW' if is_epw else 'a WEA'} file says itself where and when it is (leave place, columns and "
                "stamp out)"
            )
        return read_epw(text) if is_epw else read_wea(text)
    head = text.lstrip()[:2000].splitlines()
    if not any("," in line for line in head[:40]):
        raise FileFormatError(
            "line 1: neither LOCATION of an EPW file, place of a WEA file nor a table with commas (give one of those)"
        )
    return read_table(text, place, elevation, columns, stamp)
