"""RT-300S goniophotometer's export for SPEOS (.rtd): OPTIS' header, then its own table and one derived from it.

The first table of a sample is what was measured; the second, on SPEOS' azimuths, is interpolated from it and not read.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import FileFormatError
from clerestory.measure.contents import Contents
from clerestory.measure.formats.choices import ABOVE_DEG, angle_of, lit_side, quantity_of, sample_of
from clerestory.measure.formats.comments import pairs, stated
from clerestory.measure.formats.reflet import CONVENTION, points_of_table
from clerestory.measure.formats.tokens import head_of, lines_of, number
from clerestory.measure.scan import Measurement, Scan
from clerestory.measure.source import Source, digest

if TYPE_CHECKING:
    from collections.abc import Mapping

NAME = "RT-300S export for SPEOS"

_FIRST = "optis - anisotropic bsdf surface file"
_SPECTRUM = re.compile(r"^(reflection|transmission) spectrum", re.IGNORECASE)
_LAST_NUMBER = re.compile(r"(\d+(?:\.\d+)?)\s*$")


def recognises(data: bytes, name: str) -> bool:
    """Whether it begins with OPTIS' title; later versions are of SPEOS itself (`speos_own`)."""
    return any(line.startswith(_FIRST) and line.endswith("v1.0") for line in head_of(data)[:5])


def read(data: bytes, name: str, **choices: object) -> Contents:
    """Scans of a file by sample.

    Parameters
    ----------
    data
        The file's bytes.
    name
        Its name, for messages.
    choices
        `incident_theta_deg`, since the file does not give the angle of incidence of a table; without it the number
        that ends the name of the sample counts. `side` that the light comes from (exterior); `quantity` of the values
        (signal, as instruments export raw ones); `sample` for all of the file.

    Raises
    ------
    FileFormatError
        The header or a table is not whole, with its line, or an angle of incidence is not known.
    """
    lines = lines_of(data)
    starts = [k for k, line in enumerate(lines) if line.strip().lower().startswith(_FIRST)]
    if not starts:
        raise FileFormatError("line 1: no title of an OPTIS anisotropic BSDF (is it an export for SPEOS?)")
    side = lit_side(choices)
    header: list[str] = []
    blocks = []
    for begin, end in zip(starts, [*starts[1:], len(lines)], strict=True):
        if not lines[begin].strip().lower().endswith("v1.0"):
            raise FileFormatError(
                f"line {begin + 1}: {lines[begin].strip()[-10:]!r} is not version v1.0 (export for LightTools)"
            )
        first = _after_spectrum(lines, begin, end)
        header += lines[begin:first]
        blocks.append((begin, first, end))
    source = Source(name, digest(data), NAME, tuple(header), CONVENTION.format(side=side))
    samples: dict[str, list[Scan]] = {}
    notes = []
    for begin, first, end in blocks:
        keys = pairs(lines[begin:first])
        identity = stated(keys, "sampleid")
        theta, note = _incidence(choices, identity, begin + 1)
        notes += [f"{name}: {note}"] if note else []
        polars, azimuths, values = _table(lines, first, end)
        theta_deg, phi_deg, points = points_of_table(polars, azimuths, values, first + 1, side)
        spectrum = next(lines[k].strip().lower() for k in range(begin, first) if _SPECTRUM.match(lines[k].strip()))
        samples.setdefault(sample_of(choices, name, identity), []).append(
            Scan(
                side,
                "reflection" if spectrum.startswith("reflection") else "transmission",
                theta,
                ABOVE_DEG,
                theta_deg,
                phi_deg,
                points,
                quantity=quantity_of(choices, "signal"),
                conditions={key: value for key, value in keys.items() if key.lower() != "sampleid"},
                source=source,
            )
        )
    return Contents(
        tuple(Measurement(sample, tuple(scans)) for sample, scans in samples.items()), (), tuple(dict.fromkeys(notes))
    )


def _after_spectrum(lines: list[str], begin: int, end: int) -> int:
    """Index of the line after the spectrum, which ends the header."""
    title = next((k for k in range(begin, end) if _SPECTRUM.match(lines[k].strip())), None)
    if title is None or title + 1 >= end:
        raise FileFormatError(
            f"line {end}: no Reflection or Transmission Spectrum since line {begin + 1} (is it whole?)"
        )
    count = number(lines[title + 1].strip() or "nothing", "the count of wavelengths", title + 2)
    if count != int(count) or not 0 <= count <= end - title - 2:
        raise FileFormatError(f"line {title + 2}: {count:g} wavelengths, but the file ends before (is it whole?)")
    return title + 2 + int(count)


def _incidence(choices: Mapping[str, object], identity: str, line: int) -> tuple[float, str]:
    """The angle of incidence [°] and what to say of where it came from."""
    said = angle_of(choices, "incident_theta_deg", None)
    found = _LAST_NUMBER.search(identity)
    theta = said if said is not None else float(found[1]) if found and len(found[1]) < 8 else None
    if theta is None or not 0.0 <= theta <= 90.0:
        raise FileFormatError(f"line {line}: the angle of incidence is not known (give incident_theta_deg)")
    if said is not None:
        return theta, ""
    return theta, f"the file gives no angle of incidence; taken as the number that ends its sample, {identity!r}"


def _table(lines: list[str], first: int, end: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Polar angles of rows, azimuths of columns and values of the table that begins at a line."""
    rows = []
    for k in range(first, end):
        if lines[k].strip():
            rows.append((k + 1, lines[k].split()))
        elif rows:
            break
    if len(rows) < 2:
        raise FileFormatError(f"line {first + 1}: no table after the spectrum (is the file whole?)")
    azimuths = np.array([number(word, "an azimuth", rows[0][0]) for word in rows[0][1]])
    for line, words in rows[1:]:
        if len(words) != len(azimuths) + 1:
            raise FileFormatError(
                f"line {line}: {len(words) - 1} values where {len(azimuths)} azimuths are given (is it whole?)"
            )
    numbers = np.array([[number(word, "a value", line) for word in words] for line, words in rows[1:]])
    return numbers[:, 0], azimuths, numbers[:, 1:]
