"""How well the symmetries of a sample hold, and what a measurement of a part of it says of the rest.

A symmetry maps a scan to one of light from another direction. Where that one was measured too, both are compared: RMS
difference of ln(BSDF), weighted by projected solid angle. The same is done within the scan itself, every point against
the surface through half of the others: what that gives is noise and the error of interpolation, and is taken off (as
squares).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING, Literal

import numpy as np
from scipy.spatial import cKDTree

from clerestory._core import ClerestoryError
from clerestory.counts import counted
from clerestory.measure.delaunay import surface
from clerestory.measure.prepare.convention import moved
from clerestory.measure.prepare.noise import FLOOR, noise
from clerestory.measure.prepare.step import Step, with_samples

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from clerestory.measure.delaunay import Surface
    from clerestory.measure.scan import Measurement, Scan

    Floats = NDArray[np.float64]

Symmetry = Literal["isotropic", "quadrilateral", "left-right", "up-down", "rotational", "none"]
"""Alike from all azimuths; mirrored in both axes; mirrored left to right, or up to down; turned by 180° (a twill);
none."""
SYMMETRIES: tuple[Symmetry, ...] = ("isotropic", "quadrilateral", "left-right", "up-down", "rotational", "none")

NEGLIGIBLE = 0.10
"""RMS difference of ln(BSDF), beyond noise and interpolation, up to which a symmetry holds. In the round robin of IEA
SHC Task 61 (2021, table 5.5 of its fabric) four careful laboratories differ by 7 % (one standard deviation) in the
direct-hemispherical value and by more in any single direction: a sample's own dependence below 10 % cannot be told from
the choice of a laboratory."""
NEGLIGIBLE_TOTAL = 0.05
"""Relative difference of direct-hemispherical values up to which a symmetry holds, for the same reason."""
_NEAR_DEG = 1.0
"""An image's incident direction is that of a measured scan within this angle [°]."""
_SHALLOW = 1e-3
"""Share of the largest BSDF below which its logarithm is not looked at."""

MIRROR_X = np.diag([-1.0, 1.0])
MIRROR_Y = np.diag([1.0, -1.0])
HALF_TURN = -np.eye(2)
MOVES: dict[Symmetry, tuple[tuple[str, Floats], ...]] = {
    "left-right": (("mirrored left to right", MIRROR_X),),
    "up-down": (("mirrored up to down", MIRROR_Y),),
    "rotational": (("turned by 180°", HALF_TURN),),
    "quadrilateral": (
        ("mirrored left to right", MIRROR_X),
        ("mirrored up to down", MIRROR_Y),
        ("turned by 180°", HALF_TURN),
    ),
}
"""What each symmetry does to the sample's plane."""


@dataclass(frozen=True)
class Score:
    """How well one symmetry holds."""

    symmetry: Symmetry
    comparisons: int
    """Pairs of scans that could be compared; 0 if the measurement cannot tell."""
    difference: float
    """RMS difference of ln(BSDF) beyond noise and interpolation; NaN without comparisons."""
    baseline: float
    """RMS difference of ln(BSDF) that noise and interpolation make."""
    total: float
    """Largest relative difference of direct-hemispherical values; NaN without comparisons."""

    @property
    def holds(self) -> bool:
        """Whether it was tested and holds."""
        return self.comparisons > 0 and self.difference <= NEGLIGIBLE and self.total <= NEGLIGIBLE_TOTAL

    @property
    def words(self) -> str:
        """The verdict in words."""
        if self.comparisons == 0:
            return f"{self.symmetry}: no two scans that could tell"
        return (
            f"{self.symmetry}: {'holds' if self.holds else 'does not hold'} (BSDF differs by a factor of "
            f"{np.exp(self.difference):.2f}, direct-hemispherical by {100.0 * self.total:.1f} %, "
            f"{counted(self.comparisons, 'comparison')})"
        )


def scores(scans: Iterable[Scan], *, channel: str | None = None) -> dict[Symmetry, Score]:
    """How well each symmetry holds.

    Parameters
    ----------
    scans
        Of one sample, one a light; of any sides.
    channel
        The one to compare; the first of each scan by default.
    """
    held = [_Seen.of(scan, channel) for scan in scans if len(scan) >= 12]
    found: dict[Symmetry, Score] = {}
    single: dict[str, tuple[int, float, float, float]] = {
        words: _combined([_compared(a, b, move) for a in held for b in held if _is_image(a.scan, b.scan, move)])
        for words, move in MOVES["quadrilateral"]
    }
    for name, moves in MOVES.items():
        parts = [single[words] for words, _ in moves]
        found[name] = _together(name, parts)
    turns = [_compared(a, b, _turn(b.scan.incident_phi_deg - a.scan.incident_phi_deg)) for a, b in _turned(held)]
    found["isotropic"] = _together("isotropic", [_combined(turns)])
    return {name: found[name] for name in SYMMETRIES if name in found}


