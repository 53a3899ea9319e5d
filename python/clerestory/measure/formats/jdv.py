"""RT-300S goniophotometer's .jdv text: keys, then a table with a row for each azimuth, several samples in a file."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import FileFormatError
from clerestory.measure.contents import Contents
from clerestory.measure.formats.choices import ABOVE_DEG, lit_side, quantity_of, sample_of
from clerestory.measure.formats.comments import conditions_of, pairs, stated
from clerestory.measure.formats.reflet import CONVENTION, points_of_table
from clerestory.measure.formats.tokens import head_of, lines_of, number
from clerestory.measure.scan import Measurement, Scan
from clerestory.measure.source import Source, digest

if TYPE_CHECKING:
    from collections.abc import Mapping

    from clerestory.directions import Side
    from clerestory.measure.scan import Quantity

NAME = "RT-300S .jdv"

_FIRST = "datatype:"


def recognises(data: bytes, name: str) -> bool:
    """Whether it begins with the type of its data and names the incidence."""
    head = head_of(data)
    return (
        head[:1] != []
        and any(line.startswith(_FIRST) for line in head)
        and any(x.startswith("incidence:") for x in head)
    )


def read(data: bytes, name: str, **choices: object) -> Contents:
    """Scans of a file by sample.

    Parameters
    ----------
    data
        The file's bytes.
    name
        Its name, for messages.
    choices
        `side` that the light comes from (exterior); `quantity` of raw data (signal); `sample` for all of the file.

    Raises
    ------
    FileFormatError
        A key or a number is missing or wrong, with its line.
    """
    lines = lines_of(data)
    starts = [k for k, line in enumerate(lines) if line.strip().lower().startswith(_FIRST)]
    if not starts:
        raise FileFormatError("line 1: no line of DataType (is it an RT-300S .jdv file?)")
    side = lit_side(choices)
    blocks = []
    for begin, end in zip(starts, [*starts[1:], len(lines)], strict=True):
        rows = [(k + 1, lines[k].split()) for k in range(begin, end) if lines[k].strip() and ":" not in lines[k]]
        if len(rows) < 3 or rows[0][1][0].lstrip("-").isdigit():
            raise FileFormatError(f"line {end}: no table since line {begin + 1} (is the file whole?)")
        blocks.append((begin, rows))
    header = [line for begin, rows in blocks for line in lines[begin : rows[0][0]]]
    source = Source(name, digest(data), NAME, tuple(header), CONVENTION.format(side=side))
    samples: dict[str, list[Scan]] = {}
    for begin, rows in blocks:
        keys = pairs(lines[begin : rows[0][0]])
        sample = sample_of(choices, name, stated(keys, "sampleid"))
        samples.setdefault(sample, []).append(_scan(rows, keys, side, source, choices))
    return Contents(tuple(Measurement(sample, tuple(scans)) for sample, scans in samples.items()))


def _scan(
    rows: list[tuple[int, list[str]]],
    keys: Mapping[str, str],
    side: Side,
    source: Source,
    choices: Mapping[str, object],
) -> Scan:
    title = " ".join(rows[0][1]).lower()
    (line, heads), table = rows[1], rows[2:]
    incident = number(stated(keys, "incidence") or "nothing", "Incidence", line)
    if not 0.0 <= incident <= 90.0:
        raise FileFormatError(f"line {line}: Incidence {incident:g} is not an angle of 0 to 90° (correct it)")
    polars = np.array([number(word, "a polar angle", line) for word in heads])
    for at, words in table:
        if len(words) != len(heads) + 1:
            raise FileFormatError(
                f"line {at}: {len(words) - 1} values where {len(heads)} polar angles are given (is the file whole?)"
            )
    numbers = np.array([[number(word, "a value", at) for word in words] for at, words in table])
    theta_deg, phi_deg, values = points_of_table(polars, numbers[:, 0], numbers[:, 1:].T, line, side)
    default: Quantity = "signal" if "raw" in title else "bsdf"
    kind = stated(keys, "datatype").lower()
    return Scan(
        side,
        "transmission" if "btdf" in kind else "reflection",
        incident,
        ABOVE_DEG,
        theta_deg,
        phi_deg,
        values,
        quantity=quantity_of(choices, default),
        conditions=conditions_of({k: v for k, v in keys.items() if k.lower() not in ("sampleid", "incidence")}),
        source=source,
    )
