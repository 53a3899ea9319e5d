"""Layers of a window: what scatters and what does not, by wavelength and band."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError, MissingDataError
from clerestory.basis import Basis
from clerestory.bsdf import Bsdf
from clerestory.directions import SCATTERS, SIDES, direction
from clerestory.model import Model
from clerestory.system.glass import Thermal

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from clerestory.directions import Scatter, Side
    from clerestory.system.glass import Pane

    Floats = NDArray[np.float64]

GAIN = 1e-3
"""Data that send out more than they receive by less than this pass."""


@dataclass(frozen=True)
class Gap:
    """Gas between two layers."""

    name: str
    width_m: float
    """Width [m]."""
    gas: dict[str, float]
    """Shares by volume of air, argon, krypton or xenon; they sum to 1."""


@dataclass(frozen=True)
class Layer:
    """A solid layer: a pane by its spectra, or anything that scatters."""

    name: str
    pane: Pane | None = None
    """A pane of glass."""
    bsdf: Bsdf | None = None
    """Anything else, in broad bands."""
    thermal: Thermal = field(default_factory=Thermal)
    """What heat asks of it."""
    warnings: tuple[str, ...] = ()
    number: int | None = None
    """Its place in a specification, where gaps count too."""

    def __post_init__(self) -> None:
        if (self.pane is None) == (self.bsdf is None):
            raise ClerestoryError(f"layer {self.name!r} is either a pane or a data set (give one of them)")

    def flipped(self) -> Layer:
        """Turned round."""
        return replace(
            self,
            pane=None if self.pane is None else self.pane.flipped(),
            bsdf=None if self.bsdf is None else self.bsdf.flipped(),
            thermal=self.thermal.flipped(),
        )

    def called(self, place: int) -> str:
        """Its number and name, for messages; `place` counts from 1 where it has no number of its own."""
        return f"layer {self.number or place} ({self.name})"


@dataclass(frozen=True)
class Parts:
    """A component's beams and its scattered light, apart."""

    beams: list[tuple[float, Model]]
    scattered: list[tuple[float, Model]]

    @classmethod
    def of(cls, model: Model, weight: float = 1.0) -> Parts:
        """Taken apart down to what is no sum; a separated model counts as scattered."""
        kind, _, _, arrays, parts = model._core.to_parts()
        if kind == "sum":
            weights = dict(arrays)["weights"]
            inner = [cls.of(Model(core), weight * float(w)) for w, core in zip(weights, parts, strict=True)]
            return cls([b for part in inner for b in part.beams], [s for part in inner for s in part.scattered])
        if kind.startswith(("specular", "beam")) or kind == "pane":
            return cls([(weight, model)], [])
        if kind == "turned":
            # A turned sum of a beam and a table is one of a turned beam and a turned table: ask what it holds.
            base = cls.of(Model(parts[0]))
            if not base.scattered:
                return cls([(weight, model)], [])
            if base.beams:
                raise ClerestoryError("a turned sum of beams and scattered light is not known here (turn its parts)")
        return cls([], [(weight, model)])

    def beam(self, incident: Floats, side: Side, scatter: Scatter) -> Floats:
        """Transmittance or reflectance of the beams (m,) for directions (m, 3) from a side."""
        value = np.zeros(len(incident))
        for weight, model in self.beams:
            made = Bsdf.from_models({(side, scatter): model})
            value += weight * made.integrate(incident, scatter, part="direct")
        return value

    def scattering(self) -> Model | None:
        """The scattered light as one model."""
        if not self.scattered:
            return None
        if len(self.scattered) == 1:
            weight, model = self.scattered[0]
            return model if weight == 1.0 else model.scaled(weight)
        return Model.sum(self.scattered)

    def shares(self, basis: Basis) -> tuple[Floats, float]:
        """Flux shares (outgoing, incident) of scattered light on a basis, and the RMS sampling error over the mean."""
        n = len(basis)
        values, error = np.zeros((n, n)), 0.0
        for weight, model in self.scattered:
            made = Bsdf.from_models({("exterior", "transmission"): model})
            if not (model.kind == "matrix" and model.incident_basis == basis == model.outgoing_basis):
                made = made.to_matrix(basis)
                error = max(error, *(report.rms_error or 0.0 for report in made.conversion))
            values += weight * np.clip(made.models["visible"]["exterior", "transmission"].values, 0.0, None)
        return values * basis.projected_solid_angles[:, None], error


def components(bsdf: Bsdf, band: str) -> tuple[dict[tuple[Side, Scatter], Parts], list[str]]:
    """The four components of a band, and notes on what its data did not give.

    Raises
    ------
    MissingDataError
        It has no reflection on a side, or no transmission at all.
    """
    found, notes = {}, []
    for side in SIDES:
        for scatter in SCATTERS:
            model, by_reciprocity = bsdf.model(side, scatter, band)
            if by_reciprocity:
                notes.append(f"{scatter} for light from the {side} was taken from the other side by reciprocity")
            found[side, scatter] = Parts.of(model)
    return found, notes


def refuse_gain(bsdf: Bsdf, bands: Iterable[str]) -> None:
    """Refuse data that send out more light than they get.

    Raises
    ------
    ClerestoryError
        By more than 0.1 %; the text names band, side and angle.
    """
    theta = np.array([0.0, 30.0, 50.0, 70.0])
    for band in bands:
        for side in SIDES:
            incident = direction(np.repeat(theta, 4), np.tile([45.0, 135.0, 225.0, 315.0], 4), side=side)
            total = np.sum([bsdf.integrate(incident, scatter, band=band) for scatter in SCATTERS], axis=0)
            worst = int(np.argmax(total))
            if total[worst] > 1.0 + GAIN:
                raise ClerestoryError(
                    f"{100.0 * total[worst]:.1f} % of the {band} light from the {side} at {theta[worst // 4]:g}° "
                    "leaves it (check the data; transmittance and reflectance sum to 1)"
                )


def refuse_missing(bsdf: Bsdf, band: str) -> None:
    """Refuse data without reflection on both sides and transmission.

    Raises
    ------
    MissingDataError
        The text names the component.
    """
    for side in SIDES:
        for scatter in SCATTERS:
            try:
                bsdf.model(side, scatter, band)
            except MissingDataError as error:
                raise MissingDataError(f"band {band!r}: {error}") from None
