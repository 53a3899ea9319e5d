"""Scans along lines, in the plane of incidence or across it, as distributions over the hemisphere.

What a line says is taken as a function of the distance u in direction cosines from the mirrored or straight direction,
as Harvey found for polished surfaces and optics programs do with line scans. So the line is turned about that
direction: its two arms, and those of a second line across if there is one, pass into each other in between.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.counts import counted
from clerestory.integrals import continued
from clerestory.measure.prepare.step import Step, light_in_words, same_light, with_samples

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from clerestory.measure.scan import Measurement, Scan

    Floats = NDArray[np.float64]

ASIDE = 0.02
"""Points this close to a line, in direction cosines (1°), are on it."""
MADE = "a line turned about the mirrored or straight direction"
_NORMAL_DEG = 0.5
"""Light closer to the normal has no plane of incidence: its line may lie anywhere."""
_LEAST = 5
"""Points that a line needs."""
_SPACING = 0.035
"""Distance of the points that are made, in direction cosines, away from the peak."""
_RATIO = 1.12
"""And of rings about it to each other."""
_FINEST = 1e-3
_SECTORS = 48
_LAST_DEG = 89.0
"""Where one arm ends at the horizon another may tell what lies that far from the middle."""


@dataclass(frozen=True)
class _Arm:
    """One side of a line: BSDF over the distance from its middle."""

    azimuth: float
    """About the middle, from the plane of incidence [rad]."""
    u: Floats
    """Rising (n,)."""
    values: Floats
    """(n, channels)."""

    def at(self, u: Floats) -> Floats:
        """BSDF (m, channels), linear in its logarithm over that of u; beyond the last point it stays."""
        x, at = np.log(np.maximum(self.u, _FINEST)), np.log(np.maximum(u, _FINEST))
        made = np.empty((len(u), self.values.shape[1]))
        for c, column in enumerate(self.values.T):
            if (column > 0.0).all():
                made[:, c] = np.exp(np.interp(at, x, np.log(column)))
            else:  # noise below zero has no logarithm
                made[:, c] = np.interp(at, x, column)
        return made


def is_line(group: Sequence[Scan]) -> bool:
    """Whether all points of scans of one light lie on a line through its mirrored or straight direction."""
    off, _ = _offsets(group)
    return len(off) >= 2 and bool(_on_lines(off).all())


def spread_lines(measurement: Measurement) -> tuple[Measurement, Step]:
    """The measurement with every line turned into a distribution over the hemisphere; other scans stay as they are.

    Parameters
    ----------
    measurement
        With scans of BSDF or DSF.

    Raises
    ------
    ClerestoryError
        No scan is a line, or one has too few points.
    """
    made, turned, across = [], 0, 0
    for group in same_light(scan.as_bsdf() for scan in measurement.of()):
        if not is_line(group):
            made += list(group)
            continue
        arms = _arms(group)
        made.append(_turned(group, arms))
        turned += 1
        across += any(abs(abs(np.sin(arm.azimuth)) - 1.0) < 1e-6 for arm in arms)
    if not turned:
        raise ClerestoryError("no scan is a line in the plane of incidence (leave --lines out)")
    second = f", {across} of them with a second line across" if across else ""
    words = (
        f"{counted(turned, 'line scan')} turned about the mirrored or straight direction{second}: scattering is assumed"
        " to depend on the distance from it in direction cosines, which lines cannot test"
    )
    settings = {"rings": _RATIO, "sectors": _SECTORS}
    return with_samples(measurement, made), Step(
        "lines", words, settings, {"lines": turned, "across": across}, (words,)
    )


def _offsets(group: Sequence[Scan]) -> tuple[Floats, float]:
    """Offsets (n, 2) from the middle, along and across the plane of incidence; and the plane's azimuth [rad]."""
    first = group[0]
    middle = continued(first.incident, first.scatter)
    outgoing = np.concatenate([scan.outgoing for scan in group])
    off = outgoing[:, :2] - middle[:2]
    if first.incident_theta_deg >= _NORMAL_DEG:
        azimuth = float(np.arctan2(middle[1], middle[0]))
    else:
        far = off[int(np.argmax(np.linalg.norm(off, axis=1)))] if len(off) else np.array([1.0, 0.0])
        azimuth = float(np.arctan2(far[1], far[0]))
    c, s = np.cos(azimuth), np.sin(azimuth)
    return off @ np.array([[c, -s], [s, c]]), azimuth


