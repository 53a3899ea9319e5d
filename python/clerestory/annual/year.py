"""A year of a room: illuminance at points, and glare at eyes, step by step of the weather."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.annual.glare import SkyThrough, rate
from clerestory.annual.phases import Transfer, leaving
from clerestory.annual.sun import Eye, SunThrough
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
        empty = np.zeros((0, 3))
        self._eyes = {
            name: Eye.of(matrices, point, direction, self.sampling.eye_cells)
            for name, (point, direction) in (eyes or {}).items()
        }
        at = [empty if points is None else points, *(eye.point for eye in self._eyes.values())]
        towards = [empty if normals is None else normals, *(eye.direction for eye in self._eyes.values())]
        self._points, self._normals = np.concatenate(at), np.concatenate(towards)
        self._count = len(at[0])
        if not len(self._points):
            raise ClerestoryError("there are neither points nor eyes (give sensors or views)")

    def of(self, systems: Sequence[Bsdf], progress: Callable[[float], object] | None = None) -> Iterator[Part]:
        """The year with a system in each group of windows, part by part.

        Parameters
        ----------
        systems
            Data set of each group; their beams are as they are (see `Bsdf.separate_peaks`).
        progress
            Called with the share that is done.
        """
        matrices, sampling = self.matrices, self.sampling
        if len(systems) != len(matrices):
            raise ClerestoryError(f"{len(systems)} systems for {len(matrices)} groups of windows (give one each)")
        view = matrices.view(self._points, self._normals, samples=sampling.view)
        groups = range(len(matrices))
        daylight = [matrices.daylight(g, self.sky.patches, samples=sampling.daylight) for g in groups]
        transfers = [Transfer.of(bsdf, matrices.basis) for bsdf in systems]
        returned = [matrices.returned(g, samples=sampling.daylight).all for g in groups]
        once, whole = leaving(transfers), leaving(transfers, returned)
        to_points, to_points_directly = view.all @ whole, view.direct @ once
        if self._eyes:
            # The sun's beams are exact at an eye with what they light: that is one meeting more.
            met_once = matrices.view(
                self._points[self._count :], self._normals[self._count :], direct_meetings=1, samples=sampling.view
            )
            beams = np.concatenate([transfer.beam for transfer in transfers])
            to_points_directly[self._count :] += (met_once.direct - view.direct[self._count :]) * beams
        five = self.method == "5-phase"
        through = SunThrough(matrices, tuple(systems), sampling.cells)
        to_eyes = SunThrough(matrices, tuple(systems), sampling.eye_cells)
        numbers = np.unique(
            np.concatenate([np.zeros(0, dtype=np.int64), *(e.seen.number for e in self._eyes.values())])
        )
        cells = SkyThrough.of(to_eyes, numbers, self.sky.patches._core) if self._eyes else None
        seen = matrices.apertures(self._points, self._normals, sampling.cells) if five else None
        suns, irradiance = self.sky.suns.directions, self.sky.suns.irradiance
        steps = len(suns)
        for first in range(0, steps, sampling.chunk):
            part = slice(first, min(first + sampling.chunk, steps))
            sky = np.asarray(self.sky.columns(part, part="sky"), dtype=np.float32)
            sun = np.asarray(self.sky.columns(part, part="sun"), dtype=np.float32)
            from_sky, from_sun = [np.concatenate([d.all @ light for d in daylight]) for light in (sky, sun)]
            arrives = from_sky + from_sun
            found = to_points @ arrives
            by_patches = to_points_directly @ np.concatenate([d.direct @ sun for d in daylight])
            of_sun = {name: to_eyes.seen_by(eye, suns[part], irradiance[part]) for name, eye in self._eyes.items()}
            if seen is not None:
                exact = through.irradiance(self._points, self._normals, seen, suns[part], irradiance[part])
                for k, sun_seen in enumerate(of_sun.values(), self._count):
                    exact[k] += sun_seen.from_surfaces
                found = found - by_patches + exact
                by_patches = exact.astype(np.float32)
            light = (EFFICACY * np.maximum(found, 0.0)).astype(np.float32)
            eyes: dict[str, dict[str, Doubles]] = {}
            if cells is not None:
                from_sky_directly = np.concatenate([d.direct @ sky for d in daylight])
                radiance = cells.radiance(from_sky, from_sky_directly, sky)
                radiance += ((whole - once) @ arrives)[cells.patch]
                radiance += to_eyes.radiance(numbers, suns[part], irradiance[part]).T
                for k, (name, eye) in enumerate(self._eyes.items(), self._count):
                    at_eye = light[k].astype(np.float64)
                    sun_seen = of_sun[name].scaled(EFFICACY)
                    rated = rate(eye, numbers, EFFICACY * radiance, sun_seen, at_eye, self.settings)
                    dark = np.full(len(at_eye), np.nan)
                    eyes[name] = {"illuminance": at_eye} | {index: rated.get(index, dark) for index in INDICES}
            yield Part(part, light[: self._count].T, EFFICACY * by_patches[: self._count].T, eyes)
            if progress is not None:
                progress(part.stop / steps)
