"""Tables of integrating spheres as CSV: a row a value, or a column for each kind of value.

Columns are known by their names: wavelength or band, angle and azimuth of incidence, side, transmission or reflection,
what was collected (hemispherical, diffuse, direct), value and standard error; or columns of values whose names say it.
"""

from __future__ import annotations

import csv
import io
import re
from typing import TYPE_CHECKING, cast

import numpy as np

from clerestory._core import ClerestoryError, FileFormatError
from clerestory.measure.contents import Contents
from clerestory.measure.formats.choices import columns_said, lit_side, sample_of, scatter_of
from clerestory.measure.formats.comments import conditions_of, pairs
from clerestory.measure.formats.header import one_line
from clerestory.measure.formats.sphere_columns import BANDS, COLLECTED, SCATTERS, SIDES, Column, column, columns_named
from clerestory.measure.formats.tokens import lines_of, number
from clerestory.measure.source import Source, digest
from clerestory.measure.sphere import SphereValues

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from clerestory.directions import Scatter, Side
    from clerestory.measure.sphere import Collected

    Key = tuple[str, Side, Scatter, Collected, float, float, bool]
    Shares = dict[float | str, tuple[float, float | None]]

NAME = "integrating-sphere CSV"

_HEAD = 1 << 16
_SEPARATORS = ("\t", ";", ",")
_DIFFUSE = ("diffuse", "dif", "d")
_WRITTEN = (
    "sample",
    "incident_side",
    "scatter",
    "collected",
    "theta_deg",
    "phi_deg",
    "wavelength_nm",
    "band",
    "value",
    "standard_error",
)


def recognises(data: bytes, name: str) -> bool:
    """Whether its first line that is no comment names columns of such a table, each known."""
    try:
        lines = lines_of(data[:_HEAD])
    except FileFormatError:
        return False
    columns = columns_named(_first_names(lines), {})
    return all(columns) and _is_whole(columns)


def readable(data: bytes, choices: Mapping[str, object]) -> bool:
    """The same with names that a person gives; the other columns of such a table may be unknown."""
    try:
        names = _first_names(lines_of(data[:_HEAD]))
    except FileFormatError:
        return False
    said = _said_here(choices, names)
    return bool(said) and all(map(column, said.values())) and _is_whole(columns_named(names, said))


def _said_here(choices: Mapping[str, object], names: Sequence[str]) -> dict[str, str]:
    """What a person said of columns of this file; what is said of others is for other files."""
    return {header: name for header, name in columns_said(choices).items() if header in names}


def _is_whole(columns: Sequence[Column | None]) -> bool:
    keys = {known.key for known in columns if known}
    banded = any(known and known.band for known in columns)
    return "value" in keys and bool({"wavelength", "band"} & keys or banded)


def _first_names(lines: Sequence[str]) -> list[str]:
    return _names(next((line for line in lines if line.strip() and not line.startswith("#")), ""))[1]


def _names(line: str) -> tuple[str, list[str]]:
    """The separator of a line and its cells."""
    separator = next((mark for mark in _SEPARATORS if mark in line), ",")
    return separator, next(csv.reader([line], delimiter=separator), [])


