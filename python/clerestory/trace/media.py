"""Media of a recipe: what bodies are made of."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field, model_validator

from clerestory.trace.bands import Spectrum
from clerestory.trace.keys import Keys, Number, RecipeError, wrong

if TYPE_CHECKING:
    from clerestory.trace.bands import Bands


class Medium(Keys):
    """What a body is made of. Exactly one of index, cauchy and sellmeier is given."""

    index: Spectrum | None = None
    """Refractive index."""
    cauchy: list[Number] | None = Field(default=None, min_length=1, max_length=3)
    """Coefficients A, B [µm²] and C [µm⁴] of Cauchy's formula, n = A + B/λ² + C/λ⁴; later ones may be left out."""
    sellmeier: list[Annotated[list[Number], Field(min_length=2, max_length=2)]] | None = Field(
        default=None, min_length=1, max_length=6
    )
    """Pairs B, C [µm²] of Sellmeier's formula, n² = 1 + Σ B λ²/(λ² − C)."""
    absorption_per_m: Spectrum = 0.0
    """Absorption coefficient [1/m]."""
    scattering_per_m: Spectrum = 0.0
    """Scattering coefficient [1/m] of an opal or diffusing body."""
    g: Spectrum = 0.0
    """Mean cosine of the scattering angle (Henyey-Greenstein), −1 to 1: 0 evenly, 1 forward."""

    @model_validator(mode="after")
    def _one_index(self) -> Medium:
        given = [name for name in ("index", "cauchy", "sellmeier") if getattr(self, name) is not None]
        if len(given) != 1:
            what = f"{' and '.join(given)} are both given" if given else "no refractive index is given"
            raise wrong("index", f"{what} (give exactly one of index, cauchy and sellmeier)")
        return self

    def spec(self, bands: Bands, key: str) -> dict[str, Any]:
        """The medium as the core takes it.

        Raises
        ------
        RecipeError
            A value makes no sense; `key`, the medium's own, is in the text.
        """
        spec = {
            "index": self.indices(bands, key),
            "absorption": bands.values(self.absorption_per_m, f"{key}.absorption_per_m"),
            "scattering": bands.values(self.scattering_per_m, f"{key}.scattering_per_m"),
            "asymmetry": bands.values(self.g, f"{key}.g"),
        }
        for name, value in zip(bands.lower, spec["index"], strict=True):
            if not 0.5 <= value <= 10.0:
                raise RecipeError(f"{key}.index: {value:g} in {name} is no refractive index (1.3 to 2.5 are usual)")
        for field, values in (("absorption_per_m", spec["absorption"]), ("scattering_per_m", spec["scattering"])):
            if min(values) < 0.0:
                raise RecipeError(f"{key}.{field}: {min(values):g} is below 0 (give 0 or more)")
        if any(abs(g) >= 1.0 for g in spec["asymmetry"]):
            raise RecipeError(f"{key}.g: not between −1 and 1 (0 scatters evenly, 0.9 mostly forward)")
        return spec

    def indices(self, bands: Bands, key: str) -> list[float]:
        """Refractive index by band."""
        if self.index is not None:
            return bands.values(self.index, f"{key}.index")
        if self.cauchy is not None:
            coefficients = self.cauchy
            return [
                sum(c / wavelength ** (2 * k) for k, c in enumerate(coefficients))
                for wavelength in bands.wavelengths_um(f"{key}.cauchy")
            ]
        made = []
        for wavelength in bands.wavelengths_um(f"{key}.sellmeier"):
            square = wavelength * wavelength
            terms = [(b, square - c) for b, c in self.sellmeier or ()]
            n2 = 1.0 + sum(b * square / d for b, d in terms if d != 0.0)
            if n2 <= 0.0 or any(d == 0.0 for _, d in terms):
                raise RecipeError(
                    f"{key}.sellmeier: gives no index at {1000.0 * wavelength:g} nm (C is in µm²; check the band)"
                )
            made.append(n2**0.5)
        return made
