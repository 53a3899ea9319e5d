"""A year of a room: illuminance at points, and glare at eyes, step by step of the weather."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.annual.cells import SeenWindows
from clerestory.annual.glare import rate
from clerestory.annual.phases import Transfer, leaving
from clerestory.annual.pictures import YearPictures
from clerestory.annual.points import Light, Lit
from clerestory.annual.sun import Eye
from clerestory.glare import Settings
from clerestory.photometry import EFFICACY
from clerestory.picture import View

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from clerestory.annual.matrices import RoomMatrices
    from clerestory.bsdf import Bsdf
    from clerestory.weather import SkyYear

    Doubles = NDArray[np.float64]
    Floats = NDArray[np.float32]

Method = Literal["3-phase", "5-phase"]
METHODS: tuple[Method, ...] = ("3-phase", "5-phase")
INDICES = ("dgp", "dgi", "ugr", "dgps")
"""Indices that are kept of each eye."""


@dataclass(frozen=True)
class Sampling:
    """How finely."""

    view: int = 8192
    """Paths of a point."""
    daylight: int = 4096
    """Paths of a patch of the windows, into the room and out of it."""
    cells: int = 64
    """Cells along each axis of the square of the windows' directions for points."""
    eye_cells: int = 256
    """The same for eyes."""
    chunk: int = 256
    """Steps that are in memory at a time."""


@dataclass(frozen=True)
class Part:
    """Some steps of a year."""

    steps: slice
    """Which."""
    illuminance: Floats
    """(steps, points) [lx]."""
    direct: Floats
    """(steps, points) the sun's part that has met nothing in the room [lx]."""
    eyes: dict[str, dict[str, Doubles]] = field(default_factory=dict)
    """Of each eye, by name: illuminance [lx] and indices (steps)."""


class RoomYear:
    """A room under the skies of a year.

    Parameters
    ----------
    matrices
        Of the room.
    sky
        The skies, with as many steps as the weather has.
    points, normals
        Where illuminance is asked for (n, 3) [m], and where these points face (n, 3); none by default.
    eyes
        Point [m] and line of sight by name.
    method
        `3-phase`, or `5-phase` with the direct sun at the data set's resolution.
    picture_px
        Width and height of the pictures in which glare is found; without pictures by default.
    sampling
        How finely.
    settings
        Of glare.
    """

    def __init__(
        self,
        matrices: RoomMatrices,
        sky: SkyYear,
        points: Doubles | None = None,
        normals: Doubles | None = None,
        eyes: Mapping[str, tuple[Sequence[float], Sequence[float]]] | None = None,
        *,
        method: Method = "5-phase",
        picture_px: int | None = None,
        sampling: Sampling | None = None,
        settings: Settings | None = None,
    ) -> None:
        if method not in METHODS:
            raise ClerestoryError(f"a method {method!r} is not known (known: {', '.join(METHODS)})")
        self.matrices = matrices
        self.sky = sky
        self.method = method
        self.sampling = sampling or Sampling()
        self.settings = settings or Settings()
        if method == "3-phase" and eyes:
            raise ClerestoryError("glare needs the sun at a data set's resolution (give the method 5-phase)")
        nowhere = np.zeros((0, 3))
        self._points = nowhere if points is None else np.asarray(points, dtype=np.float64)
        given = nowhere if normals is None else np.asarray(normals, dtype=np.float64)
        self._normals = given / np.linalg.norm(given, axis=1, keepdims=True)
        given_eyes = eyes or {}
        self._names = list(given_eyes)
        self._eyes: dict[str, Eye] = {}
        self._pictures: dict[str, YearPictures] = {}
        for name, (at, towards) in given_eyes.items():
            if picture_px is None:
                self._eyes[name] = Eye.of(matrices, at, towards, self.sampling.eye_cells)
            else:
                view, size = View.fisheye(at, towards), (picture_px, picture_px)
                self._pictures[name] = YearPictures(matrices, sky, view, size, daylight=self.sampling.daylight)
        if not len(self._points) and not self._names:
            raise ClerestoryError("there are neither points nor eyes (give sensors or views)")

    def of(
        self, data_sets: Mapping[str, Sequence[Bsdf]], progress: Callable[[float], object] | None = None
    ) -> Iterator[tuple[str, Part]]:
        """The year with one data set after another, part by part; each part of all of them before the next.

        Parameters
        ----------
        data_sets
            What stands in each group of windows, by name; beams are as they are (see `Bsdf.separate_peaks`).
        progress
            Called with the share that is done.
        """
        matrices, sampling = self.matrices, self.sampling
        groups = range(len(matrices))
        for name, systems in data_sets.items():
            if len(systems) != len(matrices):
                raise ClerestoryError(
                    f"{name}: {len(systems)} systems for {len(matrices)} groups of windows (give one each)"
                )
        daylight = [matrices.daylight(g, self.sky.patches, samples=sampling.daylight) for g in groups]
        returned = [matrices.returned(g, samples=sampling.daylight).all for g in groups]
        prepared = {name: self._prepared(systems, returned) for name, systems in data_sets.items()}
        is_lit = self.sky.is_lit
        for first in range(0, len(is_lit), sampling.chunk):
            part = slice(first, min(first + sampling.chunk, len(is_lit)))
            lit = np.flatnonzero(is_lit[part])
            light = Light.of(self.sky, daylight, first + lit)
            for name, (points, eyes) in prepared.items():
                yield name, self._part(part, lit, light, points, eyes)
            if progress is not None:
                progress(part.stop / len(is_lit))

    def _prepared(
        self, systems: Sequence[Bsdf], returned: Sequence[Floats]
    ) -> tuple[Lit | None, _Eyes | _Pictured | None]:
        transfers = [Transfer.of(bsdf, self.matrices.basis) for bsdf in systems]
        once, whole = leaving(transfers), leaving(transfers, returned)
        points = self._of_points(systems, once, whole) if len(self._points) else None
        if self._pictures:
            return points, _Pictured(self, systems)
        return points, _Eyes(self, systems, transfers, once, whole) if self._eyes else None

    def _part(
        self, part: slice, lit: NDArray[np.int64], light: Light, points: Lit | None, eyes: _Eyes | _Pictured | None
    ) -> Part:
        """Some steps, of which only the lit ones were computed."""
        count = part.stop - part.start
        illuminance, direct = (np.zeros((count, len(self._points)), dtype=np.float32) for _ in range(2))
        if points is not None and len(lit):
            illuminance[lit], direct[lit] = points.illuminance(light)
        found: dict[str, dict[str, Doubles]] = {}
        rated = eyes.rated(light) if eyes is not None and len(lit) else {}
        for name in self._names:
            found[name] = {"illuminance": np.zeros(count)} | {index: np.full(count, np.nan) for index in INDICES}
            for index, values in rated.get(name, {}).items():
                found[name][index][lit] = values
        return Part(part, illuminance, direct, found)

    def _of_points(self, systems: Sequence[Bsdf], once: Floats, whole: Floats) -> Lit:
        seen = None
        if self.method == "5-phase":
            seen = SeenWindows.of(
                self.matrices, systems, self._points, self._normals, self.sampling.cells, self.sky.patches._core
            )
        return Lit(self.matrices.view(self._points, self._normals, samples=self.sampling.view), once, whole, seen)