def read(data: bytes, name: str, **choices: object) -> Contents:
    """Values of a table, by sample, side, kind and incident direction.

    Parameters
    ----------
    data
        The file's bytes.
    name
        Its name, for messages.
    choices
        `side` (exterior), `scatter` and `sample` where no column or comment says them; `columns` (names that are known
        and the file's), with which other unknown columns are left out.

    Raises
    ------
    FileFormatError
        A column is not known, or a cell is wrong, with its line.
    """
    lines = lines_of(data)
    first = next((k for k, line in enumerate(lines) if line.strip() and not line.startswith("#")), len(lines))
    if first == len(lines):
        raise FileFormatError(f"line {first}: no line that names the columns (is the file whole?)")
    separator, names = _names(lines[first])
    said = _said_here(choices, names)
    known = columns_named(names, said)
    unknown = [word for word, meaning in zip(names, known, strict=True) if meaning is None]
    if unknown and not said:
        raise FileFormatError(
            f"line {first + 1}: column {unknown[0][:40]!r} is not known (docs/measurements-formats.md has names)"
        )
    columns = [meaning or Column("") for meaning in known]
    _check(columns, first + 1)
    found: dict[Key, Shares] = {}
    try:
        rows = list(csv.reader(io.StringIO("\n".join(lines[first + 1 :])), delimiter=separator, strict=True))
    except csv.Error as error:
        raise FileFormatError(f"after line {first + 1}: it is no table ({error}; check the quotes)") from error
    if any("\n" in cell for row in rows for cell in row):
        raise FileFormatError(f"after line {first + 1}: a quoted cell goes over lines (check the quotes)")
    for line, cells in enumerate(rows, start=first + 2):
        if not any(cell.strip() for cell in cells) or cells[0].startswith("#"):
            continue
        if len(cells) != len(columns):
            raise FileFormatError(f"line {line}: {len(cells)} cells instead of {len(columns)} (is the file whole?)")
        _row(cells, columns, line, found, sample_of(choices, name), choices)
    if not found:
        raise FileFormatError(f"line {len(lines)}: no values below the names of the columns (is the file whole?)")
    conditions = conditions_of(pairs(lines[:first]))
    source = Source(
        name,
        digest(data),
        NAME,
        tuple(lines[: first + 1]),
        "front is the exterior; angles from the normal; shares of the light",
    )
    values = tuple(_values(key, shares, conditions, source) for key, shares in found.items())
    odd = [f"{name}: column {word!r} is not known and left out" for word in unknown if word]
    odd += [
        f"{name}: there is no column {header!r} (it has: {', '.join(names)})"
        for header in columns_said(choices)
        if header not in names
    ]
    return Contents((), values, tuple(odd))


def _check(columns: Sequence[Column], line: int) -> None:
    keys = [known.key for known in columns]
    twice = {key for key in keys if keys.count(key) > 1} - {"value", ""}
    values = [known for known in columns if known.key == "value"]
    if twice or len(set(values)) < len(values):
        raise FileFormatError(f"line {line}: two columns of {next(iter(twice), 'the same values')} (keep one)")
    if not values:
        raise FileFormatError(f"line {line}: no column of values (name one value, or transmittance, or Rf, …)")
    if "wavelength" in keys and ("band" in keys) and any(known.band for known in values):
        raise FileFormatError(f"line {line}: bands in a column and in names of columns (keep one)")
    if "error" in keys and len(values) > 1:
        raise FileFormatError(
            f"line {line}: one column of standard errors for {len(values)} of values (write a row a value)"
        )


