"""Sets of IEA SHC Task 21: a file for each incident direction, 145 of Tregenza's or those that symmetry leaves.

Public sources say little of the header, so any `key: value`, `key = value` or `key value` behind `#` is taken. The
luminance coefficient q = L₂/E₁ [1/sr] is the BSDF. Both polar angles are from the normal of the lit side, so that
transmitted light has θ₂ of 90 to 180°; files that have it below 90° are understood.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, cast

import numpy as np

from clerestory._core import ClerestoryError, FileFormatError, read_table, write_table
from clerestory.counts import counted
from clerestory.directions import SCATTERS, SIDES
from clerestory.measure.contents import Contents
from clerestory.measure.delaunay import surface
from clerestory.measure.formats.choices import lit_side, one_of, sample_of, scatter_of
from clerestory.measure.formats.frame import Frame, halves, signed
from clerestory.measure.formats.header import (
    HEAD,
    condition_lines,
    conditions_of,
    leading,
    number_of,
    one_line,
    pair_of,
    writable,
)
from clerestory.measure.formats.names import scan_stem, untaken
from clerestory.measure.scan import PURPOSES, Measurement, Scan
from clerestory.measure.source import Source, digest

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from clerestory.directions import Scatter, Side
    from clerestory.measure.scan import Purpose

    Floats = NDArray[np.float64]

NAME = "IEA Task 21"
FRAMED = True
"""Whether `front`, `seen_from` and `up_deg` say how its sides and azimuths count."""

_INCIDENT = re.compile(r"\b(theta|phi)[_ ]?(?:1|i|in|inc)\b\s*[:=]?\s*([-+]?[\d.][^\s;]*)", re.IGNORECASE)
_OUTGOING = re.compile(r"\b(theta|phi)[_ ]?(?:2|o|s|out|t|r)\b", re.IGNORECASE)
_SYMMETRY = re.compile(r"^isym ?([0-4])\b")
_SYMMETRIES = ("none", "rotational", "about C0-C180", "about C90-C270", "about C0-C180 and C90-C270")
_HEMISPHERICAL = re.compile(r"hemispherical|^(tau|rho|t|r)_?(dh|h|hem)$", re.IGNORECASE)
_SIDES: dict[str, Side] = {
    "exterior": "exterior",
    "outside": "exterior",
    "front": "exterior",
    "interior": "interior",
    "inside": "interior",
    "back": "interior",
}
_RESERVED = (
    *("standard", "sample", "sample_name", "isym", "incident_side", "scatter", "up_deg", "quantity", "columns"),
    *("purpose", "points", "format", "channel", "theta_1", "phi_1", "theta1", "phi1", "hemispherical"),
)
_TOLERANCE = 0.05
"""Relative difference of the points' integral from the stated hemispherical value that is named."""
_COVERED = 0.9
"""Share of the projected hemisphere that points must span for that comparison."""


def _greek(line: str) -> str:
    return line.replace("θ", "theta").replace("φ", "phi").replace("ϕ", "phi").replace("₁", "1").replace("₂", "2")


def recognises(data: bytes, name: str) -> bool:
    """Whether comments at the beginning give both incident angles, and more of them than the angles belong to it."""
    text = _greek("\n".join(leading(data[:HEAD], 0, 1)[0])).lower()
    kinds = {match[1] for match in _INCIDENT.finditer(text)}
    return kinds == {"theta", "phi"} and re.search(r"isym|btdf|brdf|task ?21|_2\b|hemispherical", text) is not None


