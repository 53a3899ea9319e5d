"""Peaks found in a coarse scan, and fine paths over them.

A peak is a point that is higher than all its neighbours, and higher than what lies around it by more than the noise
there; and between it and a higher one there is a valley. What lies around is the median at some distance; the noise is
that of the differences between points and the median of their neighbours, by median absolute deviation, so that neither
peaks nor slopes count as noise.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import cKDTree

from clerestory._core import ClerestoryError
from clerestory.directions import angles, direction
from clerestory.measure.delaunay import surface
from clerestory.measure.plan.paths import circle_path, square_path

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from clerestory.directions import Side
    from clerestory.measure.delaunay import Surface
    from clerestory.measure.plan.paths import Pattern, ScanPath
    from clerestory.measure.scan import Scan

    Floats = NDArray[np.float64]

SIGMAS = 7.0
"""Height over the noise: of 10⁵ points of Gaussian noise not one in 10⁶ scans has one so high."""
CONTRAST = 1.5
"""Height over what lies around; the tops of lobes that a coarse scan resolves are lower."""
_INNER_DEG, _OUTER_DEG = 6.0, 15.0
"""What lies around a peak is between these distances."""
_SAME_LOBE_DEG = 45.0
"""Between peaks closer than this there must be a valley, or the lower one is a ripple of the higher one's lobe."""
_RESOLVED = 5
"""Points above a tenth of a peak's height that say how wide it is."""
_APART_DEG = 3.0
"""Of two peaks closer than this the higher counts."""


@dataclass(frozen=True)
class FoundPeak:
    """A peak of outgoing light."""

    side: Side
    """Side that the light leaves to."""
    theta_deg: float
    phi_deg: float
    bsdf: float
    """Highest value [1/sr]."""
    around: float
    """BSDF around it [1/sr]."""
    sigmas: float
    """Height over the noise; infinite without noise."""
    width_deg: float
    """Width at half height [°], or the distance of the points where that is larger."""
    resolved: bool
    """Whether enough points lie on its flanks to say how wide it is."""


def find_peaks(
    scan: Scan, *, channel: str | None = None, sigmas: float = SIGMAS, contrast: float = CONTRAST
) -> tuple[FoundPeak, ...]:
    """Peaks of a scan of the hemisphere, the highest first.

    Parameters
    ----------
    scan
        Points of BSDF or DSF; those within 5° of the horizon are not looked at.
    channel
        Name of a channel; the first by default.
    sigmas
        Height over the noise that is asked for.
    contrast
        Height over what lies around that is asked for, above 1.

    Raises
    ------
    ClerestoryError
        The points make no surface, or there is no such channel.
    """
    if not sigmas > 0.0 or not contrast > 1.0:
        raise ClerestoryError(f"peaks of {sigmas:g} sigmas and contrast {contrast:g} make no sense (give > 0 and > 1)")
    through = surface(scan)
    name = channel or scan.channels[0]
    if name not in scan.channels:
        scan.channel(name)
    count = int(through.plane.simplices.max()) + 1
    rim = 180
    places, bsdf = through.plane.points[: count - rim], through.values[: count - rim, scan.channels.index(name)]
    r2 = (places**2).sum(axis=1)[:, None]
    toward = np.hstack([2.0 * places, 1.0 - r2]) / (1.0 + r2)  # all to +z; azimuths are the frame's
    # DSF: the noise of a BSDF grows toward the horizon.
    dsf = bsdf * toward[:, 2]
    starts, members = through.plane.vertex_neighbor_vertices
    highest, beside = _neighbours(starts, members, dsf)
    noise = dsf - beside
    tree = cKDTree(toward)
    found: list[FoundPeak] = []
    taken: list[Floats] = []
    for n in np.flatnonzero(dsf >= highest)[np.argsort(-dsf[dsf >= highest], kind="stable")]:
        if any(float(toward[n] @ other) > np.cos(np.radians(_APART_DEG)) for other in taken):
            continue
        near = np.array(tree.query_ball_point(toward[n], 2.0 * np.sin(np.radians(0.5 * _OUTER_DEG))))
        away = np.degrees(np.arccos(np.clip(toward[near] @ toward[n], -1.0, 1.0)))
        ring = near[away >= _INNER_DEG]
        if len(ring) < 8:
            continue
        around = float(np.median(dsf[ring]))
        sigma = 1.4826 * float(np.median(np.abs(noise[ring] - np.median(noise[ring]))))
        height = float(dsf[n]) - around
        if height <= sigmas * sigma or dsf[n] <= contrast * max(around, 0.0) or height <= 0.0:
            continue
        if any(_saddle(through, toward[n], other, scan) * contrast > dsf[n] for other in taken):
            continue
        taken.append(toward[n])
        found.append(_peak(n, near, away, dsf, bsdf, toward, around, height / sigma if sigma > 0.0 else np.inf, scan))
    return tuple(found)


