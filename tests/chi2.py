"""Chi-squared test of a sampler against its density (after the harnesses of pbrt and Mitsuba 3).

Samples are counted in bins of the outgoing hemispheres; peaks have bins of their own. The density is integrated over
every bin with low-discrepancy points, more of them where there are many samples. Bins that expect fewer than five
samples are pooled. A sample where the density is zero rejects at once.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import erfc, exp, lgamma, log, sqrt
from typing import TYPE_CHECKING

import numpy as np

from partition import low_discrepancy
from registry import outgoing

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from clerestory.bsdf import Samples
    from clerestory.directions import Side
    from partition import Partition
    from registry import Case

#: Chance of rejecting a suite of right samplers.
SIGNIFICANCE = 0.01
LEAST_EXPECTED = 5.0
PROBE = 64
STEPS = (128, 1024, 8192, 65_536, 1_048_576)


def corrected(tests: int, significance: float = SIGNIFICANCE) -> float:
    """Significance of each of several independent tests (Šidák 1967)."""
    return 1 - (1 - significance) ** (1 / tests)


def chi2_tail(x: float, freedom: int) -> float:
    """Chance that a chi-squared variable exceeds x: its closed sum for whole degrees of freedom."""
    if x <= 0:
        return 1.0
    y = x / 2
    first = 0.0 if freedom % 2 == 0 else 0.5
    sum_ = erfc(sqrt(y)) if first else 0.0
    return min(1.0, sum_ + sum(exp(j * log(y) - y - lgamma(j + 1)) for j in np.arange(first, freedom / 2)))


@dataclass(frozen=True)
class Outcome:
    """What a test found."""

    chance: float
    """p-value."""
    words: str
    observed: np.ndarray
    expected: np.ndarray

    def save(self, folder: Path, name: str) -> Path:
        """Writes both tables for a plot."""
        path = folder / f"chi2 {name}.npz"
        np.savez(path, observed=self.observed, expected=self.expected)
        return path


def expected_share(
    density: Callable[[np.ndarray], np.ndarray], bins: Partition, cells: Partition | None, count: int
) -> np.ndarray:
    """∫ density over every bin, so well that the error is small against the spread of `count` samples.

    Parameters
    ----------
    density
        Of disk points, per unit of disk area.
    cells
        Cells in which the density is constant, if there are any; that it is so is asserted.
    """
    if cells is None:
        return _refined(density, bins, count)
    values = density(cells.points(low_discrepancy(PROBE)))
    assert np.ptp(values, axis=1).max() <= 1e-9 * values.max(), "the density is not constant in its cells"
    share = values.mean(axis=1) * cells.areas
    if bins == cells:
        return share
    expected = np.zeros(len(bins.areas))
    # A cell that covers many bins needs the points of each of them.
    covered = np.maximum(cells.areas / bins.areas.min(), 1.0)
    for some, points in _groups(covered * _needed(share / covered, share / covered, count), cells, share > 0):
        inside = np.broadcast_to(share[some, None] / points.shape[1], points.shape[:2])
        expected += np.bincount(bins.index(points).ravel(), inside.ravel(), len(expected))
    return expected


def _refined(density: Callable[[np.ndarray], np.ndarray], bins: Partition, count: int) -> np.ndarray:
    values = density(bins.points(low_discrepancy(PROBE)))
    share = values.mean(axis=1) * bins.areas
    uneven = np.ptp(values, axis=1) * bins.areas
    for some, points in _groups(_needed(share, uneven, count), bins, uneven > 1e-9 * share):
        share[some] = density(points).mean(axis=1) * bins.areas[some]
    return share


def _needed(share: np.ndarray, uneven: np.ndarray, count: int) -> np.ndarray:
    """Points a cell. n points on a step err by less than uneven / n^0.75; that is to be a fifth of √(share / count)."""
    return (5 * uneven * np.sqrt(count / np.maximum(share, 1 / count))) ** (4 / 3)


def _groups(needed: np.ndarray, cells: Partition, chosen: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Cells that need about as many points, a million points at a time."""
    step = np.minimum(np.searchsorted(STEPS, needed), len(STEPS) - 1)
    for k, n in enumerate(STEPS):
        members = np.flatnonzero(chosen & (step == k))
        for some in np.array_split(members, max(1, len(members) * n // 1_000_000)):
            if len(some):
                yield some, cells.points(low_discrepancy(n), some)


def chi2(observed: np.ndarray, expected: np.ndarray) -> Outcome:
    """Pearson's test with small bins pooled."""
    order = np.argsort(expected)
    sums = np.cumsum(expected[order])
    small = int(np.searchsorted(expected[order], LEAST_EXPECTED))
    # Bins go into the pool until it expects enough as well.
    while small and small < len(order) and sums[small - 1] < LEAST_EXPECTED:
        small += 1
    o, e = observed[order][small:], expected[order][small:]
    if small and sums[small - 1] > 0:
        o, e = np.append(o, observed[order][:small].sum()), np.append(e, sums[small - 1])
    if len(e) < 2:
        return Outcome(1.0, "one bin", observed, expected)
    statistic = float(np.sum((o - e) ** 2 / e))
    freedom = len(e) - 1
    chance = chi2_tail(statistic, freedom)
    worst = int(np.argmax((o - e) ** 2 / e))
    words = (
        f"chi² {statistic:.1f} for {freedom} degrees of freedom, chance {chance:.2e}; "
        f"worst bin {o[worst]:.0f} for {e[worst]:.1f} expected"
    )
    return Outcome(chance, words, observed, expected)


def compare(
    case: Case,
    incident: np.ndarray,
    side: Side,
    divisions: list[Partition],
    bands: list[str],
    samples: Samples,
    pdf: Callable[[np.ndarray, np.ndarray], np.ndarray] | None = None,
) -> list[Outcome]:
    """Compares samples for one incident direction with their density, over all bands and all that light does.

    Parameters
    ----------
    divisions
        Bins; each division gives an outcome of its own.
    pdf
        Another density of (incident, outgoing), to show that a wrong one is found.
    """
    density_of = pdf or (lambda i, o: case.bsdf.pdf(i, o, bands, scatter=case.only(side)))
    count = len(samples.outgoing)
    scatters = case.scatters(side)
    total = sum(case.bsdf.integrate(incident, c, band=b) for c in scatters for b in bands)
    peaks: dict[tuple, float] = {}
    for peak in (p for c in scatters for b in bands for p in case.bsdf.peaks(incident, c, b)):
        key = tuple(np.round(peak.outgoing, 9) + 0.0)
        peaks[key] = peaks.get(key, 0.0) + peak.value / total
    beams = samples.outgoing[samples.peak]
    near = [int(np.sum(np.linalg.norm(beams - key, axis=1) < 1e-8)) for key in peaks]
    impossible = int(np.sum(density_of(incident, samples.outgoing[~samples.peak]) <= 0)) + len(beams) - sum(near)
    cells = case.exact(incident) if pdf is None else None
    outcomes = []
    for bins in divisions:
        observed, expected = [], []
        for scatter in scatters:

            def density(points, scatter=scatter):
                to = outgoing(points, side, scatter)
                return density_of(incident, to) / np.maximum(np.abs(to[..., 2]), 1e-300)

            sign = outgoing(np.zeros(2), side, scatter)[2]
            mine = ~samples.peak & (np.sign(samples.outgoing[:, 2]) == sign)
            observed.append(np.bincount(bins.index(samples.outgoing[mine, :2]), minlength=len(bins.areas)))
            expected.append(expected_share(density, bins, cells, count) * count)
        # One bin a peak, whose share of the samples is its share of the light.
        shares = np.array(list(peaks.values()))
        tables = np.concatenate([*observed, near]).astype(float), np.concatenate([*expected, shares * count])
        outcomes.append(
            Outcome(0.0, f"{impossible} samples where the density is zero", *tables) if impossible else chi2(*tables)
        )
    return outcomes


def draw(case: Case, incident: np.ndarray, side: Side, count: int, seed: int) -> Samples:
    """Samples of all that happens to light from one direction."""
    u = np.random.default_rng([seed, *case.name.encode()]).random((count, 2))
    return case.bsdf.sample(incident, u, case.bsdf.bands, scatter=case.only(side))
