"""Any geometry: Radiance scenes, and meshes of other programs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field, model_validator

from clerestory import _core
from clerestory.files import named
from clerestory.trace.keys import Keys, Number, Positive, RecipeError, suggestion, wrong
from clerestory.trace.kinds.common import Kind
from clerestory.trace.kinds.radiance import Found, translated
from clerestory.trace.reading import reading
from clerestory.trace.shapes import Solids

if TYPE_CHECKING:
    from collections.abc import Sequence

    from clerestory.trace.shapes import Face
    from clerestory.trace.workshop import Workshop

UNITS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "inch": 0.0254, "foot": 0.3048}
SUFFIXES = (".rad", ".obj", ".stl", ".ply")


class Skin(Keys):
    """What a surface of a scene is."""

    material: str | None = None
    """Material of both sides, or of the border of a body; the smooth border of the medium by default."""
    back: str | None = None
    """Material of the back, for thin surfaces whose sides differ."""
    medium: str | None = None
    """What the closed body that it encloses is made of; its fronts are outside."""

    @model_validator(mode="after")
    def _sound(self) -> Skin:
        if self.material is None and self.medium is None:
            raise wrong("material", "is missing (name a material, or a medium for a transparent body)")
        if self.medium is not None and self.back is not None:
            raise wrong("back", "a body has one material for both faces of its border (give material only)")
        return self

    def face(self, shop: Workshop, key: str) -> Face:
        """The surface."""
        if self.medium is not None:
            return shop.body(key, self.medium, self.material, surface_key="material")
        front = self.material or ""
        return shop.sheet(key, front, self.back or front, names=("material", "back"))


class SceneSample(Kind):
    """Geometry from a file: a Radiance scene, Wavefront OBJ, STL or PLY, with +z into the room and +y up."""

    kind: Literal["scene"]
    file: str
    """File ending in .rad, .obj, .stl or .ply, relative to the recipe."""
    unit: Literal["m", "cm", "mm", "um", "inch", "foot"]
    """What a length of 1 in the file is."""
    period_mm: Annotated[list[Positive], Field(min_length=2, max_length=2)] | None = None
    """The scene is repeated at these distances along x and y [mm]."""
    region_mm: Annotated[list[Number], Field(min_length=4, max_length=4)] | None = None
    """Instead of a period: rays start in this part of the plane, x from, x to, y from, y to [mm]. Light that leaves the
    scene at its edges is gone, so the scene has to reach far beyond."""
    surfaces: dict[str, Skin] = Field(default_factory=dict)
    """What the surfaces are, by the names of the file's materials or groups; `*` stands for all others. A scene of
    Radiance has materials of its own, which these replace."""

    @model_validator(mode="after")
    def _sound(self) -> SceneSample:
        if (self.period_mm is None) == (self.region_mm is None):
            raise wrong("period_mm", "either period_mm or region_mm is asked for (give one of them)")
        if self.region_mm is not None:
            x0, x1, y0, y1 = self.region_mm
            if not (x0 < x1 and y0 < y1):
                raise wrong("region_mm", f"{self.region_mm} is empty (give x from, x to, y from, y to)")
        return self

    def shapes(self, shop: Workshop, key: str) -> list[Solids]:
        """The scene."""
        path = shop.folder / self.file
        scene, found = self._read(str(path), f"{key}.file")
        shop.files.append(path)
        shop.warnings += [f"{path}: {text}" for text in scene.warnings]
        faces = self._faces(scene.surfaces, found, shop, key)
        if self.period_mm is not None:
            limits = ((0.0, self.period_mm[0] / 1000.0), (0.0, self.period_mm[1] / 1000.0))
        else:
            x0, x1, y0, y1 = (mm / 1000.0 for mm in self.region_mm or ())
            limits = ((x0, x1), (y0, y1))
        bounds = scene.bounds()
        if bounds is None:
            raise RecipeError(f"{key}.file: {path} holds no surfaces (check the file)")
        size = max(high - low for low, high in zip(*bounds, strict=True))
        if not 1e-5 < size < 100.0:
            shop.warnings.append(f"{key}.unit: the scene is {size:.3g} m large in {self.unit} (check the unit)")
        return [Solids(scene, tuple(faces), limits, self.period_mm is not None)]

    def _read(self, path: str, key: str) -> tuple[_core.Scene, list[Found]]:
        suffix = next((s for s in SUFFIXES if path.lower().endswith(s)), None)
        if suffix is None:
            raise RecipeError(f"{key}: {path} is of no known format (give one ending in .rad, .obj, .stl or .ply)")
        with reading(key), named(Path(path)):
            if suffix == ".rad":
                scene = _core.Scene.radiance(path, UNITS[self.unit])
                return scene, [Found(*row) for row in scene.materials()]
            return getattr(_core.Scene, suffix[1:])(path, UNITS[self.unit]), []

    def _faces(self, names: Sequence[str], found: list[Found], shop: Workshop, key: str) -> list[Face]:
        for name in self.surfaces:
            if name != "*" and name not in names:
                raise RecipeError(f"{key}.surfaces.{name}: the file has no such surface ({suggestion(name, names)})")
        faces = []
        for k, name in enumerate(names):
            skin = self.surfaces.get(name) or self.surfaces.get("*")
            if skin is not None:
                faces.append(skin.face(shop, f"{key}.surfaces.{name if name in self.surfaces else '*'}"))
            elif found:
                faces.append(translated(found[k], shop, key))
            else:
                raise RecipeError(
                    f"{key}.surfaces: nothing is said of {name!r} (add [{key}.surfaces.{name!r}], or '*')"
                )
        return faces
