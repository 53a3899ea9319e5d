"""Blocks of scattered directions: a line of an incident direction, then lines of direction and value."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import FileFormatError, read_table
from clerestory.measure.formats.specular import HORIZON, seen_from
from clerestory.measure.formats.tokens import LARGEST, number
from clerestory.measure.scan import Scan

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from clerestory.directions import Scatter, Side
    from clerestory.measure.source import Source

    Floats = NDArray[np.float64]

_ROUNDED_DEG = 1e-6

_TWO_WORDS = re.compile(r"^[ \t]*(\S+)[ \t]+(\S+)[ \t]*$", re.MULTILINE)


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
    text = "\n".join(lines)
    heads = list(_TWO_WORDS.finditer(text))
    if not heads or text[: heads[0].start()].strip():
        begin = first + text.count("\n", 0, len(text) - len(text.lstrip()))
        raise FileFormatError(f"line {begin}: values before an incident direction (add its line of two angles)")
    found = []
    line, at = first, 0
    for head, after in zip(heads, [*heads[1:], None], strict=True):
        line += text.count("\n", at, head.start())
        at = head.start()
        polar, azimuth = (number(word, "an angle of the incident direction", line) for word in head.groups())
        rows = text[head.end() : after.start() if after else len(text)]
        if not rows.strip():
            raise FileFormatError(f"line {line}: an incident direction without values (is the file whole?)")
        columns, _, _, _ = read_table(rows.encode(), 3, line=line)
        values = np.column_stack(columns)
        if np.abs(values).max() > LARGEST:
            raise FileFormatError(f"line {line}: a number below is beyond {LARGEST:g} (correct it)")
        found.append((line, polar, azimuth, values))
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
        chosen = (theta > 90.0 + _ROUNDED_DEG) == behind
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
