"""Windows at their layers' own resolution: beams stay beams, and scattered light keeps the detail of what scattered it.

A beam that goes through panes and gaps stays a beam. Where it meets a layer that scatters, that layer is evaluated
exactly at the beam's direction, and its light leaves through panes that are evaluated exactly at the outgoing
direction:

    f(vᵢ, vₒ) = Σ aₖ(vᵢ) fₖ(vᵢ, vₒ) bₖ(vₒ) + Σ aₖ(vᵢ) m(pᵢ, pₒ) bₗ(vₒ)

The first sum is light that was scattered once, at the resolution of the layer's own model; a and b hold all
reflections along beams. The second is light that was scattered more often, first by layer k and last by layer l, for
which m is solved on patches. Gaps are optically thin and layers have no lateral extent: that light comes back
elsewhere than it left is ignored.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory.basis import Basis
from clerestory.bsdf import Bsdf
from clerestory.directions import SCATTERS, SIDES, direction
from clerestory.model import Model
from clerestory.system.grid import Grid
from clerestory.system.layer import Parts, components
from clerestory.system.network import Beams, Scattered
from clerestory.system.spectrum import Spectrum
from clerestory.system.tables import patch_directions
from clerestory.system.window import Window, fields

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from clerestory.directions import Scatter, Side

    Floats = NDArray[np.float64]

FAINT = 1e-9
"""Light weaker than this is left out."""


def sharpened(window: Window, *, norm: str = "en410", basis: Basis | str = "klems-full") -> Bsdf:
    """A window at its layers' own resolution.

    Parameters
    ----------
    window
        Its layers.
    norm
        Standard whose spectra weigh the wavelengths, see `clerestory.system.spectrum.standard`.
    basis
        Patches for light that is scattered more than once.

    Returns
    -------
    Data set of sums of beams and of `Model.filtered` views, for files of Clerestory's own (`.bsdf.npz`) and for
    rendering.

    Notes
    -----
    Bands are solved once, with means over the wavelengths of what panes do. Where panes lie on both sides of a layer
    that scatters, means of products differ from products of means; they are corrected by their ratio at normal
    incidence.
    """
    chosen = Basis.named(basis) if isinstance(basis, str) else basis
    bands = {
        name: _Band(window, name, spectrum, chosen).models()
        for name, spectrum in window.bands(norm).items()
        if name != "nir" or _holds(window, "nir")
    }
    return Bsdf.from_models(bands).with_metadata(**fields(window))


def _holds(window: Window, band: str) -> bool:
    """Whether layers that scatter have a band of their own."""
    return all(layer.bsdf is None or band in layer.bsdf.bands for layer in window.layers)


class _Band:
    """A window in one band."""

    def __init__(self, window: Window, band: str, spectrum: Spectrum, basis: Basis) -> None:
        self.units, self.band, self.spectrum, self.basis = window.units, band, spectrum, basis
        self.parts: list[dict[tuple[Side, Scatter], Parts]] = [
            {} if unit.layer is None or unit.layer.bsdf is None else components(unit.layer.bsdf, band)[0]
            for unit in self.units
        ]
        beams = (model for held in self.parts for parts in held.values() for _, model in parts.beams)
        self.grid = Grid.of(beams)
        self.faces = [
            face
            for k, held in enumerate(self.parts)
            if any(parts.scattered for parts in held.values())
            for face in (2 * k, 2 * k + 1)
        ]

    def models(self) -> dict[tuple[Side, Scatter], Model]:
        beams = self._beams([self.grid.incident(side) for side in SIDES])
        ratio = self._correlation()
        kernels = self._kernels()
        return {
            (side, scatter): self._component(k, k if scatter == "reflection" else 1 - k, beams, ratio, kernels)
            for k, side in enumerate(SIDES)
            for scatter in SCATTERS
        }

    def _component(
        self, side: int, to: int, beams: Beams, ratio: Floats, kernels: dict[tuple[int, int], Floats]
    ) -> Model:
        parts: list[tuple[float, Model]] = []
        escaping = beams.escaping(to)
        for arrives in self.faces:
            before = beams.entering[side][:, arrives]
            if before.max() < FAINT:
                continue
            for leaves in self.faces:
                after = escaping[:, leaves]
                if after.max() < FAINT:
                    continue
                for model in self._scatterers(arrives, leaves, kernels):
                    weight = float(ratio[side, to, arrives, leaves])
                    parts.append((weight, model.filtered(self.grid.model(before), self.grid.model(after))))
        beam = beams.leaving[side, to]
        if beam.max() > FAINT or not parts:
            parts.append((1.0, self.grid.model(beam)))
        return Model.sum(parts)

    def _scatterers(self, arrives: int, leaves: int, kernels: dict[tuple[int, int], Floats]) -> list[Model]:
        """What scatters light from one face to another: the layer itself, and all that goes on between layers."""
        models = []
        if arrives // 2 == leaves // 2:
            scatter: Scatter = "reflection" if arrives == leaves else "transmission"
            own = self.parts[arrives // 2][SIDES[arrives % 2], scatter]
            models += [model if weight == 1.0 else model.scaled(weight) for weight, model in own.scattered]
        kernel = kernels[leaves, arrives]
        if kernel.max() > FAINT:
            models.append(Model.matrix(kernel, self.basis))
        return models

    def _beams(self, incident: list[Floats]) -> Beams:
        """Beams in directions (m, 3) from both sides, of the same points of the disk."""
        transmittance, reflectance = [], []
        theta = np.degrees(np.arccos(np.clip(np.abs(incident[0][:, 2]), 0.0, 1.0)))
        unique, where = np.unique(theta, return_inverse=True)
        for unit, held in zip(self.units, self.parts, strict=True):
            if unit.glazing is not None:
                curves = unit.glazing._curves(unique, self.spectrum)
                transmittance.append(np.stack([curves.transmittance[where]] * 2))
                reflectance.append(np.stack([curves.reflectance[side][where] for side in SIDES]))
                continue
            for found, scatter in ((transmittance, "transmission"), (reflectance, "reflection")):
                found.append(
                    np.stack(
                        [held[side, scatter].beam(incident[k], side, scatter) for k, side in enumerate(SIDES)]  # type: ignore[index, arg-type]
                    )
                )
        return Beams.of(np.stack(transmittance), np.stack(reflectance))

    def _kernels(self) -> dict[tuple[int, int], Floats]:
        """BSDF [1/sr] (outgoing, incident) of light scattered twice or more.

        By the face where it leaves the last layer that scatters it and the face where it arrives at the first one.
        """
        if not self.faces:
            return {}
        n = len(self.basis)
        beams = self._beams([patch_directions(self.basis, side, "mean") for side in SIDES]).by_patch(n)
        shares: dict[int, Floats] = {}
        for layer in sorted({face // 2 for face in self.faces}):
            shares[layer] = np.zeros((2, 2, n, n))
            for (side, scatter), parts in self.parts[layer].items():
                k = SIDES.index(side)
                to = 1 - k if scatter == "transmission" else k
                shares[layer][k, to] = parts.shares(self.basis)[0]
        between = Scattered.of(beams, shares)
        again = (
            np.clip(between.often - between.once, 0.0, None) / self.basis.projected_solid_angles[None, :, None, None]
        )
        return {
            (leaves, arrives): again[p, :, q, :]
            for p, leaves in enumerate(between.faces)
            for q, arrives in enumerate(between.faces)
        }

    def _correlation(self) -> Floats:
        """Mean of products over product of means for ways in and out, along the normal: (side, to, arrives, leaves)."""
        faces = 2 * len(self.units)
        if sum(unit.glazing is not None for unit in self.units) < 2 or not self.faces:
            return np.ones((2, 2, faces, faces))
        normal = [direction(0.0, 0.0, side=side)[None, :] for side in SIDES]
        t, r = [], []
        m = len(self.spectrum.wavelength_nm)
        for unit, held in zip(self.units, self.parts, strict=True):
            if unit.glazing is not None:
                optics = unit.glazing.at(self.spectrum.wavelength_nm, 0.0)
                t.append(np.stack([optics.transmittance.mean(axis=0)[:, 0]] * 2))
                r.append(np.stack([p.mean(axis=0)[:, 0] for p in (optics.exterior, optics.interior)]))
            else:
                for found, scatter in ((t, "transmission"), (r, "reflection")):
                    values = [held[side, scatter].beam(normal[k], side, scatter) for k, side in enumerate(SIDES)]  # type: ignore[index, arg-type]
                    found.append(np.repeat(np.stack(values), m, axis=1))
        spectral, mean = Beams.of(np.stack(t), np.stack(r)), self._beams(normal)
        weights = self.spectrum.weights
        ratio = np.ones((2, 2, faces, faces))
        for side in range(2):
            for to in range(2):
                products = np.einsum("w,wa,we->ae", weights, spectral.entering[side], spectral.escaping(to))
                means = np.outer(mean.entering[side][0], mean.escaping(to)[0])
                np.divide(products, means, out=ratio[side, to], where=means > FAINT)
        return ratio
