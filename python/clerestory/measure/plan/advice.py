"""What to know of a measurement before it is made, in words.

Source: the discussions of each laboratory's procedure in IEA SHC Task 61 report C.2.2 (2021), sections 2.1 to 2.6.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from clerestory.measure.plan.extent import Extent
    from clerestory.measure.plan.instrument import Instrument
    from clerestory.measure.plan.job import Job
    from clerestory.measure.plan.route import Route

_PATCH_DEG = 10.0
"""A patch of Klems' full basis is about so wide."""
_SUN_DEG = 0.53


def advice_of(job: Job, instrument: Instrument, extent: Extent, route: Route) -> tuple[str, ...]:
    """Sentences for a person, the most important first."""
    piece, made = job.sample, []
    missing = [s for s in job.scatter if s not in instrument.scatter]
    if missing:
        made.append(f"{' and '.join(missing)} is not seen by this instrument: take another for it.")
    if extent.largest_theta_deg <= 0.0:
        made.append(f"The smallest spot of {extent.spot_mm:g} mm is larger than the sample: light passes beside it.")
    elif extent.limited_by == "sample":
        made.append(
            f"The spot of {extent.spot_mm:g} mm grows with 1/cos θ and leaves the sample beyond "
            f"{math.floor(extent.largest_theta_deg * 10) / 10:g}°: beyond, take a larger sample or a smaller spot."
        )
    made.append(
        f"Nothing is measured beyond {min(extent.largest_theta_deg, instrument.largest_theta_deg):.3g}° of incidence: "
        "what a model says there is extrapolated, or simulated and joined (a hybrid model)."
    )
    made += _purpose(job, instrument)
    if piece.symmetry == "unknown":
        made.append(
            "Symmetry is not known, so all azimuths are planned: after the first scans at several azimuths drop those "
            "that repeat others."
        )
    elif piece.symmetry == "isotropic":
        made.append("One azimuth rests on isotropy: measure one angle at a second azimuth to check it.")
    elif piece.symmetry != "none":
        made.append("Verify the assumed symmetry by at least one direction from another quadrant.")
    if piece.weave == "rectangular" or (piece.weave != "none" and piece.symmetry == "rotational"):
        made.append("The weave needs azimuths of the adjacent quadrant: its mirror image is another fabric.")
    if not extent.turns_in_its_plane and piece.symmetry != "isotropic" and extent.holder is not None:
        made.append(
            f"The {extent.holder} does not turn the sample in its plane: each azimuth is a remounting, and reference "
            "beams are scanned anew after each."
        )
    if piece.translucent:
        made.append(
            "Light spreads inside the sample: a sphere with a small port loses some of it, so calibrate with the large "
            "sphere only, and keep the spot well inside of the sample's edges."
        )
    if instrument.kind == "scanning":
        made.append(
            "Scan the beam without a sample first and last, and the dark signal: their difference is the drift."
        )
    if "reflection" in job.scatter and "reflection" in instrument.scatter and instrument.shield_deg > 0.0:
        made.append(
            f"In reflection the detector shades the beam within {instrument.shield_deg:g}° of the source: leave those "
            "points of the hemisphere out."
        )
    if piece.period_mm > 0.0 and route.way == "measure" and extent.periods < 8.0:
        made.append(
            f"{extent.periods:.2g} periods are in the spot: shift the sample by half a period once, and compare."
        )
    if route.way == "material":
        made.append(
            "Measured surfaces in a traced geometry (first order) keep the geometry's own angles; a matrix of the "
            "whole (second order) is quicker to simulate with and blurs them. Check the traced system's "
            "direct-hemispherical values against a sphere's."
        )
    return tuple(made)


def _purpose(job: Job, instrument: Instrument) -> list[str]:
    if job.purpose == "klems":
        return [
            f"145 patches of some {_PATCH_DEG:g}° serve illuminance and heat gain; for glare or hours of direct sun "
            "measure finely."
        ]
    if job.purpose == "cut-off":
        return ["Steps of 1° about the geometry's cut-off are for the angle of cut-off; tilt errors shift it as much."]
    words = []
    if instrument.resolution_deg > _SUN_DEG:
        words.append(
            f"The instrument resolves {instrument.resolution_deg:g}°, the sun's disc is {_SUN_DEG}° wide: what comes "
            "straight through is wider and dimmer in the data than in the eye, unless the peak is separated."
        )
    if instrument.kind == "image" and job.purpose == "glare":
        words.append("An exit grid of some degrees is too coarse for glare: scan the peaks with a finer instrument.")
    return words
