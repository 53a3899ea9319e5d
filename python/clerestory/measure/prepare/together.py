"""A coarse scan of the hemisphere and fine scans of its peaks as one distribution."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Literal

import numpy as np
from scipy.spatial import Delaunay, QhullError, cKDTree
from threadpoolctl import threadpool_limits

from clerestory._core import ClerestoryError
from clerestory.counts import counted
from clerestory.measure.prepare.signature import on_one_line
from clerestory.measure.prepare.step import Step, light_in_words, same_light, with_samples

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from clerestory.measure.scan import Measurement, Scan

    Floats = NDArray[np.float64]

Level = Literal["as measured", "coarse", "fine"]
"""Scans as they are; or fine ones scaled to the coarse one where they overlap; or the coarse one to them."""
LEVELS: tuple[Level, ...] = ("as measured", "coarse", "fine")

APART = 0.1
"""Relative difference of two scans' levels that is worth a warning."""
_DENSE = 3.0
"""A triangle of a fine scan with a longer side than this many of its spacings lies outside of it."""
_FLAT = 0.3
"""Relative range of values in a triangle up to which a coarse point in it can be compared."""


def combined(measurement: Measurement, *, level: Level = "as measured") -> tuple[Measurement, Step]:
    """Scans of the same light, detectors and position as one; where a finer scan is dense, it alone counts.

    Parameters
    ----------
    measurement
        With scans of BSDF.
    level
        Which scan's level holds where they overlap; as measured by default, and the ratio is reported.

    Raises
    ------
    ClerestoryError
        Scans of one light have different quantities.
    """
    if level not in LEVELS:
        raise ClerestoryError(f"level {level!r} is not known (give {', '.join(LEVELS)})")
    made: list[Scan] = []
    ratios: dict[str, float | None] = {}
    dropped = joined = wholes = 0
    warnings = []
    for group in same_light(measurement.of()):
        alike: dict[tuple[str, ...], list[Scan]] = {}
        for scan in group:
            alike.setdefault((scan.conditions.get("position", ""), *scan.channels), []).append(scan)
        for members in alike.values():
            if len({scan.quantity for scan in members}) > 1:
                raise ClerestoryError(
                    f"{light_in_words(members[0])}: scans of {' and '.join(sorted({s.quantity for s in members}))}"
                    " cannot be put together (turn them into BSDF first)"
                )
            whole = members[0]
            ordered = sorted(members, key=lambda s: -_spacing(s))
            if len(ordered) > 1:
                whole = ordered[0]
                joined += len(ordered)
                wholes += 1
            for fine in ordered[1:]:
                whole, ratio, lost = _joined(whole, fine, level)
                dropped += lost
                where = light_in_words(fine)
                ratios[where] = ratio
                if ratio is not None and abs(ratio - 1.0) > APART:
                    warnings.append(
                        f"{where}: a fine scan is {ratio:.2f} times as high as the coarse one where they overlap"
                        + ("" if level == "as measured" else f" (scaled to the {level} one)")
                    )
            made.append(whole)
    words = (
        f"{counted(joined, 'scan')} put together to {counted(wholes, 'distribution')}; "
        f"{counted(dropped, 'coarse point')} inside of finer scans left out"
        if joined
        else "no two scans of the same light: nothing to put together"
    )
    figures = {"scans": joined, "coarse points left out": dropped, "fine over coarse": ratios}
    return with_samples(measurement, made), Step("together", words, {"level": level}, figures, tuple(warnings))


def _spacing(scan: Scan) -> float:
    """Median distance of a point to its nearest other one (chord of the unit sphere)."""
    if len(scan) < 2:
        return np.inf
    places = np.unique(np.round(scan.outgoing, 9), axis=0)
    if len(places) < 2:
        return np.inf
    return float(np.median(cKDTree(places).query(places, k=2)[0][:, 1]))


def _joined(coarse: Scan, fine: Scan, level: Level) -> tuple[Scan, float | None, int]:
    """Both as one scan, fine over coarse where they overlap (None where that cannot be told), and points left out."""
    inside, expected = _within(fine, coarse)
    ratio = None
    comparable = inside & np.isfinite(expected) & (coarse.values[:, 0] > 0.0) & (expected > 0.0)
    if comparable.sum() >= 3:
        ratio = float(np.exp(np.median(np.log(expected[comparable] / coarse.values[comparable, 0]))))
    if ratio is not None and level == "coarse":
        fine = _scaled(fine, 1.0 / ratio)
    elif ratio is not None and level == "fine":
        coarse = _scaled(coarse, ratio)
    keep = ~inside
    errors = None
    if coarse.standard_errors is not None and fine.standard_errors is not None:
        errors = np.concatenate([coarse.standard_errors[keep], fine.standard_errors])
    whole = replace(
        coarse,
        theta_deg=np.concatenate([coarse.theta_deg[keep], fine.theta_deg]),
        phi_deg=np.concatenate([coarse.phi_deg[keep], fine.phi_deg]),
        values=np.concatenate([coarse.values[keep], fine.values]),
        standard_errors=errors,
    )
    return whole, ratio, int(inside.sum())


def _scaled(scan: Scan, factor: float) -> Scan:
    errors = None if scan.standard_errors is None else scan.standard_errors * factor
    return replace(scan, values=scan.values * factor, standard_errors=errors)


def _within(fine: Scan, coarse: Scan) -> tuple[NDArray[np.bool_], Floats]:
    """Which coarse points lie where the fine scan is dense, and what it says there (NaN where it is steep)."""
    nothing = np.zeros(len(coarse), dtype=bool), np.full(len(coarse), np.nan)
    if len(fine) < 3:
        return nothing
    axis = fine.outgoing.mean(axis=0)
    axis /= np.linalg.norm(axis)
    across = np.cross(axis, [0.0, 1.0, 0.0] if abs(axis[1]) < 0.9 else [1.0, 0.0, 0.0])
    across /= np.linalg.norm(across)
    frame = np.stack([across, np.cross(axis, across)], axis=1)
    plane = fine.outgoing @ frame
    if on_one_line(plane):  # a line holds no area in which it could be denser
        return nothing
    try:
        with threadpool_limits(1):  # LAPACK finds a triangle at a time, and its threads would only wait for each other
            triangles = Delaunay(plane)
            every_transform = triangles.transform
    except QhullError:
        return nothing
    corners = fine.outgoing[triangles.simplices]
    sides = np.max([np.linalg.norm(corners[:, k] - corners[:, k - 1], axis=1) for k in range(3)], axis=0)
    dense = sides <= _DENSE * _spacing(fine)
    found = triangles.find_simplex(coarse.outgoing @ frame)
    ahead = coarse.outgoing @ axis > 0.0  # the projection has two sides
    inside = ahead & (found >= 0)
    inside[inside] = dense[found[inside]]
    expected = np.full(len(coarse), np.nan)
    held = fine.values[triangles.simplices, 0]
    flat = np.ptp(held, axis=1) <= _FLAT * np.abs(held.mean(axis=1))
    usable = inside.copy()
    usable[inside] = flat[found[inside]]
    transform = every_transform[found[usable]]
    two = np.einsum("nij,nj->ni", transform[:, :2], coarse.outgoing[usable] @ frame - transform[:, 2])
    weights = np.column_stack([two, 1.0 - two.sum(axis=1)])
    expected[usable] = np.einsum("nc,nc->n", held[found[usable]], weights)
    return inside, expected
