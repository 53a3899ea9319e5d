"""What a law can ask of a room whose windows have states."""

from __future__ import annotations

from dataclasses import asdict
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from clerestory.annual import lm83
from clerestory.annual.cache import digest
from clerestory.annual.control.outdoors import outdoors
from clerestory.annual.control.preview import Preview
from clerestory.annual.glare import SOLAR_SOLID_ANGLE
from clerestory.annual.metrics import PointYear
from clerestory.npz import mark
from clerestory.picture import View

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from clerestory.annual.arrivals import Arrivals, Light
    from clerestory.annual.control.outdoors import Outdoors
    from clerestory.annual.metrics import PointMetrics
    from clerestory.annual.year import Sampling
    from clerestory.bsdf import Bsdf
    from clerestory.room import Room
    from clerestory.weather import Hours, Weather

    Doubles = NDArray[np.float64]
    States = NDArray[np.int64]

READINGS: dict[str, Callable[..., Doubles]] = {"mean": np.mean, "least": np.min, "highest": np.max}
"""What can be said of the illuminances of sensors."""
AT_EYE = "at_eye"
"""Name of the illuminance at the eye of a view."""


class Stage:
    """A room whose windows have states.

    Parameters
    ----------
    room, weather
        The room, and the weather of its year.
    states
        Data sets of the windows by the name of their state, the most open one first.
    tilts_deg
        Angle of the slats in each state [°], where it has one.
    groups
        Names of the groups of windows.
    hours
        Whose clock the people live by.
    folder
        That files are relative to.
    arrivals
        Gives what arrives at the windows.
    sampling
        Paths of points, and steps that are in memory at a time.
    """

    def __init__(
        self,
        room: Room,
        weather: Weather,
        states: Mapping[str, Bsdf],
        tilts_deg: Sequence[float | None],
        groups: Sequence[str],
        hours: Hours,
        folder: Path,
        arrivals: Callable[[], Arrivals],
        sampling: Sampling,
    ) -> None:
        self.room, self.weather, self.folder = room, weather, folder
        self.states = list(states)
        """Names of the states."""
        self.tilts_deg = list(tilts_deg)
        self.groups = list(groups)
        self.times = hours.clock_times(weather)
        """Middle of each step on the clock that people live by (steps,)."""
        self.data_sets = list(states.values())
        """Data sets of the states."""
        self._arrivals = arrivals
        self._sampling = sampling

    @property
    def key(self) -> dict[str, object]:
        """All that laws can depend on, but for files."""
        arrivals, recipe = self._arrivals(), self.room.recipe
        sensors = [self.room.sensors(name) for name in recipe.sensors]
        return {
            **arrivals.matrices.key,
            **arrivals.key,
            "states": [[name, mark(bsdf)] for name, bsdf in zip(self.states, self.data_sets, strict=True)],
            "tilts": self.tilts_deg,
            "sensors": [list(recipe.sensors), digest(*(array for pair in sensors for array in pair))],
            "views": {name: view.model_dump() for name, view in recipe.views.items()},
            "times": digest(self.times.astype(np.int64)),
            "sampling": asdict(self._sampling),
        }

    @cached_property
    def outdoors(self) -> Outdoors:
        """What is known outdoors."""
        arrivals = self._arrivals()
        return outdoors(arrivals.matrices, arrivals.sky, self.times)

    def readings(self, sensors: Sequence[str]) -> dict[tuple[str, str], Doubles]:
        """Illuminance at sensors of the room (states, steps) [lx], all windows in one state, by reading and name."""
        found: dict[tuple[str, str], Doubles] = {}
        for name in sensors:
            preview = self._preview(*self.room.sensors(name))
            series = {key: np.zeros((len(self.states), len(self.weather))) for key in READINGS}
            for steps, light in self._light(len(preview.points)):
                values = preview.illuminance(light).sum(axis=0)
                for key, reading in READINGS.items():
                    series[key][:, steps] = reading(values, axis=1)
            found |= {(key, name): values for key, values in series.items()}
        return found

    def at_eyes(self, views: Sequence[str]) -> tuple[Doubles, Doubles]:
        """Illuminance at the eyes of views [lx], and L² ω / P² of the sun's disc that they see [cd² sr/m⁴].

        Both come through each group in each state (views, groups, states, steps).
        """
        given = [self.room.view(name) for name in views]
        eyes = [View.fisheye(view.point_m, view.direction) for view in given]
        towards = np.array([view.direction for view in given], dtype=np.float64)
        preview = self._preview(np.array([view.point_m for view in given], dtype=np.float64), towards)
        shape = (len(views), len(self.groups), len(self.states), len(self.weather))
        at_eye, disc = np.zeros(shape), np.zeros(shape)
        for steps, light in self._light(len(views)):
            at_eye[..., steps] = np.moveaxis(preview.illuminance(light), 2, 0)
            disc[..., steps] = np.moveaxis(preview.discs(light, eyes, SOLAR_SOLID_ANGLE), 2, 0)
        return at_eye, disc

    def by_lm83(self, points: Doubles, normals: Doubles) -> States:
        """States (groups, steps) of LM-83's blinds, by the direct sun at points (n, 3) [m] with normals (n, 3)."""
        preview = self._preview(points, normals)
        found = np.zeros((len(self.groups), len(self.weather)), dtype=np.int64)
        for steps, light in self._light(len(points)):
            found[:, steps] = _lm83_states(preview.direct(light))
        return found

    def lm83_year(self, points: Doubles, normals: Doubles, hours: NDArray[np.float64]) -> tuple[PointMetrics, Doubles]:
        """Metrics of points (n, 3) [m] with normals (n, 3) under LM-83's blinds, and hours (n) in the sun without.

        Both by three phases.

        Parameters
        ----------
        points, normals
            The room's grid.
        hours
            That each step counts for (steps,) [h].
        """
        preview = self._preview(points, normals)
        metrics, in_sun = PointYear(len(points), thresholds=[lm83.AUTONOMY]), lm83.SunYear(len(points))
        dark = np.where(self._arrivals().sky.is_lit, 0.0, hours).sum()
        metrics.add(np.zeros((1, len(points))), [dark])
        for steps, light in self._light(len(points)):
            every, direct = preview.illuminance(light), preview.direct(light)
            chosen = _lm83_states(direct)[:, None, None, :]
            lit = np.take_along_axis(every, chosen, axis=1).sum(axis=(0, 1))
            metrics.add(lit.T, hours[steps])
            in_sun.add(direct[:, 0].sum(axis=0).T, hours[steps])
        return metrics.result(), in_sun.result()

    def _preview(self, points: Doubles, normals: Doubles) -> Preview:
        facing = normals / np.linalg.norm(normals, axis=1, keepdims=True)
        return Preview(
            self._arrivals().matrices,
            self.data_sets,
            points,
            facing,
            samples=self._sampling.view,
            returned=self._sampling.returned,
        )

    def _light(self, points: int) -> Iterator[tuple[NDArray[np.int64], Light]]:
        """The steps that have light, so many at a time that what so many points see in all states is small."""
        arrivals = self._arrivals()
        is_lit = arrivals.sky.is_lit
        # It does not depend on the memory that a study may use: results have the same last digits with any.
        columns = max(1, int(_TILE / (_ARRAYS * 8.0 * len(self.groups) * len(self.states) * points)))
        for part in arrivals.chunks(self._sampling.chunk):
            steps = part.start + np.flatnonzero(is_lit[part])
            for first in range(0, len(steps), columns):
                some = slice(first, first + columns)
                yield steps[some], arrivals.at(part).part(some)


_TILE = float(1 << 26)
"""Memory of what is seen at some steps [B]."""
_ARRAYS = 5
"""Arrays of groups, states, points and steps that are there at once."""


def _lm83_states(direct: Doubles) -> States:
    """Of direct illuminances (groups, states, points, steps), (groups, steps)."""
    return np.stack([lm83.blind_states(np.moveaxis(group, 2, 0)) for group in direct])
