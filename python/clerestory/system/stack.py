"""Layers put together by the Klems method, and what each of them absorbs."""

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
