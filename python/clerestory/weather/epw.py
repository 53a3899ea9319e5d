"""EnergyPlus weather files (EPW)."""

from __future__ import annotations

import numpy as np

from clerestory._core import FileFormatError
from clerestory.counts import counted
from clerestory.weather import lines as of_line
from clerestory.weather.calendar import laid_out
from clerestory.weather.weather import Weather

_COLUMNS = {
    "year": 0,
    "month": 1,
    "day": 2,
    "hour": 3,
    "minute": 4,
    "dry bulb": 6,
    "dew point": 7,
    "global horizontal irradiance": 13,
    "direct normal irradiance": 14,
    "diffuse horizontal irradiance": 15,
}
_MISSING_TEMPERATURE = 99.9


def read_epw(text: str) -> Weather:
    """Weather of the text of an EPW file, whose hours are named by their end."""
    rows = of_line.cells(text)
    head = rows[0]
    if len(head) < 10:
        raise FileFormatError(f"line 1: LOCATION has {len(head)} fields instead of 10 (is the file whole?)")
    latitude, longitude, zone, elevation = (
        of_line.number(head[k], what, 1)
        for k, what in ((6, "latitude"), (7, "longitude"), (8, "time zone"), (9, "elevation"))
    )
    place = of_line.place(latitude, longitude, zone, head[1].strip(), 1)
    step = 1.0
    for row in rows[:8]:
        if row and row[0].strip().upper() == "DATA PERIODS" and len(row) > 2:
            step = 1.0 / max(1.0, of_line.number(row[2], "records an hour", 8))
    made: dict[str, list[float]] = {name: [] for name in _COLUMNS}
    numbers: list[int] = []
    for line, row in enumerate(rows[8:], start=9):
        if not any(cell.strip() for cell in row):
            continue
        if len(row) < 16:
            raise FileFormatError(f"line {line}: {counted(len(row), 'field')} instead of 35 (is the file whole?)")
        values = {name: of_line.number(row[k], name, line) for name, k in _COLUMNS.items()}
        of_line.date(values["month"], values["day"], line)
        if not 1.0 <= values["hour"] <= 24.0:
            raise FileFormatError(f"line {line}: hour {values['hour']:g} is not 1 to 24 (correct it)")
        numbers.append(line)
        for name, value in values.items():
            made[name].append(value)
    if not numbers:
        raise FileFormatError("no step has both irradiances (take a file with sunshine data)")
    years, months, days = (np.array(made[name], dtype=np.int64) for name in ("year", "month", "day"))
    hours, minutes = np.array(made["hour"]), np.array(made["minute"])
    # An hour is named by its end; several records an hour by their minutes, which are their ends, too.
    middle = (hours - 0.5 if step == 1.0 else hours - 1.0 + minutes / 60.0 - step / 2.0) % 24.0
    times = laid_out(years, months, days, middle)
    direct, of_direct = of_line.light(made["direct normal irradiance"], numbers, "direct normal irradiance")
    diffuse, of_diffuse = of_line.light(made["diffuse horizontal irradiance"], numbers, "diffuse horizontal irradiance")
    total, _ = of_line.light(made["global horizontal irradiance"], numbers, "global horizontal irradiance")
    if not np.isfinite(direct + diffuse).any():
        raise FileFormatError("no step has both irradiances (take a file with sunshine data)")
    dry_bulb, dew_point = (
        np.where(np.array(made[name]) >= _MISSING_TEMPERATURE, np.nan, made[name]) for name in ("dry bulb", "dew point")
    )
    return Weather(
        place,
        times,
        np.full(len(times), step),
        direct,
        diffuse,
        elevation=elevation,
        global_horizontal=total if np.nan_to_num(total).any() else None,
        dew_point=dew_point,
        dry_bulb=dry_bulb,
        years=years,
        lines=np.array(numbers),
        source="EPW",
        notes=(*of_direct, *of_diffuse),
    )
