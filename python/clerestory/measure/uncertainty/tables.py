"""Standard errors of matrices that were made of a fit."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory.directions import direction

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import NDArray

    from clerestory.bsdf import Bsdf
    from clerestory.directions import Scatter, Side
    from clerestory.measure.uncertainty.budget import Budget
    from clerestory.measure.uncertainty.estimate import Uncertainty

    Floats = NDArray[np.float64]

_PER_PATCH = np.array([[0.25, 0.25], [0.75, 0.75]])
"""Directions of an incident patch that stand for it: most are between measured ones."""


def with_errors(
    bsdf: Bsdf,
    found: Mapping[tuple[str, Side, Scatter], Uncertainty],
    *,
    progress: Callable[[float], object] | None = None,
) -> Bsdf:
    """A data set of matrices with the standard errors of the fit that it was made of.

    Parameters
    ----------
    bsdf
        Matrices whose outgoing patches are those of the uncertainties.
    found
        Of every component, as `uncertainties` gives it.

    Notes
    -----
    An incident patch has the root mean square of the errors of two of its directions: what is wrong in one of them is
    wrong in the other as well, so that errors do not average out within a patch.
    """
    models = {band: dict(members) for band, members in bsdf.models.items()}
    done, count = 0, sum(len(models[band][side, scatter].incident_basis) for band, side, scatter in found)
    for (band, side, scatter), one in found.items():
        model = models[band][side, scatter]
        errors, totals = np.zeros_like(model.values), np.zeros(len(model.incident_basis))
        for k in range(len(model.incident_basis)):
            budgets = [one.at(toward) for toward in model.incident_basis.sample_incident(k, _PER_PATCH, side)]
            errors[:, k] = np.sqrt(np.mean([b.flux_errors**2 for b in budgets], axis=0))
            totals[k] = np.sqrt(np.mean([b.total_error**2 for b in budgets]))
            done += 1
            if progress is not None:
                progress(done / count)
        errors /= model.outgoing_basis.projected_solid_angles[:, None]
        models[band][side, scatter] = model.with_standard_errors(errors, totals)
    return bsdf.with_models(models)


def budgets(one: Uncertainty) -> list[Budget]:
    """Budgets along one azimuth: in the measured polar angles and in the middle between them."""
    theta, phi = one.measured_plane()
    between = 0.5 * (theta[1:] + theta[:-1])
    every = np.sort(np.concatenate([theta, between]))
    return [one.at(direction(t, phi, side=one.component.side)) for t in every]
