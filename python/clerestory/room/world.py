"""Rooms: what a recipe describes, ready to be looked at."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from clerestory import _core
from clerestory.npz import mark
from clerestory.photometry import EFFICACY
from clerestory.room.builder import Quads, build
from clerestory.room.files import Found, take
from clerestory.room.recipe import Recipe
from clerestory.room.shipped import ROOMS
from clerestory.room.sky import sky_of
from clerestory.room.standing import of_points, of_windows
from clerestory.room.systems import Placed, system_of
from clerestory.trace.bands import Bands
from clerestory.trace.keys import RecipeError, suggestion
from clerestory.trace.materials import Spec
from clerestory.trace.media import Medium
from clerestory.trace.reading import reading
from clerestory.trace.recipe import read_toml
from clerestory.trace.shipped import beside

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from clerestory.bsdf import Bsdf
    from clerestory.glare import Evaluation, Settings
    from clerestory.room import recipe as keys
    from clerestory.room.illuminance import Illuminance
    from clerestory.room.picture import Rendering
    from clerestory.room.state import State
    from clerestory.sky import Sky
    from clerestory.system.build import Traced

CHANNELS = Bands(names=["red", "green", "blue"])
"""Radiance's channels, which are the bands of a room."""
AIR = "air"


@dataclass(frozen=True)
class WindowOf:
    """A window of a room."""

    name: str
    corners: NDArray[np.float64]
    """(n, 3) [m], counter-clockwise as seen from the room."""
    system: str
    up: tuple[float, float, float] = (0.0, 0.0, 1.0)
    """Upward direction of its data set, as near as its plane lets it be."""


