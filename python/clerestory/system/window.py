"""Windows: layers from outside to inside with gas between them, solved wavelength by wavelength or band by band."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

import numpy as np

from clerestory._core import ClerestoryError, MissingDataError
from clerestory.basis import Basis
from clerestory.bsdf import Bsdf
from clerestory.directions import SCATTERS, SIDES, angles
from clerestory.model import Model
from clerestory.system.glazing import Glazing
from clerestory.system.layer import Gap, Layer, Parts, components, refuse_gain, refuse_missing
from clerestory.system.network import Beams, Solution, solve
from clerestory.system.spectrum import VISIBLE_NM, Spectrum, standard

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from clerestory.directions import Scatter, Side

    Floats = NDArray[np.float64]

Specular = Literal["centre", "mean"]
BANDS = ("visible", "solar", "nir")
EDGES_NM = (*range(300, 781, 40), *range(880, 2581, 100))
"""Limits of the bins in which windows with scattering layers are solved; 380 and 780 nm are among them."""
LOST = 0.01
"""Share of near-infrared light below nothing that passes as noise."""
SAMPLES = 8
"""Directions along each axis of a patch for a mean over it."""


@dataclass(frozen=True)
class Built:
    """A window solved on patches."""

    layers: list[str]
    """Names of the solid layers, outermost first."""
    basis: Basis
    bsdf: Bsdf
    """Scattered light as matrices and, where light travels along beams alone, beams by patch."""
    absorbed: dict[str, Floats]
    """By band: side of incidence (exterior, interior), layer, incident patch (2, k, n)."""
    difference: dict[str, float]
    """By band: how far the direct-hemispherical transmittance is at most from that of broad bands; empty if these were
    taken."""
    warnings: list[str] = field(default_factory=list)

    def absorptance(self, band: str, side: Side = "exterior") -> Floats:
        """Share of the incident light that each layer absorbs, (layer, patch); outermost first on either side.

        With transmittance and reflectance the layers sum to 1.

        Raises
        ------
        MissingDataError
            The band was not built.
        """
        if band not in self.absorbed:
            raise MissingDataError(f"the window has no band {band!r} (it has {', '.join(self.absorbed)})")
        return np.asarray(self.absorbed[band][SIDES.index(side)])

    @property
    def matrices(self) -> Bsdf:
        """The data set as matrices alone, beams on their diagonals, as XML files hold it."""
        return self.bsdf.to_matrix(self.basis)


@dataclass(frozen=True)
class Unit:
    """Layers that count as one: a run of panes, or a single layer that scatters."""

    glazing: Glazing | None
    layer: Layer | None

    def __len__(self) -> int:
        """Return the number of layers."""
        return 1 if self.glazing is None else len(self.glazing)


class Window:
    """Layers from the exterior to the interior, with gaps between them.

    Parameters
    ----------
    layers
        Solid layers, outermost first. Panes that follow each other are solved together, in each polarisation.
    gaps
        Gas between them, one fewer; none if only light is asked for.

    Raises
    ------
    ClerestoryError
        There is no layer, the number of gaps is wrong, or a layer sends out more light than it gets.
    MissingDataError
        A layer lacks a side. Texts name the layer's number and name.
    """

    def __init__(self, layers: Iterable[Layer], gaps: Sequence[Gap] = ()) -> None:
        self.layers, self.gaps = list(layers), list(gaps)
        if not self.layers:
            raise ClerestoryError("a window needs at least one layer")
        if self.gaps and len(self.gaps) != len(self.layers) - 1:
            raise ClerestoryError(
                f"{len(self.gaps)} gaps do not lie between {len(self.layers)} layers (give one fewer than layers)"
            )
        for number, layer in enumerate(self.layers, 1):
            if layer.bsdf is None:
                continue
            try:
                for band in layer.bsdf.bands:
                    refuse_missing(layer.bsdf, band)
                refuse_gain(layer.bsdf, layer.bsdf.bands)
            except ClerestoryError as error:
                raise type(error)(f"{layer.called(number)}: {error}") from None

    @property
    def units(self) -> list[Unit]:
        """The layers, with panes that follow each other as one."""
        units: list[Unit] = []
        for layer in self.layers:
            if layer.pane is None:
                units.append(Unit(None, layer))
            elif units and units[-1].glazing is not None:
                units[-1] = Unit(Glazing([*units[-1].glazing.panes, layer.pane]), None)
            else:
                units.append(Unit(Glazing([layer.pane]), None))
        return units

    def bands(self, norm: str = "en410") -> dict[str, Spectrum]:
        """The bands that all layers have, of visible, solar and nir.

        Near-infrared values of a layer that scatters follow from its visible and solar ones.

        Raises
        ------
        MissingDataError
            There is none; the text lists what each layer has.
        """
        spectra = standard(norm).bands
        held = []
        for layer in self.layers:
            if layer.pane is not None:
                held.append({name for name in BANDS if layer.pane.covers(spectra[name])})
            elif layer.bsdf is not None:
                names = set(layer.bsdf.bands)
                held.append(names | {"nir"} if {"visible", "solar"} <= names else names)
        common = [name for name in BANDS if all(name in names for names in held)]
        if not common:
            lists = (
                f"{layer.called(k)}: {', '.join(sorted(names)) or 'none of them whole'}"
                for k, (layer, names) in enumerate(zip(self.layers, held, strict=True), 1)
            )
            raise MissingDataError(f"the layers have no band in common ({'; '.join(lists)})")
        return {name: spectra[name] for name in common}

    def solve(
        self,
        basis: Basis | str = "klems-full",
        *,
        norm: str = "en410",
        spectral: bool = True,
        specular: Specular = "centre",
    ) -> Built:
        """Light through all layers, by the Klems method with beams kept apart.

        Parameters
        ----------
        basis
            Patches. Layers on other ones are converted, with the error in `warnings`.
        norm
            Standard whose spectra weigh the wavelengths: en410, iso9050 or nfrc300.
        spectral
            Panes that follow each other are always solved wavelength by wavelength. Beside layers that scatter, bins of
            40 to 100 nm are solved one by one, and such layers are taken as constant between 380 and 780 nm and beyond.
            Otherwise every band is solved once with mean values.
        specular
            A pane's value in a patch: at its nominal centre, as WINDOW does, or the mean over it.
        """
        chosen = Basis.named(basis) if isinstance(basis, str) else basis
        tables = Tables(self, chosen, standard(norm).visible_share, specular)
        bands = self.bands(norm)
        broad = {name: tables.broad(name, spectrum) for name, spectrum in bands.items()}
        found, difference = broad, {}
        # A run of panes alone is exact as it is: their means are taken after light went through all of them.
        if spectral and len(self.units) > 1 and any(unit.glazing for unit in self.units):
            found = tables.by_wavelength(bands)
            difference = {name: _apart(found[name], broad[name]) for name in found}
        warnings = [f"{layer.called(k)}: {text}" for k, layer in enumerate(self.layers, 1) for text in layer.warnings]
        return Built(
            [layer.name for layer in self.layers],
            chosen,
            _bsdf(found, chosen, self),
            {name: solution.absorbed for name, solution in found.items()},
            difference,
            warnings + tables.notes,
        )

    def sharpened(self, *, norm: str = "en410", basis: Basis | str = "klems-full") -> Bsdf:
        """At the layers' own resolution, see `clerestory.system.sharp.sharpened`."""
        from clerestory.system.sharp import sharpened

        return sharpened(self, norm=norm, basis=basis)


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