def _row(
    cells: Sequence[str],
    columns: Sequence[Column],
    line: int,
    found: dict[Key, Shares],
    sample: str,
    choices: Mapping[str, object],
) -> None:
    given = {
        known.key: (cell.strip(), known) for cell, known in zip(cells, columns, strict=True) if known.key != "value"
    }

    def text(key: str) -> str:
        return given[key][0] if key in given else ""

    theta = text("theta")
    angle = np.nan if theta.lower() in _DIFFUSE else number(theta, "the angle", line) if theta else 0.0
    azimuth = number(text("phi"), "the azimuth", line) if text("phi") else 0.0
    if not (np.isnan(angle) or 0.0 <= angle <= 90.0) or abs(azimuth) > 360.0:
        raise FileFormatError(f"line {line}: an angle is not within 0 to 90°, or an azimuth beyond 360° (correct it)")
    for cell, known in zip(cells, columns, strict=True):
        if known.key != "value" or not cell.strip():
            continue
        side = known.side or cast("Side", _word(text("side"), SIDES, "side", line, lit_side(choices)))
        scatter = known.scatter or cast(
            "Scatter", _word(text("scatter"), SCATTERS, "scatter", line, scatter_of(choices))
        )
        collected = known.collected or cast(
            "Collected", _word(text("collected"), COLLECTED, "collected", line, "hemispherical")
        )
        where: float | str
        if text("wavelength"):
            where = round(number(text("wavelength"), "the wavelength", line) * given["wavelength"][1].factor, 6)
            if where <= 0.0:
                raise FileFormatError(f"line {line}: wavelength {where:g} nm is none (correct it)")
        else:
            where = known.band or BANDS.get(text("band").lower(), text("band"))
            if not where:
                raise FileFormatError(f"line {line}: neither a wavelength nor a band (add it)")
        share = number(cell.strip(), "the value", line) * known.factor
        if not -0.5 <= share <= 1.5:
            raise FileFormatError(
                f"line {line}: {share:g} is no share of the light (put % into the name of a column of per cent)"
            )
        error = (
            abs(number(text("error"), "the standard error", line) * given["error"][1].factor) if text("error") else None
        )
        key = (text("sample") or sample, side, scatter, collected, angle, azimuth, isinstance(where, str))
        # NaN is not the same as NaN, but diffuse light is.
        key = next((other for other in found if repr(other) == repr(key)), key) if np.isnan(angle) else key
        shares = found.setdefault(key, {})
        if where in shares:
            raise FileFormatError(f"line {line}: a second value of {' '.join(key[1:4])} at {where} (keep one)")
        shares[where] = (share, error)


def _word(text: str, known: Mapping[str, str], what: str, line: int, default: str | None) -> str:
    if text.lower() in known:
        return known[text.lower()]
    if text or default is None:
        raise FileFormatError(
            f"line {line}: {what} {text[:40]!r} is not known ({', '.join(dict.fromkeys(known.values()))})"
        )
    return default


def _values(key: Key, shares: Shares, conditions: dict[str, str], source: Source) -> SphereValues:
    sample, side, scatter, collected, theta, phi, banded = key
    order = list(shares) if banded else sorted(cast("dict[float, object]", shares))
    errors = [shares[where][1] for where in order]
    return SphereValues(
        sample,
        side,
        scatter,
        theta,
        np.array([shares[where][0] for where in order]),
        collected,
        None if banded else np.array(order, dtype=np.float64),
        tuple(str(where) for where in order) if banded else (),
        phi,
        None if any(error is None for error in errors) else np.array(errors, dtype=np.float64),
        conditions,
        source,
    )


def write_spheres(values: Sequence[SphereValues]) -> bytes:
    """A table of values, a row each, which `read` takes back as they were.

    Raises
    ------
    ClerestoryError
        There are none.
    """
    if not values:
        raise ClerestoryError("no sphere values to write (read some first)")
    out = io.StringIO()
    shared = dict(values[0].conditions)
    for other in values[1:]:
        shared = {key: text for key, text in shared.items() if other.conditions.get(key) == text}
    for key, text in shared.items():
        out.write(f"# {re.sub(':', ' ', one_line(key))}: {one_line(text)}\n")
    table = csv.writer(out, lineterminator="\n")
    table.writerow(_WRITTEN)
    for v in values:
        places = v.bands or [f"{wave:.10g}" for wave in cast("Sequence[float]", v.wavelength_nm)]
        for k, place in enumerate(places):
            where = ("", place) if v.bands else (place, "")
            theta = "diffuse" if np.isnan(v.theta_deg) else f"{v.theta_deg:.10g}"
            error = "" if v.standard_errors is None else f"{v.standard_errors[k]:.10g}"
            table.writerow(
                [
                    one_line(v.sample),
                    v.incident_side,
                    v.scatter,
                    v.collected,
                    theta,
                    f"{v.phi_deg:.10g}",
                    *where,
                    f"{v.values[k]:.10g}",
                    error,
                ]
            )
    return out.getvalue().encode()
