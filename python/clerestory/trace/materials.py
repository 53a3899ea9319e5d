"""Materials of a recipe: what a surface does with light."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from clerestory.trace.bands import Spectrum
from clerestory.trace.keys import Keys, RecipeError

if TYPE_CHECKING:
    from clerestory.trace.bands import Bands


@dataclass(frozen=True)
class Spec:
    """A material as the core takes it."""

    kind: str
    numbers: dict[str, list[float]]
    """Values by name: one a band, or one alone."""
    file: Path | None = None
    """A BSDF file that the material is."""
    opaque: bool = field(default=True)
    """No light passes."""

    def scaled(self, factor: float) -> Spec:
        """With all reflectances and transmittances multiplied."""
        shares = ("reflectance", "transmittance", "specular_reflectance", "specular_transmittance")
        numbers = {k: [factor * x for x in v] if k in shares else v for k, v in self.numbers.items()}
        return Spec(self.kind, numbers, self.file, self.opaque)


class _Material(Keys):
    def spec(self, bands: Bands, key: str, folder: Path) -> Spec:
        """The material as the core takes it.

        Raises
        ------
        RecipeError
            A value makes no sense; `key`, the material's own, is in the text.
        """
        del folder
        numbers = {
            name: self._numbers(name, bands, f"{key}.{name}") for name in type(self).model_fields if name != "kind"
        }
        self._check_shares(numbers, bands, key)
        return Spec(self._core_kind(), numbers, opaque=not any(numbers.get("transmittance", [0.0])))

    def _core_kind(self) -> str:
        return str(getattr(self, "kind"))  # noqa: B009 (each kind has its own)

    def _numbers(self, name: str, bands: Bands, key: str) -> list[float]:
        return bands.values(getattr(self, name), key)

    def _check_shares(self, numbers: dict[str, list[float]], bands: Bands, key: str) -> None:
        names = [n for n in ("reflectance", "transmittance") if n in numbers]
        for name in names:
            for band, value in zip(bands.lower, numbers[name], strict=True):
                if not 0.0 <= value <= 1.0:
                    raise RecipeError(f"{key}.{name}: {value:g} in {band} is not a share (give 0 to 1)")
        if len(names) == 2:
            for band, r, t in zip(bands.lower, *(numbers[n] for n in names), strict=True):
                if r + t > 1.0 + 1e-9:
                    raise RecipeError(
                        f"{key}: reflectance {r:g} and transmittance {t:g} in {band} are more than 1 together "
                        "(lower one of them)"
                    )


class Black(_Material):
    """Absorbs everything."""

    kind: Literal["black"]


class Lambertian(_Material):
    """Scatters evenly, to its own side and to the other."""

    kind: Literal["lambertian"]
    reflectance: Spectrum
    """Share that returns."""
    transmittance: Spectrum = 0.0
    """Share that passes."""


class Mirror(_Material):
    """Reflects like a mirror."""

    kind: Literal["mirror"]
    reflectance: Spectrum
    """Share that returns."""


class Dielectric(_Material):
    """The smooth border of a transparent body: Fresnel's equations. Bodies have it by themselves."""

    kind: Literal["dielectric"]

    def _core_kind(self) -> str:
        return "interface"

    def spec(self, bands: Bands, key: str, folder: Path) -> Spec:
        """The border as the core takes it."""
        made = super().spec(bands, key, folder)
        return Spec(made.kind, made.numbers, opaque=False)


Material = Annotated[Black | Lambertian | Mirror | Dielectric, Field(discriminator="kind")]
"""What a surface does with light."""