def read(data: bytes, name: str, **choices: object) -> Contents:
    """The scan of a file; two, if it has points on both sides.

    Choices are `side` (the lit one), `scatter`, `seen_from`, `up_deg` and `sample`, for files that do not say.
    """
    header, at, line = leading(data, 0, 1)
    lines = [_greek(text) for text in header]
    columns, _, _, line = read_table(data, start=at, line=line)
    if not columns:
        raise FileFormatError(f"line {line}: no points follow the header (get the whole file)")
    warnings: list[str] = []
    order = _order(lines, columns, warnings)
    theta, phi = signed(columns[order[0]], columns[order[1]])
    values = np.stack([columns[k] for k in range(len(columns)) if k not in order], axis=1)
    incident = _incident(lines)
    pairs = [pair for text in lines if not _INCIDENT.search(text) for pair in [pair_of(text)] if pair]
    stated = {key.lower().replace(" ", "_"): value for key, value in pairs}
    points = stated.get("points", "")
    if points.isdigit() and int(points) != len(theta):
        raise FileFormatError(f"line {line}: {len(theta)} of {points} points (the file is cut short; get it again)")
    side = _SIDES.get(stated.get("incident_side", stated.get("side", "")).lower())
    lit = cast("Side", one_of(choices, "side", SIDES, side or lit_side(choices)))
    up = number_of(stated["up_deg"], "up_deg", line) if "up_deg" in stated else 90.0
    frame = Frame.chosen(choices, lit, up)
    conditions = conditions_of(pairs, _RESERVED) | _conditions(stated, pairs)
    channel = stated.get("channel", "visible")
    channels = (channel,) if values.shape[1] == 1 else tuple(f"{channel} {k + 1}" for k in range(values.shape[1]))
    words = (
        f"light comes from the {lit} ({'as stated' if side else 'assumed'}); {frame.words}; "
        "θ is from the normal of the lit side"
    )
    scans = []
    for scatter, chosen, angles in halves(theta, scatter_of(choices) or _scatter(lines, stated.get("scatter", ""))):
        mirrored = scatter == "transmission" and not (theta > 90.0).any()
        scan = Scan(
            lit,
            scatter,
            incident[0],
            float(frame.azimuth(incident[1])),
            angles,
            frame.azimuth(phi[chosen]),
            values[chosen],
            quantity="dsf" if stated.get("quantity", "").lower() == "dsf" else "bsdf",
            channels=channels,
            purpose=cast("Purpose", one_of({"purpose": stated.get("purpose")}, "purpose", PURPOSES, "sample")),
            conditions=conditions,
            source=Source(
                name,
                digest(data),
                NAME,
                tuple(header),
                f"{words}, of transmitted light from that of the side that it leaves to" if mirrored else words,
            ),
        )
        warnings += _doubts(scan, line)
        scans.append(scan)
    sample = sample_of(choices, name, stated.get("sample_name", stated.get("sample", "")))
    return Contents((Measurement(sample, tuple(scans)),), warnings=tuple(f"{name}: {text}" for text in warnings))


def _incident(lines: list[str]) -> tuple[float, float]:
    found: dict[str, float] = {}
    for number, text in enumerate(lines, 1):
        for kind, value in _INCIDENT.findall(text):
            found.setdefault(kind.lower(), number_of(value.rstrip(","), f"{kind.lower()}_1", number))
    if len(found) < 2:
        raise FileFormatError("header: the incident angles are missing (add # theta_1: 30 and # phi_1: 90)")
    theta, phi = signed(np.array([found["theta"]]), np.array([found["phi"]]))
    if theta[0] > 90.0:
        raise FileFormatError(f"header: theta_1 {theta[0]:g} is beyond 90° (it is from the normal of the lit side)")
    return float(theta[0]), float(phi[0])


def _order(lines: list[str], columns: list[Floats], warnings: list[str]) -> tuple[int, int]:
    """Columns of θ₂ and φ₂: as the header has them, or φ₂ before θ₂."""
    if len(columns) < 3:
        raise FileFormatError(f"a row has {counted(len(columns), 'column')}, not two angles and a value (complete it)")
    for text in lines:
        found = [kind.lower() for kind in _OUTGOING.findall(text)]
        if sorted(found) == ["phi", "theta"]:
            return (0, 1) if found[0] == "theta" else (1, 0)
    swapped = bool(columns[0].max() <= 180.0 < columns[1].max())
    words = "theta_2, phi_2, since only the second goes beyond 180°" if swapped else "phi_2, theta_2, as is usual"
    warnings.append(f"the header does not name the columns: taken for {words}")
    return (0, 1) if swapped else (1, 0)


def _scatter(lines: list[str], stated: str) -> Scatter | None:
    if stated in SCATTERS:
        return stated
    text = "\n".join(lines).lower()
    for transmitted, reflected in (("btdf", "brdf"), (r"transmi|\btau", r"reflect|\brho")):
        found = (re.search(transmitted, text) is not None, re.search(reflected, text) is not None)
        if found[0] != found[1]:
            return "transmission" if found[0] else "reflection"
    return None


