"""A study of a year: a room, its weather, and the data sets that stand in its windows one after another."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from clerestory.annual.arrivals import Arrivals
from clerestory.annual.cache import Cache
from clerestory.annual.matrices import RoomMatrices
from clerestory.annual.metrics import PointYear, joined
from clerestory.annual.year import EYE, RoomYear, Sampling
from clerestory.room.recipe import System
from clerestory.room.world import load as load_room
from clerestory.room.world import system_of
from clerestory.trace.keys import Keys, Positive, RecipeError, wrong
from clerestory.trace.recipe import read_toml
from clerestory.weather import Hours, SkyYear, read_weather, synthetic_year
from clerestory.weather.calendar import COMMON_YEAR

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Iterator

    from numpy.typing import NDArray

    from clerestory.annual.metrics import PointMetrics
    from clerestory.annual.year import Part
    from clerestory.bsdf import Bsdf
    from clerestory.room import Room
    from clerestory.weather import Weather


class WorkingHours(Keys):
    """Hours that count."""

    start: Annotated[float, Field(ge=0.0, lt=24.0)] = 8.0
    """Hour of the day at which they begin."""
    end: Annotated[float, Field(gt=0.0, le=24.0)] = 18.0
    """Hour of the day at which they end."""
    weekdays: bool = False
    """Without Saturdays and Sundays."""
    daylight: bool = False
    """Only with the sun above the horizon."""
    clock: str | None = None
    """IANA name of the clock that people live by; standard time by default."""


class Recipe(Keys):
    """A study as a table."""

    name: str = ""
    """What it is called."""
    room: str
    """A room recipe, or the name of one that comes with Clerestory."""
    weather: str | None = None
    """A weather file; without one a year is made up for the room's place, and says so."""
    method: Literal["2-phase", "3-phase", "5-phase"] = "5-phase"
    """Whether the direct sun has the resolution of the data set."""
    patches: str = "reinhart:4"
    """Of the sky."""
    sensors: list[str] = Field(default_factory=list)
    """Names of the room's sensors; all of them by default."""
    views: list[str] | None = None
    """Names of the room's views at which glare is found; all by default, for the five-phase method."""
    hours: WorkingHours = Field(default_factory=WorkingHours)
    """Hours that count."""
    threshold_lx: Positive = 500.0
    """Illuminance of daylight autonomy [lx]."""
    paths: Annotated[int, Field(ge=16, multiple_of=16)] = 8192
    """Paths of a sensor or view."""
    seed: Annotated[int, Field(ge=0)] = 1
    """Of the random numbers."""
    memory_gb: Annotated[float, Field(ge=0.25)] = 2.0
    """Memory that may be used [GiB]."""
    data_sets: dict[str, System] = Field(default_factory=dict)
    """What stands in all windows, by name; what the room has by default."""

    @model_validator(mode="after")
    def _sound(self) -> Recipe:
        if self.views and self.method != "5-phase":
            raise wrong("views", "glare needs the sun at a data set's resolution (give the method 5-phase)")
        return self


@dataclass(frozen=True)
class Block:
    """Points, or eyes, that are found together."""

    points: slice
    """Which points of the study."""
    views: tuple[str, ...] = ()
    """Names of views."""


@dataclass(frozen=True)
class Outcome:
    """The year of one data set."""

    name: str
    """Of the data set."""
    metrics: dict[str, PointMetrics]
    """Of each name of sensors, over the hours that count."""
    direct_hours: NDArray[np.float64]
    """(points) hours with more than 1000 lx of direct sun [h]."""
    eyes: dict[str, dict[str, NDArray[np.float64]]]
    """Of each view: illuminance [lx] and indices (steps)."""


