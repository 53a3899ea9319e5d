"""Tables with names over their columns (CSV): a row a point, or a row a point and band.

Columns are known by their names, in any order and between commas, semicolons or tabs; a person names those that are
called otherwise. Lines of comment above the names hold conditions. The scans that `clerestory trace --scan` writes are
such tables. Azimuths are those of the sample's frame unless a person says otherwise.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, cast

import numpy as np

from clerestory._core import FileFormatError, read_table
from clerestory.measure.contents import Contents
from clerestory.measure.formats.choices import angle_of, columns_said, one_of, quantity_of, sample_of, scatter_of
from clerestory.measure.formats.frame import Frame, halves, signed
from clerestory.measure.formats.header import HEAD, conditions_of, leading, line_end, lines_of, pair_of
from clerestory.measure.formats.rows import grouped
from clerestory.measure.formats.table_columns import ROLES, WORDS, Column, columns_named, one_band, side_named
from clerestory.measure.formats.table_writing import RESERVED, write
from clerestory.measure.scan import PURPOSES, Measurement, Scan
from clerestory.measure.source import Source, digest
from clerestory.measure.sphere import SphereValues

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from clerestory.directions import Scatter, Side
    from clerestory.measure.scan import Purpose, Quantity
    from clerestory.measure.sphere import Collected

    Floats = NDArray[np.float64]

__all__ = ["NAME", "read", "recognises", "write"]

NAME = "table of points (CSV)"
FRAMED = True
"""Whether `front`, `seen_from` and `up_deg` say how its sides and azimuths count."""

_COLLECTED: dict[str, Collected] = {"beam": "direct", "total": "hemispherical"}
"""Rows of one value for a hemisphere, as `clerestory trace --scan` has them."""


@dataclass(frozen=True)
class _Head:
    """What stands above the rows."""

    lines: list[str]
    columns: list[Column]
    delimiter: str | None
    at: int
    line: int
    stated: dict[str, str] = field(default_factory=dict)


def recognises(data: bytes, name: str) -> bool:
    """Whether the first line that is no comment names outgoing angles and values."""
    return _head(data[:HEAD], {}) is not None


def readable(data: bytes, choices: Mapping[str, object]) -> bool:
    """The same with names that a person gives, all of them of points and in the table."""
    said = columns_said(choices)
    if not said or not set(said.values()) <= set(ROLES):
        return False
    names = _row(data, leading(data[:HEAD], 0, 1)[1])[0]
    return said.keys() <= set(names) and _head(data[:HEAD], choices) is not None


def _head(data: bytes, choices: Mapping[str, object]) -> _Head | None:
    comments, at, line = leading(data, 0, 1)
    words, row, delimiter = _row(data, at)
    columns = columns_named(words, columns_said(choices))
    roles = {column.role for column in columns}
    if not {"theta_o", "value"} <= roles:
        return None
    end = line_end(data, at)
    pairs = [pair for text in comments for pair in [pair_of(text)] if pair]
    stated = {key.lower(): value for key, value in pairs}
    return _Head([*comments, row], columns, delimiter, end, line, stated)


def _row(data: bytes, at: int) -> tuple[list[str], str, str | None]:
    """Names of columns, the line that they stand in, and what is between them."""
    row = next(iter(lines_of(data[at : at + HEAD])), "")
    counts = {mark: row.count(mark) for mark in ";\t,"}
    mark = max(counts, key=lambda m: counts[m])
    delimiter = mark if counts[mark] else None
    return [word.strip().strip('"') for word in (row.split(delimiter) if delimiter else row.split())], row, delimiter


def read(data: bytes, name: str, **choices: object) -> Contents:
    """Scans of a table, one for each incident direction, side, scatter and quantity.

    Choices, for what has no column: `columns` (our names and the file's), `angles` (degrees or radians), `side`,
    `scatter`, `quantity`, `incident_theta_deg`, `incident_phi_deg`, `front`, `seen_from`, `up_deg` and `sample`.
    """
    head = _head(data, choices)
    if head is None:
        raise FileFormatError("line 1: no column is known as theta_o or as value (name them: --column value=HEADER)")
    layout = head.columns
    words = [k for k, column in enumerate(layout) if column.role in WORDS or column.role == ""]
    runs = [k for k, column in enumerate(layout) if column.role in (*WORDS, "theta_i", "phi_i", "")]
    # Words that are of no use must not break runs of those that are.
    keys = [k for k in runs if layout[k].role]
    columns, lists, _, line = read_table(
        data,
        len(layout),
        start=head.at,
        line=head.line,
        delimiter=head.delimiter,
        words=words,
        runs=keys,
        empty=head.delimiter is not None,
    )
    starts = columns.pop() if keys else np.zeros(1)
    rows = max((len(columns[k]) for k in range(len(layout)) if k not in keys), default=0)
    if not rows:
        raise FileFormatError(f"line {line}: no rows follow the names of the columns (get the whole file)")
    named = {layout[k].role: lists[n] for n, k in enumerate(words) if layout[k].role}
    table = _Table(head, columns, named, name, digest(data), choices, rows)
    scans, spheres = [], []
    for key, chosen in grouped([columns[k] for k in keys] or [np.zeros(1)], starts, rows):
        group = dict(zip([layout[k].role for k in keys], key, strict=False))
        said = table.word(group, "quantity")
        if said in _COLLECTED:
            spheres += table.sphere(group, chosen, _COLLECTED[said])
        else:
            scans += table.scans(group, chosen)
    warnings = [
        f"{name}: column {column.name!r} is not known and left out"
        for column in layout
        if column.role == "" and column.name
    ]
    measurements = (Measurement(table.sample, tuple(one_band(scans))),) if scans else ()
    return Contents(measurements, tuple(spheres), tuple(warnings))


@dataclass(frozen=True)
class _Table:
    """Columns of a file, with what they mean."""

    head: _Head
    columns: list[Floats]
    lists: dict[str, list[str]]
    file: str
    marks: str
    choices: Mapping[str, object]
    rows: int

    @property
    def sample(self) -> str:
        return sample_of(self.choices, self.file, self.head.stated.get("sample", ""))

    def word(self, group: dict[str, float], role: str) -> str:
        """What a column of words says in these rows."""
        return self.lists[role][int(group[role])].strip().lower() if role in group else ""

    def _values(self, role: str, chosen: slice | NDArray[np.intp]) -> Floats | None:
        found = [k for k, column in enumerate(self.head.columns) if column.role == role]
        if not found:
            return None
        if len(found) == 1:
            return np.asarray(self.columns[found[0]][chosen][:, None])
        return np.stack([self.columns[k][chosen] for k in found], axis=1)

    def _unit(self, role: str) -> float:
        """Degrees of the unit of a column of angles."""
        said = one_of(self.choices, "angles", ("degrees", "radians"), None)
        stated = next((c.unit for c in self.head.columns if c.role == role), "")
        return 180.0 / np.pi if (stated or (said or "deg")[:3]) == "rad" else 1.0

    def _degrees(self, role: str, column: Floats) -> Floats:
        unit = self._unit(role)
        return np.asarray(column[:, 0] if unit == 1.0 else column[:, 0] * unit)

    def _incident(self, group: dict[str, float]) -> tuple[float, float]:
        found: list[float] = []
        for role, key in (("theta_i", "incident_theta_deg"), ("phi_i", "incident_phi_deg")):
            value = group[role] * self._unit(role) if role in group else angle_of(self.choices, key, None)
            stated = self.head.stated.get(role, self.head.stated.get(key))
            if value is None and stated is not None:
                try:
                    value = float(stated)
                except ValueError:
                    raise FileFormatError(
                        f"header: {role} {stated[:40]!r} is not a number (write it as 30.5)"
                    ) from None
            if value is None and role == "phi_i" and found[0] == 0.0:
                value = 0.0
            if value is None or not np.isfinite(value):
                raise FileFormatError(
                    f"no column gives {role}, the incident angle (name it: --column {role}=HEADER, or say it in a line"
                    f" above: # {role}: 30)"
                )
            found.append(value)
        theta, phi = signed(np.array(found[:1]), np.array(found[1:]))
        return float(theta[0]), float(phi[0])

    def _light(self, group: dict[str, float]) -> tuple[Side, float, float, Frame, str]:
        front = cast("Side", one_of(self.choices, "front", ("exterior", "interior"), "exterior"))
        word = self.word(group, "side") or self.head.stated.get("side", "")
        said = cast("Side | None", one_of(self.choices, "side", ("exterior", "interior"), None))
        side = side_named(word, front) if word else said or "exterior"
        seen = cast("Side", one_of(self.choices, "seen_from", ("exterior", "interior"), "interior"))
        frame = Frame(front, cast("float", angle_of(self.choices, "up_deg", 90.0)), seen)
        theta, phi = self._incident(group)
        how = "as stated" if word else "as said" if said else "assumed"
        return side, theta, float(frame.azimuth(phi)), frame, f"light comes from the {side} ({how}); {frame.words}"

    def scans(self, group: dict[str, float], chosen: slice | NDArray[np.intp]) -> list[Scan]:
        """One scan, or one a side that points lie on."""
        side, theta_i, phi_i, frame, words = self._light(group)
        polars = cast("Floats", self._values("theta_o", chosen))
        azimuths = self._values("phi_o", chosen)
        if azimuths is None:
            raise FileFormatError("no column gives phi_o, the outgoing azimuth (name it: --column phi_o=HEADER)")
        theta, phi = signed(self._degrees("theta_o", polars), self._degrees("phi_o", azimuths))
        values, errors = cast("Floats", self._values("value", chosen)), self._values("error", chosen)
        for what, array in (("angle", theta), ("azimuth", phi), ("value", values)):
            if not np.isfinite(array).all():
                raise FileFormatError(f"a row has no {what} (fill the field, or take the row out)")
        held = [column for column in self.head.columns if column.role == "value"]
        scatter = self._scatter(group, held)
        quantity = self._quantity(group, held)
        band = self.word(group, "band")
        channels = tuple(column.channel or "visible" for column in held)
        if errors is not None and errors.shape != values.shape:
            raise FileFormatError("columns of errors do not go with those of values (one each, or none)")
        return [
            Scan(
                side,
                found,
                theta_i,
                phi_i,
                angles,
                frame.turn(phi[part]),
                values[part],
                quantity=quantity,
                channels=(band,) if band and len(channels) == 1 else channels,
                standard_errors=None if errors is None or np.isnan(errors).all() else errors[part],
                purpose=cast("Purpose", one_of(self.head.stated, "purpose", PURPOSES, "sample")),
                conditions=conditions_of(self._pairs, RESERVED),
                source=Source(self.file, self.marks, NAME, tuple(self.head.lines), words),
            )
            for found, part, angles in halves(theta, scatter)
        ]

    @property
    def _pairs(self) -> list[tuple[str, str]]:
        return [pair for text in self.head.lines[:-1] for pair in [pair_of(text)] if pair]

    def _scatter(self, group: dict[str, float], held: list[Column]) -> Scatter | None:
        word = self.word(group, "scatter") or self.head.stated.get("scatter", "").lower() or held[0].word
        if word[:1] == "t" or word.startswith("btdf"):
            return "transmission"
        if word[:1] == "r" or word.startswith("brdf"):
            return "reflection"
        return scatter_of(self.choices)

    def _quantity(self, group: dict[str, float], held: list[Column]) -> Quantity:
        word = self.word(group, "quantity") or self.head.stated.get("quantity", "").lower() or held[0].word
        if word in ("signal", "dsf"):
            return cast("Quantity", word)
        return "bsdf" if word in ("bsdf", "brdf", "btdf") else quantity_of(self.choices, "bsdf")

    def sphere(
        self, group: dict[str, float], chosen: slice | NDArray[np.intp], collected: Collected
    ) -> list[SphereValues]:
        """Values of a whole hemisphere."""
        side, theta, phi, _, words = self._light(group)
        values, errors = cast("Floats", self._values("value", chosen)), self._values("error", chosen)
        scatter = self._scatter(group, [c for c in self.head.columns if c.role == "value"])
        if scatter is None or not np.isfinite(values).all():
            raise FileFormatError("a row of a whole hemisphere has no value, or no scatter (complete it)")
        return [
            SphereValues(
                self.sample,
                side,
                scatter,
                theta,
                values[k],
                collected,
                bands=(self.word(group, "band") or "visible",),
                phi_deg=phi,
                standard_errors=None if errors is None or np.isnan(errors[k]).any() else errors[k],
                source=Source(self.file, self.marks, NAME, tuple(self.head.lines), words),
            )
            for k in range(len(values))
        ]
