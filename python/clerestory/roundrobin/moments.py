"""Points in time: vertical illuminance, DGP and DGI at an eye, and renderings of the first one.

As section 3.5 of the report of IEA SHC Task 61 (2021, C.2.2). Values are found without a picture, so that the sun's
image in a beam has its own size and luminance whatever the resolution of a rendering; renderings show it, and the
sources that are found in them.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory.annual.cache import digest
from clerestory.room import Room
from clerestory.room.world import load_beside
from clerestory.roundrobin.pieces import Piece
from clerestory.sky import Place
from clerestory.trace.keys import RecipeError

if TYPE_CHECKING:
    from pathlib import Path

    from clerestory.annual.cache import Arrays
    from clerestory.glare import Evaluation
    from clerestory.picture import Picture
    from clerestory.roundrobin import recipe as keys
    from clerestory.roundrobin.pieces import Tell
    from clerestory.roundrobin.study import Case, System

GLARE_CPU_S = {"klems": 1.8, "klems-peaks": 4.8, "high": 3.5, "high-peaks": 3.0}
"""Measured: of a value without a picture [s]."""
PATH_CPU_S = {"klems": 6.0e-6, "klems-peaks": 8.2e-6, "high": 6.0e-6, "high-peaks": 8.1e-6}
"""Measured: of a path of a pixel [s]."""
_YEAR = 2021
"""Whose standard time is that of the place."""
QUANTITIES = ("illuminance", "dgp", "dgi")


@dataclass(frozen=True)
class Rendered:
    """A rendering."""

    picture: Picture
    """As it was found."""
    denoised: Picture
    """For the eye."""
    glare: Evaluation
    """Of the former."""


@dataclass(frozen=True)
class Moment:
    """What an eye gets at a point in time."""

    illuminance: float
    """Vertical, at the eye [lx]."""
    dgp: float
    """Daylight glare probability."""
    dgi: float
    """Daylight glare index."""


class Moments:
    """The room of points in time, with the data sets of a case in its windows.

    Raises
    ------
    RecipeError
        The room, its view or a time cannot be; the text names the key.
    """

    def __init__(self, recipe: keys.Moments, folder: Path, seeds: list[int]) -> None:
        self.recipe = recipe
        self.seeds = seeds
        self.base = load_beside(recipe.room, folder, "moments.room")
        place = self.base.recipe.place
        if place is None:
            raise RecipeError("moments.room: the room has no place, so its times have no sun (add [place])")
        try:
            self.view = self.base.view(recipe.view)
        except RecipeError as error:
            raise RecipeError(f"moments.view: {error}") from None
        hours = Place(place.latitude, place.longitude, place.timezone).standard_hours(_YEAR)
        self.place = place.model_copy(update={"timezone": hours})
        """With a clock of standard time."""
        for time in recipe.times:
            try:
                self._room(time)
            except RecipeError as error:
                raise RecipeError(f"moments.times: {time}: {error}") from None

    @property
    def first(self) -> str:
        """The time that is rendered."""
        return self.recipe.times[0]

    def sun_altitude_deg(self, time: str) -> float:
        """Of a time [°]."""
        return self._room(time).sky.settings.sun.altitude_deg

    def pieces(self, system: System, case: Case) -> dict[tuple[str, int], Piece]:
        """Values of a case by time and seed."""
        made = {}
        for seed in self.seeds:
            for time in self.recipe.times:

                def compute(tell: Tell, time: str = time, seed: int = seed) -> Arrays:
                    room = self._room(time, system, case)
                    found = room.glare(self.view, seed=seed, progress=tell)
                    return {"values": np.array([found.vertical_illuminance, found.dgp, found.dgi])}

                key = self._key(system, case, time, seed)
                words = f"{system.title}: {case}, {time}"
                made[time, seed] = Piece("moment", key, words, GLARE_CPU_S[case.treatment], 0.001, compute)
        return made

    def rendering(self, system: System, case: Case) -> Piece:
        """The picture of a case at the first time."""
        size, samples = self.recipe.size_px, self.recipe.samples
        view = self.view.model_copy(update={"size_px": [size, size]})

        def compute(tell: Tell) -> Arrays:
            room = self._room(self.first, system, case)
            made = room.picture(view, samples=samples, seed=self.seeds[0], progress=tell)
            shown = room.denoise(made)
            return {"radiance": made.radiance.astype(np.float32), "denoised": shown.radiance.astype(np.float32)}

        key = {**self._key(system, case, self.first, self.seeds[0]), "size": size, "samples": samples, "denoised": True}
        words = f"{system.title}: {case}, rendering"
        cpu_s = size * size * samples * PATH_CPU_S[case.treatment]
        return Piece("rendering", key, words, cpu_s, 24e-6 * size * size, compute)

    def picture(self, arrays: Arrays) -> Rendered:
        """What a rendering's piece holds."""
        from clerestory.glare import evaluate
        from clerestory.picture import Picture, View
        from clerestory.room.picture import options

        made, shown = (
            Picture(arrays[name].astype(np.float64), View(options(self.view))) for name in ("radiance", "denoised")
        )
        return Rendered(made, shown, evaluate(made))

    def _room(self, time: str, system: System | None = None, case: Case | None = None) -> Room:
        recipe = self.base.recipe
        sky = recipe.sky.model_copy(update={"time": time, "sun_deg": None})
        made = recipe.model_copy(update={"sky": sky, "place": self.place})
        if system is None or case is None:
            return Room(made, self.base.folder)
        try:
            return Room(made, self.base.folder, in_windows=system.treated(case))
        except RecipeError as error:
            raise RecipeError(f"{system.title}, {case}: {error}") from None

    def _key(self, system: System, case: Case, time: str, seed: int) -> dict[str, object]:
        sky = self.base.recipe.sky.model_dump() | {"time": time, "sun_deg": None}
        return {
            "data_set": system.key(case),
            "room": digest(*self.base.described(), json.dumps(self.base.content(), default=str)),
            "sky": sky,
            "place": self.place.model_dump(),
            "view": self.view.model_dump(),
            "seed": seed,
        }


def read(arrays: Arrays) -> Moment:
    """What a value's piece holds."""
    return Moment(*arrays["values"].tolist())
