"""A study of a year: a room, its weather, and the data sets that stand in its windows one after another."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import MissingDataError
from clerestory.annual.arrivals import Arrivals
from clerestory.annual.cache import Cache
from clerestory.annual.control.family import expanded
from clerestory.annual.control.stage import Stage
from clerestory.annual.control.states import Operated
from clerestory.annual.control.tables import Schedule
from clerestory.annual.facade import Facade
from clerestory.annual.matrices import RoomMatrices
from clerestory.annual.outcome import Collected
from clerestory.annual.pictures import YearPictures
from clerestory.annual.recipe import Recipe
from clerestory.annual.traced import kept
from clerestory.annual.year import RoomYear, Sampling
from clerestory.picture import View
from clerestory.room.systems import system_of
from clerestory.room.world import load_beside
from clerestory.trace.keys import RecipeError
from clerestory.trace.reading import reading
from clerestory.trace.recipe import read_toml
from clerestory.weather import Hours, SkyYear, read_weather, synthetic_year

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Iterator, Sequence

    from numpy.typing import NDArray

    from clerestory.annual.outcome import Outcome
    from clerestory.annual.year import Part
    from clerestory.bsdf import Bsdf
    from clerestory.picture import Picture
    from clerestory.room import Room
    from clerestory.room.recipe import System
    from clerestory.weather import Weather


@dataclass(frozen=True)
class Block:
    """Points, or eyes, that are found together."""

    points: slice
    """Which points of the study."""
    views: tuple[str, ...] = ()
    """Names of views."""


@dataclass(frozen=True)
class Choice:
    """What stands in the windows at some steps."""

    data_set: str
    """Name of the data set."""
    systems: list[Bsdf]
    """Of every group of windows."""
    when: NDArray[np.bool_] | None = None
    """The steps (n); None for all."""


class Study:
    """A study, read and checked: made by `load`."""

    def __init__(
        self,
        recipe: Recipe,
        folder: Path,
        cache: Cache | None = None,
        *,
        tell: Callable[[str], object] | None = None,
    ) -> None:
        self.recipe = recipe
        self.cache = cache or Cache()
        self._traced = kept(self.cache, tell)
        self.room: Room = load_beside(recipe.room, folder, "room", traced=self._traced)
        """The room."""
        self.weather: Weather = self._weather(folder)
        """The weather of its year."""
        self.hours = Hours(**recipe.hours.model_dump())
        """Hours that count."""
        if not self.hours.mask(self.weather).any():
            raise RecipeError(f"hours: no step of the weather lies in {self.hours.words} (choose others)")
        self.groups = RoomMatrices.names_of(self.room)
        """Names of the groups of windows."""
        self.data_sets = self._data_sets(folder)
        """Data sets of every group of windows, by name, that stay as they are."""
        self.stages = self._stages(folder)
        """Of data sets with states, by name."""
        known = self.room.recipe
        self.sensors = recipe.sensors or list(known.sensors)
        """Names of sensors, in the order of the points."""
        views = [] if recipe.method in ("2-phase", "3-phase") else list(known.views)
        self.views = views if recipe.views is None else recipe.views
        """Names of views."""
        with reading("views"):
            for name in self.views:
                self.room.view(name)
        with reading("sensors"):
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
        collected = {name: Collected(self, name) for name in self.names}
        for block, name, part in self.parts(progress):
            collected[name].add(block, part)
        return [each.outcome() for each in collected.values()]

    @cached_property
    def warnings(self) -> list[str]:
        """What is doubtful about the weather, the room, and the places of sensors and eyes."""
        odd = [finding for finding in self.weather.findings if finding.severity != "note"]
        return [
            *(f"weather: {str(finding).removeprefix('warning: ')}" for finding in odd),
            *self.room.warnings,
            *(text for name in self.sensors for text in self.room.doubts(sensors=name)),
            *(text for name in self.views for text in self.room.doubts(view=name)),
        ]

    @property
    def names(self) -> list[str]:
        """Names of the data sets, in the order of the recipe."""
        return list(self.recipe.data_sets) or list(self.data_sets)

    @cached_property
    def operated(self) -> dict[str, Operated]:
        """How the windows stand over the year, by the name of the data set that has states.

        Raises
        ------
        RecipeError
            A law does not say a state at every step.
        """
        return {name: self._operated(name) for name in self.stages}

    def _operated(self, name: str) -> Operated:
        law, stage = self.recipe.data_sets[name].control, self.stages[name]
        assert law is not None
        place = f"data_sets.{name}.control"
        if isinstance(law, Schedule):
            states = law.chosen(stage, place)
        else:
            # All who work on a study find the same: the last digits of light can depend on the machine.
            key = {**stage.key, "law": law.model_dump()}
            states = self.cache.get("states", key, lambda: {"states": law.chosen(stage, place)})["states"]
        return Operated(tuple(stage.states), tuple(stage.groups), states)

    @cached_property
    def choices(self) -> dict[str, Choice]:
        """What stands in the windows and when, by a name of its own: each data set, or each combination of states."""
        made = {}
        for name in self.names:
            if name in self.data_sets:
                made[name] = Choice(name, self.data_sets[name])
                continue
            bsdfs = self.stages[name].data_sets
            for numbers, when in self.operated[name].combinations():
                made[f"{name} {numbers}"] = Choice(name, [bsdfs[k] for k in numbers], when)
        return made

    def parts(self, progress: Callable[[float], object] | None = None) -> Iterator[tuple[Block, str, Part]]:
        """The years of the data sets, some points or eyes and some steps at a time."""
        names = list(self.choices)
        size = max(1, int(self._memory / 4.0 / (_PREPARED * len(self.matrices) ** 2)))
        batches = [names[first : first + size] for first in range(0, len(names), size)]
        done, count = 0, len(self.blocks) * len(batches)
        for block in self.blocks:
            year = self.year(block)
            for batch in batches:

                def tell(share: float, done: int = done) -> None:
                    if progress is not None:
                        progress((done + share) / count)

                chosen = {name: self.choices[name] for name in batch}
                systems = {name: choice.systems for name, choice in chosen.items()}
                when = {name: choice.when for name, choice in chosen.items() if choice.when is not None}
                for name, part in year.of(systems, tell, when=when):
                    yield block, chosen[name].data_set, part
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

    def pictures(self, steps: Sequence[int]) -> Iterator[tuple[str, str, int, Picture]]:
        """Pictures of some steps: of which data set, view and step each is, and the fisheye of 180° itself."""
        size = (self.recipe.picture_px, self.recipe.picture_px)
        for view in self.views:
            eye = View.fisheye(self.room.view(view).point_m, self.room.view(view).direction)
            year = YearPictures(self._arrivals, eye, size)
            for choice in self.choices.values():
                asked = [step for step in steps if choice.when is None or choice.when[step]]
                for step, picture in year.of(choice.systems).at(asked) if asked else ():
                    yield choice.data_set, view, step, picture

    def year(self, block: Block) -> RoomYear:
        """The year of some points or eyes."""
        return RoomYear(
            self._arrivals,
            self.points[block.points],
            self.normals[block.points],
            {name: (self.room.view(name).point_m, self.room.view(name).direction) for name in block.views},
            # The sixth phase is in what arrives.
            method="5-phase" if self.recipe.method == "6-phase" else self.recipe.method,
            picture_px=self.recipe.picture_px if self.recipe.glare == "pictures" else None,
            sampling=Sampling(view=self.recipe.paths),
        )

    @cached_property
    def matrices(self) -> RoomMatrices:
        """Of its room."""
        return RoomMatrices(self.room, self.recipe.basis, cache=self.cache, seed=self.recipe.seed)

    @cached_property
    def facade(self) -> Facade | None:
        """What stands before its windows, for the six-phase method."""
        return Facade(self.matrices) if self.recipe.method == "6-phase" else None

    def sky(self, patches: str) -> SkyYear:
        """The skies of its weather in patches."""
        given = self.room.recipe.sky
        ground, north = given.ground_reflectance, given.north_deg
        return SkyYear(self.weather, patches, ground_reflectance=ground, north_deg=north)

    @cached_property
    def _arrivals(self) -> Arrivals:
        sky, keep = self.sky(self.recipe.patches), int(self._memory / 8.0)
        return Arrivals(self.matrices, sky, facade=self.facade, keep=keep)

    @property
    def _memory(self) -> float:
        """That may be used [B]."""
        return self.recipe.memory_gb * 2.0**30

    def _weather(self, folder: Path) -> Weather:
        if self.recipe.weather is not None:
            with reading("weather"):
                return read_weather(folder / self.recipe.weather)
        place = self.room.recipe.place
        if place is None:
            raise RecipeError("weather: there is no file, and the room has no place to make one up for (give a file)")
        from clerestory.sky import Place

        there = Place(place.latitude, place.longitude, place.timezone)
        return synthetic_year(replace(there, timezone=there.standard_hours(_TYPICAL)))

    def _data_sets(self, folder: Path) -> dict[str, list[Bsdf]]:
        groups = RoomMatrices.systems_of(self.room)
        if not self.recipe.data_sets:
            return {"as in the room": [self.room.system(name) for name in groups]}
        lasting = {name: s for name, s in self.recipe.data_sets.items() if not s.states}
        made = {name: self._system(s, f"data_sets.{name}", folder) for name, s in lasting.items()}
        return {name: [bsdf] * len(groups) for name, bsdf in made.items()}

    def _system(self, given: System, key: str, folder: Path) -> Bsdf:
        try:
            return system_of(given, key, folder, self._traced).seen
        except MissingDataError as error:
            raise RecipeError(f"{key}.band: {error}") from None

    def _stages(self, folder: Path) -> dict[str, Stage]:
        made = {}
        for name, given in self.recipe.data_sets.items():
            if given.control is None:
                continue
            key = f"data_sets.{name}"
            bsdfs = {s: self._system(state, f"{key}.states.{s}", folder) for s, state in given.states.items()}
            tilts = [state.tilt_deg for state in given.states.values()]
            made[name] = Stage(
                self.room,
                self.weather,
                bsdfs,
                tilts,
                self.groups,
                self.hours,
                folder,
                lambda: self._arrivals,
                Sampling(view=self.recipe.paths),
            )
            given.control.check(made[name], f"{key}.control")
        return made


_TYPICAL = 2001
"""Year whose clock counts where the weather is made up."""
_EYES = 16
"""Eyes that are found together."""
_SEEN = 64.0
"""Memory of a cell that a point sees [B]."""
_RECEIVED = 64.0
"""Memory of a patch in the view matrix of a point, while it is found [B]."""
_PREPARED = 1.6e7
"""Memory of a data set that is prepared for eyes, by the square of the number of groups [B]."""


def load(
    source: str | os.PathLike[str],
    *,
    cache: str | os.PathLike[str] | None = None,
    tell: Callable[[str], object] | None = None,
) -> Study:
    """A study from its TOML file.

    Parameters
    ----------
    source
        The file.
    cache
        Folder of matrices; see `clerestory.annual.cache.default_folder`.
    tell
        Called with words before a sample is traced, which takes time.

    Raises
    ------
    RecipeError
        The text names file, key, what is wrong and the remedy.
    OSError
        A file cannot be read.
    """
    path = Path(source)
    try:
        kept_in = Cache(cache)
        tables = expanded(read_toml(path), path.parent, kept_in, tell)
        return Study(Recipe.of(tables), path.parent, kept_in, tell=tell)
    except RecipeError as error:
        raise RecipeError(f"{path}: {error}") from error
