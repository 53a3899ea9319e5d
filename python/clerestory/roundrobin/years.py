"""The year of a room with every case in its windows: daylight autonomy, vertical illuminance, DGP and DGI.

As section 3.6 of the report of IEA SHC Task 61 (2021, C.2.2), but every treatment with the direct sun at the data set's
own resolution (five phases).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from clerestory.annual.arrivals import Arrivals
from clerestory.annual.cache import digest
from clerestory.annual.recipe import Recipe
from clerestory.annual.study import Study
from clerestory.roundrobin.pieces import Piece
from clerestory.trace.keys import RecipeError
from clerestory.weather import Hours

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from clerestory.annual.cache import Arrays, Cache
    from clerestory.annual.year import Part
    from clerestory.room import Room
    from clerestory.roundrobin import recipe as keys
    from clerestory.roundrobin.pieces import Tell
    from clerestory.roundrobin.study import Case, System
    from clerestory.weather import Weather

    Floats = NDArray[np.float32]

STEP_CPU_S = {"klems": 3.0e-3, "klems-peaks": 8.0e-3, "high": 3.2e-3, "high-peaks": 7.2e-3}
"""Measured with 48 points: of a step of the weather [s]."""


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
        self._folder = folder
        self._cache = store
        self._study = cache(self._made_study)
        # Kept, so that what does not depend on data sets is found once.
        self._parts = cache(lambda seed: [(block, self._study(seed).year(block)) for block in self._study(seed).blocks])
        first = self._study(seeds[0])
        self.room: Room = first.room
        self.view = self.room.view(recipe.view)
        self.points = first.points
        """(n, 3) [m]."""
        self.weather: Weather = first.weather
        """Its months that are computed."""
        self.hours = first.hours
        """That count at the eye."""

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
                parts = self._parts(seed)
                systems = [system.treated(case)] * len(self._study(seed).matrices)
                steps = len(self.weather)
                illuminance = np.zeros((steps, len(self.points)), dtype=np.float32)
                series = {name: np.zeros(steps, dtype=np.float32) for name in ("eye_illuminance", "dgp", "dgi")}
                for done, (block, year) in enumerate(parts):

                    def share(part: float, done: int = done) -> None:
                        tell((done + part) / len(parts))

                    for _, part in year.of({str(case): systems}, share):
                        illuminance[part.steps, block.points] = part.illuminance
                        _add(series, part)
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

    def _made_study(self, seed: int) -> Study:
        """The room's year without data sets."""
        recipe = self.recipe
        given = Recipe(
            room=recipe.room,
            weather=recipe.weather,
            sensors=[recipe.sensors],
            views=[recipe.view],
            hours=recipe.hours,
            paths=recipe.paths,
            seed=seed,
        )
        try:
            made = Study(given, self._folder, self._cache)
            if not made.room.windows:
                raise RecipeError("room: it has no window (add one)")
            chosen = np.isin(made.weather.months, recipe.months)
            if not chosen.any():
                raise RecipeError("months: the weather has none of them (give others)")
        except RecipeError as error:
            raise RecipeError(f"year.{error}") from None
        made.weather = made.weather.selected(chosen)
        return made

    def _key(self, seed: int) -> dict[str, object]:
        """What a year depends on beside its data set."""
        study = self._study(seed)
        sky = study.sky(study.recipe.patches)
        arrives = Arrivals(study.matrices, sky).key
        eye = [self.view.point_m, self.view.direction]
        where = {"points": digest(study.points, study.normals), "eye": eye, "paths": self.recipe.paths}
        return {**study.matrices.key, **arrives, **where}


def _add(series: dict[str, Floats], part: Part) -> None:
    """Some steps of the eye."""
    for eye in part.eyes.values():
        series["eye_illuminance"][part.steps] = eye["illuminance"]
        for index in ("dgp", "dgi"):
            # Where it is dark there is no glare, and the hour counts.
            series[index][part.steps] = np.nan_to_num(eye[index])


def read(arrays: Arrays) -> CaseYear:
    """What a piece holds."""
    return CaseYear(**arrays)
