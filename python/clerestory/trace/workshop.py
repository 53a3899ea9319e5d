"""Where the kinds of samples get their surfaces: names of materials and media are checked here."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeVar

from clerestory.trace.keys import RecipeError, suggestion
from clerestory.trace.shapes import AIR, Face

if TYPE_CHECKING:
    from pathlib import Path

    from clerestory.trace.bands import Bands
    from clerestory.trace.materials import Spec

T = TypeVar("T")

SMOOTH = "smooth border"
"""The material of a body's surface that is not given another."""


@dataclass
class Workshop:
    """What a recipe offers to the kinds of samples."""

    folder: Path
    """Files are named relative to it."""
    materials: dict[str, Spec]
    """Its materials by name, and `SMOOTH`."""
    media: dict[str, dict[str, list[float]]]
    """Its media by name; air is always there."""
    bands: Bands
    """Its bands."""
    files: list[Path] = field(default_factory=list)
    """Files that were read."""
    warnings: list[str] = field(default_factory=list)
    """What is surprising, but can be."""

    def sheet(self, key: str, front: str, back: str, *, names: tuple[str, str] = ("upper", "lower")) -> Face:
        """A thin surface in air.

        Parameters
        ----------
        key
            The table that names the materials.
        front, back
            The materials.
        names
            The keys of both in that table.
        """
        self._material(f"{key}.{names[0]}", front)
        self._material(f"{key}.{names[1]}", back)
        return Face(front, back)

    def skin(self, key: str, material: str) -> Face:
        """The surface of a thick opaque thing: its front is outside.

        Raises
        ------
        RecipeError
            Light passes the material.
        """
        if not self._material(key, material).is_opaque(self.materials):
            raise RecipeError(
                f"{key}: light passes {material}, so that it cannot be the skin of something thick "
                "(leave the thickness out, or give a body with a medium)"
            )
        return Face(material, material)

    def yarn(self, key: str, material: str) -> Face:
        """The surface of a yarn, opaque or not: its front is outside."""
        self._material(key, material)
        return Face(material, material)

    def body(self, key: str, medium: str, surface: str | None = None, *, surface_key: str = "surface") -> Face:
        """The surface of a transparent body: its front is outside, in air."""
        if medium == AIR or medium not in self.media:
            known = sorted(self.media.keys() - {AIR})
            hint = suggestion(medium, known) if known else f"add [media.{medium}]"
            raise RecipeError(f"{key}.medium: there is no medium {medium!r} ({hint})")
        material = SMOOTH if surface is None else surface
        if surface is not None:
            self._material(f"{key}.{surface_key}", surface)
        return Face(material, material, AIR, medium)

    def add_material(self, name: str, spec: Spec) -> str:
        """Take over a material of a file; the name by which it is known."""
        return _added(self.materials, name, spec)

    def add_medium(self, name: str, spec: dict[str, list[float]]) -> str:
        """Take over a medium of a file; the name by which it is known."""
        return _added(self.media, name, spec)

    def _material(self, key: str, name: str) -> Spec:
        known = [m for m in self.materials if m != SMOOTH]
        if name not in known:
            hint = suggestion(name, known) if known else f"add [materials.{name}]"
            raise RecipeError(f"{key}: there is no material {name!r} ({hint})")
        return self.materials[name]


def _added(known: dict[str, T], name: str, value: T) -> str:
    """Add a value under a name that is not in use for another one."""
    unique, k = name, 1
    while unique in known and known[unique] != value:
        k += 1
        unique = f"{name} ({k})"
    known[unique] = value
    return unique
