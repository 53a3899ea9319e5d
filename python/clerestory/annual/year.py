"""A year of a room: illuminance at points, and glare at eyes, step by step of the weather."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Literal

import numpy as np
from threadpoolctl import threadpool_limits

from clerestory._core import ClerestoryError
from clerestory.annual.cache import digest
from clerestory.annual.cells import SeenCells, SeenWindows
from clerestory.annual.coefficients import Coefficients
from clerestory.annual.glare import rate
from clerestory.annual.phases import Transfer, leaving
from clerestory.annual.pictures import YearPictures
from clerestory.annual.points import Lit
from clerestory.annual.sun import Eye
from clerestory.glare import Settings
from clerestory.npz import mark
from clerestory.photometry import EFFICACY
from clerestory.picture import View

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from clerestory.annual.arrivals import Arrivals, Light
    from clerestory.annual.cache import Arrays
    from clerestory.annual.matrices import Matrix
    from clerestory.bsdf import Bsdf

    Doubles = NDArray[np.float64]
    Floats = NDArray[np.float32]

Method = Literal["2-phase", "3-phase", "5-phase"]
METHODS: tuple[Method, ...] = ("2-phase", "3-phase", "5-phase")
INDICES = ("dgp", "dgi", "ugr", "dgps")
"""Indices that are kept of each eye."""
EYE = ("illuminance", *INDICES)
"""All that is kept of each eye."""


@dataclass(frozen=True)
class Sampling:
    """How finely."""

    view: int = 8192
    """Paths of a point."""
    returned: int = 4096
    """Paths of a patch of the windows into the room."""
    cells: int = 64
    """Cells along each axis of the square of the windows' directions for points."""
    eye_cells: int = 256
    """The same for eyes."""
    chunk: int = 256
    """Steps that are in memory at a time."""


@dataclass(frozen=True)
class Part:
    """Some steps of a year."""

    steps: slice | NDArray[np.int64]
    """Which: all of a part of the year, or those that were asked for."""
    illuminance: Floats
    """(steps, points) [lx]."""
    direct: Floats
    """(steps, points) the sun's part that has met nothing in the room [lx]."""
    eyes: dict[str, dict[str, Doubles]] = field(default_factory=dict)
    """Of each eye, by name: illuminance [lx] and indices (steps)."""

    def of(self, rows: NDArray[np.int64]) -> Part:
        """Some of its steps, by their place in it."""
        eyes = {name: {key: values[rows] for key, values in found.items()} for name, found in self.eyes.items()}
        numbers = np.arange(self.steps.start, self.steps.stop) if isinstance(self.steps, slice) else self.steps
        return Part(numbers[rows], self.illuminance[rows], self.direct[rows], eyes)


