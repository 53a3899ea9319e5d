"""From the sky's patches to the light of windows and of what they light: the products of the matrix methods.

Three phases: E = V T D s (Ward, Mistrick, Lee, McNeil and Jonsson 2011, Leukos 7). What windows return into the room
is followed to its end: L = T D s + R W L, with R their reflection and W the room's return, where the published method
has black windows.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory import _core
from clerestory._core import ClerestoryError, MissingDataError
from clerestory.integrals import straight_through

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from clerestory.basis import Basis
    from clerestory.bsdf import Bsdf
    from clerestory.directions import Scatter, Side

    Doubles = NDArray[np.float64]
    Floats = NDArray[np.float32]


_PROBES = 64
"""Steps along each axis of the square at which beams are looked up for patches."""


@dataclass(frozen=True)
class Transfer:
    """How a system passes light between the patches of a basis."""

    transmission: Floats
    """(outgoing, incident) radiance of a patch into the room by the radiance of a patch from outside."""
    beam: Floats
    """(incident) its part that goes straight on as a beam."""
    reflection: Floats
    """(outgoing, incident) the same of light from the room that returns to it; 0 where the data set has none."""

    @classmethod
    def of(cls, bsdf: Bsdf, basis: Basis, band: str | None = None) -> Transfer:
        """Of a data set; its beams go into the patches that they fall into."""
        matrix = bsdf.to_matrix(basis, bands=None if band is None else [band])
        weights = basis.projected_solid_angles

        def table(side: Side, scatter: Scatter) -> Floats:
            model, _ = matrix.model(side, scatter, band)
            return np.ascontiguousarray(np.maximum(model.values, 0.0) * weights, dtype=np.float32)

        transmission = table("exterior", "transmission")
        points, patch = probes(basis, _PROBES)
        passed = np.bincount(patch, straight_through(bsdf, -points, band), minlength=len(basis))
        beam = (passed / np.bincount(patch, minlength=len(basis))).astype(np.float32)
        try:
            reflection = table("interior", "reflection")
        except MissingDataError:
            reflection = np.zeros_like(transmission)
        return cls(transmission, np.minimum(beam, np.diag(transmission)), reflection)


def probes(basis: Basis, steps: int) -> tuple[Doubles, NDArray[np.int64]]:
    """Directions (n, 3) of light into the room, `steps` along each axis of the square, and the patch (n) of each.

    A patch that is too small for one has its centre.
    """
    points = _core.square_directions(steps)
    patch = basis.index_of_outgoing(points)
    left = np.setdiff1d(np.arange(len(basis)), patch)
    return np.concatenate([points, basis.outgoing_centres("interior")[left]]), np.concatenate([patch, left])


def leaving(transfers: Sequence[Transfer], returned: Sequence[Floats] | None = None) -> Floats:
    """Radiance of all groups' patches by the radiance that arrives at them from outside.

    Parameters
    ----------
    transfers
        Of each group.
    returned
        Of each group (patches, groups · patches): the room's light at its inner side by the groups' patches; None for
        windows that are black from inside.

    Returns
    -------
    Array (groups · patches, groups · patches); columns are incident patches of each group.
    """
    size = len(transfers[0].transmission)
    for k, transfer in enumerate(transfers):
        if len(transfer.transmission) != size:
            raise ClerestoryError(
                f"windows of {len(transfer.transmission)} patches (group {k + 1}) do not go with {size} of the first "
                "group (give all transfers one basis)"
            )
    shape = (size, len(transfers) * size)
    for k, matrix in enumerate(returned or ()):
        if matrix.shape != shape:
            raise ClerestoryError(
                f"what the room returns to group {k + 1} is {matrix.shape[0]} × {matrix.shape[1]}, where the windows' "
                f"interior patches make it {shape[0]} × {shape[1]} (find both on one basis)"
            )
    whole = np.zeros((len(transfers) * size,) * 2, dtype=np.float64)
    for k, transfer in enumerate(transfers):
        whole[k * size : (k + 1) * size, k * size : (k + 1) * size] = transfer.transmission
    if returned is None:
        return whole.astype(np.float32)
    back = np.concatenate([t.reflection.astype(np.float64) @ w for t, w in zip(transfers, returned, strict=True)])
    return np.linalg.solve(np.eye(len(whole)) - back, whole).astype(np.float32)
