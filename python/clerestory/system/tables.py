"""A window's layers as tables on patches, solved band by band or wavelength by wavelength."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.basis import Basis
from clerestory.directions import SIDES, angles
from clerestory.system.glazing import Glazing
from clerestory.system.layer import Layer, Parts, components
from clerestory.system.network import Beams, Solution, solve
from clerestory.system.spectrum import VISIBLE_NM, Spectrum

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from clerestory.directions import Side
    from clerestory.system.window import Unit, Window

    Floats = NDArray[np.float64]

Specular = Literal["centre", "mean"]
EDGES_NM = (*range(300, 781, 40), *range(880, 2581, 100))
"""Limits of the bins in which windows with scattering layers are solved; 380 and 780 nm are among them."""
LOST = 0.01
"""Share of near-infrared light below nothing that passes as noise."""
SAMPLES = 8
"""Directions along each axis of a patch for a mean over it."""


class Tables:
    """Layers on patches."""

    def __init__(self, window: Window, basis: Basis, visible_share: float, specular: Specular) -> None:
        self.window, self.basis, self.specular = window, basis, specular
        self.visible_share = visible_share
        self.units = window.units
        self.notes: list[str] = []
        self._kept: dict[tuple[int, str], tuple[Floats, Floats, Floats | None, Floats]] = {}
        self.incident = [patch_directions(basis, side, specular) for side in SIDES]

    def broad(self, band: str, spectrum: Spectrum) -> Solution:
        """A band solved once, with means of the panes' values."""
        parts = [
            self._scattering(k, band) if unit.glazing is None else self._pane(unit.glazing, spectrum)
            for k, unit in enumerate(self.units)
        ]
        return _solved(parts)

    def by_wavelength(self, bands: dict[str, Spectrum]) -> dict[str, Solution]:
        """All bands, solved for every bin of wavelengths with the panes' means over it."""
        kept: dict[tuple[bytes, bytes], Solution] = {}
        found: dict[str, Solution] = {}
        for name, spectrum in bands.items():
            terms = []
            for weight, part in binned(spectrum):
                # The sun's bins beyond 780 nm serve solar and nir.
                key = part.wavelength_nm.tobytes(), np.round(part.weights, 12).tobytes()
                if key not in kept:
                    inside = VISIBLE_NM[0] <= part.wavelength_nm[0] <= VISIBLE_NM[1]
                    kept[key] = _solved(
                        [
                            self._pane(unit.glazing, part)
                            if unit.glazing is not None
                            else self._scattering(k, self._band_at(unit, inside=inside))
                            for k, unit in enumerate(self.units)
                        ]
                    )
                terms.append((weight, kept[key]))
            found[name] = Solution(
                *(
                    sum(weight * getattr(solution, part) for weight, solution in terms)
                    for part in ("beam", "scattered", "absorbed")
                )
            )
        return found

    def _band_at(self, unit: Unit, *, inside: bool) -> str:
        """The band that stands for a wavelength; what lacks one is taken as the same everywhere."""
        assert unit.layer is not None
        assert unit.layer.bsdf is not None
        held = unit.layer.bsdf.bands
        wanted = "visible" if inside else "nir"
        if wanted in held or (wanted == "nir" and {"visible", "solar"} <= set(held)):
            return wanted
        return "solar" if "solar" in held else held[0]

    def _pane(self, glazing: Glazing, spectrum: Spectrum) -> tuple[Floats, Floats, None, Floats]:
        theta = angles(self.incident[0])[0]
        unique, where = np.unique(np.round(theta, 9), return_inverse=True)
        curves = glazing._curves(unique, spectrum)
        reflectance = np.stack([curves.reflectance[side] for side in SIDES])
        absorbed = np.stack([curves.absorptance[side] for side in SIDES], axis=1)
        t, r, a = (
            values[..., where].reshape(*values.shape[:-1], len(self.basis), -1).mean(axis=-1)
            for values in (np.stack([curves.transmittance] * 2), reflectance, absorbed)
        )
        return t, r, None, a

    def _scattering(self, index: int, band: str) -> tuple[Floats, Floats, Floats | None, Floats]:
        if (index, band) not in self._kept:
            layer = self.units[index].layer
            assert layer is not None
            assert layer.bsdf is not None
            place = layer.called(1 + sum(len(unit) for unit in self.units[:index]))
            try:
                self._kept[index, band] = self._on_patches(layer, band, f"{place}, {band}: ")
            except ClerestoryError as error:
                raise type(error)(f"{place}: {error}") from None
        return self._kept[index, band]

    def _on_patches(self, layer: Layer, band: str, place: str) -> tuple[Floats, Floats, Floats | None, Floats]:
        assert layer.bsdf is not None
        n = len(self.basis)
        if band == "nir" and "nir" not in layer.bsdf.bands:
            # (solar − r·visible) / (1 − r), part by part: tables and beams alike.
            visible, solar = (self._scattering_of(layer, name, place) for name in ("visible", "solar"))
            r = self.visible_share
            t, f, s = ((b - r * a) / (1.0 - r) for a, b in zip(visible, solar, strict=True))
            below, above = (sum(np.clip(sign * v, 0.0, None).sum() for v in (t, f, s)) for sign in (-1.0, 1.0))
            if below > LOST * above:
                self.notes.append(
                    f"{place}its visible and solar values leave less than nothing for {100.0 * below / above:.1f} % of "
                    "the near infrared, which counts as 0"
                )
            t, f, s = (np.clip(values, 0.0, None) for values in (t, f, s))
        else:
            t, f, s = self._scattering_of(layer, band, place)
        absorbed = 1.0 - t - f - s.sum(axis=(1, 2))
        return t, f, (s if s.any() else None), absorbed.reshape(1, 2, n)

    def _scattering_of(self, layer: Layer, band: str, place: str) -> tuple[Floats, Floats, Floats]:
        assert layer.bsdf is not None
        n = len(self.basis)
        t, f, s = np.zeros((2, n)), np.zeros((2, n)), np.zeros((2, 2, n, n))
        held, notes = components(layer.bsdf, band)
        worst = 0.0
        for (side, scatter), parts in held.items():
            k = SIDES.index(side)
            beam = parts.beam(self.incident[k], side, scatter).reshape(n, -1).mean(axis=1)
            shares, error = parts.shares(self.basis)
            worst = max(worst, error)
            to = 1 - k if scatter == "transmission" else k
            s[k, to] = shares
            (t if scatter == "transmission" else f)[k] = beam
            self._note_basis(parts, place)
        if worst > 0.0:
            notes.append(f"converted to {self.basis.name} with a sampling error of {100.0 * worst:.2f} %")
        for note in notes:
            if place + note not in self.notes:
                self.notes.append(place + note)
        return t, f, s

    def _note_basis(self, parts: Parts, place: str) -> None:
        for _, model in parts.scattered:
            if model.kind == "matrix" and model.incident_basis != self.basis:
                note = f"{place}converted from {model.incident_basis.name} to {self.basis.name}"
                if note not in self.notes:
                    self.notes.append(note)


