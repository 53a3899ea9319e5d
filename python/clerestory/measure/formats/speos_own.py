"""SPEOS' own text files: anisotropic BSDF (.anisotropicbsdf, v7 and v8) and spectral BRDF (.brdf).

After Ansys' public help pages "Structure of Anisotropic BSDF files", "Structure of BRDF files" and "Anisotropic BSDF
Surface Overview": polar angles are from the normal of the lit side, 0 to 180°; azimuth 0 is where light that goes
straight on, or is mirrored, arrives; values are proportional to BSDF or to intensity, and the stated reflectance or
transmittance sets their level.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError, FileFormatError
from clerestory.measure.contents import Contents
from clerestory.measure.delaunay import surface
from clerestory.measure.formats.choices import ABOVE_DEG, lit_side, sample_of
from clerestory.measure.formats.specular import distinct, seen_from
from clerestory.measure.formats.tokens import Words, head_of, lines_of, number, within
from clerestory.measure.scan import Measurement, Scan
from clerestory.measure.source import Source, digest

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from clerestory.directions import Scatter, Side
    from clerestory.measure.scan import Quantity

    Floats = NDArray[np.float64]

NAME = "SPEOS BSDF text"

_ANISOTROPIC = "optis - anisotropic bsdf surface file"
_SPECTRAL = "optis - brdf surface file"
_NOT_OURS = "v1.0"  # of a goniophotometer's export, another layout
_INSTEAD = "save transmission and reflection as text files of their own"


@dataclass(frozen=True)
class _Head:
    """What stands before the numbers of the tables."""

    scatter: Scatter
    quantity: Quantity
    lines: int
    """How many lines it takes."""


def recognises(data: bytes, name: str) -> bool:
    """Whether it begins with the title of one of SPEOS' files."""
    first = next(iter(head_of(data)), "")
    return first.startswith((_ANISOTROPIC, _SPECTRAL)) and not first.endswith(_NOT_OURS)


def read(data: bytes, name: str, **choices: object) -> Contents:
    """Scans of a file, one an incident direction.

    Parameters
    ----------
    data
        The file's bytes.
    name
        Its name, for messages.
    choices
        `side` that the light comes from (exterior) and `sample`.

    Raises
    ------
    FileFormatError
        It is binary, holds reflection and transmission in one, is not whole or not in order; with its line.
    """
    lines = lines_of(data)
    anisotropic = lines[0].strip().lower().startswith(_ANISOTROPIC)
    head = _head(lines, anisotropic)
    words = Words(lines[head.lines :], (), head.lines + 1)
    side = lit_side(choices)
    source = Source(
        name,
        digest(data),
        NAME,
        tuple(lines[: head.lines]),
        f"light comes from the {side}, from above at anisotropy angle 0; azimuths are counter-clockwise as seen from"
        " there, 0 where straight or mirrored light arrives; the level is the stated share of the light",
    )
    make = _anisotropic if anisotropic else _spectral
    scans = make(words, head, side, source)
    return Contents((Measurement(sample_of(choices, name), tuple(scans)),))


def _head(lines: list[str], anisotropic: bool) -> _Head:  # noqa: FBT001
    """Title, mode, comment, description, the anisotropy vector, which scatter, and what values are."""

    def line(k: int) -> str:
        if k >= len(lines):
            raise FileFormatError(f"line {len(lines)}: the file ends in its header (is it whole?)")
        return lines[k].strip()

    if line(1) != "0":
        raise FileFormatError("line 2: a binary file, whose layout is not public (save it as text, mode 0)")
    left = number(line(3) or "nothing", "the length of the description", 4)
    at = 4
    # The description may go over lines; what ends a line counts for one character, or for none in some files.
    while left > 0:
        left -= len(line(at)) + 1
        at += 1
    while not line(at):
        at += 1
    if anisotropic:
        at += 1
    flags = line(at).split()
    if len(flags) != 2 or any(flag not in ("0", "1") for flag in flags) or flags == ["0", "0"]:
        raise FileFormatError(
            f"line {at + 1}: {line(at)[:40]!r} does not say whether there is reflection and transmission (0 or 1 each)"
        )
    if flags == ["1", "1"]:
        raise FileFormatError(f"line {at + 1}: reflection and transmission in one file are not read ({_INSTEAD})")
    kind = line(at + 1)
    if kind not in ("0", "1"):
        raise FileFormatError(f"line {at + 2}: {kind[:40]!r} does not say what the values are (1 BSDF, 0 intensity)")
    return _Head("reflection" if flags[0] == "1" else "transmission", "bsdf" if kind == "1" else "dsf", at + 2)


