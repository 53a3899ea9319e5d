"""FRED's tabular BSDF: a title, a line of units, then blocks of an incident direction and its scatter."""

from __future__ import annotations

import math

import numpy as np

from clerestory._core import FileFormatError
from clerestory.measure.contents import Contents
from clerestory.measure.formats.choices import lit_side, sample_of
from clerestory.measure.formats.listed import blocks, scans_of_block
from clerestory.measure.formats.tokens import head_of, lines_of, number
from clerestory.measure.scan import Measurement
from clerestory.measure.source import Source, digest

NAME = "FRED BSDF"


def recognises(data: bytes, name: str) -> bool:
    """Whether it begins with the title."""
    return next((line for line in head_of(data) if line), "").split() == ["type", "bsdf_data"]


def read(data: bytes, name: str, **choices: object) -> Contents:
    """Scans of a file, one for each incident direction and side that its light leaves to.

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
        A unit is not known, or a number is wrong, with its line.
    """
    lines = lines_of(data)
    title = next(k for k, line in enumerate(lines) if line.strip())
    at = next((k for k in range(title + 1, len(lines)) if lines[k].strip()), len(lines))
    words = lines[at].split() if at < len(lines) else []
    if not words or words[0].lower() != "format":
        raise FileFormatError(f"line {at + 1}: no line of format after the title (add angles=deg bsdf=value scale=1)")
    units = dict(word.lower().split("=", 1) for word in words[1:] if "=" in word)
    angles, kind = units.get("angles", "deg"), units.get("bsdf", "value")
    if angles not in ("deg", "rad") or kind not in ("value", "log"):
        raise FileFormatError(f"line {at + 1}: angles={angles} bsdf={kind} is not known (deg or rad, value or log)")
    scale = number(units.get("scale", "1"), "scale", at + 1)
    side = lit_side(choices)
    source = Source(
        name,
        digest(data),
        NAME,
        tuple(lines[: at + 1]),
        "incident directions given by those of their specular beams; azimuths counter-clockwise from the right as seen"
        f" from the {side}; polar angles beyond 90° behind the sample",
    )
    scans = []
    unit = 180.0 / math.pi if angles == "rad" else 1.0
    for line, polar, azimuth, rows in blocks(lines[at + 1 :], at + 2):
        scaled = rows * np.array([unit, unit, 1.0])
        if kind == "log":
            if (np.abs(scaled[:, 2]) > 30.0).any():
                raise FileFormatError(f"line {line}: a logarithm below is beyond ±30 (is it bsdf=value?)")
            scaled[:, 2] = 10.0 ** scaled[:, 2]
        scaled[:, 2] *= scale
        scans += scans_of_block((line, polar * unit, azimuth * unit, scaled), side, "reflection", source, {})
    return Contents((Measurement(sample_of(choices, name), tuple(scans)),))
