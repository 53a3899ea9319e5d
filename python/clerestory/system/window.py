"""Windows: layers from outside to inside with gas between them, solved wavelength by wavelength or band by band."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError, MissingDataError
from clerestory.basis import Basis
from clerestory.bsdf import Bsdf
from clerestory.directions import SCATTERS, SIDES
from clerestory.model import Model
from clerestory.system.glazing import Glazing
from clerestory.system.layer import Gap, Layer, refuse_gain, refuse_missing
from clerestory.system.network import Solution
from clerestory.system.spectrum import Spectrum, standard
from clerestory.system.tables import Specular, Tables

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from clerestory.directions import Scatter, Side

    Floats = NDArray[np.float64]

BANDS = ("visible", "solar", "nir")


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
