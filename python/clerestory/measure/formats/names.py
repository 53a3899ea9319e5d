"""Names of files that hold parts of a measurement."""

from __future__ import annotations

import re
import unicodedata
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Container

    from clerestory.measure.scan import Scan

_LONGEST = 80


def plain(text: str) -> str:
    """A text as part of a file's name on any system."""
    ascii_only = unicodedata.normalize("NFKD", text).encode("ascii", "ignore").decode()
    return re.sub(r"[^A-Za-z0-9.+-]+", "_", ascii_only).strip("._")[:_LONGEST] or "sample"


def scan_stem(sample: str, scan: Scan, channel: str = "") -> str:
    """Sample, side, scatter, incident angles and what is special: `twill_exterior_transmission_t30_p090`."""
    angles = f"t{scan.incident_theta_deg:g}_p{scan.incident_phi_deg % 360.0:03g}"
    more = ([] if scan.purpose == "sample" else [scan.purpose]) + ([plain(channel)] if channel else [])
    return "_".join([plain(sample), scan.incident_side, scan.scatter, angles, *more])


def untaken(stem: str, suffix: str, taken: Container[str]) -> str:
    """A name that no other file has: a number comes behind the second of a name."""
    name, count = f"{stem}{suffix}", 1
    while name in taken:
        count += 1
        name = f"{stem}-{count}{suffix}"
    return name
