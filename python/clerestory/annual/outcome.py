"""The year of a data set, collected from its parts: metrics over the hours that count, and over those of standards."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory.annual import lm83
from clerestory.annual.control.tables import Lm83
from clerestory.annual.metrics import THRESHOLDS, PointYear, joined
from clerestory.annual.year import EYE
from clerestory.weather import Hours

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from clerestory.annual.control.states import Operated
    from clerestory.annual.metrics import PointMetrics
    from clerestory.annual.study import Block, Study
    from clerestory.annual.year import Part

_THRESHOLDS = (50.0, 100.0, 300.0, 500.0, 750.0)


@dataclass(frozen=True)
class Outcome:
    """The year of one data set."""

    name: str
    """Of the data set."""
    metrics: dict[str, PointMetrics]
    """Of each name of sensors, over the hours that count."""
    daylight: dict[str, PointMetrics]
    """The same over the hours with the sun above the horizon, for EN 17037; none if the weather has none."""
    lm83: dict[str, PointMetrics]
    """The same over LM-83's hours, with its blinds if there are states; none if the weather has no such hours."""
    direct_hours: NDArray[np.float64]
    """(points) of LM-83's hours those with more than 1000 lx of direct sun, in the most open state [h]."""
    eyes: dict[str, dict[str, NDArray[np.float64]]]
    """Of each view: illuminance [lx] and indices (steps)."""
    operated: Operated | None = None
    """How the windows stood, if they have states."""


class Collected:
    """The year of a data set, as far as it is known."""

    def __init__(self, study: Study, name: str) -> None:
        steps = len(study.weather)
        self._study, self._name = study, name
        thresholds = sorted({study.recipe.threshold_lx, *_THRESHOLDS})
        self._counted = _Points(study.places, study.hours.weights(study.weather), thresholds)
        self._daylight = _Points(study.places, Hours.all_daylight().weights(study.weather), THRESHOLDS)
        self._working = Hours(*lm83.HOURS, clock=study.hours.clock).weights(study.weather)
        self._lm83 = _Points(study.places, self._working, [lm83.AUTONOMY])
        self._in_sun = np.zeros(len(study.points))
        self._eyes = {view: {key: np.full(steps, np.nan) for key in EYE} for view in study.views}

    def add(self, block: Block, part: Part) -> None:
        """Some steps of some points or eyes."""
        for points in (self._counted, self._daylight, self._lm83):
            points.add(block, part)
        self._in_sun[block.points] += self._working[part.steps] @ (part.direct > lm83.SUNLIT)
        for view, values in part.eyes.items():
            for key, series in values.items():
                self._eyes[view][key][part.steps] = series

    def outcome(self) -> Outcome:
        """All of it."""
        by_lm83 = self._lm83.result()
        stage = self._study.stages.get(self._name)
        if stage is not None and by_lm83:
            law = self._study.recipe.data_sets[self._name].control
            for key, place in self._study.places.items():
                points, normals = self._study.points[place], self._study.normals[place]
                blinds, self._in_sun[place] = stage.lm83_year(points, normals, self._working)
                if not isinstance(law, Lm83):
                    by_lm83[key] = blinds
        return Outcome(
            self._name,
            self._counted.result(),
            self._daylight.result(),
            by_lm83,
            self._in_sun,
            self._eyes,
            None if stage is None else self._study.operated[self._name],
        )


class _Points:
    """Metrics of named sensors over some hours."""

    def __init__(self, places: dict[str, slice], weights: NDArray[np.float64], thresholds: Sequence[float]) -> None:
        self._places, self._weights, self._thresholds = places, weights, thresholds
        self._metrics: dict[str, dict[int, PointYear]] = {key: {} for key in places}

    def add(self, block: Block, part: Part) -> None:
        """Some steps of some points."""
        first = block.points.start
        for key, place in self._places.items():
            start, stop = max(place.start, first), min(place.stop, block.points.stop)
            if start >= stop:
                continue
            if start not in self._metrics[key]:
                self._metrics[key][start] = PointYear(stop - start, thresholds=self._thresholds)
            values = part.illuminance[:, start - first : stop - first]
            self._metrics[key][start].add(values, self._weights[part.steps])

    def result(self) -> dict[str, PointMetrics]:
        """By name; none if no hour counts."""
        if not self._weights.any():
            return {}
        return {key: joined([points.result() for points in found.values()]) for key, found in self._metrics.items()}
