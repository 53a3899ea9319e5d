"""How wide and how clean an instrument's own beam is: what it would take an ideal sample for."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import Delaunay, QhullError

from clerestory._core import ClerestoryError
from clerestory.directions import angles
from clerestory.measure.prepare.step import time_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from clerestory.measure.scan import Measurement, Scan

    Floats = NDArray[np.float64]

LEVELS = (0.5, 1e-2, 1e-4)
"""Shares of the peak at which the width of a beam is told."""
_PER_RING = 8
"""Points over which a ring of the profile is averaged."""
_SLIVER = 60.0
"""Cotangent of an angle of a triangle (1°) beyond which it is a sliver."""
_OPEN = 0.02
"""Share of the peak at a beam scan's border above which the scan does not hold the whole beam."""


@dataclass(frozen=True)
class Signature:
    """The beam of an instrument, as seen with nothing (or an ideal mirror) in its way.

    After the "instrument signature" of IEA SHC Task 61 report C.2.2 (2021), section 2.10.1.
    """

    channel: str
    theta_deg: float
    """Of the beam's centre, from the normal [°]."""
    phi_deg: float
    """Azimuth of the beam's centre [°]."""
    peak: float
    """Largest value, in the unit of the scan."""
    integral: float
    """∫ value dΩ over the beam [unit·sr]: its power times the solid angle of the detector, for a signal."""
    widths_deg: tuple[float | None, ...]
    """Full widths [°] where the ring-averaged profile falls to `LEVELS`; None where the scan does not get so low."""
    border: float
    """Mean value at the border of the scan over the peak: the floor, or what was cut off."""

    @property
    def whole(self) -> bool:
        """Whether the scan reaches out to where the beam has ended."""
        return self.border < _OPEN

    @property
    def words(self) -> str:
        """The beam in a sentence."""
        named = ("full width at half maximum", "at 1 %", "at 0.01 %")
        parts = [
            f"{name} {'not reached' if width is None else f'{width:.3g}°'}"
            for name, width in zip(named, self.widths_deg, strict=True)
        ]
        return f"beam in {self.channel}: {', '.join(parts)}"


@dataclass(frozen=True)
class Drift:
    """What the beam did between its first scan and its last."""

    channel: str
    power: float
    """Relative change of its power."""
    shift_deg: float
    """Angle between its centres [°]."""
    seconds: float | None
    """Time between the two scans, where it is known."""


def signatures(scan: Scan) -> tuple[Signature, ...]:
    """The beam in each channel of a scan of it.

    Raises
    ------
    ClerestoryError
        There is no light in a channel, or there are fewer than three points.
    """
    if len(scan) < 3:
        raise ClerestoryError(f"{len(scan)} points are no profile of a beam (three are needed, on both of its sides)")
    return tuple(_signature(scan, name, scan.values[:, c]) for c, name in enumerate(scan.channels))


def drifts(measurement: Measurement) -> tuple[Drift, ...]:
    """Change of the beam from its first scan to its last, a channel each; empty with fewer than two scans."""
    beams = in_time(measurement.of(purpose="beam"))
    if len(beams) < 2:
        return ()
    first, last = beams[0], beams[-1]
    before, after = time_of(first), time_of(last)
    after_by_channel = {s.channel: s for s in signatures(last)}
    return tuple(
        Drift(
            s.channel,
            after_by_channel[s.channel].integral / s.integral - 1.0,
            _apart(s, after_by_channel[s.channel]),
            None if before is None or after is None else after - before,
        )
        for s in signatures(first)
        if s.channel in after_by_channel
    )


def in_time(scans: Sequence[Scan]) -> list[Scan]:
    """Scans by their time, where all tell it; else in the order in which they come."""
    times = [time_of(scan) for scan in scans]
    if any(time is None for time in times):
        return list(scans)
    return [scan for _, _, scan in sorted(zip(times, range(len(scans)), scans, strict=True))]


def on_one_line(places: Floats) -> bool:
    """Whether points of a plane (n, 2) lie on one line, to a thousandth of its length."""
    x, y = (places - places.mean(axis=0)).T
    a, b, c = float(x @ x), float(y @ y), float(x @ y)
    return a * b - c * c <= 1e-6 * (0.5 * (a + b)) ** 2


def _apart(a: Signature, b: Signature) -> float:
    def unit(s: Signature) -> Floats:
        theta, phi = np.radians([s.theta_deg, s.phi_deg])
        return np.array([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])

    return float(np.degrees(2.0 * np.arcsin(min(1.0, 0.5 * float(np.linalg.norm(unit(a) - unit(b)))))))


