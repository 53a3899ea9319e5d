"""The components of a band as tables over patches, which all checks look at."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from clerestory.directions import incident_in_words, outgoing_side
from clerestory.integrals import direct_hemispherical
from clerestory.model import Model
from clerestory.words import patch_name

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from clerestory.basis import Basis
    from clerestory.bsdf import Bsdf
    from clerestory.directions import Scatter, Side

SAMPLES = 64
"""Pairs of directions a cell over which other models than matrices are averaged."""


@dataclass(frozen=True)
class Table:
    """One component as a matrix: the data's own, or their mean over Klems full patches."""

    band: str
    side: Side
    scatter: Scatter
    kind: str
    """Kind of the model that it stands for."""
    incident: Basis
    outgoing: Basis
    values: NDArray[np.float64]
    """BSDF [1/sr] (outgoing, incident)."""
    totals: NDArray[np.float64]
    """Direct-hemispherical value of each incident patch."""
    noise: float = 0.0
    """Relative difference that the sampling of a mean makes."""

    @property
    def own(self) -> bool:
        """Whether the data are such a table themselves."""
        return self.kind == "matrix"

    @property
    def where(self) -> str:
        """The component in words."""
        return f"{self.band}, {self.scatter} from the {self.side}"

    def at(self, patch: int) -> str:
        """An incident patch in words."""
        direction = self.incident.incident_centres(self.side)[patch]
        return f"light {incident_in_words(direction)} ({patch_name(self.incident, patch)})"

    @cached_property
    def positive(self) -> NDArray[np.float64]:
        """The values, negative ones as zero, as all results take them."""
        return np.maximum(self.values, 0.0)

    @cached_property
    def weights(self) -> NDArray[np.float64]:
        """Products of projected solid angles [sr²] (outgoing, incident)."""
        return np.outer(self.outgoing.projected_solid_angles, self.incident.projected_solid_angles)

    @cached_property
    def hemispherical(self) -> float:
        """Hemispherical-hemispherical value under uniform radiance."""
        return float(self.incident.projected_solid_angles @ self.totals / np.pi)

    @property
    def square(self) -> bool:
        """Whether incident and outgoing patches are the same."""
        return self.incident == self.outgoing

    def difference(self, other: NDArray[np.float64]) -> float:
        """Σ|a − b|ΛΛ / ΣaΛΛ, the relative difference of the light's distribution, beyond the noise of a mean."""
        light = float(np.sum(self.positive * self.weights))
        if light <= 0.0:
            return 0.0
        difference = float(np.sum(np.abs(self.positive - np.maximum(other, 0.0)) * self.weights)) / light
        return max(0.0, difference - self.noise)


def tables(bsdf: Bsdf, band: str) -> dict[tuple[Side, Scatter], Table]:
    """All components that a band holds."""
    members = bsdf.models[band]
    found = {
        (side, scatter): of_model(band, side, scatter, model)
        for (side, scatter), model in members.items()
        if model.kind == "matrix"
    }
    if len(found) == len(members):
        return found
    # Two independent means: their difference is the noise of the checks.
    first, second = (bsdf.to_matrix("klems-full", samples=SAMPLES, bands=[band], seed=k).models[band] for k in (0, 1))
    for (side, scatter), model in members.items():
        if (side, scatter) in found:
            continue
        one, two = (of_model(band, side, scatter, means[side, scatter]) for means in (first, second))
        # The model's own totals are exact, which sums over sampled cells are not.
        totals = direct_hemispherical(bsdf, scatter, side=side, band=band, basis=one.incident).values
        values, noise = 0.5 * (one.values + two.values), one.difference(two.values)
        found[side, scatter] = replace(one, kind=model.kind, values=values, totals=totals, noise=noise)
    return {key: found[key] for key in members}


def of_model(band: str, side: Side, scatter: Scatter, model: Model) -> Table:
    """The table of a matrix."""
    outgoing, values = model.outgoing_basis, model.values
    totals = np.asarray(outgoing.projected_solid_angles @ np.maximum(values, 0.0))
    return Table(band, side, scatter, "matrix", model.incident_basis, outgoing, values, totals)


def reciprocal(table: Table) -> Table | None:
    """The component of the reversed paths: the other side's transmission, or the same reflection; None if no table."""
    turned = Model.matrix(table.values, table.incident, table.outgoing).reciprocal()
    if turned.kind != "matrix":
        return None
    side = table.side if table.scatter == "reflection" else outgoing_side(table.side, "transmission")
    return of_model(table.band, side, table.scatter, turned)


def neighbours(basis: Basis) -> list[NDArray[np.int64]]:
    """The patches that touch each patch: beside it in its ring, and across in the next ones."""
    limits = basis.limits_deg
    middle, half = limits[:, 2:].mean(axis=1), 0.5 * (limits[:, 3] - limits[:, 2])
    touching = []
    for k in range(len(basis)):
        apart = np.abs((middle - middle[k] + 180.0) % 360.0 - 180.0)
        beside = apart <= half + half[k] + 1e-6
        near = (limits[:, 0] <= limits[k, 1] + 1e-6) & (limits[:, 1] >= limits[k, 0] - 1e-6) & beside
        near[k] = False
        touching.append(np.flatnonzero(near))
    return touching
