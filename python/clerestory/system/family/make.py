"""From a specification of a family to its data sets."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from clerestory import trace
from clerestory._core import ClerestoryError
from clerestory.bsdf import Bsdf
from clerestory.files import named
from clerestory.model import Model
from clerestory.system import build
from clerestory.system.components import components_of_sample, components_of_window
from clerestory.system.dataset import data_set
from clerestory.system.exchange import described
from clerestory.system.family import place as places
from clerestory.system.family.family import Family, State, mixed, state_name
from clerestory.system.family.keys import HEIGHT, FamilyKeys, Head
from clerestory.trace.keys import RecipeError
from clerestory.trace.reading import reading
from clerestory.trace.recipe import Recipe, changed, read_toml
from clerestory.trace.shipped import RECIPES, beside

if TYPE_CHECKING:
    import os

    from clerestory.directions import Scatter, Side
    from clerestory.system.build import Traced
    from clerestory.system.family.place import Place
    from clerestory.system.product import ProductKeys


@dataclass(frozen=True)
class Product:
    """The tables of what changes."""

    tables: dict[str, Any]
    folder: Path
    """That its files are relative to."""
    name: str
    path: Path | None
    """Its own file, where it has one."""

    @property
    def is_window(self) -> bool:
        """Whether it is a window of layers, rather than one sample."""
        return "layers" in self.tables


@dataclass(frozen=True)
class Planned:
    """A family that is specified and not yet made."""

    keys: FamilyKeys
    about: ProductKeys
    product: Product
    place: Place | None
    """Of the parameter in the product's tables; none for a height."""
    folder: Path
    """Of the specification."""
    sources: list[Path]
    """Files that were read."""
    notes: list[str] = field(default_factory=list)
    """What was assumed of layers, and what is not known of them, once it is made."""

    @property
    def name(self) -> str:
        """Of the family."""
        return self.keys.name or self.product.name

    @property
    def slats_mm(self) -> dict[str, float] | None:
        """Width, pitch and crown of the slats that tilt [mm]."""
        if self.place is None or self.place[-1] != "tilt_deg":
            return None
        blind = places.get(self.product.tables, self.place[:-1])
        slat = blind.get("slat")
        if blind.get("kind") != "venetian-blind" or not isinstance(slat, dict):
            return None
        return {
            "width": float(slat["width_mm"]),
            "pitch": float(blind["pitch_mm"]),
            "crown": float(slat.get("crown_mm", 0.0)),
        }

    def make(self, traced: Traced | None = None) -> Family:
        """The data set of every value.

        Parameters
        ----------
        traced
            Traces a sample, as `trace.measure` does; anew each time by default.

        Raises
        ------
        ClerestoryError
            A state cannot be made; the text names it.
        """
        states: list[State] = []
        if self.place is None:
            whole, components = self._made(self.product.tables, traced)
            open_ = State("without the product", 0.0, self._without(whole, traced))
            lowered = State("the product", 1.0, whole)
            for value in self.keys.values:
                shares = [(value, lowered), (1.0 - value, open_)]
                states.append(self._state(value, mixed([pair for pair in shares if pair[0] > 0.0]), components))
        for value in self.keys.values if self.place is not None else ():
            assert self.place is not None
            name = state_name(self.keys.parameter, value)
            try:
                bsdf, components = self._made(places.put(self.product.tables, self.place, value), traced)
            except ClerestoryError as error:
                raise type(error)(f"state {name}: {error}") from None
            states.append(self._state(value, bsdf, components))
        parameter = self.keys.parameter if self.place is None else str(self.place[-1])
        orientation = None if self.about.orientation is None else self.about.orientation.made()
        return Family(self.name, parameter, tuple(states), self.slats_mm, orientation)

    def _state(self, value: float, bsdf: Bsdf, components: tuple[dict[str, Any], ...]) -> State:
        name = state_name(self.keys.parameter, value)
        described = bsdf.with_metadata(name=f"{self.name}, {name}", **self.about.fields)
        return State(name, value, described, components)

    def _made(self, tables: dict[str, Any], traced: Traced | None) -> tuple[Bsdf, tuple[dict[str, Any], ...]]:
        if self.product.is_window:
            made = build.load(tables, folder=self.product.folder, traced=traced)
            self.sources.extend(path for path in made.sources if path not in self.sources)
            return self._described(made, made.bsdf()), components_of_window(made)
        sample = trace.Sample(Recipe.of(tables), self.product.folder)
        keys = self.keys
        measured = (traced or trace.measure)(
            sample,
            basis=keys.basis or "klems-full",
            resolution=keys.resolution,
            samples=keys.samples,
            error=keys.error,
            seed=keys.seed,
        )
        return measured, components_of_sample(sample, measured)

    def _without(self, product: Bsdf, traced: Traced | None) -> Bsdf:
        """What the window is where the product is not; an opening has the product's bands and sides."""
        given = self.keys.without
        if given is None:
            return Bsdf.from_models(
                {band: {key: _opening(*key) for key in members} for band, members in product.models.items()}
            )
        with reading("family.without"):
            found = data_set(given, self.folder, traced=traced)
        self.sources.extend(path for path in found.sources if path not in self.sources)
        bsdf = found.bsdf if found.window is None else self._described(found.window, found.bsdf)
        beyond = [band for band in bsdf.bands if band not in product.bands]
        if not beyond:
            return bsdf
        if len(beyond) == len(bsdf.bands):
            raise RecipeError(
                f"family.without: {found.name} has {', '.join(bsdf.bands)}, the product {', '.join(product.bands)} "
                "(build both with the same bands)"
            )
        self.notes.append(f"{found.name}: {', '.join(beyond)} left out, which the product has not")
        return Bsdf.merged([bsdf.only_band(band) for band in bsdf.bands if band not in beyond])

    def _described(self, made: build.Specified, bsdf: Bsdf) -> Bsdf:
        found, notes = described(made, bsdf)
        self.notes.extend(note for note in notes if note not in self.notes)
        return found


