"""Clear panes of glass by their refractive index and absorption, as layers."""

from __future__ import annotations

from clerestory import _core
from clerestory.bsdf import Bsdf


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