def chosen(found: dict[Symmetry, Score]) -> tuple[Symmetry, str]:
    """The highest symmetry that was tested and holds, and why in words."""
    for name in SYMMETRIES:
        if name != "none" and found[name].holds:
            return name, found[name].words
    tested = [score for score in found.values() if score.comparisons]
    if not tested:
        return "none", "no symmetry could be tested: measure an image of one incident direction, or say which one holds"
    return "none", "; ".join(score.words for score in tested)


def completed(
    measurement: Measurement, symmetry: Symmetry | Literal["auto"] = "auto", *, isotropic_step_deg: float = 30.0
) -> tuple[Measurement, Step]:
    """The scans and their images under a symmetry, where the image's own incident direction was not measured.

    Parameters
    ----------
    measurement
        With one scan a light.
    symmetry
        The one that the sample has; the highest that holds by default.
    isotropic_step_deg
        Azimuths [°] to which scans of an isotropic sample are turned; 360 leaves them alone, for a model that knows
        that it is isotropic.

    Raises
    ------
    ClerestoryError
        There is no such symmetry, or the step does not divide 360°.
    """
    if symmetry not in (*SYMMETRIES, "auto"):
        raise ClerestoryError(f"symmetry {symmetry!r} is not known (give auto, {', '.join(SYMMETRIES)})")
    if not (0.0 < isotropic_step_deg <= 360.0 and abs(360.0 / isotropic_step_deg % 1.0) < 1e-9):
        raise ClerestoryError(f"steps of {isotropic_step_deg:g}° do not fill a circle")
    samples = list(measurement.of())
    found = scores(samples)
    stated = symmetry != "auto"
    name, why = (symmetry, "as was said") if symmetry != "auto" else chosen(found)
    made = list(samples)
    for scan in samples:
        for words, move in _moves(name, isotropic_step_deg):
            image = moved(scan, move, f"{words}, from azimuth {scan.incident_phi_deg % 360.0:g}°")
            # At the normal, images are of the same light and may still differ: there they are told by their points.
            if scan.incident_theta_deg < _NEAR_DEG or any(_same(image, other) for other in made):
                continue
            made.append(image)
    made = [replace(scan, conditions={**scan.conditions, "symmetry": name}) for scan in made]
    warnings = []
    if stated and name in found and found[name].comparisons and not found[name].holds:
        warnings.append(f"the sample is taken as {name}, but the data say: {found[name].words}")
    words = (
        f"symmetry {name} ({why}): {counted(len(made) - len(samples), 'scan')} made of {len(samples)} measured"
        if len(made) > len(samples) or name != "none"
        else f"no symmetry used ({why})"
    )
    figures = {
        "scores": {
            s.symmetry: {
                "holds": s.holds,
                "comparisons": s.comparisons,
                "difference": s.difference,
                "baseline": s.baseline,
                "total": s.total,
            }
            for s in found.values()
        },
        "made": len(made) - len(samples),
    }
    settings = {"symmetry": name, "stated": stated, "negligible": NEGLIGIBLE, "negligible total": NEGLIGIBLE_TOTAL}
    return with_samples(measurement, made), Step("symmetry", words, settings, figures, tuple(warnings))


def table(found: dict[Symmetry, Score]) -> list[str]:
    """The scores as lines, the highest symmetry first, with what follows from them."""
    name, _ = chosen(found)
    return [*(score.words for score in found.values()), f"so the sample is taken as: {name}"]


def _moves(name: Symmetry, step_deg: float) -> list[tuple[str, Floats]]:
    if name == "none":
        return []
    if name == "isotropic":
        return [(f"turned by {a:g}°", _turn(a)) for a in np.arange(step_deg, 360.0 - 1e-9, step_deg)]
    return list(MOVES[name])


def _turn(angle_deg: float) -> Floats:
    a = np.radians(angle_deg)
    return np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]])


def _same(a: Scan, b: Scan) -> bool:
    return (a.incident_side, a.scatter) == (b.incident_side, b.scatter) and _near(a.incident, b.incident)


def _near(a: Floats, b: Floats) -> bool:
    return bool(np.linalg.norm(a - b) < np.radians(_NEAR_DEG))


def _is_image(a: Scan, b: Scan, move: Floats) -> bool:
    if (a.incident_side, a.scatter) != (b.incident_side, b.scatter):
        return False
    image = np.array([*(move @ a.incident[:2]), a.incident[2]])
    return _near(image, b.incident)


def _turned(held: Sequence[_Seen]) -> list[tuple[_Seen, _Seen]]:
    """Pairs at one angle to the normal: each with the next, and each with the first."""
    rings: list[list[_Seen]] = []
    for one in held:
        ring = next((ring for ring in rings if _is_turned(ring[0].scan, one.scan)), None)
        if ring is None:
            rings.append([one])
        elif not any(_same(other.scan, one.scan) for other in ring):
            ring.append(one)
    return [pair for ring in rings for pair in [*pairwise(ring), *((ring[0], other) for other in ring[2:])]]


