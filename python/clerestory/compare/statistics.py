"""Spread and outliers among a few data sets."""

from __future__ import annotations

import numpy as np

from clerestory.compare.result import Outlier, Spread

LIMIT = 3.5
"""Modified z-score above which a value stands apart (Iglewicz and Hoaglin 1993, "How to detect and handle
outliers")."""
LEAST = 4
"""With fewer data sets nothing can be called an outlier."""
RELATIVE_FLOOR = 0.02
"""A deviation counts at least this share of the median, so that data sets that agree closely have no outliers."""


def spread(values: tuple[float | None, ...]) -> Spread | None:
    """How far values lie apart; None if there are none."""
    known = np.array([v for v in values if v is not None])
    if known.size == 0:
        return None
    mean = float(known.mean())
    return Spread(
        count=known.size,
        minimum=float(known.min()),
        maximum=float(known.max()),
        mean=mean,
        median=float(np.median(known)),
        standard_deviation=float(known.std(ddof=1)) if known.size > 1 else None,
        range_percent=100.0 * float(known.max() - known.min()) / mean if mean > 0.0 else None,
    )


def outliers(labels: tuple[str, ...], values: tuple[float | None, ...], floor: float) -> tuple[Outlier, ...]:
    """Values that stand apart from the others.

    Parameters
    ----------
    labels, values
        One a data set.
    floor
        Least median deviation that is believed, in the unit of the values.

    Notes
    -----
    With four values or more those of a modified z-score 0.6745 (x − median) / MAD above `LIMIT`, where the median
    absolute deviation MAD is at least `floor` and at least `RELATIVE_FLOOR` of the median. With three, only the one
    that is furthest from the median, if it is further than those floors. With two there is none.
    """
    known = [(label, v) for label, v in zip(labels, values, strict=True) if v is not None]
    if len(known) < 3:
        return ()
    data = np.array([v for _, v in known])
    median = float(np.median(data))
    deviation = np.abs(data - median)
    least = max(floor, RELATIVE_FLOOR * abs(median))
    if len(known) < LEAST:
        k = int(np.argmax(deviation))
        return (Outlier(known[k][0], known[k][1], None),) if deviation[k] > least else ()
    scores = 0.6745 * (data - median) / max(float(np.median(deviation)), least)
    found = [Outlier(label, v, float(s)) for (label, v), s in zip(known, scores, strict=True) if abs(s) > LIMIT]
    return tuple(sorted(found, key=lambda o: -abs(o.score or 0.0)))
