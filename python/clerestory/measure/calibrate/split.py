"""A matrix as a beam and the rest: what stands out of its diagonal, and what lies under it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import UnsupportedError
from clerestory.check.tables import neighbours

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from clerestory.model import Model

    Floats = NDArray[np.float64]


def beam_and_rest(model: Model) -> tuple[Floats, Floats]:
    """The beam of each incident patch [-] (n,), and the scattered light's BSDF [1/sr] (outgoing, incident).

    Under the beam the scattered light is taken as the mean of the patches about it (methods of the report's T_d-d: the
    value of the patch that light goes on in, less what its neighbours have).

    Raises
    ------
    UnsupportedError
        Incident and outgoing patches differ, so that there is no diagonal.
    """
    basis = model.incident_basis
    if basis != model.outgoing_basis:
        raise UnsupportedError("a matrix whose incident and outgoing patches differ has no diagonal (convert it first)")
    rest = model.values.copy()
    beam = np.zeros(len(basis))
    for patch, near in enumerate(neighbours(basis)):
        under = float(rest[near, patch].mean()) if len(near) else 0.0
        above = float(model.values[patch, patch]) - under
        if above > 0.0:
            beam[patch] = above * basis.projected_solid_angles[patch]
            rest[patch, patch] = under
    return beam, rest
