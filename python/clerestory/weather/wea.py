"""WEA files of Radiance's sky programs."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError, FileFormatError
from clerestory.counts import counted
from clerestory.finding import Finding
from clerestory.weather import lines as of_line
from clerestory.weather.calendar import intervals, laid_out, spells
from clerestory.weather.weather import Weather

if TYPE_CHECKING:
    from numpy.typing import NDArray

_KEYS = ("place", "latitude", "longitude", "time_zone", "site_elevation", "weather_data_file_units")
LOWEST_SINE = 0.05
"""Sine of the sun's altitude (2.9°) below which a division by it says nothing."""


def read_wea(text: str) -> Weather:
    """Weather of the text of a WEA file, whose times are the middle of intervals.

    Units 1 are direct normal and diffuse horizontal irradiance [W/m²], 2 has the direct one on the horizontal, 3 is
    direct normal and diffuse horizontal illuminance [lx].
    """
    rows = text.splitlines()
    start = next(k for k, content in enumerate(rows) if content.strip())
    head: dict[str, str] = {}
    for k, key in enumerate(_KEYS, start=start):
        word, _, rest = rows[k].strip().partition(" ") if k < len(rows) else ("", "", "")
        if word.lower() != key:
            raise FileFormatError(f"line {k + 1}: {word!r} instead of {key} (WEA files begin with {', '.join(_KEYS)})")
        head[key] = rest.strip()
    values = {key: of_line.number(head[key], key, start + 2 + k) for k, key in enumerate(_KEYS[1:])}
    units = values["weather_data_file_units"]
    if units not in (1, 2, 3):
        raise FileFormatError(
            f"line {start + 6}: weather_data_file_units {units:g} is not known (1: W/m², 2: direct horizontal, 3: lx)"
        )
    # The file counts degrees west, of the place and of its clock's meridian.
    place = of_line.place(
        values["latitude"], -values["longitude"], -values["time_zone"] / 15.0, head["place"], start + 2
    )
    made: list[list[float]] = []
    numbers: list[int] = []
    for line, content in enumerate(rows[start + 6 :], start=start + 7):
        cells = content.split()
        if not cells:
            continue
        if len(cells) < 5:
            raise FileFormatError(f"line {line}: {counted(len(cells), 'value')} instead of 5 (is the file whole?)")
        names = ("month", "day", "hour", "the first value", "the second value")
        row = [of_line.number(cell, what, line) for cell, what in zip(cells, names, strict=False)]
        of_line.date(row[0], row[1], line)
        if not 0.0 <= row[2] <= 24.0:
            raise FileFormatError(f"line {line}: hour {row[2]:g} is not 0 to 24 (correct it)")
        made.append(row)
        numbers.append(line)
    if not made:
        raise FileFormatError("it has no steps (is the file whole?)")
    months, days, hours, first, second = np.array(made).T
    times = laid_out(None, months.astype(np.int64), days.astype(np.int64), hours % 24.0)
    missing = np.inf if units == 3 else 9999.0
    direct, of_direct = of_line.light(first.tolist(), numbers, "the direct light", missing)
    diffuse, of_diffuse = of_line.light(second.tolist(), numbers, "the diffuse light", missing)
    weather = Weather(
        place,
        times,
        intervals(times),
        direct,
        diffuse,
        illuminances=units == 3,
        elevation=values["site_elevation"],
        lines=np.array(numbers),
        source=f"WEA, units {units:g}",
        notes=(*of_direct, *of_diffuse),
    )
    return with_direct_normal(weather, direct, what="direct horizontal irradiance") if units == 2 else weather


def with_direct_normal(weather: Weather, horizontal: NDArray[np.float64], *, what: str) -> Weather:
    """The same with direct light on the horizontal turned into direct normal, by the sun in the middle of each step.

    Parameters
    ----------
    horizontal
        Direct light on a horizontal plane (n,), NaN where it is missing.
    what
        What it is called, for the note about steps that have no sun.
    """
    sine = np.sin(np.radians(weather.sun_positions()[0]))
    low = (sine < LOWEST_SINE) & (horizontal > 0.0)
    direct = np.where(low, 0.0, horizontal / np.maximum(sine, LOWEST_SINE))
    notes = weather.notes
    if low.any():
        text = f"{what} with the sun at the horizon or below, taken as 0"
        notes = (*notes, Finding("note", "sunless", spells(weather, np.flatnonzero(low)), text, ""))
    return replace(weather, direct=direct, notes=notes)


def to_wea(weather: Weather) -> str:
    """The text of a WEA file of the weather, for Radiance's programs.

    Raises
    ------
    ClerestoryError
        Light is missing while the sun is up.
    """
    if weather.is_missing.any():
        raise ClerestoryError(
            f"light is missing in {spells(weather, np.flatnonzero(weather.is_missing))} (fill the gaps first)"
        )
    place = weather.place
    name = "_".join(place.name.split()) or "place"
    head = [
        f"place {name}",
        f"latitude {place.latitude:g}",
        f"longitude {-place.longitude:g}",
        f"time_zone {-15.0 * weather.time_zone:g}",
        f"site_elevation {weather.elevation:g}",
        f"weather_data_file_units {3 if weather.illuminances else 1}",
    ]
    rows = (
        f"{month} {day} {hour:.6g} {direct:.6g} {diffuse:.6g}"
        for month, day, hour, direct, diffuse in zip(
            weather.months,
            weather.days,
            weather.hours,
            np.nan_to_num(weather.direct),
            np.nan_to_num(weather.diffuse),
            strict=True,
        )
    )
    return "\n".join([*head, *rows]) + "\n"
