"""A study of a year: a room, its weather, and the data sets that stand in its windows one after another."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from clerestory.annual.cache import Cache
from clerestory.annual.matrices import RoomMatrices
from clerestory.annual.metrics import PointYear
from clerestory.annual.pictures import YearPictures
from clerestory.annual.year import INDICES, RoomYear, Sampling
from clerestory.picture import View
from clerestory.room.recipe import System
from clerestory.room.world import load as load_room
from clerestory.room.world import system_of
from clerestory.trace.keys import Keys, Positive, RecipeError, wrong
from clerestory.trace.recipe import read_toml
from clerestory.weather import Hours, SkyYear, read_weather, synthetic_year

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Iterator, Sequence

    from numpy.typing import NDArray

    from clerestory.annual.metrics import PointMetrics
    from clerestory.annual.year import Part
    from clerestory.bsdf import Bsdf
    from clerestory.picture import Picture
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
    method: Literal["3-phase", "5-phase"] = "5-phase"
    """Whether the direct sun has the resolution of the data set."""
    glare: Literal["imageless", "pictures"] = "imageless"
    """Whether glare is found in what eyes see of windows and surfaces, or in pictures of every step."""
    picture_px: Annotated[int, Field(ge=100, le=2000)] = 380
    """Width and height of pictures; of 380 a pixel is as large as the sun."""
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
    data_sets: dict[str, System] = Field(default_factory=dict)
    """What stands in all windows, by name; what the room has by default."""

    @model_validator(mode="after")
    def _sound(self) -> Recipe:
        if self.views and self.method == "3-phase":
            raise wrong("views", "glare needs the sun at a data set's resolution (give the method 5-phase)")
        return self


@dataclass(frozen=True)
class Outcome:
    """The year of one data set."""

    name: str
    """Of the data set."""
    illuminance: NDArray[np.float32]
    """(steps, points) [lx]."""
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
        views = [] if recipe.method == "3-phase" else list(known.views)
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
        """The year of every data set; matrices are taken from the cache where they are there.

        Parameters
        ----------
        progress
            Called with the share of the year that is done.
        """
        recipe = self.recipe
        eyes = {name: (self.room.view(name).point_m, self.room.view(name).direction) for name in self.views}
        year = RoomYear(
            RoomMatrices(self.room, cache=self.cache, seed=recipe.seed),
            self._sky(),
            self.points,
            self.normals,
            eyes,
            method=recipe.method,
            picture_px=recipe.picture_px if recipe.glare == "pictures" else None,
            sampling=Sampling(view=recipe.paths),
        )
        weights = self.hours.weights(self.weather)
        outcomes = {name: _Collected(self, name) for name in self.data_sets}
        for name, part in year.of(self.data_sets, progress):
            outcomes[name].add(part, weights[part.steps])
        return [collected.outcome() for collected in outcomes.values()]

    def pictures(self, steps: Sequence[int]) -> Iterator[tuple[str, str, int, Picture]]:
        """Pictures of some steps: of which data set, view and step each is, and the fisheye of 180° itself."""
        matrices = RoomMatrices(self.room, cache=self.cache, seed=self.recipe.seed)
        sky, size = self._sky(), (self.recipe.picture_px, self.recipe.picture_px)
        for view in self.views:
            eye = View.fisheye(self.room.view(view).point_m, self.room.view(view).direction)
            year = YearPictures(matrices, sky, eye, size)
            for name, systems in self.data_sets.items():
                for step, picture in year.of(systems).at(steps):
                    yield name, view, step, picture

    def _sky(self) -> SkyYear:
        sky = self.room.recipe.sky
        return SkyYear(
            self.weather,
            self.recipe.patches,
            ground_reflectance=sky.ground_reflectance,
            north_deg=sky.north_deg,
        )

    def _weather(self, folder: Path) -> Weather:
        if self.recipe.weather is not None:
            return read_weather(folder / self.recipe.weather)
        place = self.room.recipe.place
        if place is None:
            raise RecipeError("weather: there is no file, and the room has no place to make one up for (give a file)")
        from clerestory.sky import Place

        return synthetic_year(Place(place.latitude, place.longitude, place.timezone))

    def _data_sets(self, folder: Path) -> dict[str, list[Bsdf]]:
        groups = RoomMatrices.systems_of(self.room)
        if not self.recipe.data_sets:
            return {"as in the room": [self.room.system(name) for name in groups]}
        made = {name: system_of(s, f"data_sets.{name}", folder)[0] for name, s in self.recipe.data_sets.items()}
        return {name: [bsdf] * len(groups) for name, bsdf in made.items()}


_THRESHOLDS = (50.0, 100.0, 300.0, 500.0, 750.0)
_SUNLIT = 1000.0
_EYE = ("illuminance", *INDICES)


class _Collected:
    """The year of a data set, as far as it is known."""

    def __init__(self, study: Study, name: str) -> None:
        steps, count = len(study.weather), len(study.points)
        thresholds = sorted({study.recipe.threshold_lx, *_THRESHOLDS})
        self._name = name
        self._places = study.places
        self._metrics = {key: PointYear(p.stop - p.start, thresholds=thresholds) for key, p in study.places.items()}
        self._illuminance = np.zeros((steps, count), dtype=np.float32)
        self._in_sun = np.zeros(count)
        self._eyes = {view: {key: np.full(steps, np.nan) for key in _EYE} for view in study.views}

    def add(self, part: Part, weights: NDArray[np.float64]) -> None:
        """Some steps, with the hours that each counts for."""
        self._illuminance[part.steps] = part.illuminance
        for key, place in self._places.items():
            self._metrics[key].add(part.illuminance[:, place], weights)
        self._in_sun += weights @ (part.direct > _SUNLIT)
        for view, values in part.eyes.items():
            for key, series in values.items():
                self._eyes[view][key][part.steps] = series

    def outcome(self) -> Outcome:
        """All of it."""
        metrics = {key: points.result() for key, points in self._metrics.items()}
        return Outcome(self._name, self._illuminance, metrics, self._in_sun, self._eyes)


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
