"""Blocks of scattered directions: a line of an incident direction, then lines of direction and value."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import FileFormatError
from clerestory.measure.formats.specular import HORIZON, seen_from
from clerestory.measure.formats.tokens import number
from clerestory.measure.scan import Scan

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from clerestory.directions import Scatter, Side
    from clerestory.measure.source import Source

    Floats = NDArray[np.float64]

ROUNDED_DEG = 1e-6


def blocks(lines: Sequence[str], first: int) -> list[tuple[int, float, float, Floats]]:
    """Blocks of lines: the number of the first line, two angles, and rows of three numbers (n, 3).

    Parameters
    ----------
    lines
        The text after its header.
    first
        Number of the first of them.

    Raises
    ------
    FileFormatError
        A line has neither two nor three numbers, or a block has no rows.
    """
    split = [line.split() for line in lines]
    heads = [k for k, words in enumerate(split) if len(words) == 2]
    begin = next((k for k, words in enumerate(split) if words), len(split))
    if not heads or begin != heads[0]:
        raise FileFormatError(f"line {first + begin}: values before an incident direction (add its line of two angles)")
    found = []
    for head, end in zip(heads, [*heads[1:], len(split)], strict=True):
        polar, azimuth = (number(word, "an angle of the incident direction", first + head) for word in split[head])
        rows = [(k, words) for k, words in enumerate(split[head + 1 : end], start=head + 1) if words]
        if not rows:
            raise FileFormatError(f"line {first + head}: an incident direction without values (is the file whole?)")
        for k, words in rows:
            if len(words) != 3:
                raise FileFormatError(
                    f"line {first + k}: {len(words)} words instead of two angles and a value (correct it)"
                )
        flat = [word for _, words in rows for word in words]
        try:
            values = np.array(flat, dtype=np.float64)
        except ValueError:
            values = np.full(len(flat), np.nan)
        if not (np.abs(values) <= 1e30).all():
            for k, words in rows:
                for word in words:
                    number(word, "a number", first + k)
        found.append((first + head, polar, azimuth, values.reshape(-1, 3)))
    return found


def scans_of_block(
    block: tuple[int, float, float, Floats],
    side: Side,
    scatter: Scatter,
    source: Source,
    conditions: Mapping[str, str],
    channels: tuple[str, ...] = ("visible",),
) -> list[Scan]:
    """Scans of a block whose incident direction is given by where its specular or straight beam goes to.

    Parameters
    ----------
    block
        As of `blocks`, with angles [°]; polar angles beyond 90° lie on the other side of the sample.
    side
        That the light comes from.
    scatter
        Of polar angles up to 90°.
    """
    line, polar, azimuth, rows = block
    if not 0.0 <= polar <= 90.0:
        raise FileFormatError(f"line {line}: {polar:g}° of incidence is not within 0 to 90° (correct it)")
    theta = rows[:, 0]
    wrong = theta[(theta < 0.0) | (theta > 180.0)]
    if wrong.size:
        raise FileFormatError(f"line {line}: {wrong[0]:g}° of scatter below is not within 0 to 180° (correct it)")
    scans = []
    other: Scatter = "transmission" if scatter == "reflection" else "reflection"
    for behind, kind in ((False, scatter), (True, other)):
        chosen = (theta > 90.0 + ROUNDED_DEG) == behind
        within = np.where(behind, 180.0 - theta, np.minimum(theta, 90.0))
        chosen &= np.cos(np.radians(within)) > HORIZON
        if chosen.any():
            scans.append(
                Scan(
                    side,
                    kind,
                    polar,
                    float(seen_from(side, azimuth + 180.0)),
                    within[chosen],
                    seen_from(side, rows[chosen, 1]),
                    rows[chosen, 2:],
                    channels=channels,
                    conditions=conditions,
                    source=source,
                )
            )
    return scans
