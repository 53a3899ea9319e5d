"""What stands in windows: data sets as recipes of rooms and studies name them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from clerestory.trace.reading import reading

if TYPE_CHECKING:
    from pathlib import Path

    from clerestory.bsdf import Bsdf
    from clerestory.room import recipe as keys
    from clerestory.system.build import Traced


@dataclass(frozen=True)
class Placed:
    """The data set of a window."""

    bsdf: Bsdf
    band: str | None = None
    """Its band for each channel; visible by default."""
    file: Path | None = None
    """The BSDF file whose bytes tell all that it holds; None for one that was made."""

    @property
    def seen(self) -> Bsdf:
        """Its band alone.

        Raises
        ------
        MissingDataError
            It has no such band.
        """
        return self.bsdf if self.band is None else self.bsdf.only_band(self.band)

    @property
    def bands(self) -> list[str | None]:
        """By channel."""
        return [self.band] * 3


def system_of(given: keys.System, key: str, folder: Path, traced: Traced | None = None) -> Placed:
    """The data set of a window.

    Parameters
    ----------
    given
        Its keys.
    key
        Where these are, for errors.
    folder
        That files are relative to.
    traced
        Traces a sample, see `clerestory.system.dataset.data_set`.

    Raises
    ------
    RecipeError
        The text names the key, the file, what is wrong and the remedy.
    """
    from clerestory.system.dataset import data_set, glazed

    with reading(f"{key}.file" if given.glass is None else f"{key}.glass"):
        if isinstance(given.glass, float):
            return Placed(_pane(given.glass, given.glass_reflectance))
        if given.glass is not None:
            return Placed(glazed(given.glass, folder, given.thickness_mm).bsdf, given.band)
        found = data_set(str(given.file), folder, traced=traced)
        bsdf = found.bsdf.flipped() if given.flipped else found.bsdf
        if given.treatment.startswith("klems"):
            bsdf = bsdf.to_matrix("klems-full")
        # What is traced or solved has its beams apart already, unless it was made a matrix.
        if given.treatment.endswith("peaks") and (found.is_stored or given.treatment == "klems-peaks"):
            bsdf = bsdf.separate_peaks()
        return Placed(bsdf, given.band, found.sources[0] if found.is_stored else None)


def _pane(transmittance: float, reflectance: float | None) -> Bsdf:
    from clerestory.system import pane_from_normal

    if reflectance is None:
        r = ((1.52 - 1.0) / (1.52 + 1.0)) ** 2
        reflectance = 2.0 * r / (1.0 + r)
    return pane_from_normal(min(transmittance, 1.0 - reflectance), reflectance)
