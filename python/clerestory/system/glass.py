"""Panes by their spectra: measured along the normal, or by refractive index and absorption."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from clerestory._core import ClerestoryError, MissingDataError
from clerestory.system.coating import clear_or_bronze, roos
from clerestory.system.plate import Optics, sheets, uncoated

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from clerestory.system.spectrum import Spectrum

    Floats = NDArray[np.float64]

Coated = Literal["neither", "exterior", "interior", "both"]
Angles = Literal["fresnel", "clear-bronze", "roos"]
ANGLES: tuple[Angles, ...] = ("fresnel", "clear-bronze", "roos")

GAIN = 1e-3
"""Measured shares may sum to so much more than 1 by rounding."""
COVERED = 0.98
"""Share of a band's light that data must cover; the rest is taken like the nearest wavelength."""


_AIR = ("slat_tilt_deg", "edges_m")
"""What no BSDF file holds."""


@dataclass(frozen=True)
class Thermal:
    """What heat asks of a layer; None where it is not known."""

    thickness_m: float | None = None
    """Thickness [m]."""
    conductivity: float | None = None
    """Thermal conductivity [W/(m K)]."""
    emissivity_exterior: float | None = None
    """Hemispherical long-wave emissivity of the exterior face."""
    emissivity_interior: float | None = None
    """Hemispherical long-wave emissivity of the interior face."""
    tir: float | None = None
    """Long-wave transmittance."""
    openness: float | None = None
    """Open fraction of the area, for air."""
    slat_tilt_deg: float | None = None
    """Tilt of its slats [°], for air that passes between them; None for cloth and panes."""
    edges_m: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    """Open gaps at its top, bottom, left and right edge, for air [m]."""

    def flipped(self) -> Thermal:
        """Turned round."""
        return replace(self, emissivity_exterior=self.emissivity_interior, emissivity_interior=self.emissivity_exterior)

    def fields(self) -> dict[str, float]:
        """What is known, by the names of `Metadata`."""
        names = {"conductivity": "thermal_conductivity"}
        known = {names.get(key, key): value for key, value in vars(self).items() if key not in _AIR}
        return {key: value for key, value in known.items() if value is not None}


@dataclass(frozen=True)
class Glass:
    """A pane from its spectra along the normal.

    Raises
    ------
    ClerestoryError
        Numbers do not fit, or more light leaves than comes; the text names the wavelength.
    """

    name: str
    wavelength_nm: Floats
    """Wavelengths [nm] (n,), rising."""
    transmittance: Floats
    """Along the normal (n,); the same from both sides."""
    reflectance_exterior: Floats
    """Of the exterior face, near the normal (n,)."""
    reflectance_interior: Floats
    """Of the interior face, near the normal (n,)."""
    thermal: Thermal = field(default_factory=Thermal)
    coated: Coated = "neither"
    """Faces with a coating."""
    kind: str = "monolithic"
    """As the file names it: monolithic, coated, laminate, …"""
    angles: Angles = "fresnel"
    """How values at other angles are found; `clear-bronze` is usual for all but plain glass."""
    roos_category: float = 4.0
    """q of Roos' model, 1 to 10."""
    manufacturer: str | None = None
    warnings: tuple[str, ...] = ()
    """What was odd in its file."""

    def __post_init__(self) -> None:
        for name in ("wavelength_nm", "transmittance", "reflectance_exterior", "reflectance_interior"):
            array = np.ascontiguousarray(getattr(self, name), dtype=np.float64)
            array.flags.writeable = False
            object.__setattr__(self, name, array)
            if array.shape != self.wavelength_nm.shape or array.ndim != 1:
                raise ClerestoryError(f"{name} of {self.name!r} has {array.size} values, not one for each wavelength")
        if len(self.wavelength_nm) == 0 or not (np.diff(self.wavelength_nm) > 0.0).all():
            raise ClerestoryError(f"wavelengths of {self.name!r} do not rise (sort the values by wavelength)")
        for side in ("exterior", "interior"):
            reflectance = getattr(self, f"reflectance_{side}")
            total = self.transmittance + reflectance
            lowest = np.minimum(self.transmittance, reflectance)
            if not (total <= 1.0 + GAIN).all():
                worst = int(np.argmax(np.where(np.isfinite(total), total, np.inf)))
                raise ClerestoryError(
                    f"{self.name!r} sends out {100.0 * total[worst]:.1f} % of the light from the {side} at "
                    f"{self.wavelength_nm[worst]:g} nm (check its transmittance and reflectance)"
                )
            if not (lowest >= 0.0).all():
                worst = int(np.argmin(lowest))
                raise ClerestoryError(
                    f"{self.name!r} has a value of {lowest[worst]:g} at {self.wavelength_nm[worst]:g} nm (give shares "
                    "from 0 to 1)"
                )
        if self.angles not in ANGLES:
            raise ClerestoryError(f"angles {self.angles!r} are not known (give {', '.join(ANGLES)})")

    def flipped(self) -> Glass:
        """Turned round: the exterior face becomes the interior one."""
        turned: dict[Coated, Coated] = {"exterior": "interior", "interior": "exterior"}
        return replace(
            self,
            reflectance_exterior=self.reflectance_interior,
            reflectance_interior=self.reflectance_exterior,
            thermal=self.thermal.flipped(),
            coated=turned.get(self.coated, self.coated),
        )

    def covers(self, spectrum: Spectrum) -> bool:
        """Whether the data hold enough of a band's light."""
        return spectrum.share_beyond(self.wavelength_nm) <= 1.0 - COVERED

    def at(self, wavelength_nm: ArrayLike, theta_deg: ArrayLike) -> Optics:
        """What it does with light at wavelengths [nm] (n,) and angles from the normal [°] (m,).

        Values between the data's wavelengths are interpolated; beyond them the nearest one is taken.
        """
        wavelengths = np.atleast_1d(np.asarray(wavelength_nm, dtype=np.float64))
        theta = np.atleast_1d(np.asarray(theta_deg, dtype=np.float64))
        t, e, i = (
            np.clip(np.interp(wavelengths, self.wavelength_nm, values), 0.0, 1.0)
            for values in (self.transmittance, self.reflectance_exterior, self.reflectance_interior)
        )
        # Sums that rounding put above 1.
        e, i = np.minimum(e, 1.0 - t), np.minimum(i, 1.0 - t)
        if self.angles == "roos":
            return roos(t, e, i, theta, self.roos_category)
        if self.angles == "clear-bronze":
            return clear_or_bronze(t, e, i, theta)
        # Faces of plain glass differ by little: each side is the plate that has its reflectance.
        outer, inner = (_plate(t, r, theta) for r in (e, i))
        return Optics.of_pane((outer.transmittance + inner.transmittance) / 2.0, outer.exterior, inner.interior)