class Study:
    """A study, read and checked: made by `load`."""

    def __init__(self, recipe: Recipe, folder: Path, cache: Cache | None = None) -> None:
        self.recipe = recipe
        self.cache = cache or Cache()
        given = Path(recipe.room)
        within = folder / given
        self.room: Room = load_room(within if given.suffix or within.exists() else recipe.room)
        """The room."""
        self.weather: Weather = self._weather(folder)
        """The weather of its year."""
        self.hours = Hours(**recipe.hours.model_dump())
        """Hours that count."""
        self.data_sets = self._data_sets(folder)
        """Data sets of every group of windows, by name."""
        known = self.room.recipe
        self.sensors = recipe.sensors or list(known.sensors)
        """Names of sensors, in the order of the points."""
        views = [] if recipe.method != "5-phase" else list(known.views)
        self.views = views if recipe.views is None else recipe.views
        """Names of views."""
        for name in self.views:
            self.room.view(name)
        grids = [self.room.sensors(name) for name in self.sensors]
        ends = np.cumsum([0, *(len(points) for points, _ in grids)]).tolist()
        self.places = {name: slice(ends[k], ends[k + 1]) for k, name in enumerate(self.sensors)}
        """Which of the points are those of each name of sensors."""
        self.points = np.concatenate([g[0] for g in grids]) if grids else np.zeros((0, 3))
        """(n, 3) [m]."""
        self.normals = np.concatenate([g[1] for g in grids]) if grids else np.zeros((0, 3))
        """(n, 3)."""
        if not len(self.points) and not self.views:
            raise RecipeError("sensors: the room has neither sensors nor views (add some to its recipe)")

    def run(self, progress: Callable[[float], object] | None = None) -> list[Outcome]:
        """The year of every data set; what was found before is taken from the cache.

        Parameters
        ----------
        progress
            Called with the share of the year that is done.
        """
        weights = self.hours.weights(self.weather)
        collected = {name: _Collected(self, name) for name in self.data_sets}
        for block, name, part in self.parts(progress):
            collected[name].add(block, part, weights[part.steps])
        return [each.outcome() for each in collected.values()]

    def parts(self, progress: Callable[[float], object] | None = None) -> Iterator[tuple[Block, str, Part]]:
        """The years of the data sets, some points or eyes and some steps at a time."""
        names = list(self.data_sets)
        size = max(1, int(self._memory / 4.0 / (_PREPARED * len(self.matrices) ** 2)))
        batches = [names[first : first + size] for first in range(0, len(names), size)]
        done, count = 0, len(self.blocks) * len(batches)
        for block in self.blocks:
            year = self.year(block)
            for batch in batches:

                def tell(share: float, done: int = done) -> None:
                    if progress is not None:
                        progress((done + share) / count)

                for name, part in year.of({name: self.data_sets[name] for name in batch}, tell):
                    yield block, name, part
                done += 1

    @cached_property
    def blocks(self) -> list[Block]:
        """Points and eyes that are found together, so that the memory suffices."""
        groups = len(self.matrices)
        cells = 0 if self.recipe.method == "3-phase" else Sampling().cells ** 2
        size = max(1, int(self._memory / 4.0 / (groups * (_SEEN * cells + _RECEIVED * len(self.matrices.basis)))))
        count = len(self.points)
        made = [Block(slice(first, min(first + size, count))) for first in range(0, count, size)]
        nowhere = slice(0, 0)
        return made + [
            Block(nowhere, tuple(self.views[first : first + _EYES])) for first in range(0, len(self.views), _EYES)
        ]

    def year(self, block: Block) -> RoomYear:
        """The year of some points or eyes."""
        return RoomYear(
            self._arrivals,
            self.points[block.points],
            self.normals[block.points],
            {name: (self.room.view(name).point_m, self.room.view(name).direction) for name in block.views},
            method=self.recipe.method,
            sampling=Sampling(view=self.recipe.paths),
        )

    @cached_property
    def matrices(self) -> RoomMatrices:
        """Of its room."""
        return RoomMatrices(self.room, cache=self.cache, seed=self.recipe.seed)

    def sky(self, patches: str) -> SkyYear:
        """The skies of its weather in patches."""
        given = self.room.recipe.sky
        ground, north = given.ground_reflectance, given.north_deg
        return SkyYear(self.weather, patches, ground_reflectance=ground, north_deg=north)

    @cached_property
    def _arrivals(self) -> Arrivals:
        return Arrivals(self.matrices, self.sky(self.recipe.patches), keep=int(self._memory / 8.0))

    @property
    def _memory(self) -> float:
        """That may be used [B]."""
        return self.recipe.memory_gb * 2.0**30

    def _weather(self, folder: Path) -> Weather:
        if self.recipe.weather is not None:
            return read_weather(folder / self.recipe.weather)
        place = self.room.recipe.place
        if place is None:
            raise RecipeError("weather: there is no file, and the room has no place to make one up for (give a file)")
        from clerestory.sky import Place

        at = Place(place.latitude, place.longitude, place.timezone)
        return synthetic_year(Place(at.latitude, at.longitude, at.standard_hours(COMMON_YEAR)))

    def _data_sets(self, folder: Path) -> dict[str, list[Bsdf]]:
        groups = RoomMatrices.systems_of(self.room)
        if not self.recipe.data_sets:
            return {"as in the room": [self.room.system(name) for name in groups]}
        made = {name: system_of(s, f"data_sets.{name}", folder)[0] for name, s in self.recipe.data_sets.items()}
        return {name: [bsdf] * len(groups) for name, bsdf in made.items()}