def _anisotropic(words: Words, head: _Head, side: Side, source: Source) -> list[Scan]:
    turns = words.angles("anisotropy angles", -360.0, 360.0)
    incidences = [words.angles("incident angles", 0.0, 90.0) for _ in turns]
    measured = words.numbers(2, "the direction of the spectrum")
    if len(words) and not words.peek().isdigit():  # a line that describes the spectrum; blank in most files
        words.take("the description of the spectrum")
        words.rest_of_line()
    count = words.count("wavelengths")
    spectrum = words.numbers(2 * count, "the spectrum").reshape(-1, 2)
    scans = [
        _scan(words, head, side, source, float(theta), float(turn))
        for turn, thetas in zip(turns, incidences, strict=True)
        for theta in thetas
    ]
    # The spectrum was measured for one direction; all tables have the level that it gives there.
    near = min(scans, key=lambda s: abs(s.incident_theta_deg - measured[0]))
    factors = 0.01 * spectrum[:, 1] / _total(near)
    if np.ptp(factors) <= 1e-9 * factors.max():
        return [_times(scan, factors[:1], ("visible",)) for scan in scans]
    return [_times(scan, factors, tuple(f"{nm:g} nm" for nm in spectrum[:, 0])) for scan in scans]


def _spectral(words: Words, head: _Head, side: Side, source: Source) -> list[Scan]:
    incidents, wavelengths = words.count("incident angles"), words.count("wavelengths")
    line = words.line
    thetas = words.numbers(incidents, "incident angles")
    within(thetas, "incident angles", 0.0, 90.0, line)
    names = tuple(f"{nm:g} nm" for nm in words.numbers(wavelengths, "wavelengths"))
    made = []
    for theta in thetas:
        for nm in names:
            share = words.number(f"the share of the light at {nm}")
            scan = _scan(words, head, side, source, float(theta), 0.0)
            made.append(_times(scan, np.array([0.01 * share / _total(scan)]), (nm,)))
    return made


def _scan(words: Words, head: _Head, side: Side, source: Source, theta_deg: float, turn_deg: float) -> Scan:
    """One table as a scan, at the level that it has in the file."""
    rows, columns = words.count("polar angles"), words.count("azimuths")
    line = words.line
    phi = words.numbers(columns, "azimuths")
    table = words.numbers(rows * (columns + 1), "a table").reshape(rows, columns + 1)
    within(table[:, 0], "polar angles", 0.0, 180.0, line)
    polar, azimuth = np.repeat(table[:, 0], columns), np.tile(phi, rows)
    if polar.max() > 90.0:
        if head.scatter == "reflection" or polar.min() < 90.0:
            raise FileFormatError(
                f"line {line}: polar angles from {polar.min():g} to {polar.max():g}° for {head.scatter} (check the"
                " header)"
            )
        polar = 180.0 - polar
    values = table[:, 1:].reshape(-1, 1)
    kept = distinct(polar, azimuth, values)
    # The light's way in the plane of the lit side: downward at anisotropy angle 0.
    way = 180.0 + ABOVE_DEG - turn_deg
    return Scan(
        side,
        head.scatter,
        theta_deg,
        float(seen_from(side, way - 180.0)),
        polar[kept],
        np.asarray(seen_from(side, way + azimuth[kept])),
        values[kept],
        quantity=head.quantity,
        source=source,
    )


def _total(scan: Scan) -> float:
    """What a table integrates to as it stands."""
    try:
        total = float(surface(scan.as_bsdf()).integrate().total[0])
    except ClerestoryError as error:
        raise FileFormatError(f"the table of {scan.incident_theta_deg:g}° has no integral: {error}") from error
    if not total > 0.0:
        raise FileFormatError(f"the table of {scan.incident_theta_deg:g}° has no light (check its values)")
    return total


def _times(scan: Scan, factors: Floats, channels: tuple[str, ...]) -> Scan:
    return replace(scan, values=scan.values * factors, channels=channels)