class _Eyes:
    """The eyes of a year with one choice of systems."""

    def __init__(
        self, year: RoomYear, systems: Sequence[Bsdf], transfers: Sequence[Transfer], once: Floats, whole: Floats
    ) -> None:
        matrices, sampling = year.matrices, year.sampling
        self._eyes = year._eyes
        self._settings = year.settings
        at = np.concatenate([eye.point for eye in self._eyes.values()])
        towards = np.concatenate([eye.direction for eye in self._eyes.values()])
        self._seen = SeenWindows.of(matrices, systems, at, towards, sampling.eye_cells, year.sky.patches._core)
        self._whole = whole
        self._beams = np.concatenate([transfer.beam for transfer in transfers])[:, None]
        self._returns = (whole - once)[self._seen.sky.patch]

    def rated(self, light: Light) -> dict[str, dict[str, Doubles]]:
        """Illuminance [lx] and indices (steps) of each eye."""
        cells = self._seen.light(light)
        windows = EFFICACY * (cells.sky + cells.sun + self._returns @ light.arrives)
        from_windows = self._seen.from_cells(windows)
        sent, by_beams = self._whole @ light.arrives, self._beams * light.directly
        found: dict[str, dict[str, Doubles]] = {}
        dark = np.full(light.steps, np.nan)
        for k, (name, eye) in enumerate(self._eyes.items()):
            # What beams throw on surfaces is spread over patches, and found again for the sun itself.
            in_sun = self._seen.through.on_surfaces(eye.point[0], eye.directions, light.suns, light.irradiance)
            surfaces = EFFICACY * np.maximum(eye.surfaces @ sent - eye.directly @ by_beams + in_sun, 0.0)
            of_windows = windows[np.searchsorted(self._seen.numbers, eye.seen.number)]
            straight = EFFICACY * cells.straight[k]
            in_sight = np.maximum(light.suns @ eye.direction[0], 0.0)
            illuminance = from_windows[k] + eye.irradiance(surfaces) + straight * in_sight
            rated = rate(eye, of_windows, surfaces, straight, light.suns, illuminance, self._settings)
            found[name] = {"illuminance": illuminance} | {index: rated.get(index, dark) for index in INDICES}
        return found


class _Pictured:
    """The eyes of a year with one choice of systems, by pictures."""

    def __init__(self, year: RoomYear, systems: Sequence[Bsdf]) -> None:
        self._pictures = {name: pictures.of(systems) for name, pictures in year._pictures.items()}
        self._settings = year.settings

    def rated(self, light: Light) -> dict[str, dict[str, Doubles]]:
        """Illuminance [lx] and indices (steps) of each eye."""
        return {name: made.rated(light, self._settings, INDICES) for name, made in self._pictures.items()}
