"""Daylight matrices of a room: views, what windows return, and the sky before them.

They hold for any system in the windows: those are black here, and what they return is a matrix of its own.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory import _core
from clerestory.annual.cache import Cache, digest
from clerestory.basis import Basis
from clerestory.photometry import LUMINANCE
from clerestory.trace.keys import RecipeError

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from clerestory.picture import View
    from clerestory.room import Room
    from clerestory.room.world import WindowOf
    from clerestory.sky import SkyPatches

    Floats = NDArray[np.float32]


_PROBES = 256
"""Rays along each axis of the square by which it is found how much is seen of a cell, at least; two of each cell."""
_OUTSIDE = 64
"""Points at which windows are asked whether the sun reaches them."""


@dataclass(frozen=True)
class Matrix:
    """What columns give to rows, by the photopic mean of Radiance's channels."""

    all: Floats
    """(rows, columns) of all light."""
    direct: Floats
    """(rows, columns) of light that comes directly."""
    standard_error: Floats
    """(rows, columns) of `all`."""


@dataclass(frozen=True)
class Apertures:
    """What points see of the windows, in cells of the square of the windows' directions."""

    first: NDArray[np.int64]
    """(points + 1) where the cells of each point begin."""
    number: NDArray[np.int64]
    """(cells) group · steps² + cell."""
    solid_angle: Floats
    """(cells) seen of it [sr]."""
    projected: Floats
    """(cells) that by the cosine to the point's normal [sr]."""
    direction: Floats
    """(cells, 3) towards it."""


@dataclass(frozen=True)
class WindowsSeen:
    """What pixels show of windows, or parts of pixels."""

    pixel: NDArray[np.int64]
    """(n) its number, row by row from the top left."""
    share: NDArray[np.float64]
    """(n) of the pixel."""
    group: NDArray[np.int64]
    """(n) of the window."""
    direction: NDArray[np.float64]
    """(n, 3) from the eye."""


