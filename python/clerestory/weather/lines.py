"""What readers of weather files share: numbers with their lines, and what was odd in them."""

from __future__ import annotations

import csv
import io
import math
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError, FileFormatError
from clerestory.counts import counted
from clerestory.finding import Finding
from clerestory.sky.position import Place

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

OFFSET = -10.0
"""Negative irradiances down to this [W/m²] are what a pyranometer shows at night, and count as 0."""

_DAYS = (31, 29, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31)


def cells(text: str) -> list[list[str]]:
    """Rows of the text of a CSV file."""
    try:
        return list(csv.reader(io.StringIO(text)))
    except csv.Error as error:
        raise FileFormatError(f"it is no table ({error})") from error


def number(text: str, what: str, line: int) -> float:
    """A finite number of a line."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise FileFormatError(f"line {line}: {what} is {text.strip()!r}, not a number (correct it)")
    return value


def date(month: float, day: float, line: int) -> tuple[int, int]:
    """Month and day, if they exist."""
    if not (month == int(month) and 1 <= month <= 12 and day == int(day) and 1 <= day <= _DAYS[int(month) - 1]):
        raise FileFormatError(f"line {line}: there is no day {day:g} of month {month:g} (correct it)")
    return int(month), int(day)


def place(latitude: float, longitude: float, zone: float, name: str, line: int) -> Place:
    """A place of a line."""
    try:
        return Place(latitude, longitude, zone, name)
    except ClerestoryError as error:
        raise FileFormatError(f"line {line}: {error}") from error


def light(
    values: Sequence[float], lines: Sequence[int], what: str, missing: float = 9999.0
) -> tuple[NDArray[np.float64], list[Finding]]:
    """Light (n,) without impossible values, and what was found.

    Parameters
    ----------
    missing
        Values from this on stand for missing ones; NaN does, too.
    """
    made = np.array(values, dtype=np.float64)
    made[made >= missing] = np.nan
    found = []
    slight = (made < 0.0) & (made >= OFFSET)
    if slight.any():
        made[slight] = 0.0
        text = f"{counted(int(slight.sum()), 'value')} of {what} slightly below 0, taken as 0"
        found.append(Finding("note", "negative", numbered(np.array(lines)[slight]), text, ""))
    wrong = made < 0.0
    if wrong.any():
        text = f"{counted(int(wrong.sum()), 'value')} of {what} far below 0, taken as missing"
        found.append(Finding("warning", "negative", numbered(np.array(lines)[wrong]), text, "correct the file"))
        made[wrong] = np.nan
    return made, found


def numbered(lines: NDArray[np.int64]) -> str:
    """Numbers of lines in words: `lines 9, 10, …`."""
    shown = ", ".join(str(line) for line in lines[:5]) + (", …" if len(lines) > 5 else "")
    return f"line{'s' if len(lines) > 1 else ''} {shown}"
