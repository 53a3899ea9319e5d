"""Light in directions that no point lies in: how far the model's continuation can be off.

A model keeps the BSDF of the outermost points. It could as well go on as it came: the difference between both, as the
half width of a rectangle of equally likely values, is the uncertainty, with a tenth of the light at least.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from clerestory.bsdf import Bsdf
    from clerestory.measure.uncertainty.patches import Patches

    Floats = NDArray[np.float64]

LEAST = 0.1
"""Share of the light beyond the points that is uncertain even where the BSDF is even up to them."""
_FACTOR = 3.0
"""A continuation changes the BSDF by no more."""
_RECTANGLE = np.sqrt(3.0)


def beyond_points(
    bsdf: Bsdf, incident: Floats, patches: Patches, values: Floats, beyond: NDArray[np.bool_], limit_deg: float
) -> tuple[Floats, float]:
    """Standard uncertainties of the fluxes into patches (patches,) and of their sum.

    Parameters
    ----------
    incident
        Toward the source (3,).
    values
        BSDF along the patches' directions [1/sr] (patches, each).
    beyond
        Whether each of them lies where nothing was measured.
    limit_deg
        Largest measured outgoing angle [°].
    """
    half_width = np.zeros_like(values)
    directions = patches.directions[beyond]
    if len(directions):
        theta = np.arccos(np.clip(np.abs(directions[:, 2]), 0.0, 1.0))
        limit = np.radians(limit_deg)
        # As far inside of the last points as the direction is outside; in a gap between points there is no trend.
        inside = np.where(theta > limit, np.maximum(2.0 * limit - theta, 0.0), theta)
        edge = bsdf.evaluate(incident, _at(directions, np.minimum(theta, limit)))
        before = bsdf.evaluate(incident, _at(directions, inside))
        ratio = np.divide(edge, before, out=np.ones_like(edge), where=before > 0.0)
        off = np.abs(np.clip(ratio, 1.0 / _FACTOR, _FACTOR) - 1.0)
        half_width[beyond] = values[beyond] * np.hypot(off, LEAST)
    fluxes = patches.fluxes(half_width) / _RECTANGLE
    return fluxes, float(fluxes.sum())


def _at(directions: Floats, theta: Floats) -> Floats:
    """The same azimuths at other angles from the normal [rad]."""
    across = np.linalg.norm(directions[:, :2], axis=1)
    unit = np.divide(
        directions[:, :2], across[:, None], out=np.zeros((len(directions), 2)), where=across[:, None] > 0.0
    )
    return np.column_stack([unit * np.sin(theta)[:, None], np.copysign(np.cos(theta), directions[:, 2])])
