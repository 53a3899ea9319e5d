"""Samples: what a recipe describes, ready to be measured."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from clerestory import _core
from clerestory.trace.keys import RecipeError
from clerestory.trace.materials import Measured, Spec
from clerestory.trace.media import Medium
from clerestory.trace.recipe import Recipe, read_toml
from clerestory.trace.shapes import AIR, Section, Solids
from clerestory.trace.shipped import RECIPES
from clerestory.trace.workshop import SMOOTH, Workshop

if TYPE_CHECKING:
    from clerestory.trace.shapes import Face, Shape


class Sample:
    """What rays can meet: made by `load`, or by the functions named after the kinds of samples."""

    def __init__(self, recipe: Recipe, folder: str | os.PathLike[str] = ".", *, source: str = "") -> None:
        """From a recipe.

        Parameters
        ----------
        recipe
            The recipe.
        folder
            Files that it names are relative to this one.
        source
            The recipe's text, to be recorded; from the recipe itself by default.

        Raises
        ------
        RecipeError
            The sample cannot be; the text names the key.
        """
        self.recipe = recipe
        self.source = source or _as_text(recipe.model_dump(exclude_unset=True))
        """The recipe, as it is recorded in outputs."""
        folder = Path(folder)
        self._specs: dict[str, Spec] = {SMOOTH: Spec("interface", {}, opaque=False)}
        for name, material in recipe.materials.items():
            self._specs[name] = material.spec(recipe.bands, f"materials.{name}", folder)
        for name, material in recipe.materials.items():
            material.check(self._specs, f"materials.{name}")
        self._media = {AIR: Medium(index=1.0).spec(recipe.bands, AIR)}
        for name, medium in recipe.media.items():
            if name == AIR:
                raise RecipeError(f"media.{name}: air is always there (choose another name)")
            self._media[name] = medium.spec(recipe.bands, f"media.{name}")
        shop = Workshop(folder, self._specs, self._media, recipe.bands)
        self.shapes: list[Shape] = recipe.sample.placed(shop, "sample")
        """Its layers, from the exterior to the interior."""
        self.files = [*shop.files, *(folder / m.file for m in recipe.materials.values() if isinstance(m, Measured))]
        """Files that it was made from, beside the recipe."""
        self.warnings = shop.warnings
        """What is surprising in the recipe."""
        self.core()  # Whatever the core objects to comes now.

    @property
    def name(self) -> str:
        """What it is called."""
        return self.recipe.sample.name or self.recipe.sample.kind.replace("-", " ")

    @property
    def device(self) -> str:
        """The kind of device, as data sets name it."""
        return self.recipe.sample.kind.replace("-", " ").capitalize()

    @property
    def bands(self) -> list[str]:
        """The bands that are traced."""
        return self.recipe.bands.lower

    @property
    def depth_m(self) -> tuple[float, float]:
        """Least and greatest z [m]."""
        low, high = self.core().depth()
        return low, high

    @property
    def openness(self) -> float | None:
        """Open share of the area, seen along the normal, of fabrics and perforated screens."""
        return getattr(self.recipe.sample, "open_fraction", None)

    def content(self) -> list[bytes]:
        """The content of the files that it was made from."""
        return [path.read_bytes() for path in self.files]

    def core(self) -> _core.Sample:
        """The sample as the core takes it; anew at every call."""
        faces: dict[Face, int] = {}
        layers = []
        for shape in self.shapes:
            try:
                layers.append(_geometry(shape, faces))
            except _core.ClerestoryError as error:
                raise RecipeError(f"sample: {error}") from error
        specs = list(self._specs)
        media = list(self._media)
        surfaces = [
            ((specs.index(f.front), specs.index(f.back)), (media.index(f.before), media.index(f.behind))) for f in faces
        ]
        materials = [spec.for_core(self._specs) for spec in self._specs.values()]
        try:
            return _core.Sample(self.bands, layers, surfaces, materials, list(self._media.values()))
        except _core.ClerestoryError as error:
            named = ", ".join(f"{k} {name}" for k, name in enumerate(media))
            hint = f"; media: {named}" if "medium" in str(error) or "media" in str(error) else ""
            raise RecipeError(f"sample: {error}{hint}") from error


def _geometry(shape: Shape, faces: dict[Face, int]) -> _core.Geometry:
    """A shape as the core takes it; its surfaces are added to those that are known."""

    def number(face: Face) -> int:
        return faces.setdefault(face, len(faces))

    if isinstance(shape, Section):
        rows = np.array([[*p.start, *p.end, p.turn] for p in shape.pieces], dtype=np.float64)
        surfaces = np.array([number(p.face) for p in shape.pieces], dtype=np.uint32)
        return _core.Geometry.profile(rows, surfaces, shape.period)
    numbers = [number(face) for face in shape.faces]
    if isinstance(shape, Solids):
        limits = [list(pair) for pair in shape.limits]
        repeats = [shape.repeats, shape.repeats]
        return _core.Geometry.mesh(shape.scene, numbers, limits, repeats, shape.z)
    scene = _core.Scene.of_triangles(
        np.ascontiguousarray(shape.corners),
        np.ascontiguousarray(shape.triangles, dtype=np.int64),
        np.ascontiguousarray(shape.face, dtype=np.uint32),
        [f"surface {k + 1} ({face.front})" for k, face in enumerate(shape.faces)],
    )
    limits = [[0.0, shape.periods[0]], [0.0, shape.periods[1]]]
    return _core.Geometry.mesh(scene, numbers, limits, [True, True], 0.0)


def load(source: str | os.PathLike[str] | Mapping[str, Any] | Sample) -> Sample:
    """A sample from a recipe.

    Parameters
    ----------
    source
        A TOML file, the name of a recipe that comes with Clerestory (`names` lists them), or tables as TOML has them.

    Raises
    ------
    RecipeError
        The text names file, key, what is wrong and the remedy.
    OSError
        A file cannot be read.

    Examples
    --------
    >>> from clerestory import trace
    >>> trace.load("round-robin-blind").bands
    ['visible']
    """
    if isinstance(source, Sample):
        return source
    if isinstance(source, Mapping):
        return Sample(Recipe.of(source))
    path = RECIPES.find(os.fspath(source))
    shown = str(source)
    try:
        tables = read_toml(path)
        return Sample(Recipe.of(tables), path.parent, source=path.read_text(encoding="utf-8"))
    except RecipeError as error:
        raise RecipeError(f"{shown}: {error}") from None


def _as_text(value: dict[str, Any], place: str = "") -> str:
    """Tables as TOML."""
    lines, below = [], []
    for key, member in value.items():
        if isinstance(member, dict):
            below.append(_as_text(member, f"{place}.{key}".strip(".")))
        else:
            lines.append(f"{key} = {_literal(member)}")
    head = [f"[{place}]"] if place and lines else []
    return "\n".join([*head, *lines, *below])


def _literal(value: object) -> str:
    if isinstance(value, str):
        import json

        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(_literal(v) for v in value)}]"
    if isinstance(value, dict):
        return f"{{ {', '.join(f'{k} = {_literal(v)}' for k, v in value.items())} }}"
    return repr(value)
