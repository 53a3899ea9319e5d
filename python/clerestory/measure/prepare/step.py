"""What was done to a measurement, step by step."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from datetime import datetime
from typing import TYPE_CHECKING

import numpy as np

from clerestory.measure.scan import Measurement

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from clerestory.measure.scan import Scan

SAME_DEG = 0.1
"""Incident directions closer than this [°] are one."""


@dataclass(frozen=True)
class Step:
    """One step of a preparation, as it is kept beside its result."""

    name: str
    """Which step, in a few words."""
    words: str
    """What it did, in a sentence."""
    settings: Mapping[str, object] = field(default_factory=dict)
    """What it was told."""
    figures: Mapping[str, object] = field(default_factory=dict)
    """What it found and how much it touched."""
    warnings: tuple[str, ...] = ()
    """What a person should look at."""


@dataclass(frozen=True)
class Prepared:
    """A measurement ready to be fitted, and how it came about; the raw one is never changed."""

    measurement: Measurement
    steps: tuple[Step, ...]

    @property
    def warnings(self) -> list[str]:
        """All that a person should look at."""
        return [text for step in self.steps for text in step.warnings]

    def record(self) -> list[dict[str, object]]:
        """The steps as values that JSON knows."""
        return [
            {
                "step": step.name,
                "what": step.words,
                "settings": dict(step.settings),
                "figures": dict(step.figures),
                "warnings": list(step.warnings),
            }
            for step in self.steps
        ]


def same_light(scans: Iterable[Scan], tolerance_deg: float = SAME_DEG) -> list[list[Scan]]:
    """Scans of light from one direction and to one side together, in the order in which they come."""
    groups: list[list[Scan]] = []
    for scan in scans:
        for group in groups:
            if is_same_light(group[0], scan, tolerance_deg):
                group.append(scan)
                break
        else:
            groups.append([scan])
    return groups


def is_same_light(a: Scan, b: Scan, tolerance_deg: float = SAME_DEG) -> bool:
    """Whether two scans are of light from one direction, to one side."""
    if (a.incident_side, a.scatter, a.purpose) != (b.incident_side, b.scatter, b.purpose):
        return False
    return bool(np.linalg.norm(a.incident - b.incident) <= np.radians(tolerance_deg))


def with_samples(measurement: Measurement, scans: Iterable[Scan]) -> Measurement:
    """The same measurement with other scans of the sample; those of the beam and of the dark stay."""
    others = tuple(scan for scan in measurement.scans if scan.purpose != "sample")
    return replace(measurement, scans=(*scans, *others))


def with_conditions(scan: Scan, **conditions: str) -> Scan:
    """The same points with more known of them."""
    return replace(scan, conditions={**scan.conditions, **conditions})


def time_of(scan: Scan) -> float | None:
    """When it was measured [s], from a date with a time of day; None if that is not known."""
    text = scan.conditions.get("date", "").strip()
    if len(text) <= len("2026-01-01"):
        return None
    try:
        return datetime.fromisoformat(text).timestamp()
    except ValueError:
        return None


def light_in_words(scan: Scan) -> str:
    """Where a scan's light comes from and goes to: "transmission from the exterior, 40° at azimuth 90°"."""
    return (
        f"{scan.scatter} from the {scan.incident_side}, {scan.incident_theta_deg:g}° at azimuth "
        f"{scan.incident_phi_deg % 360.0:g}°"
    )