class RoomYear:
    """A room under the skies of a year.

    Parameters
    ----------
    arrivals
        What arrives at the windows of a room.
    points, normals
        Where illuminance is asked for (n, 3) [m], and where these points face (n, 3); none by default.
    eyes
        Point [m] and line of sight by name.
    method
        `2-phase` by daylight coefficients, `3-phase`, or `5-phase` with the direct sun at the data set's resolution.
    picture_px
        Width and height of the pictures in which glare is found; without pictures by default.
    sampling
        How finely.
    settings
        Of glare.
    """

    def __init__(
        self,
        arrivals: Arrivals,
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
        self.arrivals = arrivals
        self.matrices = arrivals.matrices
        self.method = method
        self.picture_px = picture_px
        self.sampling = sampling or Sampling()
        self.settings = settings or Settings()
        if method != "5-phase" and eyes:
            raise ClerestoryError("glare needs the sun at a data set's resolution (give the method 5-phase)")
        nowhere = np.zeros((0, 3))
        self._points = nowhere if points is None else np.asarray(points, dtype=np.float64)
        given = nowhere if normals is None else np.asarray(normals, dtype=np.float64)
        self._normals = given / np.linalg.norm(given, axis=1, keepdims=True)
        self._lines = dict(eyes or {})
        if not len(self._points) and not self._lines:
            raise ClerestoryError("there are neither points nor eyes (give sensors or views)")

    @property
    def chunks(self) -> list[slice]:
        """Steps that are found together."""
        return self.arrivals.chunks(self.sampling.chunk)

    def of(
        self,
        data_sets: Mapping[str, Sequence[Bsdf]],
        progress: Callable[[float], object] | None = None,
        *,
        when: Mapping[str, NDArray[np.bool_]] | None = None,
        steps: Sequence[slice] | None = None,
    ) -> Iterator[tuple[str, Part]]:
        """The year with one data set after another, part by part; each part of all of them before the next.

        A part that was found before is taken from the cache.

        Parameters
        ----------
        data_sets
            What stands in each group of windows, by name; beams are as they are (see `Bsdf.separate_peaks`).
        progress
            Called with the share that is done.
        when
            The steps (n) that are asked for of some data sets; parts have no others.
        steps
            Which of `chunks`; all by default.
        """
        for name, systems in data_sets.items():
            if len(systems) != len(self.matrices):
                raise ClerestoryError(
                    f"{name}: {len(systems)} systems for {len(self.matrices)} groups of windows (give one each)"
                )
        marks = {name: [mark(bsdf) for bsdf in systems] for name, systems in data_sets.items()}
        prepared: dict[str, tuple[Lit | Coefficients | None, _Eyes | _Pictured | None]] = {}
        is_lit = self.arrivals.sky.is_lit
        chunks = self.chunks if steps is None else steps
        for done, part in enumerate(chunks, start=1):
            for name, systems in data_sets.items():
                lit = is_lit[part]
                wanted = None if when is None else when.get(name)
                if wanted is not None and not wanted[part].any():
                    continue
                asked = lit if wanted is None else lit & wanted[part]

                def compute(
                    part: slice = part,
                    name: str = name,
                    systems: Sequence[Bsdf] = systems,
                    chosen: NDArray[np.bool_] = asked[lit],
                ) -> Arrays:
                    # Products of matrices have other last digits with another number of threads.
                    with threadpool_limits(1, user_api="blas"):
                        if name not in prepared:
                            prepared[name] = self._prepared(systems)
                        return self._computed(self.arrivals.at(part), chosen, *prepared[name])

                key = self._key_of(marks[name], part, asked)
                found = self.matrices.cache.get("part", key, compute) if asked.any() else {}
                made = self._part(part, np.flatnonzero(asked), found)
                yield name, made if wanted is None else made.of(np.flatnonzero(wanted[part]))
            if progress is not None:
                progress(done / len(chunks))

    def missing(self, systems: Sequence[Bsdf], when: NDArray[np.bool_] | None = None) -> list[slice]:
        """Those of `chunks` that the cache does not hold for one choice of systems, and some steps (n)."""
        marks = [mark(bsdf) for bsdf in systems]
        is_lit, cache = self.arrivals.sky.is_lit, self.matrices.cache
        asked = is_lit if when is None else is_lit & when
        return [
            part
            for part in self.chunks
            if asked[part].any() and not cache.path_of("part", self._key_of(marks, part, asked[part])).is_file()
        ]

    def prepare(self) -> None:
        """Find the matrices, which hold for all systems, for the cache."""
        _ = self.arrivals.matrix, self._returned
        if len(self._points):
            _ = self._view
            if self.method != "3-phase":
                _ = self._cells
        if self._lines:
            _ = self._eye_cells if self.picture_px is None else self._pictures

    def _key_of(self, marks: list[str], part: slice, asked: NDArray[np.bool_]) -> dict[str, object]:
        return self._key | {"systems": marks, "steps": [part.start, part.stop], "asked": digest(asked)}

    @cached_property
    def _key(self) -> dict[str, object]:
        """What parts depend on, but for systems and steps."""
        lines = [[[float(x) for x in v] for v in line] for line in self._lines.values()]
        where = {"points": digest(self._points, self._normals), "eyes": lines}
        how = {
            "method": self.method,
            "picture": self.picture_px,
            "sampling": asdict(self.sampling),
            "glare": asdict(self.settings),
        }
        return self.matrices.key | self.arrivals.key | where | how | {"basis": self.matrices.basis.name}

    @cached_property
    def _eyes(self) -> dict[str, Eye]:
        steps = self.sampling.eye_cells
        return {name: Eye.of(self.matrices, at, towards, steps) for name, (at, towards) in self._lines.items()}

    @cached_property
    def _returned(self) -> list[Floats]:
        return [self.matrices.returned(g, samples=self.sampling.returned).all for g in range(len(self.matrices))]

    @cached_property
    def _cells(self) -> SeenCells:
        return SeenCells(self.matrices, self._points, self._normals, self.sampling.cells)

    @cached_property
    def _eye_cells(self) -> SeenCells:
        at, towards = (np.concatenate([getattr(e, key) for e in self._eyes.values()]) for key in ("point", "direction"))
        return SeenCells(self.matrices, at, towards, self.sampling.eye_cells)

    @cached_property
    def _pictures(self) -> dict[str, YearPictures]:
        assert self.picture_px is not None
        size, returned = (self.picture_px, self.picture_px), self.sampling.returned
        return {
            name: YearPictures(self.arrivals, View.fisheye(at, towards), size, returned=returned)
            for name, (at, towards) in self._lines.items()
        }

    def _prepared(self, systems: Sequence[Bsdf]) -> tuple[Lit | Coefficients | None, _Eyes | _Pictured | None]:
        transfers, once, whole = self._transfers(systems)
        points = self._of_points(systems, once, whole) if len(self._points) else None
        if not self._lines:
            return points, None
        if self.picture_px is not None:
            return points, _Pictured(self, systems)
        return points, _Eyes(self, systems, transfers, once, whole)

    def _computed(
        self,
        light: Light,
        chosen: NDArray[np.bool_],
        points: Lit | Coefficients | None,
        eyes: _Eyes | _Pictured | None,
    ) -> Arrays:
        """What is found at the chosen steps of some light."""
        made: Arrays = {}
        only = light.only(chosen)
        if points is not None:
            made["illuminance"], made["direct"] = (values[chosen] for values in points.illuminance(only))
        if eyes is not None:
            rated = eyes.rated(only, chosen)
            made["eyes"] = np.array([[rated[name][index] for index in EYE] for name in self._lines])
        return made

    def _part(self, part: slice, lit: NDArray[np.int64], found: Arrays) -> Part:
        """Some steps, of which only the lit ones were computed."""
        count = part.stop - part.start
        illuminance, direct = (np.zeros((count, len(self._points)), dtype=np.float32) for _ in range(2))
        if "illuminance" in found:
            illuminance[lit], direct[lit] = found["illuminance"], found["direct"]
        eyes: dict[str, dict[str, Doubles]] = {}
        for k, name in enumerate(self._lines):
            eyes[name] = {"illuminance": np.zeros(count)} | {index: np.full(count, np.nan) for index in INDICES}
            if "eyes" in found:
                for index, values in zip(EYE, found["eyes"][k], strict=True):
                    eyes[name][index][lit] = values
        return Part(part, illuminance, direct, eyes)

    def coefficients(self, systems: Sequence[Bsdf]) -> Coefficients:
        """Daylight coefficients of the points with one choice of systems, one of each group."""
        _, once, whole = self._transfers(systems)
        return self._coefficients(systems, once, whole)

    def _transfers(self, systems: Sequence[Bsdf]) -> tuple[list[Transfer], Floats, Floats]:
        """Of each group, and what windows send without and with what the room returns to them."""
        transfers = [Transfer.of(bsdf, self.matrices.basis) for bsdf in systems]
        return transfers, leaving(transfers), leaving(transfers, self._returned)

    def _coefficients(self, systems: Sequence[Bsdf], once: Floats, whole: Floats) -> Coefficients:
        seen = SeenWindows(self._cells, systems, self.arrivals.sky.patches._core)
        return Coefficients(self.arrivals, self._view, once, whole, seen)

    @property
    def _view(self) -> Matrix:
        return self.matrices.view(self._points, self._normals, samples=self.sampling.view)

    def _of_points(self, systems: Sequence[Bsdf], once: Floats, whole: Floats) -> Lit | Coefficients:
        if self.method == "2-phase":
            return self._coefficients(systems, once, whole)
        seen = None
        if self.method == "5-phase":
            seen = SeenWindows(self._cells, systems, self.arrivals.sky.patches._core)
        return Lit(self._view, once, whole, seen)


class _Eyes:
    """The eyes of a year with one choice of systems."""

    def __init__(
        self, year: RoomYear, systems: Sequence[Bsdf], transfers: Sequence[Transfer], once: Floats, whole: Floats
    ) -> None:
        self._eyes = year._eyes
        self._settings = year.settings
        cells = year._eye_cells
        self._seen = SeenWindows(cells, systems, year.arrivals.sky.patches._core)
        self._whole = whole
        self._beams = np.concatenate([transfer.beam for transfer in transfers])[:, None]
        self._returns = (whole - once)[self._seen.sky.patch]

    def rated(self, light: Light, chosen: NDArray[np.bool_]) -> dict[str, dict[str, Doubles]]:
        """Illuminance [lx] and indices (steps) of each eye at the chosen steps."""
        cells = self._seen.light(light)
        windows = EFFICACY * (cells.sky + cells.sun + self._returns @ light.arrives)
        from_windows = self._seen.from_cells(windows)
        sent, by_beams = self._whole @ light.arrives, self._beams * light.directly
        found: dict[str, dict[str, Doubles]] = {}
        dark = np.full(np.count_nonzero(chosen), np.nan)
        for k, (name, eye) in enumerate(self._eyes.items()):
            # What beams throw on surfaces is spread over patches, and found again for the sun itself.
            in_sun = self._seen.through.on_surfaces(eye.point[0], eye.directions, light.suns, cells.beams)
            surfaces = EFFICACY * np.maximum(eye.surfaces @ sent - eye.directly @ by_beams + in_sun, 0.0)
            of_windows = windows[np.searchsorted(self._seen.cells.numbers, eye.seen.number)]
            straight = EFFICACY * cells.straight[k]
            in_sight = np.maximum(light.suns @ eye.direction[0], 0.0)
            illuminance = from_windows[k] + eye.irradiance(surfaces) + straight * in_sight
            rated = rate(eye, of_windows, surfaces, straight, light.suns, illuminance, chosen, self._settings)
            found[name] = {"illuminance": illuminance[chosen]} | {index: rated.get(index, dark) for index in INDICES}
        return found


class _Pictured:
    """The eyes of a year with one choice of systems, by pictures."""

    def __init__(self, year: RoomYear, systems: Sequence[Bsdf]) -> None:
        self._pictures = {name: pictures.of(systems) for name, pictures in year._pictures.items()}
        self._settings = year.settings

    def rated(self, light: Light, chosen: NDArray[np.bool_]) -> dict[str, dict[str, Doubles]]:
        """Illuminance [lx] and indices (steps) of each eye at the chosen steps."""
        part = light.part(chosen)
        return {name: made.rated(part, self._settings, INDICES) for name, made in self._pictures.items()}
