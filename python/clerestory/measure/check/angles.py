"""Mistakes of angles: radians, exchanged columns, other azimuths, directions that are not there."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from clerestory.counts import counted
from clerestory.directions import SIDES, direction, outgoing_in_words
from clerestory.finding import Finding
from clerestory.measure.delaunay import NoSurfaceError, surface
from clerestory.measure.prepare.convention import check_peaks
from clerestory.measure.prepare.step import is_same_light, light_in_words
from clerestory.words import percent

if TYPE_CHECKING:
    from collections.abc import Iterator

    from clerestory.measure.scan import Measurement, Scan

COVERED = 0.8
"""Share of the projected hemisphere up to `SEEN_DEG` that a scan should cover; self-shadowing takes a few per cent."""
SEEN_DEG = 70.0
_LEAST_POINTS = 20


def radians(measurement: Measurement) -> Iterator[Finding]:
    """All angles together lie within a quarter and a whole circle of radians."""
    samples = measurement.of()
    if sum(map(len, samples)) < _LEAST_POINTS:
        return
    theta = max(float(scan.theta_deg.max(initial=0.0)) for scan in samples)
    phi = max(float(np.abs(scan.phi_deg).max(initial=0.0)) for scan in samples)
    incident = max(scan.incident_theta_deg for scan in samples)
    if 0.5 < theta <= 0.5 * np.pi + 1e-3 and phi <= 2.0 * np.pi + 1e-3 and incident <= 0.5 * np.pi + 1e-3:
        yield Finding(
            "error",
            "radians",
            "",
            f"θ reaches only {theta:.3g}° and φ {phi:.3g}°: the angles look like radians",
            "multiply them by 57.2958 before the import",
        )


def azimuths(measurement: Measurement) -> Iterator[Finding]:
    """The brightest light stands where straight or mirrored light goes, or would with other azimuths."""
    for scatter in ("transmission", "reflection"):
        for side in SIDES:
            found = check_peaks(measurement.of(side, scatter))
            if found.better is None:
                continue
            yield Finding(
                "warning",
                "azimuths",
                f"{scatter} from the {side}",
                f"the brightest light stands {found.apart_deg:.0f}° (median of {counted(found.scans, 'scan')}) from "
                f"{'straight' if scatter == 'transmission' else 'mirrored'} light, but {found.better_deg:.0f}° "
                f"{found.better}",
                "check the order of columns and the laboratory's convention (clerestory measure prepare --preset)",
            )


def copies(measurement: Measurement) -> Iterator[Finding]:
    """Scans of different light, or of one, with the same values."""
    for a, b in combinations(measurement.of(), 2):
        if len(a) < _LEAST_POINTS or a.values.shape != b.values.shape or not np.array_equal(a.values, b.values):
            continue
        # Images under a symmetry have the values of their original at other angles.
        if np.ptp(a.values) == 0.0 or not np.allclose(a.outgoing, b.outgoing, atol=1e-6):
            continue
        same = is_same_light(a, b)
        yield Finding(
            "warning" if same else "error",
            "copy",
            light_in_words(b),
            f"the values are those of {'another scan of the same light' if same else light_in_words(a)}",
            "leave one of them out" if same else "a file was read or named twice: find the true one",
        )


def hemispheres(measurement: Measurement) -> Iterator[Finding]:
    """Transmission and reflection, from both sides."""
    held = {(scan.incident_side, scan.scatter) for scan in measurement.of()}
    missing = [
        f"{scatter} from the {side}"
        for scatter in ("transmission", "reflection")
        for side in SIDES
        if (side, scatter) not in held
    ]
    if missing:
        yield Finding(
            "note",
            "hemisphere",
            "",
            f"not measured: {', '.join(missing)}",
            "a missing transmission follows from the other side's; a missing reflection does not",
        )


def coverage(measurement: Measurement) -> Iterator[Finding]:
    """Every scan holds its hemisphere, or half of it where its file states a mirror's plane."""
    cuts: list[Scan] = []
    gaps: dict[tuple[str, str], list[tuple[float, str, Scan]]] = {}
    for scan in measurement.of():
        try:
            share, middle = _covered(scan)
        except NoSurfaceError:
            cuts.append(scan)
            continue
        if share < COVERED:
            gaps.setdefault((scan.incident_side, scan.scatter), []).append((share, middle, scan))
    if cuts:
        yield Finding(
            "note",
            "coverage",
            light_in_words(cuts[0]) + _more(len(cuts)),
            "single points or points on one line: a cut, which has no integral",
            "fit a model to it, or scan the hemisphere",
        )
    for found in gaps.values():
        share, middle, scan = min(found, key=lambda gap: gap[0])
        halves = "plane" in scan.conditions.get("symmetry", "").lower()
        yield Finding(
            "note" if halves else "warning",
            "coverage",
            light_in_words(scan) + _more(len(found)),
            f"points cover {percent(share)} of the hemisphere up to {SEEN_DEG:g}°; what is missing lies about {middle}",
            "right for a file that holds one side of a mirror's plane"
            if halves
            else "scan it, or complete it by symmetry or reversed paths; integrals stand on what is about the gap",
        )


def _more(count: int) -> str:
    return f" and {count - 1} more" if count > 1 else ""


def _covered(scan: Scan) -> tuple[float, str]:
    """Share of the projected hemisphere that lies between measured points, and where the middle of the rest is."""
    through = surface(scan)
    k = np.arange(600)
    theta = np.degrees(np.arcsin(np.sqrt((k + 0.5) / len(k)) * np.sin(np.radians(SEEN_DEG))))
    outgoing = direction(theta, (k * 137.50776405) % 360.0, side=scan.side)
    here = through.measured(outgoing)
    if here.all():
        return 1.0, ""
    middle = outgoing[~here].mean(axis=0)
    if np.linalg.norm(middle[:2]) < 0.1:
        return float(here.mean()), "the rim" if theta[~here].min() > 30.0 else "the whole hemisphere"
    return float(here.mean()), outgoing_in_words(middle / np.linalg.norm(middle))
