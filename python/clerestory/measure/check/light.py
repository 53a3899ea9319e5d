"""Mistakes of light: more than there was, cut off, mislabelled, noisy, not symmetric."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import cKDTree

from clerestory.counts import counted
from clerestory.finding import Finding
from clerestory.integrals import continued
from clerestory.measure.delaunay import NoSurfaceError, surface
from clerestory.measure.prepare.noise import NEGATIVE
from clerestory.measure.prepare.step import SAME_DEG, light_in_words
from clerestory.measure.prepare.symmetry import chosen, scores
from clerestory.words import percent

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from clerestory.measure.prepare.symmetry import Symmetry
    from clerestory.measure.scan import Measurement, Scan

    Floats = NDArray[np.float64]

ENERGY_WARNING = 0.01
ENERGY_ERROR = 0.05
"""Share by which the light that leaves may exceed what arrived."""
PLATEAU = 5
"""Points of one largest value from which on a detector was probably saturated."""
RESOLVED = 0.25
"""Share of the peak that its nearest neighbour should have: a Gaussian then has a point every 0.7 of its full width."""
PROMINENT = 10.0
"""Brightest point over the median from which on it counts as a peak."""
SHADOW_DEG = 6.0
SHADOWED = 0.4
"""Light about the source over that in the ring around it, below which the detector stood in the beam."""
LABEL = 0.15
"""Deviation of a power of cos θ from 0 or 1 up to which values that follow it are taken to be mislabelled."""
_FOLLOWS = 0.06
"""RMS of the logarithm up to which values follow a power of cos θ."""


def energy(measurement: Measurement) -> Iterator[Finding]:
    """The integrals of transmission and reflection of one light are at most 1."""
    totals: list[tuple[Scan, Floats]] = []
    for scan in measurement.of():
        try:
            totals.append((scan, surface(scan).integrate().total))
        except NoSurfaceError:
            continue
    over: dict[tuple[str, str, str], list[tuple[float, str, str]]] = {}
    for scan, total in totals:
        for name, value in zip(scan.channels, total, strict=True):
            other = [
                float(t[s.channels.index(name)])
                for s, t in totals
                if s.scatter != scan.scatter and name in s.channels and _same_source(s, scan)
            ]
            if other and scan.scatter == "reflection":
                continue  # said with the transmission
            whole = float(value) + (other[0] if other else 0.0)
            if whole > 1.0 + ENERGY_WARNING:
                verb = "passes" if scan.scatter == "transmission" else "is reflected"
                words = f"{percent(float(value))} {verb}" + (f" and {percent(other[0])} is reflected" if other else "")
                over.setdefault((name, scan.incident_side, scan.scatter), []).append(
                    (whole, words, f"{scan.incident_theta_deg:g}° at azimuth {scan.incident_phi_deg % 360.0:g}°")
                )
    for (name, side, _), found in over.items():
        worst, words, where = max(found)
        yield Finding(
            "error" if worst > 1.0 + ENERGY_ERROR else "warning",
            "energy",
            f"{name}, light from the {side}",
            f"more light leaves than arrives at {counted(len(found), 'incident direction')}; worst at {where}: {words}",
            "check the reference beam and whether values are BSDF; calibrate to a sphere's values",
        )


def _same_source(a: Scan, b: Scan) -> bool:
    same = a.incident_side == b.incident_side
    return same and float(np.linalg.norm(a.incident - b.incident)) <= np.radians(SAME_DEG)


def saturation(measurement: Measurement) -> Iterator[Finding]:
    """No plateau of one largest value."""
    for scan in (*measurement.of(), *measurement.of(purpose="beam")):
        cosine = np.cos(np.radians(scan.theta_deg))
        for name in scan.channels:
            values = scan.channel(name)
            for seen in (values, values * cosine):
                top = float(seen.max(initial=0.0))
                count = int((seen >= top * (1.0 - 1e-9)).sum())
                if top > 0.0 and PLATEAU <= count < 0.3 * len(seen):
                    yield Finding(
                        "warning",
                        "saturation",
                        f"{name}, {light_in_words(scan)}" + (" (beam)" if scan.purpose == "beam" else ""),
                        f"{counted(count, 'point')} have the largest value, {top:.4g}: probably a saturated detector",
                        "measure again with less gain or a filter",
                    )
                    break


def label(measurement: Measurement) -> Iterator[Finding]:
    """Values of BSDF do not fall with cos θ, and those of DSF do: away from the peak, from 30 to 80°."""
    slopes = [found for scan in measurement.of() if (found := _power(scan)) is not None]
    if len(slopes) < 1 or len(slopes) < 0.5 * len(measurement.of()):
        return
    power = float(np.median(slopes))
    where = f"{counted(len(slopes), 'scan')} of {len(measurement.of())}"
    if abs(power - 1.0) <= LABEL:
        yield Finding(
            "warning",
            "label",
            where,
            f"the BSDF falls with cos θ to the power of {power:.2f} away from the peak: it looks like DSF",
            "divide by cos θ, unless the sample is that dark at grazing",
        )
    elif abs(power + 1.0) <= LABEL:
        yield Finding(
            "warning",
            "label",
            where,
            f"the BSDF grows with 1/cos θ (power {power:.2f}) away from the peak: its values were probably BSDF when"
            " they were taken for DSF",
            "correct the label of the quantity",
        )


def _power(scan: Scan) -> float | None:
    """The power of cos θ that values away from the peak follow in all azimuths; None if they follow none."""
    values = scan.values[:, 0]
    away = scan.outgoing @ continued(scan.incident, scan.scatter) < np.cos(np.radians(25.0))
    chosen = away & (scan.theta_deg >= 30.0) & (scan.theta_deg <= 80.0) & (values > 0.0)
    if chosen.sum() < 30 or np.ptp(scan.theta_deg[chosen]) < 30.0:
        return None
    x, y = np.log(np.cos(np.radians(scan.theta_deg[chosen]))), np.log(values[chosen])
    slope, start = np.polyfit(x, y, 1)
    if float(np.sqrt(np.mean((y - start - slope * x) ** 2))) > _FOLLOWS:
        return None
    return float(slope)


def negative(measurement: Measurement) -> Iterator[Finding]:
    """Few values below 0."""
    for scan in measurement.of():
        for name in scan.channels:
            share = float((scan.channel(name) < 0.0).mean()) if len(scan) else 0.0
            if share > NEGATIVE:
                yield Finding(
                    "warning",
                    "negative",
                    f"{name}, {light_in_words(scan)}",
                    f"{percent(share)} of the values are negative",
                    "mostly noise, or the dark signal that was taken off is too large",
                )


def peak(measurement: Measurement) -> Iterator[Finding]:
    """The brightest point has neighbours that still see the peak."""
    for scan in measurement.of():
        if len(scan) < 20:
            continue
        dsf = scan.values[:, 0] * np.cos(np.radians(scan.theta_deg))
        top = int(np.argmax(dsf))
        if dsf[top] < PROMINENT * max(float(np.median(dsf)), 1e-12):
            continue
        far, near = cKDTree(scan.outgoing).query(scan.outgoing[top], k=7)
        apart = far > 1e-6
        if not apart.any():
            continue
        best = float((dsf[near] / dsf[top])[apart].max())
        if best < RESOLVED:
            yield Finding(
                "warning",
                "peak",
                light_in_words(scan),
                f"the peak is one point: its neighbours, {np.degrees(far[apart][0]):.2g}° away, have {percent(best)}",
                "scan about it in steps of half its width or less (clerestory measure plan); its light is not known",
            )


def shadow(measurement: Measurement) -> Iterator[Finding]:
    """Reflection about the source is not dark, as where the detector's arm stands in the beam."""
    for scan in measurement.of(scatter="reflection"):
        apart = np.degrees(np.arccos(np.clip(scan.outgoing @ scan.incident, -1.0, 1.0)))
        inside, around = apart < SHADOW_DEG, (apart >= SHADOW_DEG) & (apart < 3.0 * SHADOW_DEG)
        if inside.sum() < 2 or around.sum() < 4:
            continue
        within, about = float(np.median(scan.values[inside, 0])), float(np.median(scan.values[around, 0]))
        if about > 0.0 and within < SHADOWED * about:
            yield Finding(
                "warning",
                "shadow",
                light_in_words(scan),
                f"light within {SHADOW_DEG:g}° of the source has {percent(max(within, 0.0) / about)} of that around:"
                " the detector stood in the beam",
                "leave these points out (clerestory measure prepare --shadow)",
            )


