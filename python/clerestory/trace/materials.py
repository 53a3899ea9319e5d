"""Materials of a recipe: what a surface does with light."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field, model_validator

from clerestory._core import ClerestoryError
from clerestory.trace.bands import Spectrum
from clerestory.trace.keys import Fraction, Keys, NotNegative, Number, Positive, RecipeError, suggestion, wrong
from clerestory.trace.reading import reading

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from clerestory.bsdf import Bsdf
    from clerestory.directions import Side
    from clerestory.trace.bands import Bands


@dataclass(frozen=True)
class Spec:
    """A material as the core takes it."""

    kind: str
    numbers: dict[str, list[float]]
    """Values by name: one a band, or one alone."""
    opaque: bool = True
    """No light passes; for a mixture, apart from its parts."""
    data: tuple[Bsdf, list[str | None], Side, tuple[float, float, float]] | None = None
    """A data set that the surface scatters like: bands, side that it shows, its upward direction."""
    parts: tuple[tuple[float, str], ...] = ()
    """Names of the materials of a mixture, with their shares."""

    def is_opaque(self, others: Mapping[str, Spec]) -> bool:
        """Whether no light passes."""
        return self.opaque and all(others[name].opaque for _, name in self.parts)

    def for_core(self, others: Mapping[str, Spec]) -> dict[str, Any]:
        """What the binding takes."""
        data = None if self.data is None else (self.data[0]._core, *self.data[1:])
        parts = [(share, others[name].for_core(others)) for share, name in self.parts]
        return {"kind": self.kind, "numbers": self.numbers, "data": data, "parts": parts}


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
        return Spec(self._core_kind(), numbers, self._is_opaque())

    def check(self, specs: Mapping[str, Spec], key: str) -> None:
        """Check what it says of other materials.

        Raises
        ------
        RecipeError
            There is no such material.
        """

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
    shares = (
        "reflectance",
        "transmittance",
        "diffuse_reflectance",
        "diffuse_transmittance",
        "colour",
        "transmissivity",
    )
    for name in shares:
        if len(numbers.get(name, [])) == len(bands.names):
            for band, value in zip(bands.lower, numbers[name], strict=True):
                if not 0.0 <= value <= 1.0:
                    raise RecipeError(f"{key}.{name}: {value:g} in {band} is not a share (give 0 to 1)")
    parts = [
        n for n in ("reflectance", "transmittance", "diffuse_reflectance", "diffuse_transmittance") if n in numbers
    ]
    for k, band in enumerate(bands.lower if "reflectance" in numbers else ()):
        values = {n: numbers[n][k] for n in parts}
        if sum(values.values()) > 1.0 + 1e-9:
            words = [f"{n.replace('_', ' ')} {v:g}" for n, v in values.items() if v > 0.0]
            raise RecipeError(f"{key}: {' and '.join(words)} in {band} are more than 1 together (lower one of them)")


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


class RoughDielectric(_Material):
    """The rough border of a transparent body, such as ground glass: facets with the distribution GGX."""

    kind: Literal["rough-dielectric"]
    roughness: Fraction
    """Alpha of Walter et al. (2007); 0 is smooth."""

    def _core_kind(self) -> str:
        return "rough interface"

    def _is_opaque(self) -> bool:
        return False


class Ggx(_Material):
    """A metal whose facets have the distribution GGX."""

    kind: Literal["ggx"]
    reflectance: Spectrum
    """Reflectance of a facet at normal incidence."""
    roughness: Fraction
    """Alpha of Walter et al. (2007); 0 is smooth."""


class _Lobe(_Material):
    reflectance: Spectrum = 0.0
    """Share in the lobe about the mirrored direction."""
    transmittance: Spectrum = 0.0
    """Share in the lobe straight on."""
    diffuse_reflectance: Spectrum = 0.0
    """Share that is scattered back evenly."""
    diffuse_transmittance: Spectrum = 0.0
    """Share that is scattered evenly to the other side."""

    def _is_opaque(self) -> bool:
        return _is_zero(self.transmittance) and _is_zero(self.diffuse_transmittance)


class Gaussian(_Lobe):
    """Gaussian lobes about the mirrored direction and straight on, and even scattering."""

    kind: Literal["gaussian"]
    width: Positive
    """Standard deviation in direction cosines: sin 1° = 0.0175."""


class Abg(_Lobe):
    """ABg lobes, A/(B + u^g) at a distance u in direction cosines, and even scattering; A follows from the share."""

    kind: Literal["abg"]
    b: Positive
    """B."""
    g: NotNegative
    """g."""


class Measured(_Material):
    """A surface that scatters like a data set: a BSDF file. It is put on with its exterior or interior out."""

    kind: Literal["bsdf"]
    file: str
    """BSDF file, relative to the recipe."""
    side: Literal["exterior", "interior"] = "exterior"
    """Side of the data set that this face of the surface is."""
    band: str | None = None
    """Band of the file for all bands; those of the same names by default."""
    up: Annotated[list[Number], Field(min_length=3, max_length=3)] = Field(default=[0.0, 1.0, 0.0])
    """Direction x, y, z in the sample that the data set's upward axis points to, as near as the surface lets it."""

    def spec(self, bands: Bands, key: str, folder: Path) -> Spec:
        """The data set, read, as the core takes it."""
        from clerestory.directions import direction
        from clerestory.files import read

        path = folder / self.file
        with reading(f"{key}.file"):
            bsdf = read(path)
        names: list[str | None] = [self.band or band for band in bands.lower]
        for name in names:
            if name is not None and name.lower() not in [b.lower() for b in bsdf.bands]:
                raise RecipeError(f"{key}: {path} has no band {name} ({suggestion(name, bsdf.bands)}; set band)")
        x, y, z = self.up
        if x == y == z == 0.0:
            raise RecipeError(f"{key}.up: [0, 0, 0] is no direction (give [0, 1, 0] for upwards)")
        normal = direction(0.0, 0.0, side=self.side)
        try:
            opaque = all(float(bsdf.integrate(normal, "transmission", band=name)) == 0.0 for name in names)
        except ClerestoryError as error:
            raise RecipeError(f"{key}.file: {path}: {error}") from None
        return Spec("measured", {}, opaque, (bsdf, names, self.side, (x, y, z)))