def _is_turned(a: Scan, b: Scan) -> bool:
    """Whether two scans are of light at the same angle to the normal and another azimuth."""
    alike = (a.incident_side, a.scatter) == (b.incident_side, b.scatter)
    near = abs(a.incident_theta_deg - b.incident_theta_deg) < 0.5 * _NEAR_DEG
    return alike and near and a.incident_theta_deg >= _NEAR_DEG and not _near(a.incident, b.incident)


@dataclass(frozen=True)
class _Seen:
    """A scan, and what is needed of it again and again."""

    scan: Scan
    least: float
    """BSDF below which logarithms are not looked at [1/sr]."""
    own: float
    """RMS difference of ln(BSDF) within the scan."""
    total: float
    through: Surface

    @classmethod
    def of(cls, scan: Scan, channel: str | None) -> _Seen:
        name = scan.channels[0] if channel is None else channel
        bsdf = scan.as_bsdf()
        one = replace(bsdf, channels=(name,), values=bsdf.channel(name)[:, None].copy(), standard_errors=None)
        values = one.values[:, 0]
        least = max(FLOOR * noise(one, name), _SHALLOW * float(np.quantile(values, 0.98)), 1e-12)
        through = surface(one)
        return cls(one, least, _own_difference(one, least), float(through.integrate().total[0]), through)


def _own_difference(scan: Scan, least: float) -> float:
    """RMS difference of ln(BSDF) between every second point and the surface through the others.

    A surface through all points errs less than one through half of them: by a half, as its error goes with the square
    of the points' distance.
    """
    order = np.argsort(np.arctan2(scan.outgoing[:, 1], scan.outgoing[:, 0]) + 1e-3 * scan.theta_deg)
    kept, left = np.sort(order[::2]), np.sort(order[1::2])
    half = _part(scan, kept)
    return 0.5 * _rms(surface(half), scan.outgoing[left], scan.values[left, 0], scan.theta_deg[left], least)[0]


def _part(scan: Scan, which: NDArray[np.intp]) -> Scan:
    return replace(scan, theta_deg=scan.theta_deg[which], phi_deg=scan.phi_deg[which], values=scan.values[which])


def _compared(a: _Seen, b: _Seen, move: Floats) -> tuple[float, float, float, float]:
    """RMS difference between the image of `a` and `b`, its baseline, its weight, and that of the totals."""
    least = max(a.least, b.least)
    back = b.scan.outgoing.copy()
    back[:, :2] = back[:, :2] @ move  # the inverse of an orthogonal matrix is its transpose
    difference, weight = _rms(a.through, back, b.scan.values[:, 0], b.scan.theta_deg, least)
    level = max(0.5 * (a.total + b.total), 1e-12)
    return difference, float(np.hypot(a.own, b.own)), weight, abs(a.total - b.total) / level


def _rms(through: Surface, outgoing: Floats, values: Floats, theta_deg: Floats, least: float) -> tuple[float, float]:
    """RMS difference of ln(BSDF) between a surface and values elsewhere, and how much area it was seen on."""
    here = through.measured(outgoing)
    expected = through.evaluate(outgoing)[:, 0]
    here &= (np.maximum(expected, values) > least) & (theta_deg < 85.0)
    if here.sum() < 4:
        return 0.0, 0.0
    # Points crowd about peaks: each stands for the area between it and its neighbours.
    weights = _areas(outgoing[here]) * np.cos(np.radians(theta_deg[here]))
    off = np.log(np.maximum(expected[here], least) / np.maximum(values[here], least))
    return float(np.sqrt(np.average(off**2, weights=weights))), float(weights.sum())


def _areas(outgoing: Floats) -> Floats:
    """Area about each point by its distance to its third neighbour."""
    count = min(4, len(outgoing))
    far = cKDTree(outgoing).query(outgoing, k=count)[0][:, -1]
    return np.asarray(np.maximum(far**2, 1e-12))


def _combined(pairs: Sequence[tuple[float, float, float, float]]) -> tuple[int, float, float, float]:
    usable = [pair for pair in pairs if pair[2] > 0.0]
    if not usable:
        return 0, float("nan"), 0.0, float("nan")
    array = np.array(usable)
    difference = float(np.sqrt(np.mean(array[:, 0] ** 2)))
    baseline = float(np.sqrt(np.mean(array[:, 1] ** 2)))
    return len(usable), difference, baseline, float(array[:, 3].max())


def _together(name: Symmetry, parts: Sequence[tuple[int, float, float, float]]) -> Score:
    """A symmetry of several moves holds if each does, and was tested if each was."""
    if any(part[0] == 0 for part in parts):
        return Score(name, 0, float("nan"), 0.0, float("nan"))
    worst = max(parts, key=lambda part: part[1])
    beyond = float(np.sqrt(max(0.0, worst[1] ** 2 - worst[2] ** 2)))
    return Score(name, sum(part[0] for part in parts), beyond, worst[2], max(part[3] for part in parts))