def _plate(transmittance: Floats, reflectance: Floats, theta_deg: Floats) -> Optics:
    index, internal = uncoated(transmittance, reflectance)
    return sheets([index], [internal], theta_deg)


@dataclass(frozen=True)
class Sheet:
    """A sheet of a clear material by its refractive index."""

    wavelength_nm: Floats
    """Wavelengths [nm] (n,), rising."""
    index: Floats
    """Refractive index n (n,)."""
    extinction: Floats
    """Extinction coefficient κ (n,): exp(−4πκd/λ) passes."""
    thickness_m: float
    """Thickness [m]."""

    def __post_init__(self) -> None:
        arrays = [
            np.atleast_1d(np.asarray(a, dtype=np.float64)) for a in (self.wavelength_nm, self.index, self.extinction)
        ]
        wavelengths, index, extinction = np.broadcast_arrays(*arrays)
        for name, array in (("wavelength_nm", wavelengths), ("index", index), ("extinction", extinction)):
            object.__setattr__(self, name, array)
        if not (index >= 1.0).all() or not (extinction >= 0.0).all() or not self.thickness_m > 0.0:
            raise ClerestoryError(
                "a sheet has an index of 1 or more, an extinction of 0 or more and a thickness above 0"
            )
        if not (np.diff(wavelengths) > 0.0).all():
            raise ClerestoryError("wavelengths of a sheet do not rise (sort the values by wavelength)")


@dataclass(frozen=True)
class Plate:
    """A pane of sheets in contact, such as plain glass or a laminate, by refractive index and extinction."""

    name: str
    sheets: tuple[Sheet, ...]
    """Outermost first."""
    thermal: Thermal = field(default_factory=Thermal)
    warnings: tuple[str, ...] = ()

    def flipped(self) -> Plate:
        """Turned round."""
        return replace(self, sheets=self.sheets[::-1], thermal=self.thermal.flipped())

    def covers(self, spectrum: Spectrum) -> bool:
        """Whether the data hold enough of a band's light; one value stands for all wavelengths."""
        return all(
            len(sheet.wavelength_nm) == 1 or spectrum.share_beyond(sheet.wavelength_nm) <= 1.0 - COVERED
            for sheet in self.sheets
        )

    def at(self, wavelength_nm: ArrayLike, theta_deg: ArrayLike) -> Optics:
        """What it does with light at wavelengths [nm] (n,) and angles from the normal [°] (m,)."""
        wavelengths = np.atleast_1d(np.asarray(wavelength_nm, dtype=np.float64))
        indices, internal = [], []
        for sheet in self.sheets:
            indices.append(np.interp(wavelengths, sheet.wavelength_nm, sheet.index))
            kappa = np.interp(wavelengths, sheet.wavelength_nm, sheet.extinction)
            internal.append(np.exp(-4.0 * np.pi * kappa * sheet.thickness_m / (wavelengths * 1e-9)))
        return sheets(indices, internal, theta_deg)


Pane = Glass | Plate


def common_bands(panes: list[Pane], bands: dict[str, Spectrum]) -> dict[str, Spectrum]:
    """The bands whose light all panes' data cover.

    Raises
    ------
    MissingDataError
        There is none; the text names each pane's wavelengths.
    """
    common = {name: spectrum for name, spectrum in bands.items() if all(pane.covers(spectrum) for pane in panes)}
    if not common:
        ranges = (
            f"layer {k} ({pane.name}): {pane.wavelength_nm[0]:g} to {pane.wavelength_nm[-1]:g} nm"
            for k, pane in enumerate(panes, 1)
            if isinstance(pane, Glass)
        )
        raise MissingDataError(f"the panes' data cover no band in common ({'; '.join(ranges)})")
    return common
