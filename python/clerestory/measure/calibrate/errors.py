"""Standard errors of calibrated matrices."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory.directions import angles
from clerestory.measure.calibrate.factors import Factors

if TYPE_CHECKING:
    from collections.abc import Sequence

    from clerestory.measure.calibrate.known import Known
    from clerestory.model import Model


def with_sphere_errors(model: Model, here: Sequence[Known]) -> Model:
    """A calibrated component with the uncertainty of the sphere's values.

    The level of a calibrated component is the sphere's: its relative error, linear between the measured angles as the
    factors are, is that of the direct-hemispherical values. Values of patches have it beside their own errors, which
    tell how far the shape is known.

    Parameters
    ----------
    model
        After calibration. Models other than matrices hold no errors and stay as they are.
    here
        Values of the sphere that it was scaled to, of one component. Where one has no standard error, nothing is added.
    """
    known = [one for one in here if one.hemispherical]
    if model.kind != "matrix" or not known or any(one.standard_error is None for one in known):
        return model
    relative = Factors.of(
        [one.theta_deg for one in known],
        [one.phi_deg for one in known],
        [(one.standard_error or 0.0) / (one.hemispherical or 1.0) for one in known],
    ).at(*angles(model.incident_basis.incident_centres(known[0].side)))
    values = model.values
    own = np.zeros_like(values) if model.standard_errors is None else model.standard_errors
    totals = relative * (model.outgoing_basis.projected_solid_angles @ values)
    return model.with_standard_errors(np.hypot(own, values * relative), totals)
