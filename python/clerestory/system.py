"""Window systems: layers put together, and what each of them absorbs.

A layer is a `Bsdf`: a file's, a pane's, a measured one. It is turned round with `Bsdf.flipped` and turned in its plane
with `Bsdf.rotated` before it is put in.

Examples
--------
>>> from clerestory.system import pane_from_normal, stack
>>> glass = pane_from_normal(0.8993, 0.0826)
>>> stack([glass, glass]).absorptance("visible").shape
(2, 145)
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from clerestory import _core
from clerestory.basis import Basis
from clerestory.bsdf import Bsdf
from clerestory.directions import SCATTERS, SIDES, direction

if TYPE_CHECKING:
    from collections.abc import Iterable

    import numpy as np
    from numpy.typing import NDArray

    from clerestory.directions import Side

__all__ = ["System", "pane", "pane_from_normal", "stack"]


def pane(
    refractive_index: float,
    *,
    internal_transmittance: float | None = None,
    absorption_per_m: float | None = None,
    extinction: float | None = None,
    thickness_m: float | None = None,
    wavelength_nm: float | None = None,
    band: str = "visible",
) -> Bsdf:
    """Make a clear uncoated pane from what its glass is.

    The absorption is given in one of three ways: `internal_transmittance`; `absorption_per_m` and `thickness_m`; or
    `extinction`, `thickness_m` and `wavelength_nm`. Fresnel reflection at both faces and all internal reflections are
    followed in each polarisation and averaged, so natural light is meant; the pane is thick against the light's
    coherence length. Values at all angles are exact; nothing is tabulated.

    Parameters
    ----------
    refractive_index
        Real part, 1 or more.
    internal_transmittance
        Share of light that one pass along the normal between the faces leaves over.
    absorption_per_m
        Absorption coefficient α [1/m]: exp(−αd) passes.
    extinction
        Imaginary part of the refractive index κ: exp(−4πκd/λ) passes.
    thickness_m
        Thickness d [m].
    wavelength_nm
        Wavelength in vacuum λ [nm].
    band
        Name of the band. `Bsdf.merged` puts several together.

    Raises
    ------
    ClerestoryError
        The absorption is given in no way or in several, or a value is not one of a pane.

    References
    ----------
    Furler 1991, "Angular dependence of optical properties of homogeneous glasses", ASHRAE Transactions 97.

    Examples
    --------
    >>> from clerestory.system import pane
    >>> glass = pane(1.526, absorption_per_m=20.0, thickness_m=0.003)
    """
    match internal_transmittance, absorption_per_m, extinction, thickness_m, wavelength_nm:
        case (float() | int()) as internal, None, None, _, _:
            pass
        case None, (float() | int()) as alpha, None, (float() | int()) as d, _:
            internal = _core.Bsdf.internal_by_absorption(alpha, d)
        case None, None, (float() | int()) as kappa, (float() | int()) as d, (float() | int()) as wavelength:
            internal = _core.Bsdf.internal_by_extinction(kappa, d, wavelength * 1e-9)
        case _:
            raise _core.ClerestoryError(
                "the pane's absorption is not given in one way (give internal_transmittance; or absorption_per_m and "
                "thickness_m; or extinction, thickness_m and wavelength_nm)"
            )
    return Bsdf(_core.Bsdf.pane(refractive_index, internal, band))


def pane_from_normal(transmittance: float, reflectance: float, *, band: str = "visible") -> Bsdf:
    """Make a clear uncoated pane from its transmittance and reflectance at normal incidence.

    Refractive index and absorption follow from both values; the angles as in `pane`. For a single wavelength this is
    exact, for a band a good approximation.

    Parameters
    ----------
    transmittance, reflectance
        At normal incidence, greater than 0, with a sum of at most 1.
    band
        Name of the band. `Bsdf.merged` puts several together.

    Raises
    ------
    ClerestoryError
        No uncoated pane has these values.

    References
    ----------
    Furler 1991, "Angular dependence of optical properties of homogeneous glasses", ASHRAE Transactions 97.
    """
    return Bsdf(_core.Bsdf.pane_from_normal(transmittance, reflectance, band))


class System:
    """A window of layers; made by `stack`."""

    def __init__(self, core: _core.System) -> None:
        self._core = core

    @property
    def bsdf(self) -> Bsdf:
        """How the system scatters light.

        Its models are matrices of scattered light and, where light travels through along specular paths alone, beams
        by patch. A beam over its patch's projected solid angle, added to the diagonal of the matrix, is the classic
        result.
        """
        return Bsdf(self._core.bsdf)

    @property
    def basis(self) -> Basis:
        """Patches that the layers are put together on."""
        return Basis(self._core.basis)

    @property
    def warnings(self) -> list[str]:
        """What was taken by reciprocity, left out, or sends out more light than it gets."""
        return self._core.bsdf.warnings

    def __len__(self) -> int:
        """Return the number of layers."""
        return len(self._core)

    def absorptance(self, band: str | None = None, side: Side = "exterior") -> NDArray[np.float64]:
        """Share of the incident light that each layer absorbs.

        Parameters
        ----------
        band
            Name of a band; visible, or the first, by default.
        side
            Side that the light comes from.

        Returns
        -------
        Array (layer, incident patch), outermost layer first on either side. With transmittance and reflectance
        the layers sum to 1. Negative where a layer's data send out more light than they receive.
        """
        return self._core.absorptance(band, side)

    def __repr__(self) -> str:
        """Return what becomes of light along the normal, by band and side."""
        bsdf, count = self.bsdf, len(self)
        lines = [f"System of {count} layer{'s' if count > 1 else ''} on {self.basis.name}, light along the normal:"]
        for band in bsdf.bands:
            for side in SIDES:
                normal = direction(0.0, 0.0, side=side)
                t, r = (float(bsdf.integrate(normal, scatter, band=band)) for scatter in SCATTERS)
                layers = ", ".join(f"{a:.3f}" for a in self.absorptance(band, side)[:, 0])
                lines.append(f"  {band}, from the {side}: T {t:.3f}, R {r:.3f}, absorbed by the layers {layers}")
        return "\n".join(lines)


def stack(
    layers: Iterable[Bsdf], basis: str | Basis = "klems-full", *, specular: Literal["centre", "mean"] = "centre"
) -> System:
    """Put layers together to a window by the Klems method.

    Each band that all layers have is solved by itself: mixing band averages of layers with different spectra is an
    approximation (wavelength by wavelength it is exact). Layers are infinite and homogeneous at their scale; gaps have
    no lateral shift. Inter-reflection is followed to the end by solving linear equations. A missing transmission side
    is taken from the other by reciprocity, with a line in `System.warnings`. Standard errors of the layers'
    matrices travel into the system's to first order, all cells being independent; absorptances carry none.

    Parameters
    ----------
    layers
        Outermost first. Matrices must be written on `basis`; panes, diffusers and beams need no basis.
        Trees and other models are converted with a line in `System.warnings`.
    basis
        Patches: a name as in `Basis.named`, or a basis.
    specular
        A pane's or beam's value in a patch: at its nominal centre (as WINDOW does), or the mean over it.

    Raises
    ------
    MissingDataError
        A layer has no reflection on some side, or the layers have no band in common.
    ClerestoryError
        There is no layer, or a layer is written on other patches. The text names the layer.

    References
    ----------
    Klems 1994, "A new method for predicting the solar heat gain of complex fenestration systems", ASHRAE Transactions
    100.
    """
    chosen = Basis.named(basis) if isinstance(basis, str) else basis
    return System(_core.System.stack([layer._core for layer in layers], chosen._core, specular))
