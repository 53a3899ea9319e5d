"""Layers put together by the Klems method, and what each of them absorbs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from clerestory import _core
from clerestory.basis import Basis
from clerestory.bsdf import Bsdf
from clerestory.directions import SCATTERS, SIDES, direction
from clerestory.integrals import hemispherical

if TYPE_CHECKING:
    from collections.abc import Iterable

    import numpy as np
    from numpy.typing import NDArray

    from clerestory.directions import Scatter, Side
    from clerestory.model import Model


class System:
    """A window of layers; made by `stack`."""

    def __init__(self, core: _core.System, notes: Iterable[str] = ()) -> None:
        self._core = core
        self._notes = list(notes)

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
        return [*self._notes, *self._core.bsdf.warnings]

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
        Outermost first. Panes, diffusers and beams need no basis. Matrices on other patches, trees and other models are
        converted with a line in `System.warnings` that states the error.
    basis
        Patches: a name as in `Basis.named`, or a basis.
    specular
        A pane's or beam's value in a patch: at its nominal centre (as WINDOW does), or the mean over it.

    Raises
    ------
    MissingDataError
        A layer has no reflection on some side, or the layers have no band in common.
    ClerestoryError
        There is no layer, or light between two of them never leaves. The text names the layer.

    References
    ----------
    Klems 1994, "A new method for predicting the solar heat gain of complex fenestration systems", ASHRAE Transactions
    100.
    """
    chosen = Basis.named(basis) if isinstance(basis, str) else basis
    made = [_on_basis(layer, chosen, number) for number, layer in enumerate(layers, 1)]
    core = _core.System.stack([layer._core for layer, _ in made], chosen._core, specular)
    return System(core, [note for _, notes in made for note in notes])


def _on_basis(layer: Bsdf, basis: Basis, number: int) -> tuple[Bsdf, list[str]]:
    """The layer with matrices of other patches converted, and what that changed."""
    converted: dict[str, dict[tuple[Side, Scatter], Model]] = {}
    notes = []
    for band, models in layer.models.items():
        for (side, scatter), model in models.items():
            if model.kind != "matrix" or model.incident_basis == basis == model.outgoing_basis:
                continue
            made = Bsdf.from_models({(side, scatter): model}).to_matrix(basis)
            converted.setdefault(band, {})[side, scatter] = made.models["visible"][side, scatter]
            here, there = (_hemispherical(m, scatter, side) for m in (model, made.models["visible"][side, scatter]))
            notes.append(
                f"layer {number}, band {band!r}: {scatter} for light from the {side} converted from "
                f"{model.incident_basis.name} to {basis.name}, which changes its hemispherical value by "
                f"{abs(there - here):.1e}"
            )
    return (layer.with_models(converted) if converted else layer), notes


def _hemispherical(model: Model, scatter: Scatter, side: Side) -> float:
    return hemispherical(Bsdf.from_models({(side, scatter): model}), scatter, side=side, samples=1).value
