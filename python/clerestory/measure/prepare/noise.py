"""How much of what was measured is noise: a floor, negative values, and a standard error for every point.

A detector's noise is the same in all directions, so it is one number in DSF and grows with 1/cos θ in BSDF. Negative
values are the half of the noise that can be seen. They stay: to make them 0 would leave the other half, and add half of
the noise's mean to every integral.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import cKDTree

from clerestory._core import ClerestoryError
from clerestory.measure.prepare.step import Step, light_in_words, with_conditions, with_samples
from clerestory.words import percent

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from clerestory.measure.scan import Measurement, Scan

    Floats = NDArray[np.float64]

FLOOR = 3.0
"""Standard deviations of the noise below which a single value says nothing."""
NEGATIVE = 0.25
"""Share of negative values above which a scan is mostly noise, or its dark signal is wrong."""
_NEARLY_HALF = 0.4
_NEIGHBOURS = 6
_LEAST_COSINE = 1e-3
_MEDIAN_TO_SIGMA = 1.4826
"""Standard deviation over the median absolute deviation of a normal distribution."""


def with_errors(measurement: Measurement, *, relative: float = 0.0) -> tuple[Measurement, Step]:
    """Scans with a standard error for every value that has none, and the noise floor among their conditions.

    Parameters
    ----------
    measurement
        With scans of BSDF.
    relative
        Standard error of a value relative to it, beside the noise: of levels and angles of the instrument.

    Raises
    ------
    ClerestoryError
        `relative` is negative or not a number, or scans are a detector's signal.
    """
    if not (np.isfinite(relative) and 0.0 <= relative < 1.0):
        raise ClerestoryError(f"a relative error of {relative:g} makes no sense (give a share, 0 to 1)")
    made, warnings, floors = [], [], {}
    negative = below = total = 0
    for scan in measurement.of():
        if scan.quantity == "signal":
            raise ClerestoryError("noise is told of a BSDF (refer the signal to the beam first)")
        cosine = _cosine(scan)
        sigma = np.array([noise(scan, name) for name in scan.channels])
        errors = scan.standard_errors
        if errors is None:
            errors = np.hypot(sigma / cosine[:, None], relative * scan.values)
        dsf = scan.values * cosine[:, None]
        under = int((scan.values < 0.0).sum())
        negative += under
        below += int((dsf < FLOOR * sigma).sum())
        total += scan.values.size
        where = light_in_words(scan)
        floors[where] = {name: float(s) for name, s in zip(scan.channels, sigma, strict=True)}
        if under > NEGATIVE * scan.values.size:
            warnings.append(
                f"{where}: {percent(under / scan.values.size)} of the values are negative (mostly noise, or the dark"
                " signal that was taken off is too large)"
            )
        text = ", ".join(f"{s:.3g}" for s in sigma)
        made.append(with_conditions(replace(scan, standard_errors=errors), noise_dsf=text))
    median = float(np.median([max(by.values()) for by in floors.values()])) if floors else 0.0
    words = (
        f"noise of {median:.2g}/sr in DSF (median of the scans): {below:,} of {total:,} values lie below {FLOOR:g}"
        f" times it, {negative:,} are negative; all are kept"
    )
    figures = {"noise of DSF": floors, "below the floor": below, "negative": negative, "values": total}
    settings = {"relative": relative, "floor": FLOOR}
    return with_samples(measurement, made), Step("noise", words, settings, figures, tuple(warnings))


def noise(scan: Scan, channel: str) -> float:
    """Standard deviation of the noise in DSF [1/sr].

    It is told where the scan is darkest, by the mean of each point's neighbours (a point that is dark itself may be so
    by its noise): from the scan's own standard errors there; else from negative values, E[v² | v < 0] = σ² about a true
    value of 0, where nearly half are negative; else from how points differ from the mean of their neighbours. A scan of
    fewer than 12 points has none that could be told: 0.
    """
    cosine = _cosine(scan)
    dsf = scan.channel(channel) * cosine
    places, first = np.unique(np.round(scan.outgoing, 9), axis=0, return_index=True)
    if len(places) < 2 * _NEIGHBOURS:
        return 0.0
    held = dsf[first]
    about = held[cKDTree(places).query(places, k=_NEIGHBOURS + 1)[1][:, 1:]].mean(axis=1)
    dark = about <= np.quantile(about, 0.25)
    if scan.standard_errors is not None:
        return float(np.median((scan.standard_errors[:, scan.channels.index(channel)] * cosine)[first][dark]))
    below = held[dark & (held < 0.0)]
    if len(below) >= _NEARLY_HALF * dark.sum():
        return float(np.sqrt(np.mean(below**2)))
    off = (held - about)[dark]
    # A difference to the mean of n neighbours has 1 + 1/n times the variance of one value.
    spread = _MEDIAN_TO_SIGMA * float(np.median(np.abs(off - np.median(off))))
    return spread / float(np.sqrt(1.0 + 1.0 / _NEIGHBOURS))


def _cosine(scan: Scan) -> Floats:
    return np.maximum(np.cos(np.radians(scan.theta_deg)), _LEAST_COSINE)
