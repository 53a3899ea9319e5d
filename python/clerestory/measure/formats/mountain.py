"""pab's tabular text, which the program Mountain shows: a file for each incident direction, or several in one.

Facts: manual page of Radiance's pabopto2bsdf (G. Ward), and files of pab advanced technologies' PG2. Angles of both
sides are those of one frame: θ from the normal of the front, 0 to 180°, azimuths counter-clockwise as seen from the
front, up where `#upphi` says. Radiance's programs take pab's front to be the interior; here it is the exterior unless
a person says otherwise.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, cast

import numpy as np

from clerestory._core import ClerestoryError, FileFormatError, read_table, write_table
from clerestory.counts import counted
from clerestory.directions import SIDES
from clerestory.measure.contents import Contents
from clerestory.measure.formats.choices import one_of, sample_of, scatter_of
from clerestory.measure.formats.frame import Frame, halves, opposite, wrapped
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
    from collections.abc import Iterator, Mapping

    from numpy.typing import NDArray

    from clerestory.directions import Side
    from clerestory.measure.scan import Purpose, Quantity

    Floats = NDArray[np.float64]

NAME = "pab Mountain"
FRAMED = True
"""Whether `front`, `seen_from` and `up_deg` say how its sides and azimuths count."""

_ROWS = 1 << 18  # written at a time

_KEYWORD = re.compile(r"^#\s*(\w+)\s*:?\s*(.*?)\s*$")
_HEADING = re.compile(rb"^\s*#\s*(format:\s*theta\s+phi|intheta\b|incident_angle\b)", re.IGNORECASE | re.MULTILINE)
_WORDS: dict[str, Quantity] = {"bsdf": "bsdf", "brdf": "bsdf", "btdf": "bsdf", "dsf": "dsf"}
_CHANNELS = {"cie-y": ("visible",), "cie-xyz": ("X", "Y", "Z")}
_RESERVED = (
    *("sample_name", "format", "intheta", "inphi", "i_phi", "incident_angle", "upphi", "colorimetry"),
    *("datapoints_in_file", "channel", "purpose"),
)


@dataclass
class _Header:
    """What the lines up to a block of points say; what is not said again holds on."""

    sample: str = ""
    quantity: Quantity | None = None
    theta_deg: float | None = None
    phi_deg: float | None = None
    up_deg: float = 0.0
    channels: tuple[str, ...] = ("visible",)
    purpose: Purpose = "sample"
    stated: list[int] = field(default_factory=list)
    """Numbers of points, as lines give them."""
    conditions: dict[str, str] = field(default_factory=dict)

    def after(self, lines: list[str], first: int) -> _Header:
        """What holds behind more lines, the first of which has that number."""
        later = replace(self, stated=list(self.stated), conditions=dict(self.conditions))
        for number, text in enumerate(lines, first):
            match = _KEYWORD.match(text)
            if match:
                later._take(match[1].lower(), match[2], number)
            pair = pair_of(text)
            if pair:
                later.conditions |= conditions_of([pair], _RESERVED)
        return later

    def _take(self, key: str, value: str, line: int) -> None:
        if key == "sample_name":
            self.sample = value.strip().strip('"')
        elif key == "format":
            words = value.lower().split()
            if words[:2] != ["theta", "phi"] or len(words) != 3 or words[2] not in _WORDS:
                raise FileFormatError(
                    f'line {line}: "{value}" is not known as a format (theta phi and BSDF, BRDF, BTDF or DSF)'
                )
            self.quantity = _WORDS[words[2]]
        elif key == "intheta":
            self.theta_deg = number_of(value, "#intheta", line)
        elif key in ("inphi", "i_phi"):
            self.phi_deg = number_of(value, f"#{key}", line)
        elif key == "incident_angle":
            words = value.replace(",", " ").split()
            if len(words) != 2:
                raise FileFormatError(f'line {line}: #incident_angle "{value}" is not two angles (give θ and φ)')
            self.theta_deg, self.phi_deg = (number_of(word, "#incident_angle", line) for word in words)
        elif key == "upphi":
            self.up_deg = number_of(value, "#upphi", line)
        elif key == "colorimetry":
            if value.lower() not in _CHANNELS:
                raise FileFormatError(f'line {line}: colorimetry "{value}" is not known (CIE-Y or CIE-XYZ)')
            self.channels = _CHANNELS[value.lower()]
        elif key == "channel" and len(self.channels) == 1:
            self.channels = (value or "visible",)
        elif key == "purpose":
            if value not in PURPOSES:
                raise FileFormatError(f'line {line}: purpose "{value}" is not known ({", ".join(PURPOSES)})')
            self.purpose = value
        elif key == "datapoints_in_file":
            self.stated.append(int(min(max(number_of(value, "#datapoints_in_file", line), 0.0), 1e15)))

    def light(self, line: int) -> tuple[object, ...]:
        """What tells one scan from the next, checked to be there."""
        for value, key in ((self.theta_deg, "intheta"), (self.phi_deg, "inphi")):
            if value is None:
                raise FileFormatError(f"line {line}: points stand before a line #{key} (add it above them)")
        if self.quantity is None:
            raise FileFormatError(
                f"line {line}: points stand before a line #format: theta phi BSDF (or DSF; add it above them)"
            )
        return (self.sample, self.quantity, self.theta_deg, self.phi_deg, self.up_deg, self.channels, self.purpose)


def recognises(data: bytes, name: str) -> bool:
    """Whether there is a line of comment with a format or an incident angle of pab's."""
    return _HEADING.search(data[:HEAD].replace(b"\r", b"\n")) is not None


