"""Bands of a recipe, and values by band."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BeforeValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from clerestory.counts import counted
from clerestory.trace.keys import Keys, Positive, RecipeError, suggestion, wrong


def _spectrum(value: Any) -> Any:  # noqa: ANN401 (anything that TOML can hold)
    if isinstance(value, dict):
        if value and all(_is_number(v) for v in value.values()):
            return {str(band).lower(): float(v) for band, v in value.items()}
    elif _is_number(value):
        return float(value)
    raise PydanticCustomError("spectrum", "a number, or a table of numbers by band such as { visible = 0.5 }")


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and -1e300 < value < 1e300


Spectrum = Annotated[float | dict[str, float], BeforeValidator(_spectrum)]
"""A number for all bands, or a table of numbers by the names of the bands."""


class Bands(Keys):
    """The bands that are traced, all in one run."""

    names: list[str] = Field(default=["visible"], min_length=1)
    """Their names: visible, solar, nir, thermal, 550 nm, …"""
    wavelengths_nm: list[Positive] | None = None
    """Wavelength of each band [nm], in the same order; refractive indices given by a formula need it. A band named by
    its wavelength (`550 nm`) has that one; visible stands for 555 nm where nothing is given."""

    @model_validator(mode="after")
    def _sound(self) -> Bands:
        twice = [name for name in self.names if [n.lower() for n in self.names].count(name.lower()) > 1]
        if twice:
            raise wrong("names", f"{twice[0]!r} is there twice (give each band once)")
        if self.wavelengths_nm is not None and len(self.wavelengths_nm) != len(self.names):
            raise wrong(
                "wavelengths_nm",
                f"{counted(len(self.wavelengths_nm), 'wavelength')} for {counted(len(self.names), 'band')}"
                " (give one each)",
            )
        return self

    @property
    def lower(self) -> list[str]:
        """The names as data sets have them."""
        return [name.lower() for name in self.names]

    def values(self, spectrum: float | dict[str, float], key: str) -> list[float]:
        """A spectrum's values in the order of the bands.

        Raises
        ------
        RecipeError
            A band is missing or not known; `key` is named.
        """
        if not isinstance(spectrum, dict):
            return [spectrum] * len(self.names)
        for band in spectrum:
            if band not in self.lower:
                raise RecipeError(f"{key}.{band}: there is no such band ({suggestion(band, self.lower)})")
        for band in self.lower:
            if band not in spectrum:
                raise RecipeError(f"{key}: no value for the band {band} (add it, or give one number for all)")
        return [spectrum[band] for band in self.lower]

    def wavelengths_um(self, key: str) -> list[float]:
        """The bands' wavelengths [µm].

        Raises
        ------
        RecipeError
            They are not known; `key` is what needs them.
        """
        if self.wavelengths_nm is not None:
            return [nm / 1000.0 for nm in self.wavelengths_nm]
        found = []
        for band in self.lower:
            number = band.removesuffix("nm").strip()
            if band == "visible":
                found.append(0.555)
            elif band.endswith("nm") and number.replace(".", "", 1).isdigit() and float(number) > 0.0:
                found.append(float(number) / 1000.0)
            else:
                raise RecipeError(f"{key}: the wavelength of the band {band} is not known (add bands.wavelengths_nm)")
        return found
