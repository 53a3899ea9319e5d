"""A year of a room: illuminance at points, and glare at eyes, step by step of the weather."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.annual.cells import SeenWindows
from clerestory.annual.glare import rate
from clerestory.annual.phases import Transfer, leaving
from clerestory.annual.points import Light, Lit
from clerestory.annual.sun import Eye
from clerestory.glare import Settings
from clerestory.photometry import EFFICACY

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
    eye_cells: int = 128
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
        steps = self.sampling.eye_cells
        self._eyes = {name: Eye.of(matrices, at, towards, steps) for name, (at, towards) in (eyes or {}).items()}
        if not len(self._points) and not self._eyes:
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

    def _prepared(self, systems: Sequence[Bsdf], returned: Sequence[Floats]) -> tuple[Lit | None, _Eyes | None]:
        transfers = [Transfer.of(bsdf, self.matrices.basis) for bsdf in systems]
        once, whole = leaving(transfers), leaving(transfers, returned)
        points = self._of_points(systems, once, whole) if len(self._points) else None
        return points, _Eyes(self, systems, transfers, once, whole) if self._eyes else None

    def _part(self, part: slice, lit: NDArray[np.int64], light: Light, points: Lit | None, eyes: _Eyes | None) -> Part:
        """Some steps, of which only the lit ones were computed."""
        count = part.stop - part.start
        illuminance, direct = (np.zeros((count, len(self._points)), dtype=np.float32) for _ in range(2))
        if points is not None and len(lit):
            illuminance[lit], direct[lit] = points.illuminance(light)
        found: dict[str, dict[str, Doubles]] = {}
        rated = eyes.rated(light) if eyes is not None and len(lit) else {}
        for name in self._eyes:
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
        view = matrices.view(at, towards, samples=sampling.view)
        self._lit = Lit(view, once, whole, self._seen)
        # A beam of the sun is exact together with what it lights, which is one meeting more.
        met = matrices.view(at, towards, direct_meetings=1, samples=sampling.view)
        self._by_beams = (met.direct - view.direct) * np.concatenate([transfer.beam for transfer in transfers])
        self._returns = (whole - once)[self._seen.sky.patch]

    def rated(self, light: Light) -> dict[str, dict[str, Doubles]]:
        """Illuminance [lx] and indices (steps) of each eye."""
        cells = self._seen.light(light)
        suns = [
            self._seen.through.seen_by(eye, light.suns, light.irradiance, straight)
            for eye, straight in zip(self._eyes.values(), cells.straight, strict=True)
        ]
        lit = self._lit.irradiance(light, cells)[0] - self._by_beams @ light.directly
        lit += np.stack([sun.from_surfaces for sun in suns])
        illuminance = EFFICACY * np.maximum(lit, 0.0)
        luminances = (EFFICACY * (cells.sky + cells.sun + self._returns @ light.arrives)).astype(np.float32)
        found: dict[str, dict[str, Doubles]] = {}
        dark = np.full(light.steps, np.nan)
        for (name, eye), sun, at_eye in zip(self._eyes.items(), suns, illuminance, strict=True):
            rated = rate(eye, self._seen.numbers, luminances, sun.scaled(EFFICACY), at_eye, self._settings)
            found[name] = {"illuminance": at_eye} | {index: rated.get(index, dark) for index in INDICES}
        return found
