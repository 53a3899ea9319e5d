"""What a product is made of, as a list of plain values: its manifest."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING, Any

from clerestory.system.recipe import FileKeys, GapKeys, GlassKeys, RecipeKeys

if TYPE_CHECKING:
    from pathlib import Path

    from clerestory.bsdf import Bsdf
    from clerestory.system.build import Specified
    from clerestory.system.glass import Thermal
    from clerestory.trace import Sample

THERMAL = ("thickness_m", "conductivity", "emissivity_exterior", "emissivity_interior", "tir", "openness")


def components_of_window(made: Specified) -> tuple[dict[str, Any], ...]:
    """Layers and gaps of a window, from the exterior to the interior, counted as in its specification.

    Returns
    -------
    Of each its number, kind and name; of a layer its thermal properties, by their names in `Thermal`, as far as they
    are known, and its file with the SHA-256 of that; of a gap its width [m] and its gas.
    """
    found: list[dict[str, Any]] = []
    solids, gaps = iter(made.window.layers), iter(made.window.gaps)
    for number, keys in enumerate(made.specification.layers, 1):
        if isinstance(keys, GapKeys):
            gap = next(gaps)
            found.append({"number": number, "kind": "gap", "name": gap.name, "width_m": gap.width_m, "gas": gap.gas})
            continue
        layer = next(solids)
        entry: dict[str, Any] = {"number": number, "kind": keys.kind, "name": layer.name}
        if isinstance(keys, RecipeKeys) and isinstance(keys.recipe, str):
            entry["recipe"] = keys.recipe
        if isinstance(keys, (FileKeys, GlassKeys)) and keys.file is not None:
            entry |= {"file": keys.file, "sha256": sha256(made.folder / keys.file)}
        if keys.flipped:
            entry["flipped"] = True
        found.append(entry | _thermal(layer.thermal))
    return tuple(found)


def components_of_sample(sample: Sample, measured: Bsdf) -> tuple[dict[str, Any], ...]:
    """A sample of the virtual goniophotometer as the one component of a product."""
    from clerestory.system.traced import traced_thermal

    entry = {"number": 1, "kind": "recipe", "name": sample.name, "sample": sample.recipe.sample.kind}
    return (entry | _thermal(traced_thermal(sample, measured)),)


def sha256(path: Path) -> str:
    """Of a file's content."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _thermal(known: Thermal) -> dict[str, float]:
    return {name: float(value) for name in THERMAL if (value := getattr(known, name)) is not None}