def symmetry(measurement: Measurement) -> Iterator[Finding]:
    """The symmetry that a file states holds; and which do."""
    samples = [scan for scan in measurement.of() if len(scan) >= 20]
    try:
        found = scores(samples)
    except NoSurfaceError:
        return
    stated = {scan.conditions["symmetry"] for scan in samples if scan.conditions.get("symmetry")}
    name, why = chosen(found)
    for text in sorted(stated):
        meant = _meant(text)
        tested = [found[one] for one in meant if found[one].comparisons]
        if tested and not any(score.holds for score in tested):
            yield Finding(
                "warning",
                "symmetry",
                "",
                f"the file says {text!r}, but it does not hold: {tested[0].words}",
                "complete the data by the symmetry that holds, or measure the other azimuths",
            )
    if any(score.comparisons for score in found.values()):
        yield Finding("note", "symmetry", "", why if name != "none" else f"none: {why}", "compare with the sample")


def _meant(text: str) -> Sequence[Symmetry]:
    """The symmetries that a file's word may mean."""
    word = text.lower()
    if "aniso" in word or "none" in word or "asym" in word:
        return ()
    if "iso" in word:
        return ("isotropic",)
    if "quad" in word:
        return ("quadrilateral",)
    if "rotational" in word or "180" in word:
        return ("rotational",)
    if "left" in word:
        return ("left-right",)
    if "up-down" in word:
        return ("up-down",)
    return ("left-right", "up-down") if "bilat" in word or "plane" in word else ()
