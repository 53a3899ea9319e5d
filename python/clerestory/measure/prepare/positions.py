"""Several positions of a sample, or samples of a product: their mean, their spread, and which stands for all."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.counts import counted
from clerestory.measure.delaunay import surface
from clerestory.measure.prepare.channels import same_points
from clerestory.measure.prepare.step import Step, light_in_words, same_light, with_samples
from clerestory.words import percent

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from clerestory.measure.scan import Measurement, Scan

    Floats = NDArray[np.float64]

SPREAD = 0.05
"""Standard deviation of direct-hemispherical values over their mean from which on a sample is called inhomogeneous."""
OUTLIER = 3.5
"""Modified z-score above which one of several is an outlier (Iglewicz and Hoaglin 1993)."""
LEAST_DEVIATION = 0.01
"""Relative difference from the median below which nothing is an outlier, however alike the others are."""
_Z = 0.6745
"""Median absolute deviation of a normal distribution over its standard deviation."""


@dataclass(frozen=True)
class Inhomogeneity:
    """How much several samples, or positions on one, differ."""

    mean: Floats
    """(values,)."""
    standard_deviation: Floats
    """Between samples (values,)."""
    relative: float
    """RMS of the standard deviations over the RMS of the means."""
    outliers: tuple[int, ...]
    """Samples that stand out of the others, counted from 0."""
    representative: int
    """The sample nearest to the mean of all that are no outliers, counted from 0."""

    @property
    def is_inhomogeneous(self) -> bool:
        """Whether the samples differ by more than `SPREAD`."""
        return self.relative > SPREAD


def inhomogeneity(values: ArrayLike) -> Inhomogeneity:
    """Mean, spread, outliers and the representative one of several samples.

    Parameters
    ----------
    values
        Spectra, or values of several bands or angles, (samples, values); at least two samples.

    Notes ----- A sample's distance is the RMS of its differences from the medians. It is an outlier if its modified
    z-score, 0.6745 times the distance over the median of all distances, is above `OUTLIER`. Two samples have none:
    nobody knows which is right.

    Raises
    ------
    ClerestoryError
        There are fewer than two samples, or a value is not a number.
    """
    table = np.asarray(values, dtype=np.float64)
    if table.ndim != 2 or len(table) < 2 or table.shape[1] == 0:
        raise ClerestoryError(f"values of shape {table.shape} are not those of several samples (samples, values)")
    if not np.isfinite(table).all():
        raise ClerestoryError("a value of a sample is not a number (leave incomplete samples out)")
    far = np.sqrt(np.mean((table - np.median(table, axis=0)) ** 2, axis=1))
    usual = float(np.median(far))
    level = float(np.sqrt(np.mean(np.median(table, axis=0) ** 2)))
    outliers: tuple[int, ...] = ()
    if len(table) > 2:
        limit = max(OUTLIER * usual / _Z, LEAST_DEVIATION * level)
        outliers = tuple(int(k) for k in np.flatnonzero(far > limit))
    good = np.setdiff1d(np.arange(len(table)), outliers)
    mean = table[good].mean(axis=0)
    nearest = good[int(np.argmin(np.mean((table[good] - mean) ** 2, axis=1)))]
    deviation = table.std(axis=0, ddof=1)
    whole = float(np.sqrt(np.mean(table.mean(axis=0) ** 2)))
    relative = float(np.sqrt(np.mean(deviation**2))) / whole if whole > 0.0 else 0.0
    return Inhomogeneity(table.mean(axis=0), deviation, relative, outliers, int(nearest))


def averaged(measurement: Measurement) -> tuple[Measurement, Step]:
    """Scans of the same light at several positions of the sample as their mean, with the error of that mean.

    Scans belong to different positions where their condition `position` differs. Those at other points than the first
    are read off their surfaces at its points.

    Raises
    ------
    ClerestoryError
        Positions of one light have different quantities, or one has several scans.
    """
    made = []
    spreads: dict[str, object] = {}
    joined = 0
    warnings = []
    for group in _of_one_detector(measurement):
        places: dict[str, list[Scan]] = {}
        for scan in group:
            places.setdefault(scan.conditions.get("position", ""), []).append(scan)
        if len(places) < 2:
            made += group
            continue
        if any(len(members) > 1 for members in places.values()):
            raise ClerestoryError(
                f"{light_in_words(group[0])}: several scans at one position (combine coarse and fine ones first)"
            )
        joined += len(group)
        mean, found = _mean(group)
        made.append(mean)
        where = light_in_words(mean)
        spreads[where] = {
            "positions": list(places),
            "hemispherical": found.mean.tolist(),
            "relative spread": found.relative,
            "outliers": [list(places)[k] for k in found.outliers],
            "representative": list(places)[found.representative],
        }
        if found.is_inhomogeneous:
            warnings.append(
                f"{where}: {counted(len(group), 'position')} differ by {percent(found.relative)} (standard deviation of"
                " the direct-hemispherical values): the sample is inhomogeneous, or the spot is too small for it"
            )
        warnings += [f"{where}: position {list(places)[k]!r} stands out of the others" for k in found.outliers]
    words = (
        f"{counted(joined, 'scan')} at several positions averaged to {counted(len(spreads), 'scan')}"
        if joined
        else "one position only: nothing to average"
    )
    return with_samples(measurement, made), Step("positions", words, {}, {"spread": spreads}, tuple(warnings))


def _of_one_detector(measurement: Measurement) -> list[list[Scan]]:
    """Scans of one light and of the same channels."""
    groups = []
    for light in same_light(measurement.of()):
        by_channels: dict[tuple[str, ...], list[Scan]] = {}
        for scan in light:
            by_channels.setdefault(scan.channels, []).append(scan)
        groups += list(by_channels.values())
    return groups


def _mean(group: Sequence[Scan]) -> tuple[Scan, Inhomogeneity]:
    first = group[0]
    if any(scan.quantity != first.quantity for scan in group):
        raise ClerestoryError(
            f"{light_in_words(first)}: positions have different quantities (turn them into BSDF first)"
        )
    if same_points(group):
        values = np.stack([scan.values for scan in group])
    else:
        first = first.as_bsdf()
        through = [surface(scan, clip_deg=0.0).evaluate(first.outgoing) for scan in group[1:]]
        values = np.stack([first.values, *through])
    totals = np.stack([surface(scan).integrate().total for scan in group])
    found = inhomogeneity(totals)
    conditions = {key: text for key, text in first.conditions.items() if key != "position"}
    conditions["positions"] = str(len(group))
    mean = replace(
        first,
        values=values.mean(axis=0),
        standard_errors=values.std(axis=0, ddof=1) / np.sqrt(len(group)),
        conditions=conditions,
    )
    return mean, found