def load(source: str | os.PathLike[str]) -> Planned:
    """A family from its specification, read and checked.

    Parameters
    ----------
    source
        A TOML file with a table `family`, and a recipe or the specification of a window beside it, or its name in it.

    Raises
    ------
    RecipeError
        The text names file, key, what is wrong and the remedy.
    OSError
        A file cannot be read.
    """
    path = Path(source)
    try:
        return _planned(read_toml(path), path)
    except RecipeError as error:
        raise RecipeError(f"{path}: {error}") from None


def _planned(tables: dict[str, Any], path: Path) -> Planned:
    if not isinstance(tables.get("family"), dict):
        raise RecipeError("family: is missing (add a table [family] with parameter and values)")
    head = Head.of({key: tables.pop(key) for key in ("family", "product") if key in tables})
    keys = head.family
    if (keys.product is None) != bool(tables):
        raise RecipeError(
            "family.product: "
            + (
                "is missing (give a recipe or a specification of a window, or put its tables beside [family])"
                if not tables
                else f"is given, and so are tables beside [family]: {', '.join(tables)} (leave one of them out)"
            )
        )
    product = (
        Product(tables, path.parent, keys.name or path.stem, None)
        if keys.product is None
        else _product(keys.product, path.parent)
    )
    if not (product.is_window or "sample" in product.tables):
        raise RecipeError(
            "family.product: neither a recipe nor a window (a recipe has a table [sample], a window has [[layers]])"
        )
    given = keys.model_fields_set & {"basis", "resolution", "samples", "error", "seed"}
    if product.is_window and given:
        raise RecipeError(f"family.{sorted(given)[0]}: goes with a recipe; a window's layers say it (leave it out)")
    sources = [path, *([product.path] if product.path else [])]
    opened = Product(_with_recipes(product, sources), product.folder, product.name, product.path)
    place = None if keys.parameter == HEIGHT else places.find(opened.tables, keys.parameter)
    return Planned(keys, head.product, opened, place, path.parent, sources)


def _product(given: str, folder: Path) -> Product:
    with reading("family.product"):
        found = beside(given, folder, RECIPES, build.SYSTEMS)
        with named(found):
            tables = read_toml(found)
    return Product(tables, found.parent, found.stem, found)


def _with_recipes(product: Product, sources: list[Path]) -> dict[str, Any]:
    """The tables, with the sample of each layer's recipe put where the layer says what is changed of it.

    So a parameter of the recipe is a key of the window, and files that the recipe names stay relative to it.
    """
    layers = product.tables.get("layers")
    if not isinstance(layers, list):
        return product.tables
    made = []
    for number, layer in enumerate(layers, 1):
        recipe = layer.get("recipe") if isinstance(layer, dict) else None
        if not isinstance(recipe, str):
            made.append(layer)
            continue
        with reading(f"layer {number} ({layer.get('name', recipe)})"):
            path = beside(recipe, product.folder, RECIPES)
            with named(path):
                sample = read_toml(path).get("sample")
        sources.append(path)
        given = layer.get("changed", {})
        made.append({**layer, "changed": changed({"sample": sample}, given) if isinstance(given, dict) else given})
    return {**product.tables, "layers": made}


def _opening(side: Side, scatter: Scatter) -> Model:
    del side
    return Model.specular(1.0) if scatter == "transmission" else Model.lambertian(0.0)
