"""What is known of how a sample was measured: the beam's drift, the spot, the angles that were chosen."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.finding import Finding
from clerestory.measure.prepare.reference import DRIFT
from clerestory.measure.prepare.signature import drifts
from clerestory.measure.prepare.step import light_in_words
from clerestory.words import percent

if TYPE_CHECKING:
    from collections.abc import Iterator

    from clerestory.measure.scan import Measurement, Scan

DRIFT_ERROR = 0.05
SHIFT_DEG = 0.1
PERIODS = 4.0
"""Periods of the sample's structure that a spot should hold (report C.2.2, section 2.2)."""


def drift(measurement: Measurement) -> Iterator[Finding]:
    """The beam at the end is the one of the beginning."""
    try:
        moved = drifts(measurement)
    except ClerestoryError as error:
        yield Finding("warning", "beam", "", str(error), "scan the beam again")
        return
    for one in moved:
        if abs(one.power) > DRIFT:
            yield Finding(
                "error" if abs(one.power) > DRIFT_ERROR else "warning",
                "drift",
                one.channel,
                f"the beam's power changed by {'+' if one.power > 0 else '-'}{percent(abs(one.power))} from its first"
                " scan to its last",
                "with the time of every scan it is corrected on a line; else measure again with a warm lamp",
            )
        if one.shift_deg > SHIFT_DEG:
            yield Finding(
                "warning",
                "drift",
                one.channel,
                f"the beam's centre moved by {one.shift_deg:.2g}° from its first scan to its last",
                "check the lamp and the lens; peaks are off by as much",
            )


def spot(measurement: Measurement) -> Iterator[Finding]:
    """The spot holds enough periods of the structure, and lies on the sample."""
    said: set[str] = set()
    for scan in measurement.of():
        width, period, sample = (_millimetres(scan, key) for key in ("spot_mm", "period_mm", "sample_mm"))
        for finding in _spot(scan, width, period, sample):
            if finding.what not in said:
                said.add(finding.what)
                yield finding


def _spot(scan: Scan, width: float | None, period: float | None, sample: float | None) -> Iterator[Finding]:
    if width is not None and period is not None and width < PERIODS * period:
        yield Finding(
            "warning",
            "spot",
            "",
            f"a spot of {width:g} mm holds {width / period:.2g} periods of {period:g} mm, fewer than {PERIODS:g}",
            "widen the spot, average several positions, or simulate the system from its material",
        )
    if width is not None and sample is not None:
        wide = width / max(float(np.cos(np.radians(scan.incident_theta_deg))), 1e-6)
        if wide > sample:
            yield Finding(
                "warning",
                "spot",
                light_in_words(scan),
                f"a spot of {width:g} mm is {wide:.0f} mm long at {scan.incident_theta_deg:g}° and passes the sample"
                f" of {sample:g} mm",
                "narrow the spot, or leave this angle out",
            )


def near_normal(measurement: Measurement) -> Iterator[Finding]:
    """An angle beside the normal, where sample, detector and lamp do not mirror each other."""
    angles = {round(scan.incident_theta_deg, 1) for scan in measurement.of()}
    if any(angle < 1.0 for angle in angles) and not any(4.0 <= angle <= 12.0 for angle in angles):
        yield Finding(
            "note",
            "near normal",
            "",
            "0° was measured and nothing near 8°, where neither lamp nor detector stands in the mirrored light",
            "measure 8° too: at 0°, reflection is shadowed by the detector and transmission may hold light sent back",
        )


def _millimetres(scan: Scan, key: str) -> float | None:
    try:
        value = float(scan.conditions.get(key, "nan"))
    except ValueError:
        return None  # a note in words, such as "about 20"
    return value if np.isfinite(value) and value > 0.0 else None
