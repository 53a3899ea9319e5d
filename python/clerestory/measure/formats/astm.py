"""Tables of ASTM E1392 and E2387: keywords, a line VARS that names the columns, then rows of all incident directions.

Angles are radians in the files that are in use, azimuths those of the direction to the source and of the light,
counter-clockwise as seen by who looks at the lit side. The standards name the quantities and leave the layout open, so
what a file does not say is told by a person.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, cast

import numpy as np

from clerestory._core import FileFormatError, read_table, write_table
from clerestory.counts import counted
from clerestory.directions import SIDES
from clerestory.measure.contents import Contents
from clerestory.measure.formats.choices import lit_side, one_of, sample_of, scatter_of
from clerestory.measure.formats.frame import Frame, halves, signed
from clerestory.measure.formats.header import HEAD, condition_key, lines_of, one_line, text_of, writable
from clerestory.measure.formats.names import plain, untaken
from clerestory.measure.formats.rows import grouped, repeated
from clerestory.measure.scan import CONDITIONS, PURPOSES, Measurement, Scan
from clerestory.measure.source import Source, digest

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from clerestory.directions import Scatter, Side
    from clerestory.measure.scan import Purpose, Quantity

    Floats = NDArray[np.float64]

NAME = "ASTM E2387"
FRAMED = True
"""Whether `front`, `seen_from` and `up_deg` say how its sides and azimuths count."""

_ANGLES = ("theta_i", "phi_i", "theta_s", "phi_s")
_VARS = re.compile(rb"^[ \t]*VARS[ \t]+(theta_i\b[^\r\n]*)", re.IGNORECASE | re.MULTILINE)
_CHANNELS = {"": "visible", "value": "visible", "bsdf": "visible", "brdf": "visible", "btdf": "visible"}
_WAVELENGTH = re.compile(r"^(\d+(?:\.\d+)?)\s*nm$", re.IGNORECASE)
_RESERVED = ("type", "sample_id", "incident_side", "quantity", "angle_unit", "purpose", "num_points", "vars", "up_deg")
_SCATTERS: dict[str, Scatter] = {"brdf": "reflection", "btdf": "transmission"}
_DEGREES_FROM = 3.5
"""A polar angle above this is none in radians."""


def recognises(data: bytes, name: str) -> bool:
    """Whether a line VARS begins with the incident angle."""
    return _VARS.search(data[:HEAD].replace(b"\r", b"\n")) is not None


def read(data: bytes, name: str, **choices: object) -> Contents:
    """Scans of a file, one for each incident direction.

    Choices are `side` (the lit one), `scatter`, `quantity` (dsf where values are corrected by the cosine), `angles`
    (degrees or radians), `seen_from`, `up_deg` and `sample`, for files that do not say.
    """
    found = cast("re.Match[bytes]", _VARS.search(data[:HEAD].replace(b"\r", b"\n")))
    header = tuple(line for line in lines_of(data[: found.end()]) if line.strip())
    stated = _keywords(header[:-1])
    names = [word.strip() for word in text_of(found[1]).split(",")]
    if tuple(word.lower() for word in names[:4]) != _ANGLES:
        raise FileFormatError(
            f"line {len(header)}: VARS {','.join(names)[:60]} does not begin with {','.join(_ANGLES)} "
            "(reorder the columns)"
        )
    columns, starts, line = _table(data, found.end(), len(header), names)
    rows = len(columns[2])
    announced = stated.get("NUM_POINTS", "")
    if announced.isdigit() and int(announced) != rows:
        raise FileFormatError(f"line {line}: {rows} rows, and NUM_POINTS announces {announced} (get the whole file)")
    units, warnings = _unit(stated, columns, choices)
    scatter = scatter_of(choices) or _SCATTERS.get(stated.get("TYPE", "").lower()[:4])
    side = cast("Side", one_of(choices, "side", SIDES, stated.get("INCIDENT_SIDE", "").lower() or lit_side(choices)))
    frame = Frame.chosen(choices, side, float(stated["UP_DEG"]) if _is_number(stated.get("UP_DEG")) else 90.0)
    quantity, words = _quantity(stated, choices)
    source = Source(
        name,
        digest(data),
        NAME,
        header,
        f"light comes from the {side} ({'as stated' if 'INCIDENT_SIDE' in stated else 'assumed'}); {frame.words}; "
        f"angles in {'degrees' if units == 1.0 else 'radians'}; {words}",
    )
    theta, phi = signed(columns[2] * units, columns[3] * units)
    values = columns[4][:, None] if len(columns) == 5 else np.stack(columns[4:], axis=1)
    del columns[4:]
    scans = []
    for (theta_i, phi_i), chosen in grouped([columns[0], columns[1]], starts, rows):
        incident, azimuth = signed(np.array([theta_i * units]), np.array([phi_i * units]))
        for found_scatter, part, angles in halves(theta[chosen], scatter):
            scan = Scan(
                side,
                found_scatter,
                float(incident[0]),
                float(frame.azimuth(azimuth[0])),
                angles,
                frame.azimuth(phi[chosen][part]),
                values[chosen][part],
                quantity=quantity,
                channels=tuple(_channel(word) for word in names[4:]) or ("visible",),
                purpose=cast("Purpose", one_of({"purpose": stated.get("PURPOSE")}, "purpose", PURPOSES, "sample")),
                conditions={condition_key(k): v for k, v in stated.items() if v and k.lower() not in _RESERVED},
                source=source,
            )
            scans.append(scan)
    return Contents(
        (Measurement(sample_of(choices, name, stated.get("SAMPLE_ID", "")), tuple(scans)),), warnings=tuple(warnings)
    )


def _keywords(header: tuple[str, ...]) -> dict[str, str]:
    """Values by keywords: those that mean something here in capitals, others as they stand."""
    pairs = (line.strip().partition(" ") for line in header if not line.lstrip().startswith("#"))
    return {key.upper() if key.lower() in _RESERVED else key: value.strip() for key, _, value in pairs}


def _table(data: bytes, start: int, line: int, names: list[str]) -> tuple[list[Floats], Floats, int]:
    first = next((row for row in lines_of(data[start : start + HEAD]) if row.strip() and row.lstrip()[0] != "#"), "")
    width = len([word for word in re.split(r"[,;\s]+", first.strip()) if word])
    if not width:
        raise FileFormatError(f"line {line + 1}: no rows follow VARS (get the whole file)")
    # The name of a single column of values may be missing.
    wanted = 5 if len(names) == 4 and width == 5 else len(names)
    if wanted < 5:
        raise FileFormatError(f"line {line}: VARS has no column of values (name one behind phi_s)")
    columns, _, _, end = read_table(data, wanted, start=start, line=line, runs=[0, 1])
    return columns[:-1], columns[-1], end


def _unit(stated: dict[str, str], columns: list[Floats], choices: dict[str, object]) -> tuple[float, list[str]]:
    """Degrees of a unit of the angles."""
    said = one_of(choices, "angles", ("degrees", "radians"), None)
    said = said or {"deg": "degrees", "rad": "radians"}.get(stated.get("ANGLE_UNIT", "").lower()[:3])
    largest = max(float(np.abs(columns[k]).max()) for k in (0, 2))
    if said is None and largest > _DEGREES_FROM:
        return 1.0, [f"an angle to the normal is {largest:g}: taken for degrees, though ASTM's tables have radians"]
    if said == "radians" and largest > _DEGREES_FROM:
        raise FileFormatError(f"an angle to the normal is {largest:g} and cannot be radians (give angles: degrees)")
    return (1.0 if said == "degrees" else 180.0 / np.pi), []


def _quantity(stated: dict[str, str], choices: dict[str, object]) -> tuple[Quantity, str]:
    said = one_of(choices, "quantity", ("bsdf", "dsf"), None)
    words = f"{stated.get('QUANTITY', '')} {stated.get('TYPE', '')}".lower()
    if said is None and ("cosine" in words or "dsf" in words.split()):
        said = "dsf"
    return ("dsf", "values are BSDF times the cosine") if said == "dsf" else ("bsdf", "values are BSDF")


def _channel(word: str) -> str:
    match = _WAVELENGTH.match(word)
    return f"{match[1]} nm" if match else _CHANNELS.get(word.lower(), word)


def _is_number(word: str | None) -> bool:
    return word is not None and re.fullmatch(r"-?\d+(\.\d*)?", word) is not None


def write(measurement: Measurement, **choices: object) -> dict[str, bytes]:
    """A file for all scans of a side, a scatter and the same conditions; angles in radians, up is azimuth 90°."""
    groups: dict[tuple[object, ...], list[Scan]] = {}
    for before, scan in repeated(measurement.scans):
        writable(scan, NAME)
        held = (scan.incident_side, scan.scatter, scan.quantity, scan.channels, scan.purpose)
        key = (before, *held, *scan.conditions.items())
        groups.setdefault(key, []).append(scan)
    files: dict[str, bytes] = {}
    for scans in groups.values():
        first = scans[0]
        more = [] if first.purpose == "sample" else [first.purpose]
        stem = "_".join([plain(measurement.sample), first.incident_side, first.scatter, *more])
        files[untaken(stem, ".astm", files)] = _written(measurement.sample, scans)
    return files


def _written(sample: str, scans: list[Scan]) -> bytes:
    first = scans[0]
    frame = Frame(first.incident_side, 90.0, first.incident_side)
    names = [
        "value" if name == "visible" and len(first.channels) == 1 else name.replace(" nm", "nm").replace(",", " ")
        for name in first.channels
    ]
    lines = [
        f"TYPE {'BRDF' if first.scatter == 'reflection' else 'BTDF'}",
        f"SAMPLE_ID {one_line(sample)}",
        f"INCIDENT_SIDE {first.incident_side}",
        f"QUANTITY {'BSDF' if first.quantity == 'bsdf' else 'COSINE_CORRECTED_BSDF'}",
        "ANGLE_UNIT RADIANS",
        f"UP_DEG {frame.up_deg:g}",
        *([] if first.purpose == "sample" else [f"PURPOSE {first.purpose}"]),
        *(f"{_keyword(key)} {one_line(value)}" for key, value in first.conditions.items()),
        f"NUM_POINTS {sum(map(len, scans))}",
        f"VARS {','.join([*_ANGLES, *names])}",
    ]
    parts = [("\n".join(lines) + "\n").encode()]
    for scan in scans:
        theta = scan.theta_deg if scan.scatter == "reflection" else 180.0 - scan.theta_deg
        angles = (np.radians(scan.incident_theta_deg), np.radians(float(frame.written(scan.incident_phi_deg))))
        columns = [np.radians(theta), np.radians(frame.written(scan.phi_deg)), *scan.values.T]
        before = "".join(f"{float(angle)!r}," for angle in angles)
        parts.append(write_table([np.ascontiguousarray(column) for column in columns], ",", before))
    return b"".join(parts)


def _keyword(key: str) -> str:
    word = "_".join(key.split())
    if word.lower() in _RESERVED:
        return f"CONDITION_{word}"
    return word.upper() if key in CONDITIONS else word


def notes(measurement: Measurement) -> list[str]:
    """What the format cannot hold of a measurement."""
    count = sum(scan.standard_errors is not None for scan in measurement.scans)
    return [f"standard errors of {counted(count, 'scan')} are left out: {NAME} has no place for them"] if count else []
