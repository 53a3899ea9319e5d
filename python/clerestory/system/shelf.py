"""Glass that comes with Clerestory, by refractive index and extinction: typical, not of a product."""

from __future__ import annotations

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.system.glass import Plate, Sheet, Thermal

# Extinction coefficient of clear float glass, in units of 1e-7, by wavelength [nm]. With the index below, panes of 3
# and 6 mm agree with the generic clear glass of NFRC (102 and 103) to 0.002 in transmittance.
CLEAR = {
    300: 480, 310: 370, 320: 180, 330: 80, 340: 35, 360: 7.0, 380: 6.4, 400: 2.4, 440: 2.9, 500: 1.7, 540: 2.0,
    580: 3.2, 620: 5.7, 660: 8.9, 700: 13, 750: 20, 800: 27, 900: 40, 1000: 49, 1100: 55, 1200: 57, 1300: 57, 1400: 53,
    1500: 46, 1600: 40, 1800: 43, 2000: 50, 2200: 61, 2400: 64, 2500: 75,
}  # fmt: skip
NAMES = ("clear",)
EMISSIVITY = 0.84
CONDUCTIVITY = 1.0


def glass(name: str, thickness_m: float) -> Plate:
    """A pane of typical glass by its name: `clear`.

    Parameters
    ----------
    thickness_m
        Thickness [m].

    Raises
    ------
    ClerestoryError
        There is no glass of this name.

    Notes
    -----
    n = 1.5130 − 0.003169 λ² + 0.003962 λ⁻², λ in µm.

    References
    ----------
    Rubin 1985, "Optical properties of soda lime silica glasses", Solar Energy Materials 12, for the index.
    """
    if name not in NAMES:
        raise ClerestoryError(
            f"no glass {name!r} comes with Clerestory (known: {', '.join(NAMES)}; or give a file of a product)"
        )
    wavelength = np.array(list(CLEAR), dtype=np.float64)
    micrometres = wavelength / 1000.0
    index = 1.5130 - 0.003169 * micrometres**2 + 0.003962 / micrometres**2
    sheet = Sheet(wavelength, index, np.array(list(CLEAR.values())) * 1e-7, thickness_m)
    thermal = Thermal(thickness_m, CONDUCTIVITY, EMISSIVITY, EMISSIVITY, 0.0, 0.0)
    return Plate(f"{name} {1000.0 * thickness_m:g} mm", (sheet,), thermal)