class Mixture(_Material):
    """Other materials side by side, finer than one sees: a print, or threads of two colours."""

    kind: Literal["mixture"]
    parts: dict[str, Fraction] = Field(min_length=1)
    """Shares by the names of the materials; what they leave of 1 is black."""

    @model_validator(mode="after")
    def _sound(self) -> Mixture:
        if sum(self.parts.values()) > 1.0 + 1e-9:
            raise wrong("parts", f"the shares sum to {sum(self.parts.values()):g} (at most 1 can be covered)")
        return self

    def spec(self, bands: Bands, key: str, folder: Path) -> Spec:
        """The shares as the core takes them."""
        del bands, key, folder
        return Spec("mixture", {}, parts=tuple((share, name) for name, share in self.parts.items()))

    def check(self, specs: Mapping[str, Spec], key: str) -> None:
        """Check that its materials are there and no mixtures themselves."""
        for name in self.parts:
            if name not in specs:
                raise RecipeError(f"{key}.parts.{name}: there is no such material ({suggestion(name, specs)})")
            if specs[name].kind == "mixture":
                raise RecipeError(f"{key}.parts.{name}: is a mixture itself (name its materials here)")


def _is_zero(spectrum: float | dict[str, float]) -> bool:
    return not any(spectrum.values()) if isinstance(spectrum, dict) else spectrum == 0.0


Material = Annotated[
    Black
    | Lambertian
    | Mirror
    | Plastic
    | Metal
    | Trans
    | Glass
    | Dielectric
    | RoughDielectric
    | Ggx
    | Gaussian
    | Abg
    | Measured
    | Mixture,
    Field(discriminator="kind"),
]
"""What a surface does with light."""
