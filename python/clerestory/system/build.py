"""From a specification to a window: files are read, recipes are traced, and every layer is checked."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from clerestory._core import ClerestoryError
from clerestory.system.glass import Plate, Sheet, Thermal
from clerestory.system.glass_files import read_glass
from clerestory.system.layer import Gap, Layer
from clerestory.system.recipe import FileKeys, GapKeys, GlassKeys, RecipeKeys, Specification
from clerestory.system.shelf import glass
from clerestory.system.traced import traced_thermal
from clerestory.system.window import Window
from clerestory.trace.keys import RecipeError
from clerestory.trace.reading import reading
from clerestory.trace.recipe import read_toml
from clerestory.trace.shipped import RECIPES, Shelf, beside

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Mapping

    from clerestory.bsdf import Bsdf
    from clerestory.system.window import Built
    from clerestory.trace import Sample

    Traced = Callable[..., Bsdf]
    """Traces a sample, with the settings of `trace.measure`."""

SYSTEMS = Shelf(Path(__file__).parent / "systems", "specification of a window", "system build")
names = SYSTEMS.names


@dataclass(frozen=True)
class Specified:
    """A specification with its layers made."""

    specification: Specification
    window: Window
    name: str
    sources: list[Path]
    """Files that were read."""
    folder: Path
    """That its files are relative to."""

    @property
    def is_sharp(self) -> bool:
        """Whether it asks for its layers' own resolution rather than patches."""
        return self.specification.system.resolution == "layers"

    def bsdf(self) -> Bsdf:
        """Its data set at the resolution that it asks for."""
        return self.sharpened() if self.is_sharp else self.solve().bsdf

    def solve(self) -> Built:
        """On the patches that it asks for."""
        keys = self.specification.system
        built = self.window.solve(keys.basis, norm=keys.standard, spectral=keys.spectral, specular=keys.specular)
        return replace(built, bsdf=self._described(built.bsdf))

    def sharpened(self) -> Bsdf:
        """At its layers' own resolution."""
        keys = self.specification.system
        return self._described(self.window.sharpened(norm=keys.standard, basis=keys.basis))

    def _described(self, bsdf: Bsdf) -> Bsdf:
        keys = self.specification.system
        size = {key: value for key, value in (("width_m", keys.width_m), ("height_m", keys.height_m)) if value}
        return bsdf.with_metadata(name=self.name, **size, **self.specification.product.fields)


def load(
    source: str | os.PathLike[str] | Mapping[str, Any],
    *,
    folder: str | os.PathLike[str] = ".",
    traced: Traced | None = None,
) -> Specified:
    """A window from a specification.

    Parameters
    ----------
    source
        A TOML file, the name of one that comes with Clerestory (`names` lists them), or tables as TOML has them.
    folder
        That the files of tables are relative to; those of a TOML file are relative to it.
    traced
        Traces the sample of a recipe, as `trace.measure` does; anew each time by default.

    Raises
    ------
    ClerestoryError
        The text names file, layer by number and name, what is wrong and the remedy.
    OSError
        A file cannot be read.
    """
    from collections.abc import Mapping

    if isinstance(source, Mapping):
        return _made(_checked(source), Path(folder), [], traced)
    path = SYSTEMS.find(str(source))
    try:
        return _made(_checked(read_toml(path)), path.parent, [path], traced)
    except ClerestoryError as error:
        text = str(error)
        raise type(error)(text if text.startswith(f"{source}:") else f"{source}: {text}") from None


def _checked(tables: Mapping[str, Any]) -> Specification:
    """The keys of a specification; faults of a layer name it by number and name."""
    try:
        return Specification.of(tables)
    except RecipeError as error:
        found = re.match(r"layers\[(\d+)\]\.?(.*)", str(error), re.DOTALL)
        if found is None:
            raise
        number = int(found[1])
        table = tables["layers"][number - 1]
        table = table if isinstance(table, dict) else {}
        name = next((str(table[key]) for key in ("name", "file", "glass", "kind") if key in table), "no name")
        # A pane's kind is a key of it too, which its place would name before the key.
        text = re.sub(r"^glass\.(?=\w)", "", found[2].removeprefix(": "))
        raise RecipeError(f"layer {number} ({name}): {text}") from None


def _made(specification: Specification, folder: Path, sources: list[Path], traced: Traced | None) -> Specified:
    solids: list[Layer] = []
    gaps: list[Gap] = []
    basis = specification.system.basis
    for number, keys in enumerate(specification.layers, 1):
        if isinstance(keys, GapKeys):
            gas = " + ".join(f"{100.0 * share:g} % {name}" for name, share in keys.shares.items())
            gaps.append(Gap(keys.name or gas, keys.width_mm / 1000.0, keys.shares))
            continue
        with reading(f"layer {number} ({_called(keys)})"):
            layer = _layer(keys, folder, basis, sources, traced)
        solids.append(replace(layer.flipped() if keys.flipped else layer, number=number))
    name = specification.system.name or " + ".join(layer.name for layer in solids)
    return Specified(specification, Window(solids, gaps), name, sources, folder)