def read(data: bytes, name: str, **choices: object) -> Contents:
    """Scans of a file: one for each incident direction and side of the points.

    Choices are `front` (the side that it calls front), `side` (the lit side, which tells the same), `scatter` (for
    transmission whose θ is below 90°), `seen_from`, `up_deg` and `sample`.
    """
    header, blocks = _Header(), list[_Block]()
    at, line = 0, 1
    while True:
        lines, behind, below = leading(data, at, line)
        header = header.after(lines, line)
        at, line = behind, below
        if at >= len(data):
            break
        light = header.light(line)
        columns, _, at, line = read_table(data, 2 + len(header.channels), start=at, line=line, stops=True)
        if not blocks or blocks[-1].header.light(line) != light:
            shared = blocks[0].lines if blocks else []
            blocks.append(_Block(header, shared + lines, []))
        else:
            blocks[-1] = _Block(header, blocks[-1].lines + lines, blocks[-1].parts)
        blocks[-1].parts.append(columns)
    if not blocks:
        raise FileFormatError(f"line {line}: no points follow the header (get the whole file)")
    marks = digest(data)
    samples: dict[str, list[Scan]] = {}
    for block in blocks:
        sample = sample_of(choices, name, block.header.sample)
        samples.setdefault(sample, []).extend(_scans(block, name, marks, choices))
    warnings = _counted_points(header.stated, sum(len(part[0]) for b in blocks for part in b.parts), line)
    return Contents(
        tuple(Measurement(sample, tuple(scans)) for sample, scans in samples.items()),
        warnings=tuple(f"{name}: {text}" for text in warnings),
    )


@dataclass(frozen=True)
class _Block:
    """Points of light from one direction."""

    header: _Header
    lines: list[str]
    """Of the file's first header, and those that stand with the points."""
    parts: list[list[Floats]]
    """Columns, as often as comments stand between points."""


def _counted_points(stated: list[int], total: int, line: int) -> list[str]:
    """Compare the number of points with what one header announces, or all do together."""
    announced = sum(stated) if sum(stated) == total else max(stated, default=total)
    if total < announced:
        raise FileFormatError(
            f"line {line}: {total} points, and the header announces {announced} (the file is cut short; get it again)"
        )
    return [f"the header announces {announced} points, there are {total}"] if total > announced else []


