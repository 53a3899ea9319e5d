"""Why a file is no measurement that is read: of a table with names over its columns, which names are not known."""

from __future__ import annotations

import csv
from difflib import get_close_matches
from typing import TYPE_CHECKING

from clerestory._core import FileFormatError
from clerestory.measure.formats.choices import columns_said
from clerestory.measure.formats.header import HEAD, leading, lines_of
from clerestory.measure.formats.sphere_columns import KEYS, column
from clerestory.measure.formats.table_columns import POINTS, ROLES, role_of

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

_SEPARATORS = ("\t", ";", ",", None)
_OF_SPHERES = f"{', '.join(dict.fromkeys(KEYS.values()))}, T, Rf, …"
_SHOWN = 12  # names of columns in a message

_NEITHER = "no format of measurements is recognised (docs/measurements.md lists them)"
_SPHERE = "values of a sphere need wavelength or band, and T, R or value"
_POINTS = "points need theta_o and value"


def reason(data: bytes, choices: Mapping[str, object]) -> str:
    """What is to be said of a file that no format recognises, with the remedy in brackets at its end."""
    words = _names(data)
    if not words:
        return _NEITHER
    columns = ", ".join(words[:_SHOWN]) + (", …" if len(words) > _SHOWN else "")
    said = columns_said(choices)
    absent = [header for header in said if header not in words]
    if absent:
        return f"columns: the file has no column {absent[0]!r} (it has: {columns})"
    for header, name in said.items():
        if name not in ROLES and column(name) is None:
            return f"columns: {name!r} of {header!r} is not known (points: {', '.join(ROLES)}; a sphere: {_OF_SPHERES})"
    of_sphere = {word: known.key for word in words if (known := column(said.get(word, word)))}
    of_points = {word: role for word in words if (role := role_of(said.get(word, word)))}
    if not (of_sphere or of_points):
        return (
            f"a table of {columns}, whose columns are not known: {_POINTS}, {_SPHERE} (name those that are called"
            " otherwise: --column NAME=HEADER)"
        )
    if len(of_points) > len(of_sphere) or {"theta_o", "theta_i"} & set(map(_bare, words)):
        lacking = [role for role in ("theta_o", "value") if role not in of_points.values()]
        return _lacking(columns, words, of_points, lacking, _POINTS, POINTS)
    held = set(of_sphere.values())
    lacking = [] if held & {"wavelength", "band"} else ["wavelength"]
    lacking += [] if "value" in held else ["value"]
    return _lacking(columns, words, of_sphere, lacking, _SPHERE, KEYS)


def _lacking(
    columns: str,
    words: Sequence[str],
    known: Mapping[str, str],
    lacking: Sequence[str],
    need: str,
    names: Mapping[str, str],
) -> str:
    """What is said of a table that is nearly one of points, or of values of a sphere."""
    unknown = [word for word in words if word not in known]
    text = f"a table of {columns}"
    if unknown:
        text += f", of which {', '.join(map(repr, unknown[:_SHOWN]))} {'is' if len(unknown) == 1 else 'are'} not known"
    if not unknown:
        return f"{text}: {need} (add what is missing: {', '.join(lacking)})"
    if not lacking:
        word, key = (unknown[0], "theta") if "theta" not in known.values() else next(iter(known.items()))
        return (
            f"{text} (name what counts, such as --column {key}={_quoted(word)}; other columns that are not known are"
            " left out then)"
        )
    pairs = []
    for word in unknown:
        near = get_close_matches(_bare(word), names, 1, 0.7)
        if near and names[near[0]] not in known.values():
            pairs.append((names[near[0]], word))
    pairs = pairs or [(lacking[0], unknown[0])]
    told = " ".join(f"--column {key}={_quoted(word)}" for key, word in pairs[:2])
    return f"{text}: {need} (name what is called otherwise, such as {told})"


def _names(data: bytes) -> list[str]:
    """The names over the columns of a table with numbers below them; none of a file that is no such table."""
    head = data[:HEAD]
    if b"\0" in head:
        return []
    at = leading(head, 0, 1)[1]
    try:
        first, *rest = [line for line in lines_of(head[at:]) if line.strip()] or [""]
    except FileFormatError:
        return []
    separator = next((mark for mark in _SEPARATORS if mark is None or mark in first), None)
    words, below = (_cells(line, separator) for line in (first, rest[0] if rest else ""))
    numbers = [_is_number(cell) for cell in below]
    enough = any(numbers) if separator else all(numbers)  # words between blanks may be prose
    if len(words) < 2 or len(words) != len(below) or not enough or any(map(_is_number, words)):
        return []
    return words


def _cells(line: str, separator: str | None) -> list[str]:
    cells = line.split() if separator is None else next(csv.reader([line], delimiter=separator), [])
    return [cell.strip().strip('"') for cell in cells]


def _is_number(cell: str) -> bool:
    try:
        float(cell.replace(",", "."))
    except ValueError:
        return False
    return True


def _bare(word: str) -> str:
    """A name as it is compared: without its unit."""
    return word.strip().lower().partition("[")[0].partition("(")[0].strip().replace(" ", "_")


def _quoted(word: str) -> str:
    return word if word.replace("_", "").isalnum() else f"'{word}'"
