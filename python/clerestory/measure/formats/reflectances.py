"""The table of angles of incidence, transmittances and reflectances that goes with LightTools' scatter data.

Goniophotometers that export for LightTools write it as RTfile.txt: lines of `AOI angle transmittance reflectance`.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import FileFormatError
from clerestory.directions import SCATTERS
from clerestory.measure.contents import Contents
from clerestory.measure.formats.choices import lit_side, sample_of
from clerestory.measure.formats.comments import pairs, stated
from clerestory.measure.formats.tokens import head_of, lines_of, number
from clerestory.measure.source import Source, digest
from clerestory.measure.sphere import SphereValues

if TYPE_CHECKING:
    from collections.abc import Mapping

    from clerestory.directions import Scatter, Side

NAME = "table of AOI, T and R"

_ROW = re.compile(r"^\s*aoi\b[\s:=]*(.*)$", re.IGNORECASE)
_FIRST_ROW = re.compile(r"^aoi[\s:=]+[-+.\d]\S*[\s,;]+[-+.\d]\S*[\s,;]+[-+.\d]")


def recognises(data: bytes, name: str) -> bool:
    """Whether a line of the angle and both values is there."""
    return any(_FIRST_ROW.match(line) for line in head_of(data))


def read(data: bytes, name: str, **choices: object) -> Contents:
    """Direct-hemispherical transmittances and reflectances of a file.

    Parameters
    ----------
    data
        The file's bytes.
    name
        Its name, for messages.
    choices
        `side` that the light comes from (exterior), unless a comment `Incident side:` says it; `sample`.

    Raises
    ------
    FileFormatError
        A row is not an angle and two shares, with its line.
    """
    lines = lines_of(data)
    header = tuple(line for line in lines if line.strip() and not _ROW.match(line))
    comments = pairs(header)
    side = lit_side({"side": stated(comments, "incident side") or None, **{k: v for k, v in choices.items() if v}})
    sample = sample_of(choices, name, stated(comments, "sample"))
    source = Source(
        name, digest(data), NAME, header, f"AOI from the normal, then transmittance, then reflectance of the {side}"
    )
    found = []
    for at, line in enumerate(lines, start=1):
        row = _ROW.match(line)
        if not row:
            continue
        words = row[1].replace(",", " ").replace(";", " ").split()
        if len(words) != 3:
            raise FileFormatError(f"line {at}: {len(words)} numbers after AOI instead of 3 (angle, T and R)")
        theta, *shares = (number(word, "a number of the row", at) for word in words)
        if not 0.0 <= theta <= 90.0:
            raise FileFormatError(f"line {at}: AOI {theta:g} is not an angle of 0 to 90° (correct it)")
        if max(shares) > 1.5:
            raise FileFormatError(f"line {at}: {max(shares):g} is no share of the light (give shares, not per cent)")
        found += [
            SphereValues(sample, side, scatter, theta, np.array([share]), bands=("visible",), source=source)
            for scatter, share in zip(SCATTERS, shares, strict=True)
        ]
    return Contents((), tuple(found))


def text(side: Side, totals: Mapping[tuple[Side, Scatter, float], float]) -> str:
    """Rows of one lit side, where both transmittance and reflectance are known at an angle [°]; none if nowhere."""
    angles = sorted({theta for lit, _, theta in totals if lit == side})
    both = [theta for theta in angles if all((side, scatter, theta) in totals for scatter in SCATTERS)]
    if not both:
        return ""
    rows = [f"AOI {a:.10g} " + " ".join(f"{totals[side, scatter, a]:.6g}" for scatter in SCATTERS) for a in both]
    return "\n".join([f"# Incident side: {side}", *rows]) + "\n"
