"""What a year of illuminance comes to at every point: autonomy, useful illuminance, exposure."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

THRESHOLDS = (100.0, 300.0, 500.0, 750.0)
"""Illuminances [lx] for which autonomy is kept: those of EN 17037 and of LM-83 among them."""
UDI_LIMITS = (100.0, 300.0, 3000.0)
"""Limits of useful daylight illuminance [lx] (Nabil and Mardaljevic 2005; Mardaljevic et al. 2012)."""
UDI_NAMES = ("fell-short", "supplementary", "autonomous", "exceeded")
"""Bands below, between and above them: below 100, 100 to 300, 300 to 3000, above 3000 lx."""


@dataclass(frozen=True)
class PointMetrics:
    """Metrics of the points (n) of a room over the hours that count."""

    hours: float
    """Hours that count [h]."""
    thresholds: Floats
    """Illuminances (k,) [lx]."""
    autonomy: Floats
    """Daylight autonomy: share of the hours with at least so much (k, n), 0 to 1 (Reinhart and Walkenhorst 2001)."""
    continuous_autonomy: Floats
    """Mean of min(1, E/threshold) (k, n), 0 to 1 (Rogers 2006)."""
    useful: Floats
    """Share of the hours in the bands of `UDI_NAMES` (4, n); their sum is 1."""
    exposure: Floats
    """Light exposure (n,) [lx·h]."""
    highest: Floats
    """Highest illuminance (n,) [lx]."""

    @property
    def mean(self) -> Floats:
        """Mean illuminance (n,) [lx]."""
        return self.exposure / self.hours

    def autonomy_at(self, threshold: float) -> Floats:
        """Daylight autonomy (n,) of one illuminance [lx]."""
        found: Floats = self.autonomy[self._index(threshold)]
        return found

    def continuous_autonomy_at(self, threshold: float) -> Floats:
        """Continuous daylight autonomy (n,) of one illuminance [lx]."""
        found: Floats = self.continuous_autonomy[self._index(threshold)]
        return found

    def _index(self, threshold: float) -> int:
        found = np.flatnonzero(self.thresholds == threshold)
        if len(found) == 0:
            kept = ", ".join(f"{t:g}" for t in self.thresholds)
            raise ClerestoryError(f"autonomy of {threshold:g} lx was not kept (kept: {kept} lx; say it beforehand)")
        return int(found[0])


def joined(parts: Sequence[PointMetrics]) -> PointMetrics:
    """Metrics of the points of several, over the same hours, one after another."""
    arrays = ("autonomy", "continuous_autonomy", "useful", "exposure", "highest")
    together = {name: np.concatenate([getattr(part, name) for part in parts], axis=-1) for name in arrays}
    return PointMetrics(parts[0].hours, parts[0].thresholds, **together)


class PointYear:
    """Collects the metrics of points from pieces of a year, so that the whole of it is never in memory."""

    def __init__(self, points: int, *, thresholds: Sequence[float] = THRESHOLDS) -> None:
        """For so many points, with the illuminances [lx] for which autonomy is kept."""
        if points < 1:
            raise ClerestoryError("a room without points has no metrics (give at least one)")
        if not len(thresholds) or min(thresholds) <= 0.0:
            raise ClerestoryError("autonomy is of illuminances above 0 lx (give at least one)")
        self._thresholds = np.array(thresholds, dtype=np.float64)
        self._hours = 0.0
        self._reached = np.zeros((len(thresholds), points))
        self._partly = np.zeros((len(thresholds), points))
        self._bands = np.zeros((len(UDI_NAMES), points))
        self._exposure = np.zeros(points)
        self._highest = np.zeros(points)

    def add(self, illuminance: ArrayLike, hours: ArrayLike) -> None:
        """Some steps.

        Parameters
        ----------
        illuminance
            (steps, points) [lx].
        hours
            Hours that each step counts for (steps,) [h]; 0 if it does not.
        """
        values, weights = checked(illuminance, hours)
        if values.shape[1] != len(self._exposure):
            raise ClerestoryError(
                f"illuminances of {values.shape[1]} points do not go with {len(self._exposure)} (give all a step)"
            )
        counted = weights > 0.0
        values, weights = values[counted], weights[counted]
        if not len(weights):
            return
        self._hours += float(weights.sum())
        for k, threshold in enumerate(self._thresholds):
            self._reached[k] += weights @ (values >= threshold)
            self._partly[k] += weights @ np.minimum(values / threshold, 1.0)
        low, middle, high = UDI_LIMITS
        short, little, much = weights @ (values < low), weights @ (values < middle), weights @ (values > high)
        self._bands += np.stack([short, little - short, weights.sum() - little - much, much])
        self._exposure += weights @ values
        self._highest = np.maximum(self._highest, values.max(axis=0))

    def result(self) -> PointMetrics:
        """The metrics of all that was added.

        Raises
        ------
        ClerestoryError
            No hour counted.
        """
        if self._hours <= 0.0:
            raise ClerestoryError("no hour of the weather counts (choose other hours)")
        return PointMetrics(
            self._hours,
            self._thresholds.copy(),
            self._reached / self._hours,
            self._partly / self._hours,
            np.maximum(self._bands, 0.0) / self._hours,
            self._exposure.copy(),
            self._highest.copy(),
        )


def point_metrics(
    illuminance: ArrayLike, hours: ArrayLike, *, thresholds: Sequence[float] = THRESHOLDS
) -> PointMetrics:
    """Metrics of every point of a year that is in memory.

    Parameters
    ----------
    illuminance
        (steps, points) [lx].
    hours
        Hours that each step counts for (steps,) [h].
    thresholds
        Illuminances for which autonomy is kept [lx].

    Examples
    --------
    >>> from clerestory.annual.metrics import point_metrics
    >>> point_metrics([[0.0], [250.0], [500.0], [4000.0]], [1, 1, 1, 1]).autonomy_at(500)
    array([0.5])
    """
    year = PointYear(np.shape(illuminance)[1] if np.ndim(illuminance) == 2 else 1, thresholds=thresholds)
    year.add(illuminance, hours)
    return year.result()


def share_of_area(is_met: ArrayLike, area: ArrayLike | None = None) -> float:
    """Share of the room in which something holds, 0 to 1.

    Parameters
    ----------
    is_met
        At every point (n,).
    area
        That each point stands for (n,) [m²]; all the same by default.
    """
    met = np.asarray(is_met, dtype=bool)
    weights = np.ones(met.shape) if area is None else np.asarray(area, dtype=np.float64)
    if weights.shape != met.shape or not weights.sum() > 0.0:
        raise ClerestoryError(f"areas {weights.shape} do not go with {met.shape} points (give one above 0 each)")
    return float(weights[met].sum() / weights.sum())


def checked(values: ArrayLike, hours: ArrayLike) -> tuple[Floats, Floats]:
    """Values (steps, n) and hours (steps,), if they go together and are finite."""
    made, weights = np.asarray(values, dtype=np.float64), np.asarray(hours, dtype=np.float64)
    if made.ndim != 2 or weights.shape != made.shape[:1]:
        raise ClerestoryError(
            f"values {made.shape} do not go with hours {weights.shape} (give (steps, points) and (steps,))"
        )
    if not (np.isfinite(weights).all() and (weights >= 0.0).all()):
        raise ClerestoryError("hours that steps count for are numbers of at least 0 (see Hours.weights)")
    if not np.isfinite(made[weights > 0.0]).all():
        step = int(np.flatnonzero((weights > 0.0) & ~np.isfinite(made).all(axis=1))[0])
        raise ClerestoryError(f"a value of step {step} is not a number (a year with gaps has no metrics)")
    return made, weights
