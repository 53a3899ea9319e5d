"""Materials of a recipe: what a surface does with light."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field, model_validator

from clerestory.trace.bands import Spectrum
from clerestory.trace.keys import Fraction, Keys, NotNegative, Number, RecipeError, wrong

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


class _Material(Keys):
    def spec(self, bands: Bands, key: str, folder: Path) -> Spec:
        """The material as the core takes it.

        Raises
        ------
        RecipeError
            A value makes no sense; `key`, the material's own, is in the text.
        """
        del folder
        numbers = self._numbers(bands, key)
        _check_shares(numbers, bands, key)
        return Spec(self._core_kind(), numbers, opaque=self._is_opaque())

    def _core_kind(self) -> str:
        return str(getattr(self, "kind"))  # noqa: B009 (each kind has its own)

    def _is_opaque(self) -> bool:
        return True

    def _numbers(self, bands: Bands, key: str) -> dict[str, list[float]]:
        """All values by name: spectra by band, others alone."""
        numbers = {}
        for name, field_info in type(self).model_fields.items():
            if name != "kind":
                value = getattr(self, name)
                spectral = field_info.annotation == float | dict[str, float]
                numbers[name] = bands.values(value, f"{key}.{name}") if spectral else [value]
        return numbers


def _check_shares(numbers: dict[str, list[float]], bands: Bands, key: str) -> None:
    shares = ("reflectance", "transmittance", "colour", "transmissivity")
    for name in shares:
        if len(numbers.get(name, [])) == len(bands.names):
            for band, value in zip(bands.lower, numbers[name], strict=True):
                if not 0.0 <= value <= 1.0:
                    raise RecipeError(f"{key}.{name}: {value:g} in {band} is not a share (give 0 to 1)")
    if "reflectance" in numbers and "transmittance" in numbers:
        for band, r, t in zip(bands.lower, numbers["reflectance"], numbers["transmittance"], strict=True):
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

    def _is_opaque(self) -> bool:
        return _is_zero(self.transmittance)


class Mirror(_Material):
    """Reflects like a mirror."""

    kind: Literal["mirror"]
    reflectance: Spectrum
    """Share that returns."""


class Plastic(_Material):
    """Radiance's plastic: a diffuse colour under a gloss without colour."""

    kind: Literal["plastic"]
    colour: Spectrum
    """Reflectance of what is not reflected by the gloss."""
    specularity: Fraction = 0.0
    """Share that the gloss reflects."""
    roughness: NotNegative = 0.0
    """RMS slope of the surface; 0 reflects like a mirror, 0.2 is dull."""


class Metal(_Material):
    """Radiance's metal: as plastic, but the gloss has the colour, too."""

    kind: Literal["metal"]
    colour: Spectrum
    """Reflectance of both parts."""
    specularity: Fraction = 0.9
    """Share of the gloss."""
    roughness: NotNegative = 0.0
    """RMS slope of the surface; 0 reflects like a mirror, 0.2 is dull."""


class Trans(_Material):
    """Radiance's trans: a thin translucent sheet with gloss."""

    kind: Literal["trans"]
    colour: Spectrum
    """Share of what is not reflected by the gloss that goes on, reflected or transmitted."""
    specularity: Fraction = 0.0
    """Share that the gloss reflects."""
    roughness: NotNegative = 0.0
    """RMS slope of the surface."""
    transmission: Fraction
    """Share of what goes on that passes."""
    transmitted_specularity: Fraction = 0.0
    """Share of what passes that is not spread evenly."""

    def _is_opaque(self) -> bool:
        return self.transmission == 0.0


class Glass(_Material):
    """Radiance's glass: a thin clear pane without thickness, which light passes straight."""

    kind: Literal["glass"]
    transmittance: Spectrum | None = None
    """Transmittance at normal incidence; or give transmissivity."""
    transmissivity: Spectrum | None = None
    """Transmittance of one pass between the faces, at normal incidence, as Radiance has it."""
    index: Annotated[Number, Field(gt=1.0, le=4.0)] = 1.52
    """Refractive index."""

    @model_validator(mode="after")
    def _one(self) -> Glass:
        if (self.transmittance is None) == (self.transmissivity is None):
            raise wrong("transmittance", "either transmittance or transmissivity is asked for (give one of them)")
        return self

    def _is_opaque(self) -> bool:
        return False

    def _numbers(self, bands: Bands, key: str) -> dict[str, list[float]]:
        numbers = {"index": [self.index]}
        if self.transmissivity is not None:
            return {**numbers, "transmissivity": bands.values(self.transmissivity, f"{key}.transmissivity")}
        r = ((self.index - 1.0) / (self.index + 1.0)) ** 2
        wanted = bands.values(self.transmittance or 0.0, f"{key}.transmittance")
        most = (1.0 - r) ** 2 / (1.0 - r * r)
        for band, t in zip(bands.lower, wanted, strict=True):
            if not 0.0 <= t <= most:
                raise RecipeError(
                    f"{key}.transmittance: {t:g} in {band} is more than a pane of index {self.index:g} lets pass "
                    f"({most:.4f} at most)"
                )
        passed = [
            0.0 if t == 0.0 else (math.sqrt((1.0 - r) ** 4 + 4.0 * (r * t) ** 2) - (1.0 - r) ** 2) / (2.0 * r * r * t)
            for t in wanted
        ]
        return {**numbers, "transmissivity": [min(tau, 1.0) for tau in passed]}


class Dielectric(_Material):
    """The smooth border of a transparent body: Fresnel's equations. Bodies have it by themselves."""

    kind: Literal["dielectric"]

    def _core_kind(self) -> str:
        return "interface"

    def _is_opaque(self) -> bool:
        return False


def _is_zero(spectrum: float | dict[str, float]) -> bool:
    return not any(spectrum.values()) if isinstance(spectrum, dict) else spectrum == 0.0


Material = Annotated[
    Black | Lambertian | Mirror | Plastic | Metal | Trans | Glass | Dielectric, Field(discriminator="kind")
]
"""What a surface does with light."""
