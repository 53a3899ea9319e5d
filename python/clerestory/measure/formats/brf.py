"""Tables of bidirectional reflectance factors: zenith and azimuth of source and view, then a column a wavelength."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import FileFormatError
from clerestory.measure.contents import Contents
from clerestory.measure.formats.choices import lit_side, sample_of
from clerestory.measure.formats.specular import seen_from
from clerestory.measure.formats.tokens import Words, head_of, lines_of, within
from clerestory.measure.scan import Measurement, Scan
from clerestory.measure.source import Source, digest

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

NAME = "table of BRF"

_ANGLES = ["src_z", "src_a", "view_z", "view_a"]
_WAVELENGTH = re.compile(r"^(\d+(?:\.\d+)?) ?nm$")
_SAMPLE_LINE = 1
"""Of the header: the kind of values stands before the sample."""


def recognises(data: bytes, name: str) -> bool:
    """Whether a line names the columns of angles."""
    return any(line.split()[:4] == _ANGLES for line in head_of(data))


def read(data: bytes, name: str, **choices: object) -> Contents:
    """Scans of a file, one for each direction of the source.

    Parameters
    ----------
    data
        The file's bytes.
    name
        Its name, for messages.
    choices
        `side` that the light comes from (exterior); `sample`.

    Raises
    ------
    FileFormatError
        A column or a number is wrong, with its line.

    Notes
    -----
    BSDF = BRF / π. A direction of view that was measured more than once stays there as often.
    """
    lines = lines_of(data)
    at = next((k for k, line in enumerate(lines) if line.lower().split()[:4] == _ANGLES), None)
    if at is None:
        raise FileFormatError(f"line {len(lines)}: no line that names the columns {' '.join(_ANGLES)} (is it whole?)")
    names = lines[at].split()[4:]
    channels = tuple(f"{match[1]} nm" for match in map(_WAVELENGTH.match, names) if match)
    if len(channels) != len(names) or not channels or len(set(channels)) < len(channels):
        raise FileFormatError(
            f"line {at + 1}: the columns after the angles are not wavelengths, each once (name them 550nm)"
        )
    width = 4 + len(channels)
    for k, line in enumerate(lines[at + 1 :], start=at + 2):
        if line.strip() and len(line.split()) != width:
            raise FileFormatError(f"line {k}: {len(line.split())} columns instead of {width} (is the file whole?)")
    words = Words(lines[at + 1 :], (), first=at + 2)
    if not len(words):
        raise FileFormatError(f"line {at + 1}: no rows after the names of the columns (is the file whole?)")
    rows = words.numbers(len(words), "values of the table").reshape(-1, width)
    for column, what in ((0, "src_z"), (2, "view_z")):
        within(rows[:, column], what, 0.0, 90.0, at + 2)
    header = tuple(lines[: at + 1])
    side = lit_side(choices)
    source = Source(
        name,
        digest(data),
        NAME,
        header,
        "reflectance factors, π times the BSDF; azimuths of the source and of the view in one frame, counter-clockwise"
        f" from the right as seen from the {side}",
    )
    stated = header[_SAMPLE_LINE].strip() if len(header) > _SAMPLE_LINE + 1 else ""
    conditions = {"description": stated} if stated else {}
    directions, which = np.unique(rows[:, :2], axis=0, return_inverse=True)
    scans = tuple(
        Scan(
            side,
            "reflection",
            float(theta),
            float(seen_from(side, azimuth)),
            rows[which == k, 2],
            seen_from(side, rows[which == k, 3]),
            rows[which == k, 4:] / np.pi,
            channels=channels,
            conditions=conditions,
            source=source,
        )
        for k, (theta, azimuth) in enumerate(directions)
    )
    return Contents((Measurement(sample_of(choices, name, stated.split(",")[0]), scans),))