def binned(spectrum: Spectrum) -> list[tuple[float, Spectrum]]:
    """A spectrum in bins: the share of each, and its own spectrum."""
    # 380 and 780 nm belong to visible light.
    edges = [edge + (1e-6 if edge >= VISIBLE_NM[1] else -1e-6) for edge in EDGES_NM]
    number = np.digitize(spectrum.wavelength_nm, edges)
    bins = []
    for k in np.unique(number):
        inside = number == k
        share = float(spectrum.weights[inside].sum())
        bins.append((share, Spectrum(spectrum.wavelength_nm[inside], spectrum.weights[inside] / share)))
    return bins


def patch_directions(basis: Basis, side: Side, specular: Specular) -> Floats:
    """Incident directions (n·k, 3), k a patch."""
    if specular == "centre":
        return basis.incident_centres(side)
    if specular != "mean":
        raise ClerestoryError(f"specular {specular!r} is not known (give centre or mean)")
    steps = (np.arange(SAMPLES) + 0.5) / SAMPLES
    u = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 2)
    return np.concatenate([basis.sample_incident(k, u, side) for k in range(len(basis))])


def _solved(parts: list[tuple[Floats, Floats, Floats | None, Floats]]) -> Solution:
    beams = Beams.of(np.stack([t for t, *_ in parts]), np.stack([r for _, r, *_ in parts]))
    shares = {k: s for k, (_, _, s, _) in enumerate(parts) if s is not None}
    return solve(beams, shares, [a for *_, a in parts])
