"""Measured BSDF of engineered diffusers by RPC Photonics (VIAVI): lines of `!!`, the incident direction, and points."""

from __future__ import annotations

import re

from clerestory._core import FileFormatError
from clerestory.measure.contents import Contents
from clerestory.measure.formats.choices import lit_side, sample_of, scatter_of
from clerestory.measure.formats.listed import blocks, scans_of_block
from clerestory.measure.formats.tokens import head_of, lines_of
from clerestory.measure.scan import Measurement
from clerestory.measure.source import Source, digest

NAME = "RPC/VIAVI BSDF"

_DATE = re.compile(r"\b(\d{1,2})/(\d{1,2})/(\d{4})\b")


def recognises(data: bytes, name: str) -> bool:
    """Whether it begins with lines of `!!`."""
    return next((line for line in head_of(data) if line), "").startswith("!!")


def read(data: bytes, name: str, **choices: object) -> Contents:
    """Scans of a file.

    Parameters
    ----------
    data
        The file's bytes.
    name
        Its name, for messages.
    choices
        `scatter` (transmission, as diffusers are measured); `side` that the light comes from (exterior); `sample`.

    Raises
    ------
    FileFormatError
        A number is wrong, with its line.
    """
    lines = lines_of(data)
    first = next((k for k, line in enumerate(lines) if line.strip() and not line.startswith("!!")), len(lines))
    if first in (0, len(lines)):
        raise FileFormatError(f"line {first + 1}: no header of !! before values (is the file whole?)")
    header = tuple(lines[:first])
    title = next((line for line in header if line.strip()), "").removeprefix("!!")
    side, scatter = lit_side(choices), scatter_of(choices) or "transmission"
    conditions = {"laboratory": "RPC Photonics"} if "RPC Photonics" in title else {}
    dated = _DATE.search(title)
    if dated:
        conditions["date"] = f"{dated[3]}-{int(dated[1]):02d}-{int(dated[2]):02d}"
    source = Source(
        name,
        digest(data),
        NAME,
        header,
        f"{scatter}; incident directions given by those of their straight beams, where the light is seen to go;"
        f" azimuths counter-clockwise from the right as seen from the {side}",
    )
    scans = [
        scan
        for block in blocks(lines[first:], first + 1)
        for scan in scans_of_block(block, side, scatter, source, conditions)
    ]
    return Contents((Measurement(sample_of(choices, name, title.split()[0] if title.split() else ""), tuple(scans)),))
