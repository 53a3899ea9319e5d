"""Data sets scaled to a sphere's values with reversed paths kept equal, reflection and both sides' transmission."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import UnsupportedError
from clerestory.directions import SIDES, outgoing_side
from clerestory.measure.calibrate import reciprocal as together
from clerestory.model import Model
from clerestory.words import percent

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from clerestory.basis import Basis
    from clerestory.bsdf import Bsdf
    from clerestory.directions import Scatter, Side

    Floats = NDArray[np.float64]


def reversible(bsdf: Bsdf, targets: dict[tuple[str, Side, Scatter], Floats], warnings: list[str]) -> Bsdf:
    """A data set of matrices whose patches have wanted direct-hemispherical values, reversed paths equal.

    Parameters
    ----------
    targets
        Values of the incident patches by band, side and scatter.
    warnings
        Gets what could not be had, in words.

    Raises
    ------
    UnsupportedError
        A model is no square matrix, or its patches have no reverse.
    """
    models: dict[str, dict[tuple[Side, Scatter], Model]] = {}
    for band in bsdf.bands:
        held = bsdf.models[band]
        for side in SIDES:
            wanted = targets.get((band, side, "reflection"))
            if wanted is None:
                continue
            model = held[side, "reflection"]
            basis = _reversible(model)
            _say_breach(model, model, f"{band}, reflection from the {side}", warnings)
            found = together.reflection(model.values, basis, wanted)
            models.setdefault(band, {})[side, "reflection"] = Model.matrix(found.values, basis)
            _say(found, f"{band}, reflection from the {side}", warnings)
        first: Side = "exterior" if (band, "exterior", "transmission") in targets else "interior"
        front = targets.get((band, first, "transmission"))
        if front is None:
            continue
        other = outgoing_side(first, "transmission")
        back = targets.get((band, other, "transmission"))
        model = held[first, "transmission"]
        basis = _reversible(model)
        where = f"{band}, transmission"
        if (other, "transmission") in held:
            _reversible(held[other, "transmission"])
            _say_breach(model, held[other, "transmission"], where, warnings)
        if back is None:
            # One side alone: its factors are those of its incident patches, and the other side is its reverse.
            sums = basis.projected_solid_angles @ np.maximum(model.values, 0.0)
            table = np.maximum(model.values, 0.0) * np.divide(front, sums, out=np.zeros_like(front), where=sums > 0.0)
        else:
            found = together.transmission(model.values, basis, front, back)
            _say(found, where, warnings)
            table = found.values
        made = Model.matrix(table, basis)
        models.setdefault(band, {})[first, "transmission"] = made
        if (other, "transmission") in held:
            models[band][other, "transmission"] = made.reciprocal()
    return bsdf.with_models(models)


def _reversible(model: Model) -> Basis:
    if model.kind != "matrix" or model.incident_basis != model.outgoing_basis:
        raise UnsupportedError(
            f"reversed paths are kept equal for square matrices, not a {model.kind} (convert it to klems-full first)"
        )
    if (model.incident_basis.reversed < 0).any():
        raise UnsupportedError(
            f"{model.incident_basis.name} has patches without a reverse (convert it to klems-full first)"
        )
    return model.incident_basis


def _say_breach(front: Model, back: Model, where: str, warnings: list[str]) -> None:
    breach = front.reciprocity_error(back)
    if breach > 0.01:
        warnings.append(f"{where}: reversed paths differed by {percent(breach)} before; they are equal now")


def _say(found: together.Scaled, where: str, warnings: list[str]) -> None:
    if abs(found.uneven - 1.0) > 0.01:
        warnings.append(
            f"{where}: the sphere's values of the two sides differ by {percent(abs(found.uneven - 1.0))} in the"
            " hemispherical value, which reciprocity makes equal; those from the interior were scaled"
        )
    if found.residual > 1e-4:
        warnings.append(
            f"{where}: no table with equal reversed paths has all these values; the largest difference is"
            f" {found.residual:.2g}"
        )
