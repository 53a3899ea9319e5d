"""Light by which spectra are weighed: visible, solar and near-infrared, as three standards give it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

FOLDER = Path(__file__).parent / "spectra"
VISIBLE_NM = (380.0, 780.0)
STANDARDS = ("en410", "iso9050", "nfrc300")


@dataclass(frozen=True)
class Spectrum:
    """A weight for each wavelength; the weights sum to 1."""

    wavelength_nm: Floats
    """Wavelengths [nm] (n,), rising."""
    weights: Floats
    """Share of the band's light (n,)."""

    @classmethod
    def of(cls, wavelength_nm: Floats, weights: Floats) -> Spectrum:
        """From weights of any sum; wavelengths without weight are left out."""
        some = weights > 0.0
        return cls(wavelength_nm[some], weights[some] / weights[some].sum())

    def mean(self, values: Floats) -> Floats:
        """Mean of values (..., n) at the wavelengths."""
        return np.asarray(values @ self.weights)

    def share_beyond(self, wavelength_nm: Floats) -> float:
        """Share of the light outside of the range of some wavelengths [nm]."""
        outside = (self.wavelength_nm < wavelength_nm[0]) | (self.wavelength_nm > wavelength_nm[-1])
        return float(self.weights[outside].sum())

    def joined(self, other: Spectrum) -> Floats:
        """The wavelengths of both [nm], rising."""
        return np.union1d(self.wavelength_nm, other.wavelength_nm)


@dataclass(frozen=True)
class Standard:
    """The spectra of a standard."""

    name: str
    """As people write it."""
    bands: dict[str, Spectrum]
    """Spectra of the bands visible, solar and nir; nir is the solar spectrum beyond 780 nm."""

    @property
    def visible_share(self) -> float:
        """Share of the solar spectrum between 380 and 780 nm."""
        solar = self.bands["solar"]
        inside = (solar.wavelength_nm >= VISIBLE_NM[0]) & (solar.wavelength_nm <= VISIBLE_NM[1])
        return float(solar.weights[inside].sum())


@cache
def standard(name: str) -> Standard:
    """The spectra of a standard by its name.

    Parameters
    ----------
    name
        `en410`: global sun at air mass 1, tables 1 and 2 of EN 410. `iso9050`: global sun at air mass 1.5 (ISO 9845-1,
        column 5). `nfrc300`: direct sun at air mass 1.5 (ASTM E891, as NFRC 300 asks for). D65 and V(λ) in all.

    Raises
    ------
    ClerestoryError
        There is no such standard.

    Notes
    -----
    EN 410 gives weights by interval. For the others the trapezoidal rule is taken: solar at the wavelengths of the
    sun's table up to 2500 nm, visible at steps of 5 nm.
    """
    key = name.lower().replace(" ", "").replace("-", "").replace("_", "")
    if key == "en410":
        visible, solar = (Spectrum.of(*_table(f"en410_{part}").T) for part in ("light", "solar"))
        return Standard("EN 410", _bands(visible, solar))
    if key not in STANDARDS:
        raise ClerestoryError(f"standard {name!r} is not known (give {', '.join(STANDARDS[:-1])} or {STANDARDS[-1]})")
    sun, eye = _table("sun"), _table("eye")
    visible = _by_trapezoids(eye[:, 0], eye[:, 1] * eye[:, 2])
    solar = _by_trapezoids(sun[:, 0], sun[:, 1 if key == "nfrc300" else 2])
    return Standard("NFRC 300" if key == "nfrc300" else "ISO 9050", _bands(visible, solar))


def _bands(visible: Spectrum, solar: Spectrum) -> dict[str, Spectrum]:
    beyond = solar.wavelength_nm > VISIBLE_NM[1]
    nir = Spectrum.of(solar.wavelength_nm[beyond], solar.weights[beyond])
    return {"visible": visible, "solar": solar, "nir": nir}


def _by_trapezoids(wavelength_nm: Floats, density: Floats) -> Spectrum:
    widths = np.empty_like(wavelength_nm)
    widths[1:-1] = (wavelength_nm[2:] - wavelength_nm[:-2]) / 2.0
    widths[0] = (wavelength_nm[1] - wavelength_nm[0]) / 2.0
    widths[-1] = (wavelength_nm[-1] - wavelength_nm[-2]) / 2.0
    return Spectrum.of(wavelength_nm, density * widths)


def _table(name: str) -> Floats:
    with (FOLDER / f"{name}.csv").open(encoding="utf-8") as lines:
        rows = [line for line in lines if line[0].isdigit()]
    return np.loadtxt(rows, delimiter=",", ndmin=2)
