"""Panes behind each other: transmittance, reflectance and what each pane absorbs, by angle and band."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.bsdf import Bsdf
from clerestory.model import Model
from clerestory.system.glass import common_bands
from clerestory.system.spectrum import standard

if TYPE_CHECKING:
    from collections.abc import Iterable

    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike, NDArray

    from clerestory.directions import Scatter, Side
    from clerestory.system.glass import Pane
    from clerestory.system.plate import Optics
    from clerestory.system.spectrum import Spectrum

    Floats = NDArray[np.float64]

STEPS = 2048
"""Steps of cosθ in the models of a data set, linear between them: within 1e-6 for panes of glass."""
CHUNK = 24
"""Wavelengths that are worked on at a time, so that memory does not grow with the spectrum."""


@dataclass(frozen=True)
class Curves:
    """Values by angle of incidence, for natural light of one band."""

    theta_deg: Floats
    """Angles from the normal [°] (m,)."""
    transmittance: Floats
    """(m,); the same from both sides."""
    reflectance: dict[Side, Floats]
    """By side of incidence (m,)."""
    absorptance: dict[Side, Floats]
    """By side of incidence, (pane, m), outermost first."""


class Glazing:
    """Panes of glass with gaps between them, outermost first; a single pane too.

    Light is followed through all reflections, wavelength by wavelength and in each polarisation, as fluxes: gaps are
    thick against the coherence length, and optically nothing.

    Parameters
    ----------
    panes
        `Glass` or `Plate`, outermost first.

    References
    ----------
    EN 410:2011 section 5; ISO 9050:2003 section 3.

    Examples
    --------
    >>> from clerestory.system import Glazing, Plate, Sheet
    >>> pane = Plate("clear", (Sheet(550.0, 1.52, 2e-7, 0.004),))
    >>> round(float(Glazing([pane, pane]).curves(0.0)["visible"].transmittance[0]), 4)
    0.8133
    """

    def __init__(self, panes: Iterable[Pane]) -> None:
        self.panes = list(panes)
        if not self.panes:
            raise ClerestoryError("a glazing needs at least one pane")

    def __len__(self) -> int:
        """Return the number of panes."""
        return len(self.panes)

    def at(self, wavelength_nm: ArrayLike, theta_deg: ArrayLike) -> Optics:
        """What all together do with light at wavelengths [nm] (n,) and angles from the normal [°] (m,)."""
        first, *others = (pane.at(wavelength_nm, theta_deg) for pane in self.panes)
        for other in others:
            first = first.before(other)
        return first

    def bands(self, norm: str = "en410") -> dict[str, Spectrum]:
        """The bands of a standard that the panes' data cover, of visible, solar and nir."""
        return common_bands(self.panes, standard(norm).bands)

    def curves(self, theta_deg: ArrayLike, norm: str = "en410") -> dict[str, Curves]:
        """Values of each band by angle of incidence.

        Parameters
        ----------
        theta_deg
            Angles from the normal [°] (m,).
        norm
            Standard whose spectra weigh the wavelengths, see `clerestory.system.spectrum.standard`.

        Raises
        ------
        MissingDataError
            The panes' data cover no band in common.
        """
        theta = np.atleast_1d(np.asarray(theta_deg, dtype=np.float64))
        return {name: self._curves(theta, spectrum) for name, spectrum in self.bands(norm).items()}

    def _curves(self, theta: Floats, spectrum: Spectrum) -> Curves:
        transmittance = np.zeros(len(theta))
        reflectance, absorbed = np.zeros((2, len(theta))), np.zeros((len(self), 2, len(theta)))
        for begin in range(0, len(spectrum.wavelength_nm), CHUNK):
            part = slice(begin, begin + CHUNK)
            weights, optics = spectrum.weights[part], self.at(spectrum.wavelength_nm[part], theta)
            # Natural light: the mean of both polarisations.
            transmittance += weights @ optics.transmittance.mean(axis=0)
            reflectance += np.stack([weights @ r.mean(axis=0) for r in (optics.exterior, optics.interior)])
            absorbed += np.einsum("w,kspwm->ksm", weights / 2.0, optics.absorbed)
        return Curves(
            theta,
            transmittance,
            {"exterior": reflectance[0], "interior": reflectance[1]},
            {"exterior": absorbed[:, 0], "interior": absorbed[:, 1]},
        )

    def bsdf(self, norm: str = "en410") -> Bsdf:
        """As a data set of exact beams, a value for each angle, in the bands that the data cover.

        Raises
        ------
        MissingDataError
            The panes' data cover no band in common.
        """
        cosine = np.linspace(0.0, 1.0, STEPS + 1)
        bands: dict[str, dict[tuple[Side, Scatter], Model]] = {}
        for name, curves in self.curves(np.degrees(np.arccos(cosine)), norm).items():
            passed = Model.specular(curves.transmittance, by="cosine")
            bands[name] = {
                ("exterior", "transmission"): passed,
                ("interior", "transmission"): passed,
                ("exterior", "reflection"): Model.specular(curves.reflectance["exterior"], by="cosine"),
                ("interior", "reflection"): Model.specular(curves.reflectance["interior"], by="cosine"),
            }
        made = Bsdf.from_models(bands).with_metadata(name=" + ".join(pane.name for pane in self.panes))
        return made if len(self) > 1 else made.with_metadata(**self.panes[0].thermal.fields())

    def csv(self, theta_deg: ArrayLike | None = None, norm: str = "en410") -> str:
        """Table of all bands by angle (every 5° by default), for a spreadsheet."""
        theta = np.arange(0.0, 90.1, 5.0) if theta_deg is None else theta_deg
        lines = ["band,theta_deg,transmittance,reflectance_exterior,reflectance_interior"]
        lines[0] += "".join(f",absorptance_{k}" for k in range(1, len(self) + 1))
        for band, curves in self.curves(theta, norm).items():
            columns = np.column_stack(
                [
                    curves.theta_deg,
                    curves.transmittance,
                    curves.reflectance["exterior"],
                    curves.reflectance["interior"],
                    curves.absorptance["exterior"].T,
                ]
            )
            lines += [band + "," + ",".join(f"{value:.6g}" for value in row) for row in columns]
        return "\n".join(lines) + "\n"

    def figure(self, norm: str = "en410") -> Figure:
        """Curves of transmittance, reflectance and absorptance by angle, a panel a band."""
        from clerestory.system.curves_figure import figure

        return figure(self.curves(np.linspace(0.0, 90.0, 181), norm), standard(norm).name)
