"""Text of Light Tec's Reflet goniophotometers, which RT-300S instruments export for LightTools too.

A header of `key : value` and a table: a row for each polar angle, a column for each azimuth. A scan of two axes is a
mesh over the hemisphere, one of one axis a slice through it. A file may hold several, one after the other.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import FileFormatError
from clerestory.measure.contents import Contents
from clerestory.measure.formats.choices import ABOVE_DEG, lit_side, quantity_of, sample_of
from clerestory.measure.formats.comments import conditions_of, pairs, stated
from clerestory.measure.formats.specular import distinct, seen_from
from clerestory.measure.formats.tokens import head_of, lines_of, number
from clerestory.measure.scan import Measurement, Scan
from clerestory.measure.source import Source, digest

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from clerestory.directions import Scatter, Side
    from clerestory.measure.scan import Quantity

    Floats = NDArray[np.float64]

NAME = "Reflet / RT-300S text"
CONVENTION = (
    "light from above; polar angles from the normal, negative ones across it; azimuth -90° in the plane of incidence, "
    "with positive polar angles toward the specular direction, counter-clockwise as seen from the {side}"
)

_FIRST = "name / comment"
_TABLE = "theta lighting"


def recognises(data: bytes, name: str) -> bool:
    """Whether its keys of the measured angles are there."""
    return any(line.startswith(("theta measure", "theta lighting", "phi measure")) for line in head_of(data))


def read(data: bytes, name: str, **choices: object) -> Contents:
    """Scans of a file, one for each table.

    Parameters
    ----------
    data
        The file's bytes.
    name
        Its name, for messages.
    choices
        `side` that the light comes from (exterior); `quantity` of values that the file calls intensities, whose unit
        it does not give (signal); `sample`.

    Raises
    ------
    FileFormatError
        A key or a number is missing or wrong, with its line.
    """
    lines = lines_of(data)
    starts = [k for k, line in enumerate(lines) if line.strip().lower().startswith(_FIRST)] or [0]
    side = lit_side(choices)
    header: list[str] = []
    tables = []
    for begin, end in zip(starts, [*starts[1:], len(lines)], strict=True):
        at = next((k for k in range(begin, end) if lines[k].strip().lower().startswith(_TABLE)), None)
        if at is None:
            raise FileFormatError(f"line {end}: no line of Theta Lighting since line {begin + 1} (is the file whole?)")
        header += lines[begin : at + 1]
        tables.append((begin, at, end))
    source = Source(name, digest(data), NAME, tuple(header), CONVENTION.format(side=side))
    samples: dict[str, list[Scan]] = {}
    for begin, at, end in tables:
        keys = pairs(lines[begin:at])
        sample = sample_of(choices, name, stated(keys, "name / comment"))
        samples.setdefault(sample, []).append(_scan(lines, at, end, keys, side, source, choices))
    return Contents(tuple(Measurement(sample, tuple(scans)) for sample, scans in samples.items()))


def _scan(
    lines: list[str],
    at: int,
    end: int,
    keys: Mapping[str, str],
    side: Side,
    source: Source,
    choices: Mapping[str, object],
) -> Scan:
    kind = stated(keys, "data file type").lower()
    scatter: Scatter = "transmission" if "btdf" in kind or "trans" in kind else "reflection"
    incident = number(" ".join(lines[at].split()[2:]).lstrip(":").strip() or "nothing", "Theta Lighting", at + 1)
    if not 0.0 <= incident <= 90.0:
        raise FileFormatError(f"line {at + 1}: Theta Lighting {incident:g} is not an angle of 0 to 90° (correct it)")
    rows = [(k + 1, lines[k].split()) for k in range(at + 1, end) if lines[k].strip()]
    if not rows:
        raise FileFormatError(f"line {at + 1}: no table after Theta Lighting (is the file whole?)")
    columns = _azimuths(keys, len(rows[0][1]) - 1, rows[0][0])
    for line, words in rows:
        if len(words) != len(columns) + 1:
            raise FileFormatError(
                f"line {line}: {len(words) - 1} values where {len(columns)} azimuths are declared (is the file whole?)"
            )
    numbers = np.array([[number(word, "a value", line) for word in words] for line, words in rows])
    theta_deg, phi_deg, values = points_of_table(numbers[:, 0], columns, numbers[:, 1:], rows[0][0], side)
    default: Quantity = "signal" if "intensity" in kind else "bsdf"
    conditions = conditions_of({k: v for k, v in keys.items() if k.lower() != _FIRST})
    return Scan(
        side,
        scatter,
        incident,
        ABOVE_DEG,
        theta_deg,
        phi_deg,
        values,
        quantity=quantity_of(choices, default),
        conditions=conditions,
        source=source,
    )


def _azimuths(keys: Mapping[str, str], columns: int, line: int) -> Floats:
    """Azimuths [°] of a table's columns: those that the header gives, or the plane of incidence of a slice."""
    given = [stated(keys, f"phi measure {word}") for word in ("beginning", "end", "step")]
    if not any(given):
        if columns != 1:
            raise FileFormatError(
                f"line {line}: {columns} columns without Phi measure beginning, end and step (add them)"
            )
        return np.array([-90.0])
    first, last, step = (
        number(word or "nothing", f"Phi measure {what}", line)
        for word, what in zip(given, ("beginning", "end", "step"), strict=True)
    )
    count = round((last - first) / step) + 1 if step else 1
    if count != columns:
        raise FileFormatError(
            f"line {line}: {columns} values in a row where azimuths {first:g} to {last:g}° by {step:g}° are declared"
            " (is the file whole?)"
        )
    return first + step * np.arange(columns, dtype=np.float64)


def points_of_table(
    polar_deg: Floats, azimuth_deg: Floats, values: Floats, line: int, side: Side
) -> tuple[Floats, Floats, Floats]:
    """Points of a table of this instrument's angles, each once: polar angles and azimuths [°] (n,), values (n, 1).

    Parameters
    ----------
    polar_deg
        Signed polar angles of the rows [°] (rows,).
    azimuth_deg
        Of the columns [°] (columns,).
    values
        Of shape (rows, columns).
    line
        Of the table's first row, for messages.
    side
        That the light comes from.

    Notes
    -----
    In this frame the light comes from azimuth 90° and the specular direction has -90°, both with positive polar
    angles, so its azimuths are those that who stands on the lit side counts from the right with the light from above.
    """
    beyond = polar_deg[np.abs(polar_deg) > 90.0]
    if beyond.size:
        raise FileFormatError(f"line {line}: polar angle {beyond[0]:g} is not one of -90 to 90° (correct it)")
    polar, azimuth = np.broadcast_arrays(polar_deg[:, None], azimuth_deg)
    theta_deg = np.abs(polar).ravel()
    phi_deg = seen_from(side, np.where(polar < 0.0, azimuth + 180.0, azimuth)).ravel()
    flat = values.reshape(-1, 1)
    kept = distinct(theta_deg, phi_deg, flat)
    return theta_deg[kept], phi_deg[kept], flat[kept]