def _signature(scan: Scan, channel: str, values: Floats) -> Signature:
    outgoing = scan.outgoing
    if not values.max() > 0.0:
        raise ClerestoryError(f"a scan of the beam has no light in {channel} (is it a scan of the dark?)")
    bright = values > 0.5 * values.max()
    axis = (outgoing[bright] * values[bright, None]).sum(axis=0)
    axis /= np.linalg.norm(axis)
    apart = np.degrees(2.0 * np.arcsin(np.clip(0.5 * np.linalg.norm(outgoing - axis, axis=1), 0.0, 1.0)))
    order = np.argsort(apart)
    rings = np.array_split(order, max(3, len(order) // _PER_RING)) if len(order) > 3 * _PER_RING else order[:, None]
    radius = np.array([apart[ring].mean() for ring in rings])
    profile = np.array([values[ring].mean() for ring in rings])
    # A scan's innermost ring already falls off a little; what the beam peaks at is the brightest of both.
    peak = float(max(values[rings[0]].max(), profile.max()))
    theta, phi = angles(axis)
    return Signature(
        channel,
        float(theta),
        float(phi),
        peak,
        _integral(outgoing, axis, values),
        tuple(_width(radius, profile / peak, level) for level in LEVELS),
        float(profile[-max(1, len(profile) // 10) :].mean() / peak),
    )


def _width(radius: Floats, share: Floats, level: float) -> float | None:
    """Twice the radius where a falling profile passes a level, linear in its logarithm."""
    below = np.flatnonzero(share < level)
    if len(below) == 0 or below[0] == 0:
        return None
    # Noise may dip below the level and come back: the beam ends after the last ring above it.
    above = np.flatnonzero(share >= level)
    k = int(above[-1])
    if k + 1 >= len(share):
        return None
    low = max(float(share[k + 1]), 1e-3 * level)
    part = np.log(share[k] / level) / np.log(share[k] / low)
    return float(2.0 * (radius[k] + part * (radius[k + 1] - radius[k])))


def _integral(outgoing: Floats, axis: Floats, values: Floats) -> float:
    """∫ value dΩ: over the places nearest to each point in Lambert's projection, or rings about a line's centre."""
    across = np.cross(axis, [0.0, 1.0, 0.0] if abs(axis[1]) < 0.9 else [1.0, 0.0, 0.0])
    across /= np.linalg.norm(across)
    plane = np.stack([outgoing @ across, outgoing @ np.cross(axis, across)], axis=1)
    plane *= np.sqrt(2.0 / np.maximum(1.0 + outgoing @ axis, 1e-9))[:, None]
    if on_one_line(plane):
        along = np.linalg.norm(plane, axis=1)
        order = np.argsort(along)
        r = np.concatenate([[0.0], along[order]])
        v = np.concatenate([[values[order[0]]], values[order]])
        return float(np.pi * np.sum(np.diff(r**2) * 0.5 * (v[1:] + v[:-1])))
    try:
        triangles = Delaunay(plane).simplices
    except QhullError as error:
        raise ClerestoryError("the points of a beam scan make no triangles (check their angles)") from error
    return float(np.sum(_voronoi(plane[triangles]) * values[triangles]))


def _voronoi(corners: Floats) -> Floats:
    """Shares of triangles (n, 3, 2) that lie nearest to each corner (n, 3).

    On a square grid each point then stands for one cell, whichever way its squares were cut; thirds of triangles would
    weigh points by how they were cut. Slivers, whose middle lies far off, are cut in thirds.
    """
    sides = np.roll(corners, -1, axis=1) - corners  # from each corner to the next
    area = 0.5 * np.abs(sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0])
    squares = np.sum(sides**2, axis=2)
    # The angle at a corner lies between the way to the next one and the way back to the one before.
    cosines = -np.sum(sides * np.roll(sides, 1, axis=1), axis=2)
    cotangents = cosines / np.maximum(2.0 * area, 1e-300)[:, None]
    opposite = np.roll(cotangents, 1, axis=1)  # to the side from each corner to the next lies the corner before it
    along = squares * opposite / 8.0
    shares = along + np.roll(along, 1, axis=1)
    sliver = np.abs(cotangents).max(axis=1) > _SLIVER
    shares[sliver] = (area / 3.0)[sliver, None]
    return np.asarray(shares)