def _on_lines(off: Floats) -> NDArray[np.bool_]:
    return np.asarray((np.abs(off[:, 1]) <= ASIDE) | (np.abs(off[:, 0]) <= ASIDE))


def _arms(group: Sequence[Scan]) -> list[_Arm]:
    off, _ = _offsets(group)
    values = np.concatenate([scan.values for scan in group])
    sound = np.isfinite(values).all(axis=1)
    if sound.sum() < _LEAST:
        raise ClerestoryError(
            f"{light_in_words(group[0])}: {counted(int(sound.sum()), 'point')} are no line ({_LEAST} are needed)"
        )
    u = np.linalg.norm(off, axis=1)
    along, over = np.abs(off[:, 1]) <= ASIDE, np.abs(off[:, 0]) <= ASIDE
    wanted = (
        (0.0, along & (off[:, 0] >= 0.0)),
        (np.pi, along & (off[:, 0] <= 0.0)),
        (0.5 * np.pi, over & (off[:, 1] >= 0.0)),
        (-0.5 * np.pi, over & (off[:, 1] <= 0.0)),
    )
    found = []
    for azimuth, which in wanted:
        # What lies close to the middle belongs to all arms; an arm is one that leaves it.
        here = sound & which
        if here.sum() < 2 or u[here].max() < 2.0 * ASIDE:
            continue
        order = np.argsort(u[here], kind="stable")
        places, first = np.unique(np.round(u[here][order], 6), return_inverse=True)
        means = np.stack([np.bincount(first, column) / np.bincount(first) for column in values[here][order].T], axis=1)
        found.append(_Arm(azimuth, places, means))
    if not found:
        raise ClerestoryError(f"{light_in_words(group[0])}: the line does not leave the peak (scan more of it)")
    return found


def _turned(group: Sequence[Scan], arms: Sequence[_Arm]) -> Scan:
    """A scan over the hemisphere, as far from the middle as an arm reaches."""
    first = group[0]
    _, azimuth = _offsets(group)
    limit = np.sin(np.radians(_LAST_DEG))
    reach = max(float(arm.u[-1]) for arm in arms)
    middle = continued(first.incident, first.scatter)[:2]
    rings = [np.zeros(1)]
    radius = _FINEST
    while radius < reach:
        rings.append(np.array([radius]))
        radius = min(radius * _RATIO, radius + _SPACING)
    u, psi = [], []
    for ring in np.concatenate(rings):
        count = 1 if ring == 0.0 else max(_SECTORS, int(np.ceil(2.0 * np.pi * ring / _SPACING)))
        u.append(np.full(count, ring))
        psi.append(2.0 * np.pi * np.arange(count) / count)
    distance, around = np.concatenate(u), np.concatenate(psi)
    places = middle + distance[:, None] * np.stack([np.cos(around + azimuth), np.sin(around + azimuth)], axis=1)
    inside = np.hypot(*places.T) <= limit
    values = _between(arms, distance[inside], around[inside])
    theta = np.degrees(np.arcsin(np.hypot(*places[inside].T)))
    phi = np.degrees(np.arctan2(places[inside, 1], places[inside, 0]))
    return replace(
        first,
        theta_deg=theta,
        phi_deg=phi,
        values=values,
        standard_errors=None,
        conditions={**first.conditions, "made": MADE},
    )


def _between(arms: Sequence[_Arm], u: Floats, around: Floats) -> Floats:
    """BSDF between the arms: they count by how near their azimuth is, and no longer where they have ended.

    With one plane the shares are cos² and sin² of half the angle; arms at right angles share by cos² of the angle.
    """
    power = 1.0 if any(abs(abs(np.sin(arm.azimuth)) - 1.0) < 1e-6 for arm in arms) else 0.5
    shares, rows = [], []
    for arm in arms:
        away = np.abs((around - arm.azimuth + np.pi) % (2.0 * np.pi) - np.pi)
        share = np.cos(np.minimum(power * away, 0.5 * np.pi)) ** 2
        # An arm that has ended counts only where all have.
        shares.append(np.where(u <= arm.u[-1], share + 1e-6, 1e-12))
        rows.append(arm.at(u))
    weights = np.stack(shares)[:, :, None]
    return np.asarray((weights * np.stack(rows)).sum(axis=0) / weights.sum(axis=0))