def _apart(one: Solution, other: Solution) -> float:
    """Largest difference of direct-hemispherical transmittances."""
    totals = [s.beam[0, 1] + s.scattered[0, 1].sum(axis=0) for s in (one, other)]
    return float(np.abs(totals[0] - totals[1]).max())


def _bsdf(found: dict[str, Solution], basis: Basis, window: Window) -> Bsdf:
    area = basis.projected_solid_angles
    bands: dict[str, dict[tuple[Side, Scatter], Model]] = {}
    for name, solution in found.items():
        bands[name] = {}
        for k, side in enumerate(SIDES):
            for scatter in SCATTERS:
                to = 1 - k if scatter == "transmission" else k
                beam, scattered = np.clip(solution.beam[k, to], 0.0, None), solution.scattered[k, to]
                parts = []
                if scattered.any() or not beam.any():
                    parts.append((1.0, Model.matrix(scattered / area[:, None], basis)))
                if beam.any():
                    parts.append((1.0, Model.specular(beam, basis=basis)))
                bands[name][side, scatter] = parts[0][1] if len(parts) == 1 else Model.sum(parts)
    return Bsdf.from_models(bands).with_metadata(**fields(window))


def fields(window: Window) -> dict[str, str | float]:
    """What is known of the whole window, by the names of `Metadata`."""
    known: dict[str, str | float] = {"name": " + ".join(layer.name for layer in window.layers)}
    thick = [layer.thermal.thickness_m for layer in window.layers]
    if window.gaps and all(thickness is not None for thickness in thick):
        known["thickness_m"] = sum(t for t in thick if t is not None) + sum(gap.width_m for gap in window.gaps)
    for name, value in (
        ("emissivity_exterior", window.layers[0].thermal.emissivity_exterior),
        ("emissivity_interior", window.layers[-1].thermal.emissivity_interior),
    ):
        if value is not None:
            known[name] = value
    return known