def _scans(block: _Block, name: str, marks: str, choices: Mapping[str, object]) -> list[Scan]:
    header, parts = block.header, block.parts
    columns = parts[0] if len(parts) == 1 else [np.concatenate(part) for part in zip(*parts, strict=True)]
    theta, phi = wrapped(columns[0], columns[1])
    values = columns[2][:, None] if len(columns) == 3 else np.stack(columns[2:], axis=1)
    incident, azimuth = wrapped(np.array([header.theta_deg], dtype=float), np.array([header.phi_deg], dtype=float))
    from_front = bool(incident[0] <= 90.0)
    lit = cast("Side | None", one_of(choices, "side", SIDES, None))
    default: Side = "exterior" if lit is None else lit if from_front else opposite(lit)
    front = cast("Side", one_of(choices, "front", SIDES, default))
    frame = Frame.chosen(choices, front, header.up_deg)
    own = theta if from_front else 180.0 - theta
    words = f"{frame.words}; θ is from the normal of the front, 0 to 180°"
    made = []
    for scatter, chosen, angles in halves(own, scatter_of(choices), "reflection"):
        mirrored = scatter == "transmission" and not (own > 90.0).any()
        scan = Scan(
            front if from_front else opposite(front),
            scatter,
            float(incident[0] if from_front else 180.0 - incident[0]),
            float(frame.azimuth(azimuth[0])),
            angles,
            frame.azimuth(phi[chosen]),
            values[chosen],
            quantity=cast("Quantity", header.quantity),
            channels=header.channels,
            purpose=header.purpose,
            conditions=header.conditions,
            source=Source(
                name,
                marks,
                NAME,
                tuple(block.lines),
                f"{words}, of transmitted light from that of the side that it leaves to" if mirrored else words,
            ),
        )
        made.append(scan)
    return made


def write(measurement: Measurement, **choices: object) -> dict[str, Iterator[bytes]]:
    """A file for each scan, and for each channel that is not CIE XYZ; front is the exterior, up is azimuth 90°.

    Raises
    ------
    ClerestoryError
        Values are a detector's signal, or not finite.
    """
    if '"' in measurement.sample:
        raise ClerestoryError(
            f"{NAME} cannot hold a quotation mark in the sample's name {measurement.sample!r} (rename it)"
        )
    front = cast("Side", one_of(choices, "front", SIDES, "exterior"))
    frame = Frame(front, 90.0, front)
    files: dict[str, Iterator[bytes]] = {}
    for scan in measurement.scans:
        writable(scan, NAME)
        together = scan.channels == _CHANNELS["cie-xyz"]
        for k, channel in enumerate([""] if together else scan.channels):
            more = channel if len(scan.channels) > 1 else ""
            stem = untaken(scan_stem(measurement.sample, scan, more), ".txt", files)
            columns = list(scan.values.T) if together else [scan.values[:, k]]
            files[stem] = _written(measurement.sample, scan, channel, columns, frame)
    return files


def _written(sample: str, scan: Scan, channel: str, columns: list[Floats], frame: Frame) -> Iterator[bytes]:
    """Header and rows, some at a time, so that a scan of any length takes little memory."""
    from_front = scan.incident_side == frame.front
    theta = scan.incident_theta_deg if from_front else 180.0 - scan.incident_theta_deg
    phi = float(frame.written(scan.incident_phi_deg))
    lines = [
        f'#sample_name "{one_line(sample)}"',
        f"#format: theta phi {scan.quantity.upper()}",
        f"#incident_angle {theta!r} {phi!r}",
        f"#intheta {theta!r}",
        f"#inphi {phi!r}",
        f"#upphi {frame.up_deg:g}",
        f"#colorimetry: {'CIE-XYZ' if len(columns) == 3 else 'CIE-Y'}",
        f"#datapoints_in_file: {len(scan)}",
        *([] if channel in ("", "visible") else [f"#channel: {one_line(channel)}"]),
        *([] if scan.purpose == "sample" else [f"#purpose: {scan.purpose}"]),
        *condition_lines(scan.conditions, _RESERVED, "#"),
    ]
    yield ("\n".join(lines) + "\n").encode()
    for start in range(0, len(scan), _ROWS):
        rows = slice(start, start + _ROWS)
        outgoing = scan.theta_deg[rows] if scan.side == frame.front else 180.0 - scan.theta_deg[rows]
        table = [outgoing, frame.written(scan.phi_deg[rows]), *(column[rows] for column in columns)]
        yield write_table([np.ascontiguousarray(column) for column in table], "\t")


def notes(measurement: Measurement) -> list[str]:
    """What the format cannot hold of a measurement."""
    count = sum(scan.standard_errors is not None for scan in measurement.scans)
    return [f"standard errors of {counted(count, 'scan')} are left out: {NAME} has no place for them"] if count else []
