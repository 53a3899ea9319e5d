"""What a room takes from scene files: shapes and materials, windows with their data sets, and lights."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from clerestory import _core
from clerestory.room import recipe as keys
from clerestory.room.scene import UNITS, RoomScene
from clerestory.trace.keys import RecipeError
from clerestory.trace.kinds.radiance import COUNTS, numbers_of
from clerestory.trace.materials import Spec
from clerestory.trace.reading import reading

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from clerestory.trace.kinds.radiance import Found as Material

SCENES = (".rad", ".obj")
"""Suffixes of files with materials of their own."""
MESHES = (".stl", ".ply")


@dataclass(frozen=True)
class Found:
    """A material of a file."""

    spec: Spec
    medium: dict[str, list[float]] | None = None
    """What is behind its front, if that is not air."""


@dataclass
class Taken:
    """What a file gives to a room."""

    scene: _core.Scene
    surfaces: list[Found | None]
    """By the scene's surfaces; None where the file does not say."""
    elsewhere: set[str] = field(default_factory=set)
    """Surfaces that are windows or lights."""
    windows: list[tuple[str, NDArray[np.float64], keys.System, tuple[float, float, float]]] = field(
        default_factory=list
    )
    """Name, corners (n, 3) [m], system, and the upward direction of its data set."""
    lights: list[tuple[str, list[list[float]], list[float]]] = field(default_factory=list)
    """Name, corners [m], radiance [W/(m² sr)]."""
    warnings: list[str] = field(default_factory=list)


def take(path: Path, geometry: keys.Geometry, key: str) -> Taken:
    """Read a file.

    Raises
    ------
    RecipeError
        It cannot be read, or holds what a room cannot have; file and line are named.
    """
    suffix = path.suffix.lower()
    if suffix not in SCENES + MESHES:
        raise RecipeError(f"{key}.file: {path} is of no known format (give one ending in .rad, .obj, .stl or .ply)")
    with reading(f"{key}.file"):
        if suffix in MESHES:
            mesh: _core.Scene = getattr(_core.Scene, suffix[1:])(path, UNITS[geometry.unit])
            return Taken(mesh, [None] * len(mesh.surfaces), warnings=list(mesh.warnings))
        scene = RoomScene.read(path, unit=geometry.unit)
    return _of_scene(scene, path, key)


def _of_scene(scene: RoomScene, path: Path, key: str) -> Taken:
    taken = Taken(scene.shapes, [], warnings=list(scene.warnings))
    data_sets = {d.surface: d for d in scene.data_sets}
    lights = {light.surface: light for light in scene.lights}
    round_ones = {scene.surfaces[number] for _, number, _ in scene.shapes.round()}
    for surface in [*data_sets, *lights]:
        taken.elsewhere.add(surface)
        if surface in round_ones:
            raise RecipeError(
                f"{key}.file: {path}: {surface} is on a round shape (windows and lights are flat polygons)"
            )
    for polygon in scene.polygons:
        if polygon.surface in data_sets:
            found = data_sets[polygon.surface]
            if found.path is None:
                raise RecipeError(f"{key}.file: {path}: {found.file} of {found.surface} was not found (put it beside)")
            treatment: keys.Treatment = "high-peaks" if found.peaks else "high"
            system = keys.System(file=str(found.path.resolve()), treatment=treatment)
            taken.windows.append((polygon.name, polygon.corners, system, found.up))
            if any(any(part) for part in found.added):
                taken.warnings.append(f"{found.surface}: the even scattering that it adds to its file is left out")
            if found.thickness != 0.0:
                taken.warnings.append(
                    f"{polygon.name}: its data set stands for the shapes within {abs(found.thickness):g} m of it, but "
                    "here light meets both (leave the shapes out)"
                )
        elif polygon.surface in lights:
            light = lights[polygon.surface]
            dark = light.kind == "spotlight"
            if dark:
                taken.warnings.append(
                    f"{polygon.name}: the spotlight {light.surface} is left dark, as electric light that no daylight "
                    "needs (make it a light to have it shine to all sides)"
                )
            taken.lights.append((polygon.name, polygon.corners.tolist(), [0.0] * 3 if dark else list(light.radiance)))
    if scene.skies or scene.sources:
        taken.warnings.append("its sky and sun are not used: the recipe's are")
    taken.surfaces = [None if m.name in taken.elsewhere else _translated(m, key) for m in scene.materials] or [
        None
    ] * len(scene.surfaces)
    return taken


def _translated(material: Material, key: str) -> Found:
    """A material with its colours, as the core takes it."""
    counts = COUNTS.get(material.kind)
    if counts is None or len(material.numbers) not in counts:
        what = "cannot be followed" if counts is None else f"has {len(material.numbers)} numbers, not {counts[0]}"
        raise RecipeError(
            f"{key}.file: {material.place}: {material.kind} {material.name} {what} (say what it is in "
            f"[materials.{material.name}])"
        )
    colour, rest = material.numbers[:3], material.numbers[3:]
    if material.kind == "dielectric":
        index = rest[0]
        if not (all(0.0 < t <= 1.0 for t in colour) and index >= 1.0):
            raise RecipeError(
                f"{key}.file: {material.place}: dielectric {material.name} has transmittances {colour} and an index of "
                f"{index:g} (give 0 to 1, and 1 or more)"
            )
        medium = {
            "index": [index] * 3,
            "absorption": [-math.log(t) / material.metres_per_unit for t in colour],
            "scattering": [0.0] * 3,
            "asymmetry": [0.0] * 3,
        }
        return Found(Spec("interface", {}, opaque=False), medium)
    return Found(Spec(material.kind, numbers_of(material.kind, colour, rest)))
