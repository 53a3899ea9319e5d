"""Tables of points, written: a file for all scans of the same conditions."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import write_table
from clerestory.measure.formats.header import condition_lines, one_line, writable
from clerestory.measure.formats.names import plain, untaken
from clerestory.measure.formats.rows import repeated
from clerestory.measure.scan import QUANTITIES

if TYPE_CHECKING:
    from collections.abc import Iterator

    from clerestory.measure.scan import Measurement, Scan

RESERVED = (
    *("sample", "purpose", "side", "scatter", "quantity"),
    *("theta_i", "phi_i", "incident_theta_deg", "incident_phi_deg"),
)
"""Keys of comments that are no conditions."""
_STEP = 100_000
"""Rows are made text so many at a time."""


def write(measurement: Measurement, **choices: object) -> dict[str, Iterator[bytes]]:
    """A file for all scans of the same quantity, channels and conditions, most often one."""
    groups: dict[tuple[object, ...], list[Scan]] = {}
    for before, scan in repeated(measurement.scans):
        writable(scan, "CSV", quantities=QUANTITIES)
        errors = scan.standard_errors is not None
        key = (scan.quantity, scan.channels, scan.purpose, errors, before, *scan.conditions.items())
        groups.setdefault(key, []).append(scan)
    files: dict[str, Iterator[bytes]] = {}
    for scans in groups.values():
        more = [] if scans[0].purpose == "sample" else [scans[0].purpose]
        stem = "_".join([plain(measurement.sample), *more])
        files[untaken(stem, ".csv", files)] = _written(measurement.sample, scans)
    return files


def _written(sample: str, scans: list[Scan]) -> Iterator[bytes]:
    first = scans[0]
    channels = [one_line(name).replace(",", " ").replace('"', "'") for name in first.channels]
    names = [
        *("side", "scatter", "theta_i_deg", "phi_i_deg", "theta_o_deg", "phi_o_deg"),
        *(f"{first.quantity}_{name}" for name in channels),
        *(f"error_{name}" for name in channels if first.standard_errors is not None),
    ]
    lines = [
        f"# sample: {one_line(sample)}",
        *([] if first.purpose == "sample" else [f"# purpose: {first.purpose}"]),
        *condition_lines(first.conditions, RESERVED),
        ",".join(names),
    ]
    yield ("\n".join(lines) + "\n").encode()
    for scan in scans:
        light = (scan.incident_theta_deg, scan.incident_phi_deg)
        before = "".join(f"{word}," for word in (scan.incident_side, scan.scatter, *map(repr, map(float, light))))
        for start in range(0, len(scan), _STEP):
            part = slice(start, start + _STEP)
            columns = [scan.theta_deg[part], scan.phi_deg[part], *scan.values[part].T]
            if scan.standard_errors is not None:
                columns += list(scan.standard_errors[part].T)
            yield write_table([np.ascontiguousarray(column) for column in columns], ",", before)