class RoomMatrices:
    """The matrices of a room's windows in groups: those that share a system and look the same way.

    Parameters
    ----------
    room
        The room; its sky and the data sets of its systems do not matter.
    basis
        Patches of the windows' directions.
    cache
        Where matrices are kept.
    seed
        Of the random numbers.
    """

    def __init__(self, room: Room, basis: str = "klems-full", cache: Cache | None = None, seed: int = 1) -> None:
        self.room = room
        self.basis = Basis.named(basis)
        self.cache = cache or Cache()
        self.seed = seed
        if not room.windows:
            raise RecipeError("the room has no window, so there are no matrices (add one)")
        keys = [group_of(window) for window in room.windows]
        names = list(dict.fromkeys(keys))
        self.of_window = [names.index(key) for key in keys]
        """Group of each window."""
        self.systems = self.systems_of(room)
        """Name of the system of each group."""
        self._bare = room.bare()
        self._groups = _core.WindowGroups(self._bare, self.of_window, self.basis._core)
        self.key: dict[str, object] = {"room": digest(*room.described()), "groups": self.of_window, "seed": seed}
        """What they depend on."""

    @staticmethod
    def systems_of(room: Room) -> list[str]:
        """Name of the system of each group of a room's windows."""
        return [system for system, _ in dict.fromkeys(group_of(window) for window in room.windows)]

    @staticmethod
    def names_of(room: Room) -> list[str]:
        """Names of the groups of a room's windows: their system, and where they look if it stands in several."""
        groups = list(dict.fromkeys(group_of(window) for window in room.windows))
        systems = [system for system, _ in groups]
        names = [system if systems.count(system) == 1 else f"{system} {_outlook(inward)}" for system, inward in groups]
        return [
            name if names.count(name) == 1 else f"{name} {names[: k + 1].count(name)}" for k, name in enumerate(names)
        ]

    def __len__(self) -> int:
        """Number of groups."""
        return len(self.systems)

    def frame(self, group: int) -> NDArray[np.float64]:
        """Axes of a group's samples in the world (3, 3), a row each: x, y, and z into the room."""
        return np.array(self._groups.frame(group))

    def outside_of(self, group: int) -> NDArray[np.float64]:
        """Points (n, 3) [m] just before a group's windows outside; none where only sky and ground are before them."""
        return self._groups.outside_of(group, _OUTSIDE)

    def sunlit_share(self, group: int, suns: NDArray[np.float64]) -> NDArray[np.float64]:
        """Share (n) of a group's windows that suns (n, 3) reach from outside, if they stand before it."""
        points = self.outside_of(group)
        if not len(points):
            return np.ones(len(suns))
        return np.asarray(np.mean(self.outlooks(points, suns) == -2, axis=0))

    def view(
        self,
        points: NDArray[np.float64],
        normals: NDArray[np.float64],
        *,
        samples: int = 4096,
        progress: Callable[[float], object] | None = None,
    ) -> Matrix:
        """Irradiance at points (n, 3) [m] with normals (n, 3) by the radiance of patches, group by group [sr].

        Direct is what comes from a window and has met no surface.
        """
        at, towards = np.ascontiguousarray(points), np.ascontiguousarray(normals)
        key = {"points": digest(at), "normals": digest(towards), "samples": samples}
        return self._of(
            "view",
            key | {"basis": self.basis.name},
            lambda: self._groups.view_matrix(at, towards, samples, self.seed, progress),
        )

    def surfaces(
        self,
        view: View,
        size_px: tuple[int, int],
        *,
        samples: int = 64,
        progress: Callable[[float], object] | None = None,
    ) -> Matrix:
        """Radiance of the surfaces in the pixels of a picture, row by row from the top left, by that of patches.

        Direct is what a surface that is seen gets from a window. The windows themselves are not in it, see
        `windows_seen`; a pixel that shows both has the surface's radiance times its share.
        """
        width, height = size_px
        key = {"view": view.options, "size": [width, height], "samples": samples, "basis": self.basis.name}

        def compute() -> dict[str, NDArray[np.float32]]:
            # A part at a time: colours take three times the memory.
            parts = []
            step = max(1, 4_000_000 // (len(self) * len(self.basis)))
            for first in range(0, width * height, step):
                last = min(first + step, width * height)

                def share(part: float, first: int = first, last: int = last) -> None:
                    if progress is not None:
                        progress((first + part * (last - first)) / (width * height))

                made = self._groups.picture_matrix(view._core, width, height, first, last, samples, self.seed, share)
                parts.append(photopic(made))
            return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}

        return Matrix(**self.cache.get("surfaces", {**self.key, **key}, compute))

    def windows_seen(self, view: View, size_px: tuple[int, int]) -> WindowsSeen:
        """What the pixels of a picture show of windows; those at an edge in parts."""
        pixel, share, window, direction = self._groups.windows_seen(view._core, *size_px)
        return WindowsSeen(pixel, share, np.array(self.of_window, dtype=np.int64)[window], direction)

    def returned(self, group: int, *, samples: int = 4096) -> Matrix:
        """Mean radiance from the room at a group's windows by patches of interior light (rows), by that of patches."""
        key = {"group": group, "samples": samples, "basis": self.basis.name}
        return self._of("return", key, lambda: self._groups.return_matrix(group, samples, self.seed))

    def daylight(self, group: int, patches: SkyPatches, *, samples: int = 4096) -> Matrix:
        """Mean radiance from outside at a group's windows by patches of exterior light (rows), by that of the sky's.

        Direct is what comes from the sky or the ground without meeting anything.
        """
        key = {"group": group, "patches": patches.name, "samples": samples, "basis": self.basis.name}
        return self._of("daylight", key, lambda: self._groups.daylight_matrix(group, patches._core, samples, self.seed))

    def apertures(self, points: NDArray[np.float64], normals: NDArray[np.float64], steps: int) -> Apertures:
        """What points (n, 3) with normals (n, 3) see of the windows, in `steps` cells along each axis of the square."""
        parts = max(2, _PROBES // steps)
        key = {"points": digest(points), "normals": digest(normals), "steps": steps, "parts": parts}
        names = ("first", "number", "solid_angle", "projected", "direction")

        def compute() -> dict[str, NDArray[np.generic]]:
            made = self._groups.apertures(np.ascontiguousarray(points), np.ascontiguousarray(normals), steps, parts)
            return dict(zip(names, made, strict=True))

        return Apertures(**self.cache.get("apertures", {**self.key, **key}, compute))

    def outlooks(self, points: NDArray[np.float64], directions: NDArray[np.float64]) -> NDArray[np.int64]:
        """Group of the windows through which points (n, 3) see directions (m, 3); -1 for none, -2 where nothing is met.

        (n, m). A direction that is hidden outside is not seen.
        """
        return self._group_of(self._groups.outlooks(np.ascontiguousarray(points), np.ascontiguousarray(directions)))

    def sunlit(
        self, point: NDArray[np.float64], directions: NDArray[np.float64], suns: NDArray[np.float64]
    ) -> tuple[NDArray[np.int64], Floats]:
        """What an eye at a point (3) [m] sees along directions (n, 3) of what suns (m, 3) light through windows.

        The group of the window (n, m), -1 for none, and the radiance by the irradiance of a plane that faces the
        sun [1/sr].
        """
        x, y, z = point.tolist()
        windows, radiance = self._groups.sunlit((x, y, z), np.ascontiguousarray(directions), np.ascontiguousarray(suns))
        return self._group_of(windows), radiance

    def _group_of(self, windows: NDArray[np.uint16]) -> NDArray[np.int64]:
        """Groups of numbers of windows from 1; -1 for 0, -2 for the number that means that nothing is met."""
        groups = np.full(int(np.iinfo(np.uint16).max) + 1, -2, dtype=np.int64)
        groups[: len(self.of_window) + 1] = [-1, *self.of_window]
        return groups[windows]

    def _of(self, kind: str, key: dict[str, object], compute: Callable[[], tuple[Floats, Floats, Floats]]) -> Matrix:
        return Matrix(**self.cache.get(kind, {**self.key, **key}, lambda: photopic(compute())))


def photopic(made: tuple[Floats, Floats, Floats]) -> dict[str, Floats]:
    """Arrays of a `Matrix` from those of Radiance's channels."""
    weights = np.asarray(LUMINANCE, dtype=np.float32)
    every, direct, error = made
    return {"all": every @ weights, "direct": direct @ weights, "standard_error": error}


def group_of(window: WindowOf) -> tuple[str, tuple[float, ...]]:
    """What windows of a group share: their system, and where they look."""
    edges = window.corners[1:] - window.corners[0]
    normal = np.cross(edges[0], edges[1])
    return window.system, tuple(np.round(normal / np.linalg.norm(normal), 6).tolist())


_WALLS = ("north", "north-east", "east", "south-east", "south", "south-west", "west", "north-west")


def _outlook(inward: Sequence[float]) -> str:
    """Where windows look, as a room's walls are named: north is its y axis."""
    x, y, z = inward
    if abs(z) > 0.9:
        return "up" if z < 0.0 else "down"
    return _WALLS[round(math.degrees(math.atan2(-x, -y)) / 45.0) % 8]