def _saddle(through: Surface, one: Floats, other: Floats, scan: Scan) -> float:
    """Lowest DSF on the way from a point to a higher peak; 0 if that is far away."""
    if float(one @ other) < np.cos(np.radians(_SAME_LOBE_DEG)):
        return 0.0
    share = np.linspace(0.0, 1.0, 33)[:, None]
    way = (1.0 - share) * one + share * other
    way /= np.linalg.norm(way, axis=1)[:, None]
    way[:, 2] *= 1.0 if scan.side == "interior" else -1.0
    return float(through.evaluate(way, dsf=True)[:, 0].min())


def _neighbours(starts: NDArray[np.int32], members: NDArray[np.int32], values: Floats) -> tuple[Floats, Floats]:
    """The highest value among the neighbours of each point, and the median of them."""
    count = len(values)
    highest, beside = np.full(count, -np.inf), np.array(values)
    sizes = np.diff(starts[: count + 1])
    # Points with equally many neighbours together.
    for size in np.unique(sizes):
        rows = np.flatnonzero(sizes == size)
        which = members[starts[rows][:, None] + np.arange(size)]
        held = np.where(which < count, values[np.minimum(which, count - 1)], np.nan)
        known = np.isfinite(held).any(axis=1)
        highest[rows[known]] = np.nanmax(held[known], axis=1)
        beside[rows[known]] = np.nanmedian(held[known], axis=1)
    return highest, beside


def _peak(
    n: int,
    near: NDArray[np.int64],
    away: Floats,
    dsf: Floats,
    bsdf: Floats,
    toward: Floats,
    around: float,
    sigmas: float,
    scan: Scan,
) -> FoundPeak:
    inside = near[away < _INNER_DEG]
    spacing = float(np.sqrt(np.pi * _INNER_DEG**2 / len(inside)))
    height = dsf[inside] - around
    kept = inside[height > 0.1 * (dsf[n] - around)]
    middle, width = _gaussian(toward[kept], np.log(dsf[kept] - around), toward[n])
    resolved = len(kept) >= _RESOLVED and width > 0.0
    if not resolved or float(middle @ toward[n]) < np.cos(np.radians(spacing)):
        middle = toward[n]
    theta, phi = angles(middle)
    width = width if resolved else spacing
    return FoundPeak(
        scan.side,
        float(theta),
        float(phi),
        float(bsdf[n]),
        around / float(toward[n, 2]),
        sigmas,
        float(width),
        resolved,
    )


def _gaussian(toward: Floats, logs: Floats, top: Floats) -> tuple[Floats, float]:
    """Middle (3,) and width at half height [°] of a round Gaussian by least squares; a width of 0 if it has none."""
    aside = np.array([1.0, 0.0, 0.0]) if abs(top[0]) < 0.9 else np.array([0.0, 1.0, 0.0])
    right = np.cross(aside, top) / np.linalg.norm(np.cross(aside, top))
    up = np.cross(top, right)
    x, y = toward @ right, toward @ up
    a, _, rank, _ = np.linalg.lstsq(np.column_stack([np.ones(len(x)), x, y, -0.5 * (x**2 + y**2)]), logs, rcond=None)
    if rank < 4 or a[3] <= 0.0:
        return top, 0.0
    middle = top + (a[1] * right + a[2] * up) / a[3]
    return middle / np.linalg.norm(middle), float(np.degrees(np.sqrt(8.0 * np.log(2.0) / a[3])))


def fine_paths(
    peaks: Iterable[FoundPeak], *, pattern: Pattern = "circle", resolution_deg: float = 1.5
) -> tuple[ScanPath, ...]:
    """A fine path over each peak.

    It reaches one and a half widths from the middle, in steps of an eighth of the width, and no finer than a sixth of
    what the instrument resolves; over a peak that was not resolved, in steps of a sixth of that.
    """
    made = []
    for peak in peaks:
        finest = resolution_deg / 6.0
        step = max(peak.width_deg / 8.0, finest) if peak.resolved else finest
        reach = 1.5 * max(peak.width_deg, resolution_deg)
        centre = direction(peak.theta_deg, peak.phi_deg, side=peak.side)
        if pattern == "circle":
            made.append(circle_path(centre, radius_deg=reach, step_deg=step))
        elif pattern == "square":
            made.append(square_path(centre, half_width_deg=reach, step_deg=step))
        else:
            raise ClerestoryError(f"pattern {pattern!r} is not known (give circle or square)")
    return tuple(made)
