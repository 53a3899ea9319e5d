"""The year of a room with every case in its windows: daylight autonomy, vertical illuminance, DGP and DGI.

As section 3.6 of the report of IEA SHC Task 61 (2021, C.2.2), but every treatment with the direct sun at the data set's
own resolution (five phases).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from clerestory.annual.cache import digest
from clerestory.annual.matrices import RoomMatrices
from clerestory.annual.year import RoomYear, Sampling
from clerestory.roundrobin.moments import room_of
from clerestory.roundrobin.pieces import Piece
from clerestory.sky import Place
from clerestory.trace.keys import RecipeError
from clerestory.weather import Hours, SkyYear, read_weather, synthetic_year

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from clerestory.annual.cache import Arrays, Cache
    from clerestory.room import Room
    from clerestory.roundrobin import recipe as keys
    from clerestory.roundrobin.pieces import Tell
    from clerestory.roundrobin.study import Case, System
    from clerestory.weather import Weather

    Floats = NDArray[np.float32]

STEP_CPU_S = {"klems": 3.0e-3, "klems-peaks": 8.0e-3, "high": 3.2e-3, "high-peaks": 7.2e-3}
"""Measured with 48 points: of a step of the weather [s]."""
_EYE = "eye"
_PATCHES = "reinhart:4"


@dataclass(frozen=True)
class CaseYear:
    """The year of a case."""

    illuminance: Floats
    """(steps, points) [lx]."""
    eye_illuminance: Floats
    """(steps) vertical, at the eye [lx]."""
    dgp: Floats
    """(steps); 0 where it is dark."""
    dgi: Floats
    """(steps); 0 where it is dark."""


class Years:
    """The room of the year, its weather and hours.

    Raises
    ------
    RecipeError
        The room, its view or sensors, or the weather cannot be; the text names the key.
    """

    def __init__(self, recipe: keys.Year, folder: Path, seeds: list[int], store: Cache) -> None:
        self.recipe = recipe
        self.seeds = seeds
        self._cache = store
        self.room: Room = room_of(recipe.room, folder, "year")
        try:
            self.view = self.room.view(recipe.view)
        except RecipeError as error:
            raise RecipeError(f"year.view: {error}") from None
        try:
            self.points, self.normals = self.room.sensors(recipe.sensors)
        except RecipeError as error:
            raise RecipeError(f"year.sensors: {error}") from None
        if not self.room.windows:
            raise RecipeError("year.room: the room has no window (add one)")
        self.weather = self._weather(folder)
        self.hours = Hours(**recipe.hours.model_dump())
        """That count at the eye."""
        self._year = cache(self._made_year)

    @property
    def is_synthetic(self) -> bool:
        """Whether the weather was made up."""
        return self.recipe.weather is None

    @property
    def daylight(self) -> NDArray[np.float64]:
        """Hours that each step counts for daylight autonomy (steps,) [h]: those with the sun above the horizon."""
        return Hours.all_daylight().weights(self.weather)

    def pieces(self, system: System, case: Case, *, repeated: bool) -> dict[int, Piece]:
        """The year of a case by seed: the first one, and the others where it is repeated."""
        made = {}
        for seed in self.seeds if repeated else self.seeds[:1]:

            def compute(tell: Tell, seed: int = seed) -> Arrays:
                year = self._year(seed)
                steps = len(self.weather)
                illuminance = np.zeros((steps, len(self.points)), dtype=np.float32)
                series = {name: np.zeros(steps, dtype=np.float32) for name in ("eye_illuminance", "dgp", "dgi")}
                systems = [system.treated(case)] * len(year.matrices)
                for _, part in year.of({str(case): systems}, tell):
                    illuminance[part.steps] = part.illuminance
                    eye = part.eyes[_EYE]
                    series["eye_illuminance"][part.steps] = eye["illuminance"]
                    for index in ("dgp", "dgi"):
                        # Where it is dark there is no glare, and the hour counts.
                        series[index][part.steps] = np.nan_to_num(eye[index])
                return {"illuminance": illuminance, **series}

            steps = len(self.weather)
            made[seed] = Piece(
                "case-year",
                {"data_set": system.key(case), **self._key(seed)},
                f"{system.title}: {case}, year" + (f", seed {seed}" if seed != self.seeds[0] else ""),
                steps * STEP_CPU_S[case.treatment],
                4e-6 * steps * (len(self.points) + 3),
                compute,
            )
        return made

    def _made_year(self, seed: int) -> RoomYear:
        north = self.room.recipe.sky.north_deg
        ground = self.room.recipe.sky.ground_reflectance
        sky = SkyYear(self.weather, _PATCHES, ground_reflectance=ground, north_deg=north)
        return RoomYear(
            RoomMatrices(self.room, cache=self._cache, seed=seed),
            sky,
            self.points,
            self.normals,
            {_EYE: (self.view.point_m, self.view.direction)},
            sampling=Sampling(view=self.recipe.paths),
        )

    def _key(self, seed: int) -> dict[str, object]:
        weather, sky = self.weather, self.room.recipe.sky
        where = [weather.place.latitude, weather.place.longitude, weather.time_zone]
        light = [np.asarray(v) for v in (weather.times.astype(np.int64), weather.direct, weather.diffuse)]
        dew = weather.dew_point
        return {
            "room": digest(*self.room.described()),
            "weather": digest(where, *light, *(() if dew is None else (np.asarray(dew),))),
            "sky": [_PATCHES, sky.ground_reflectance, sky.north_deg],
            "points": digest(self.points, self.normals),
            "view": [self.view.point_m, self.view.direction],
            "paths": self.recipe.paths,
            "seed": seed,
        }

    def _weather(self, folder: Path) -> Weather:
        if self.recipe.weather is not None:
            path = folder / self.recipe.weather
            try:
                found = read_weather(path)
            except FileNotFoundError:
                raise RecipeError(
                    f"year.weather: {path} does not exist (check it; it is relative to the study)"
                ) from None
        else:
            place = self.room.recipe.place
            if place is None:
                raise RecipeError(
                    "year.weather: there is no file, and the room has no place to make one up for (give a file)"
                )
            at = Place(place.latitude, place.longitude, place.timezone)
            found = synthetic_year(Place(at.latitude, at.longitude, at.standard_hours(2001)))
        chosen = np.isin(found.months, self.recipe.months)
        if not chosen.any():
            raise RecipeError("year.months: the weather has none of them (give others)")
        return found.selected(chosen)


def read(arrays: Arrays) -> CaseYear:
    """What a piece holds."""
    return CaseYear(**arrays)
