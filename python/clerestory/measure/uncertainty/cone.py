"""Light that the cones of source and detector carry across the border of a patch.

An instrument sees a BSDF that is blurred by its cones. To second order a second blur takes as much light across each
border as the first did, so that what the model would lose to one more is the error that it has. The integral over the
hemisphere keeps its light, but for what falls below the horizon.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from clerestory.bsdf import Bsdf
    from clerestory.measure.scan import Scan
    from clerestory.measure.uncertainty.patches import Patches

    Floats = NDArray[np.float64]


def cone_of(scans: Iterable[Scan]) -> float:
    """Full angle [°] of one cone that blurs as those of source and detector do together; 0 where no scan tells.

    Raises
    ------
    ClerestoryError
        A scan tells a cone that is none.
    """
    found = []
    for scan in scans:
        squares = 0.0
        for key in ("source_cone_deg", "detector_cone_deg"):
            text = scan.conditions.get(key, "0")
            try:
                value = float(text)
            except ValueError:
                value = float("nan")
            if not 0.0 <= value < 90.0:
                raise ClerestoryError(f"{key} {text!r} of a scan is not the angle of a cone (give degrees below 90)")
            squares += value**2
        found.append(np.sqrt(squares))
    return float(np.median(found)) if found else 0.0


def blurred(bsdf: Bsdf, incident: Floats, patches: Patches, cone_deg: float, values: Floats) -> tuple[Floats, float]:
    """Fluxes into patches (patches,) as seen through one more cone, and the light that it takes below the horizon.

    Parameters
    ----------
    cone_deg
        Full angle [°].
    values
        BSDF along the patches' directions [1/sr] (patches, each).

    Notes
    -----
    An even disk of radius r has the variance r²/4 along each axis, as have four points at r/√2 from its middle.
    """
    off = np.radians(0.5 * cone_deg) / np.sqrt(2.0)
    d = patches.directions
    helper = np.where(np.abs(d[..., :1]) < 0.7, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0])
    one = np.cross(d, helper)
    one /= np.linalg.norm(one, axis=-1, keepdims=True)
    other = np.cross(d, one)
    sums, lost = np.zeros(d.shape[:2]), np.zeros(d.shape[:2])
    for step in (one, -one, other, -other):
        moved = np.cos(off) * d + np.sin(off) * step
        above = moved[..., 2] * d[..., 2] > 0.0
        sums[above] += 0.25 * bsdf.evaluate(incident, moved[above])
        lost[~above] += 0.25 * values[~above]
    return patches.fluxes(sums), float(patches.fluxes(lost).sum())