class Room:
    """A room with windows under a sky: made by `load`."""

    def __init__(
        self,
        recipe: Recipe,
        folder: str | os.PathLike[str] = ".",
        *,
        in_windows: Bsdf | None = None,
        traced: Traced | None = None,
    ) -> None:
        """From a recipe; files that it names are relative to `folder`.

        A data set `in_windows` stands in all windows in place of the recipe's systems. Samples are traced by `traced`
        (see `clerestory.system.dataset.data_set`).

        Raises
        ------
        RecipeError
            The room cannot be; the text names the key.
        """
        self.recipe = recipe
        self.folder = Path(folder)
        self._traced = traced
        self.warnings: list[str] = []
        """What is surprising, but can be."""
        self.sky: Sky = sky_of(recipe)
        """What is outside."""
        self._specs: dict[str, Spec] = {}
        for name, material in recipe.materials.items():
            self._specs[name] = material.spec(CHANNELS, f"materials.{name}", self.folder)
        for name, material in recipe.materials.items():
            material.check(self._specs, f"materials.{name}")
        self._media = {AIR: Medium(index=1.0).spec(CHANNELS, AIR)}
        self._systems = dict(recipe.systems)
        self._lights = [
            (name, light.corners_m, [light.luminance / EFFICACY] * 3) for name, light in recipe.lights.items()
        ]
        self._surfaces: list[tuple[tuple[int, int], tuple[int, int]]] = []
        self._shapes = _core.RoomShapes()
        self.windows: list[WindowOf] = []
        """Its windows."""
        if recipe.room is not None:
            quads, windows = build(recipe.room)
            for quad in quads:
                self._add(quad)
            self.windows += [WindowOf(name, np.array(corners), system) for name, corners, system in windows]
        for k, geometry in enumerate(recipe.geometry):
            self._add_file(geometry, f"geometry[{k + 1}]")
        for name, polygon in recipe.windows.items():
            self.windows.append(WindowOf(name, np.array(polygon.corners_m), polygon.system))
        self._bsdfs: dict[str, Placed] = {}
        for window in self.windows:
            if window.system not in self._systems:
                known = recipe.systems
                hint = suggestion(window.system, known) if known else f"add [systems.{window.system}]"
                raise RecipeError(f"window {window.name}: there is no system {window.system!r} ({hint})")
            if window.system not in self._bsdfs:
                self._bsdfs[window.system] = (
                    system_of(self._systems[window.system], f"systems.{window.system}", self.folder, traced)
                    if in_windows is None
                    else Placed(in_windows)
                )
        if not self.windows:
            self.warnings.append("the room has no window: daylight enters through openings of the geometry only")
        self._core = self._made()
        for name, _, lacks in self._core.windows():
            self.warnings += [f"window {name}: {text}" for text in lacks]
        self.warnings += of_windows(self._core)

    @property
    def name(self) -> str:
        """What it is called."""
        return self.recipe.name or "room"

    @property
    def ports(self) -> list[WindowOf]:
        """Openings before its façade."""
        return [WindowOf(name, np.array(port.corners_m), "") for name, port in self.recipe.ports.items()]

    def without_facade(self) -> Room:
        """The same room without what stands between its windows and its ports."""
        kept = [geometry for geometry in self.recipe.geometry if not geometry.facade]
        return Room(self.recipe.model_copy(update={"geometry": kept}), self.folder, traced=self._traced)

    @property
    def files(self) -> list[Path]:
        """Files of data sets that it scatters by: of windows, and of materials."""
        named = [getattr(material, "file", None) for material in self.recipe.materials.values()]
        of_windows = [placed.file for placed in self._bsdfs.values() if placed.file is not None]
        return of_windows + [self.folder / name for name in named if name is not None]

    def content(self) -> list[object]:
        """All that it is made of but for the data of its files: two rooms that differ have other contents."""
        specs = [(name, spec.kind, spec.numbers, spec.parts) for name, spec in self._specs.items()]
        windows = [(w.name, w.corners.tolist(), self._systems[w.system].model_dump(), w.up) for w in self.windows]
        outside = [self.recipe.sky.model_dump(), self.recipe.place and self.recipe.place.model_dump()]
        made = [self._shapes.mark(), self._surfaces, specs, self._media, windows, self._lights, outside]
        return made + [mark(placed.bsdf) for placed in self._bsdfs.values() if placed.file is None]

    def view(self, name: str) -> keys.View:
        """One of its views.

        Raises
        ------
        RecipeError
            There is no such view.
        """
        known = self.recipe.views
        if name not in known:
            hint = suggestion(name, known) if known else "add [views.NAME]"
            raise RecipeError(f"there is no view {name!r} ({hint})")
        return known[name]

    def system(self, name: str) -> Bsdf:
        """The data set of one of its systems, in the band that it is seen in if one is named."""
        return self._bsdfs[name].seen

    def sensors(self, name: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Points (n, 3) [m] and normals (n, 3) of its sensors.

        Raises
        ------
        RecipeError
            There are no such sensors, or a grid has no room.
        """
        known = self.recipe.sensors
        if name not in known:
            hint = suggestion(name, known) if known else "add [sensors.NAME]"
            raise RecipeError(f"there are no sensors {name!r} ({hint})")
        sensors = known[name]
        if sensors.points_m is not None:
            points = np.array(sensors.points_m, dtype=float)
        else:
            points = self._grid(sensors, f"sensors.{name}")
        return points, np.broadcast_to(np.array(sensors.normal, dtype=float), points.shape).copy()

    def doubts(self, view: str | keys.View | None = None, sensors: str | None = None) -> list[str]:
        """What is doubtful about the place of a view's eye, or of sensors: outside of the room, or within a body."""
        found = []
        if view is not None:
            name = f"the eye of view {view}" if isinstance(view, str) else "the eye"
            chosen = self.view(view) if isinstance(view, str) else view
            found += of_points(self._core, [chosen.point_m], name)
        if sensors is not None:
            found += of_points(self._core, self.sensors(sensors)[0].tolist(), f"sensors {sensors}")
        return found

    def illuminance(
        self,
        sensors: str | None = None,
        *,
        points: NDArray[np.float64] | None = None,
        normals: NDArray[np.float64] | None = None,
        error: float = 0.01,
        samples: int | None = None,
        seed: int = 1,
        progress: Callable[[float], object] | None = None,
    ) -> Illuminance:
        """Illuminance at sensors, with standard errors.

        Parameters
        ----------
        sensors
            A name of the recipe's sensors; or give `points` and `normals`, (n, 3) each [m].
        error
            Relative standard error to reach at the mean of the sensors.
        samples
            Paths a sensor, instead; rounded up to a multiple of 16.
        seed
            Of the random numbers: the same seed gives the same numbers for any number of threads.
        progress
            Called with the share that is done.
        """
        from clerestory.room.illuminance import measure

        if sensors is not None:
            points, normals = self.sensors(sensors)
        if points is None or normals is None:
            raise RecipeError("which sensors is not said (give a name, or points and normals)")
        return measure(self._core, points, normals, error=error, samples=samples, seed=seed, progress=progress)

    def picture(
        self,
        view: str | keys.View,
        *,
        noise: float = 0.05,
        samples: int | None = None,
        seconds: float | None = None,
        seed: int = 1,
        state: State | None = None,
        progress: Callable[[float], object] | None = None,
    ) -> Rendering:
        """A picture of radiance, with its noise.

        Parameters
        ----------
        view
            A name of the recipe's views, or a view.
        noise
            Relative noise of a pixel to reach, as a mean over the picture weighted by luminance.
        samples
            Paths a pixel, instead.
        seconds
            Time after which no further pass is begun.
        seed
            Of the random numbers: the same seed and number of paths give the same picture for any number of threads.
        state
            What was found of the same picture before; it goes on from there, with the same result.
        progress
            Called with the share that is done.
        """
        from clerestory.room.picture import render
        from clerestory.room.state import State, fingerprint

        chosen = self.view(view) if isinstance(view, str) else view
        if state is None:
            state = State.new(self, chosen, seed=seed)
        elif state.fingerprint != fingerprint(self, chosen, seed):
            raise _core.ClerestoryError("the state is of another picture (make one of this room, view and seed)")
        return render(state.core, chosen, noise=noise, samples=samples, seconds=seconds, progress=progress)

    def denoise(self, picture: Rendering) -> Rendering:
        """A picture of this room with neighbours averaged where they differ by noise: for eyes, not for glare."""
        from clerestory.room.denoise import denoise

        return denoise(self._core, picture)

    def glare(
        self,
        view: str | keys.View,
        *,
        error: float = 0.01,
        samples: int | None = None,
        seed: int = 1,
        settings: Settings | None = None,
        progress: Callable[[float], object] | None = None,
    ) -> Evaluation:
        """Glare at the eye of a view, without a picture.

        Sources are found in what windows send and in what the sun lights, in directions half a degree apart; the sun
        that is seen through a beam is a source of its own, exactly. Light between surfaces is spread over the whole
        view, so that a surface which is bright by it alone is no source.

        Parameters
        ----------
        view
            A name of the recipe's views, or a view; what counts is where it looks.
        error
            Relative standard error of the illuminance at the eye to reach.
        samples
            Paths a direction, instead.
        seed
            Of the random numbers.
        settings
            Of the evaluation; those of `evalglare` 3.06 by default.
        progress
            Called with the share that is done.

        Raises
        ------
        ClerestoryError
            The settings need a picture.
        """
        from clerestory.room.glare import of_room

        chosen = self.view(view) if isinstance(view, str) else view
        return of_room(self, chosen, error=error, samples=samples, seed=seed, settings=settings, progress=progress)

    def described(self) -> tuple[bytes, list[object]]:
        """All that its light depends on but for systems and sky: shapes; surfaces, materials, media, windows."""

        def plain(spec: Spec) -> object:
            data = None if spec.data is None else (mark(spec.data[0]), *spec.data[1:])
            return [spec.kind, spec.numbers, data, spec.parts]

        materials = [(name, plain(spec)) for name, spec in self._specs.items()]
        windows = [(w.corners.tolist(), w.system, list(w.up)) for w in self.windows]
        return self._shapes.described(), [self._surfaces, materials, self._media, windows]

    def bare(self, *, ports: bool = False) -> _core.Room:
        """The same room, without lights, with windows that send evenly: for what does not depend on systems and sky.

        With ports, these are windows too, behind the others.
        """
        from clerestory.bsdf import Bsdf
        from clerestory.model import Model
        from clerestory.sky import Sky

        # A matrix is read off where another model would be sampled.
        even = Bsdf.from_models({("exterior", "transmission"): Model.lambertian(1.0)}).to_matrix("klems-quarter")
        openings = self.windows + (self.ports if ports else [])
        windows = [(w.name, w.corners.tolist(), even._core, Placed(even).bands, list(w.up)) for w in openings]
        return self._room(windows, [], Sky.uniform())

    def _grid(self, sensors: keys.Sensors, key: str) -> NDArray[np.float64]:
        box, height = self.recipe.room, sensors.height_m
        assert box is not None
        assert height is not None
        rows = []
        for length in (box.width_m, box.depth_m):
            inner = length - 2.0 * sensors.margin_m
            if inner <= 0.0:
                raise RecipeError(f"{key}.margin_m: leaves nothing of {length:g} m (lower it)")
            count = int(np.ceil(inner / sensors.spacing_m - 1e-9)) + 1
            rows.append(sensors.margin_m + np.linspace(0.0, inner, max(count, 2)))
        x, y = np.meshgrid(*rows)
        return np.column_stack([x.ravel(), y.ravel(), np.full(x.size, height)])

    def _add(self, quads: Quads) -> None:
        corners = quads.corners.reshape(-1, 3)
        first = 4 * np.arange(len(quads.corners), dtype=np.int64)[:, None]
        triangles = np.concatenate([first + np.array([0, 1, 2]), first + np.array([0, 2, 3])])
        surface = self._surface(quads.name, self._material(quads.material, f"room.{quads.name}"))
        self._shapes.triangles(quads.name, surface, np.ascontiguousarray(corners), np.ascontiguousarray(triangles))

    def _surface(self, name: str, material: str, behind: str = AIR) -> int:
        """Number of a surface; a new one gets its material, and the medium behind its front."""
        number = self._shapes.surface(name)
        if number == len(self._surfaces):
            index = list(self._specs).index(material)
            self._surfaces.append(((index, index), (0, list(self._media).index(behind))))
        return number

    def _material(self, given: str | float, key: str) -> str:
        """Name of a material; a reflectance becomes one."""
        if isinstance(given, str):
            if given not in self._specs:
                known = [m for m in self._specs if not m.startswith("reflectance ")]
                hint = suggestion(given, known) if known else f"add [materials.{given}]"
                raise RecipeError(f"{key}: there is no material {given!r} ({hint})")
            return given
        name = f"reflectance {given:g}"
        self._specs.setdefault(name, Spec("lambertian", {"reflectance": [given] * 3, "transmittance": [0.0] * 3}))
        return name

    def _add_file(self, geometry: keys.Geometry, key: str) -> None:
        path = self.folder / geometry.file
        taken = take(path, geometry, key)
        self.warnings += [f"{path}: {text}" for text in taken.warnings]
        numbers: list[int | None] = []
        for name, found in zip(taken.scene.surfaces, taken.surfaces, strict=True):
            if name in taken.elsewhere:
                numbers.append(None)
                continue
            if name in self.recipe.materials:
                material, medium = name, AIR
            elif found is not None:
                material, medium = self._added(f"{geometry.file}: {name}", found)
            elif geometry.material is not None:
                material, medium = self._material(geometry.material, f"{key}.material"), AIR
            else:
                raise RecipeError(
                    f"{key}: nothing is said of the surface {name!r} (add [materials.{name}], or material)"
                )
            numbers.append(self._surface(f"{geometry.file}: {name}", material, medium))
        self._shapes.scene(taken.scene, numbers)
        for name, corners, system, up in taken.windows:
            # One file can stand in a room in two treatments.
            used = f"{system.file} ({system.treatment})"
            self.windows.append(WindowOf(name, corners, used, up))
            self._systems[used] = system
        self._lights += taken.lights

    def _added(self, name: str, found: Found) -> tuple[str, str]:
        """A material of a file, and the medium behind its front."""
        self._specs[name] = found.spec
        if found.medium is None:
            return name, AIR
        self._media[name] = found.medium
        return name, name

    def _made(self) -> _core.Room:
        windows = [
            (w.name, w.corners.tolist(), self._bsdfs[w.system].bsdf._core, self._bsdfs[w.system].bands, list(w.up))
            for w in self.windows
        ]
        return self._room(windows, self._lights, self.sky)

    def _room(
        self,
        windows: list[tuple[str, list[list[float]], _core.Bsdf, list[str | None], list[float]]],
        lights: list[tuple[str, list[list[float]], list[float]]],
        sky: Sky,
    ) -> _core.Room:
        materials = [spec.for_core(self._specs) for spec in self._specs.values()]
        media = list(self._media.values())
        try:
            return _core.Room(self._shapes, self._surfaces, materials, media, windows, lights, sky._core)
        except _core.ClerestoryError as error:
            raise RecipeError(str(error)) from error


def load(source: str | os.PathLike[str] | Mapping[str, Any] | Room, *, traced: Traced | None = None) -> Room:
    """A room from a recipe.

    Parameters
    ----------
    source
        A TOML file, the name of a room that comes with Clerestory (`names` lists them), or tables as TOML has them.
    traced
        Traces the samples that its windows name; anew each time by default.

    Raises
    ------
    RecipeError
        The text names file, key, what is wrong and the remedy.
    OSError
        A file cannot be read.
    """
    if isinstance(source, Room):
        return source
    if isinstance(source, Mapping):
        return Room(Recipe.of(source), traced=traced)
    path = ROOMS.find(os.fspath(source))
    try:
        return Room(Recipe.of(read_toml(path)), path.parent, traced=traced)
    except RecipeError as error:
        raise RecipeError(f"{source}: {error}") from None


def load_beside(given: str, folder: Path, key: str, *, traced: Traced | None = None) -> Room:
    """A room that a study names under a key: a recipe relative to its folder, or one that comes with Clerestory.

    Raises
    ------
    RecipeError
        As in `load`, after the key; also where there is no such file.
    """
    with reading(key):
        return load(beside(given, folder, ROOMS), traced=traced)