_THRESHOLDS = (50.0, 100.0, 300.0, 500.0, 750.0)
_SUNLIT = 1000.0
_EYES = 16
"""Eyes that are found together."""
_SEEN = 64.0
"""Memory of a cell that a point sees [B]."""
_RECEIVED = 64.0
"""Memory of a patch in the view matrix of a point, while it is found [B]."""
_PREPARED = 1.6e7
"""Memory of a data set that is prepared for eyes, by the square of the number of groups [B]."""


class _Collected:
    """The year of a data set, as far as it is known."""

    def __init__(self, study: Study, name: str) -> None:
        steps = len(study.weather)
        self._name = name
        self._places = study.places
        self._thresholds = sorted({study.recipe.threshold_lx, *_THRESHOLDS})
        self._metrics: dict[str, dict[int, PointYear]] = {key: {} for key in study.places}
        self._in_sun = np.zeros(len(study.points))
        self._eyes = {view: {key: np.full(steps, np.nan) for key in EYE} for view in study.views}

    def add(self, block: Block, part: Part, weights: NDArray[np.float64]) -> None:
        """Some steps, with the hours that each counts for."""
        first = block.points.start
        for key, place in self._places.items():
            start, stop = max(place.start, first), min(place.stop, block.points.stop)
            if start >= stop:
                continue
            if start not in self._metrics[key]:
                self._metrics[key][start] = PointYear(stop - start, thresholds=self._thresholds)
            self._metrics[key][start].add(part.illuminance[:, start - first : stop - first], weights)
        self._in_sun[block.points] += weights @ (part.direct > _SUNLIT)
        for view, values in part.eyes.items():
            for key, series in values.items():
                self._eyes[view][key][part.steps] = series

    def outcome(self) -> Outcome:
        """All of it."""
        metrics = {key: joined([points.result() for points in found.values()]) for key, found in self._metrics.items()}
        return Outcome(self._name, metrics, self._in_sun, self._eyes)


def load(source: str | os.PathLike[str], *, cache: str | os.PathLike[str] | None = None) -> Study:
    """A study from its TOML file.

    Parameters
    ----------
    source
        The file.
    cache
        Folder of matrices; see `clerestory.annual.cache.default_folder`.

    Raises
    ------
    RecipeError
        The text names file, key, what is wrong and the remedy.
    OSError
        A file cannot be read.
    """
    path = Path(source)
    try:
        return Study(Recipe.of(read_toml(path)), path.parent, Cache(cache))
    except RecipeError as error:
        raise RecipeError(f"{path}: {error}") from error
