"""Materials of Radiance scenes, as the tracer has them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from clerestory.photometry import LUMINANCE
from clerestory.trace.keys import RecipeError
from clerestory.trace.materials import Spec
from clerestory.trace.shapes import Face

if TYPE_CHECKING:
    from clerestory.trace.workshop import Workshop

COUNTS = {"plastic": (5,), "metal": (5,), "trans": (7,), "glass": (3, 4), "mirror": (3,), "dielectric": (5,)}


@dataclass(frozen=True)
class Found:
    """A material of a scene."""

    name: str
    kind: str
    words: list[str]
    numbers: list[float]
    metres_per_unit: float
    """Metres that a unit of length in the file is."""
    place: str
    """File and line."""


def translated(found: Found, shop: Workshop, key: str) -> Face:
    """The surface of a material; its colours count by their brightness, in all bands.

    Raises
    ------
    RecipeError
        It cannot be traced; the text says what to write into the recipe instead.
    """
    counts = COUNTS.get(found.kind)
    instead = f"say what it is in [{key}.surfaces.{found.name}]"
    if counts is None:
        raise RecipeError(f"{key}.file: {found.place}: {found.kind} {found.name} cannot be traced as it is ({instead})")
    if len(found.numbers) not in counts:
        raise RecipeError(
            f"{key}.file: {found.place}: {found.kind} {found.name} has {len(found.numbers)} numbers, not {counts[0]} "
            "(correct the scene)"
        )
    red, green, blue, *rest = found.numbers
    if not red == green == blue and found.kind != "dielectric":
        shop.warnings.append(f"{found.place}: the colour of {found.name} counts as grey, by its brightness")
    grey = sum(float(w) * c for w, c in zip(LUMINANCE, (red, green, blue), strict=True))
    bands = len(shop.bands.names)
    if found.kind == "dielectric":
        return _body(found, grey, rest[0], shop, key)
    passes = found.kind == "glass" or (found.kind == "trans" and rest[2] > 0.0)
    numbers = numbers_of(found.kind, [grey] * bands, rest)
    name = shop.add_material(found.name, Spec(found.kind, numbers, opaque=not passes))
    return Face(name, name)


def numbers_of(kind: str, colour: list[float], rest: list[float]) -> dict[str, list[float]]:
    """A material's numbers by the names of the core: its colour by band, and what follows it in the file."""
    if kind == "glass":
        return {"transmissivity": colour, "index": [rest[0] if rest else 1.52]}
    if kind == "mirror":
        return {"reflectance": colour}
    names = ("specularity", "roughness", "transmission", "transmitted_specularity")
    return {"colour": colour, **{name: [value] for name, value in zip(names, rest, strict=False)}}


def _body(found: Found, transmittance: float, index: float, shop: Workshop, key: str) -> Face:
    """A dielectric: its transmittance is that of one unit of length of the file."""
    if not (0.0 < transmittance <= 1.0 and index >= 1.0):
        raise RecipeError(
            f"{key}.file: {found.place}: dielectric {found.name} has a transmittance of {transmittance:g} and an index "
            f"of {index:g} (give 0 to 1, and 1 or more)"
        )
    bands = len(shop.bands.names)
    medium = shop.add_medium(
        found.name,
        {
            "index": [index] * bands,
            "absorption": [-math.log(transmittance) / found.metres_per_unit] * bands,
            "scattering": [0.0] * bands,
            "asymmetry": [0.0] * bands,
        },
    )
    return shop.body(key, medium)