def _called(keys: GlassKeys | FileKeys | RecipeKeys) -> str:
    """What a layer is called before it is made."""
    if keys.name is not None:
        return keys.name
    if isinstance(keys, RecipeKeys):
        return keys.recipe if isinstance(keys.recipe, str) else "recipe"
    return keys.file or getattr(keys, "glass", None) or keys.kind


def _layer(
    keys: GlassKeys | FileKeys | RecipeKeys,
    folder: Path,
    basis: str,
    sources: list[Path],
    traced: Traced | None,
) -> Layer:
    if isinstance(keys, GlassKeys):
        return _glass(keys, folder, sources)
    if isinstance(keys, FileKeys):
        return _file(keys, folder, sources)
    return _of_recipe(keys, folder, basis, sources, traced)


def _thermal(keys: GlassKeys | FileKeys | RecipeKeys, known: Thermal) -> Thermal:
    """What the specification says goes before what the file says."""
    given: dict[str, Any] = {
        key: value
        for key in ("emissivity_exterior", "emissivity_interior", "tir", "conductivity", "openness")
        if (value := getattr(keys, key)) is not None
    }
    if keys.thickness_mm is not None:
        given["thickness_m"] = keys.thickness_mm / 1000.0
    found = replace(known, **given)
    edges = keys.edges_mm
    if edges is None:
        return found
    top, bottom, left, right = (mm / 1000.0 for mm in (edges.top, edges.bottom, edges.left, edges.right))
    return replace(found, edges_m=(top, bottom, left, right))


def _glass(keys: GlassKeys, folder: Path, sources: list[Path]) -> Layer:
    if keys.file is not None:
        path = folder / keys.file
        sources.append(path)
        pane = read_glass(path, angles=keys.angles, roos_category=keys.roos_category)
        return _pane_layer(keys, pane, pane.warnings)
    if keys.glass is not None:
        assert keys.thickness_mm is not None
        return _pane_layer(keys, glass(keys.glass, keys.thickness_mm / 1000.0), ())
    assert keys.sheets is not None
    made = tuple(
        Sheet(550.0, sheet.refractive_index, sheet.extinction, sheet.thickness_mm / 1000.0)  # type: ignore[arg-type]
        for sheet in keys.sheets
    )
    thermal = Thermal(thickness_m=sum(sheet.thickness_m for sheet in made))
    return _pane_layer(keys, Plate(keys.name or "plate", made, thermal), ())


def _pane_layer(keys: GlassKeys, pane: Any, warnings: tuple[str, ...]) -> Layer:  # noqa: ANN401 (Glass or Plate)
    thermal = _thermal(keys, pane.thermal)
    return Layer(keys.name or pane.name, pane=replace(pane, thermal=thermal), thermal=thermal, warnings=tuple(warnings))


def _file(keys: FileKeys, folder: Path, sources: list[Path]) -> Layer:
    from clerestory.files import read

    path = folder / keys.file
    sources.append(path)
    bsdf = read(path)
    found = bsdf.metadata
    if keys.rotated_deg:
        bsdf = bsdf.rotated(keys.rotated_deg)
    if keys.separate_peaks:
        bsdf = bsdf.separate_peaks()
    known = Thermal(
        found.thickness_m,
        found.thermal_conductivity,
        found.emissivity_exterior,
        found.emissivity_interior,
        found.tir,
        found.openness,
    )
    warnings = tuple(text.removeprefix(f"{path}: ") for text in bsdf.warnings)
    return Layer(
        keys.name or found.name or Path(keys.file).name, bsdf=bsdf, thermal=_thermal(keys, known), warnings=warnings
    )


def sample_of(keys: RecipeKeys, folder: Path) -> Sample:
    """The sample of a layer that is a recipe; files are relative to a folder."""
    from clerestory.trace import Sample
    from clerestory.trace.recipe import Recipe, changed

    if isinstance(keys.recipe, dict):
        return Sample(Recipe.of(changed(keys.recipe, keys.changed)), folder)
    path = beside(keys.recipe, folder, RECIPES)
    try:
        return Sample(Recipe.of(changed(read_toml(path), keys.changed)), path.parent)
    except RecipeError as error:
        raise RecipeError(f"{keys.recipe}: {error}") from None


def _of_recipe(keys: RecipeKeys, folder: Path, basis: str, sources: list[Path], traced: Traced | None) -> Layer:
    from clerestory import trace

    sample = sample_of(keys, folder)
    if isinstance(keys.recipe, str):
        sources.append(beside(keys.recipe, folder, RECIPES))
    measured = (traced or trace.measure)(
        sample,
        basis=keys.basis or basis,
        resolution=keys.resolution,
        samples=keys.samples,
        error=keys.error,
        seed=keys.seed,
    )
    return Layer(
        keys.name or sample.name,
        bsdf=measured,
        thermal=_thermal(keys, traced_thermal(sample, measured)),
        warnings=tuple(sample.warnings),
    )