def _conditions(stated: dict[str, str], pairs: list[tuple[str, str]]) -> dict[str, str]:
    found = {}
    symmetry = stated.get("isym", "")
    if symmetry[:1] in "01234" and symmetry:
        found["symmetry"] = f"isym {symmetry[0]}: {_SYMMETRIES[int(symmetry[0])]}"
    for key, value in pairs:
        if _HEMISPHERICAL.search(key) and value:
            found["hemispherical"] = value
    return found


def _doubts(scan: Scan, line: int) -> list[str]:
    """Whether the points come to the hemispherical value that the file states."""
    if "hemispherical" not in scan.conditions or len(scan.channels) > 1:
        return []
    words = scan.conditions["hemispherical"]
    stated = number_of(words, "the hemispherical value", line)
    if "%" in words or stated > 1.5:
        stated /= 100.0
    try:
        whole = surface(scan, clip_deg=0.0, gap_deg=180.0).integrate()
    except ClerestoryError:  # too few points, or on one line
        whole = None
    if whole is None or whole.covered < _COVERED:
        return ["the points do not span enough of the hemisphere to verify the stated hemispherical value"]
    found = float(whole.total[0] - whole.extrapolated[0])
    if abs(found - stated) > _TOLERANCE * max(stated, 0.01) + (1.0 - whole.covered) * stated:
        return [f"the points come to a hemispherical value of {found:.3g}, and the file states {stated:.3g}"]
    return []


def write(measurement: Measurement, **choices: object) -> dict[str, bytes]:
    """A file for each scan and channel; θ₂ is from the normal of the lit side, up is azimuth 90°."""
    files: dict[str, bytes] = {}
    for scan in measurement.scans:
        writable(scan, NAME)
        for k, channel in enumerate(scan.channels):
            more = channel if len(scan.channels) > 1 else ""
            files[untaken(scan_stem(measurement.sample, scan, more), ".txt", files)] = _written(
                measurement.sample, scan, channel, k
            )
    return files


def _written(sample: str, scan: Scan, channel: str, column: int) -> bytes:
    frame = Frame(scan.incident_side, 90.0, scan.incident_side)
    transmitted = scan.scatter == "transmission"
    conditions = dict(scan.conditions)
    symmetry = _SYMMETRY.match(conditions.get("symmetry", ""))
    lines = [
        f"# standard: IEA SHC Task 21 {'BTDF' if transmitted else 'BRDF'}",
        f"# sample_name: {one_line(sample)}",
        f"# incident_side: {scan.incident_side}",
        f"# scatter: {scan.scatter}",
        f"# theta_1: {scan.incident_theta_deg!r}",
        f"# phi_1: {float(frame.written(scan.incident_phi_deg))!r}",
        f"# up_deg: {frame.up_deg:g}",
        *([] if scan.quantity == "bsdf" else ["# quantity: DSF"]),
        *([] if channel == "visible" else [f"# channel: {one_line(channel)}"]),
        *([] if scan.purpose == "sample" else [f"# purpose: {scan.purpose}"]),
        *([f"# isym: {symmetry[1]}"] if symmetry else []),
    ]
    if symmetry:
        del conditions["symmetry"]
    if "hemispherical" in conditions:
        lines.append(f"# hemispherical: {one_line(conditions.pop('hemispherical'))}")
    lines += [
        *condition_lines(conditions, _RESERVED),
        f"# points: {len(scan)}",
        f"# columns: phi_2 theta_2 {'BTDF' if transmitted else 'BRDF'}",
    ]
    theta = 180.0 - scan.theta_deg if transmitted else scan.theta_deg
    table = [frame.written(scan.phi_deg), theta, np.ascontiguousarray(scan.values[:, column])]
    return ("\n".join(lines) + "\n").encode() + write_table(table, "\t")


def notes(measurement: Measurement) -> list[str]:
    """What the format cannot hold of a measurement."""
    count = sum(scan.standard_errors is not None for scan in measurement.scans)
    return [f"standard errors of {counted(count, 'scan')} are left out: {NAME} has no place for them"] if count else []
