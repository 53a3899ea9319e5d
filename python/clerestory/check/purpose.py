"""Whether the resolution of the data serves a purpose."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from clerestory._core import MissingDataError
from clerestory.directions import direction
from clerestory.finding import Finding
from clerestory.integrals import PROBES_DEG, direct_direct

if TYPE_CHECKING:
    from collections.abc import Iterator

    from clerestory.bsdf import Bsdf

Purpose = Literal["illuminance", "glare", "ase"]
PURPOSES: tuple[Purpose, ...] = ("illuminance", "glare", "ase")

SUN_DEG = 0.53
"""Width of the sun [°]."""
LIMITS_DEG = {"illuminance": 15.0, "glare": 2.0, "ase": 2.0}
"""Resolution [°] that a purpose asks for: a patch of the sky; or little more than the sun, whose image glares."""
COARSE_DEG = 30.0
"""Resolution [°] above which no beam can be told from scattered light."""
BEAM = 3e-4
"""Transmittance of a through-beam below which the sun behind it neither glares nor counts as direct sun."""

_NEEDS = {
    "illuminance": "the distribution of daylight",
    "glare": "glare from the sun's image",
    "ase": "hours of direct sun",
}


def purpose(bsdf: Bsdf, band: str, wanted: Purpose) -> Iterator[Finding]:
    """Compare the resolution for light from above with what a purpose asks for."""
    incident = direction(np.array(PROBES_DEG), 90.0)
    try:
        model, _ = bsdf.model("exterior", "transmission", band)
        resolution = bsdf.resolution_deg(incident, "transmission", band)
    except MissingDataError:
        yield Finding(
            "error", "purpose", band, f"no transmission, which {wanted} asks for", "ask for data of the transmission"
        )
        return
    where = f"{band}, transmission from the exterior"
    worst = float(resolution.max())
    limit = LIMITS_DEG[wanted]
    peaks = any(bsdf.peaks(d, "transmission", band) for d in incident)
    if wanted == "illuminance":
        if worst > limit:
            yield Finding(
                "warning",
                "purpose",
                where,
                f"the data resolve {worst:.2g}°, too coarse for {_NEEDS[wanted]} in a room",
                "use Klems full data or finer",
            )
        else:
            yield Finding(
                "note", "purpose", where, f"the resolution{_degrees(worst)} is fine enough for {_NEEDS[wanted]}", ""
            )
        return
    if worst <= limit or peaks:
        reason = "the through-beam is separate, which is" if peaks else f"the resolution{_degrees(worst)} is"
        yield Finding("note", "purpose", where, f"{reason} fine enough for {_NEEDS[wanted]}", "")
        return
    if not _has_beam(bsdf, band):
        yield Finding(
            "note",
            "purpose",
            where,
            f"the data resolve only {worst:.2g}° and show no through-beam; if the sample has none, they will do for "
            f"{_NEEDS[wanted]}",
            "look at the sample against a lamp: is it seen sharply?",
        )
        return
    spread = (worst / SUN_DEG) ** 2
    yield Finding(
        "warning",
        "purpose",
        where,
        f"the data resolve {worst:.2g}°, the sun is {SUN_DEG}° wide: its image is smeared over {spread:,.0f} times "
        f"its area, so that {_NEEDS[wanted]} will be wrong",
        "use a tensor tree of 1.4° or finer, or separate the peak: convert --separate-peaks"
        if model.kind == "matrix"
        else "use a finer tensor tree, or separate the peak: convert --separate-peaks",
    )


def _degrees(worst: float) -> str:
    return f" of {worst:.2g}°" if worst > 0.0 else ""


def _has_beam(bsdf: Bsdf, band: str) -> bool:
    """Whether the light about the continued direction stands out of that around it."""
    for theta in PROBES_DEG:
        d = direction(theta, 90.0)
        resolution = float(bsdf.resolution_deg(d, "transmission", band))
        if resolution > COARSE_DEG:
            continue
        inner = direct_direct(bsdf, d, band=band, cone_deg=1.5 * resolution).value
        outer = direct_direct(bsdf, d, band=band, cone_deg=3.0 * resolution).value
        # Light spread evenly would put a quarter of the large cone into the small one.
        if inner > BEAM and inner > 0.5 * outer:
            return True
    return False
