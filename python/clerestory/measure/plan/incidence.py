"""Incident directions: steps of the polar angle at azimuths that symmetry asks for, or patches of a basis.

Source: IEA SHC Task 61 report C.2.2 (2021), sections 2.1 (steps of 10°, azimuths every 15° for anisotropic samples),
2.2 (subsets of Klems' basis; azimuths from 0° to 90° or to 180° by symmetry), 2.3 (0° to 80°, 8° included, steps of 1°
near a cut-off; at least three azimuths for a weave, and those of the next quadrant for a rectangular weave or
rotational symmetry of order 2) and 2.4 (directions that symmetry makes redundant are left out).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory.basis import Basis
from clerestory.directions import angles

if TYPE_CHECKING:
    from clerestory.directions import Side
    from clerestory.measure.plan.job import Directions, Piece, Symmetry

STEP_DEG = 10.0
NEAR_NORMAL_DEG = 8.0
FINE_DEG = 1.0
NEAR_CUT_OFF_DEG = 5.0
"""Steps are fine this far [°] to both sides of a cut-off."""
AZIMUTH_STEP_DEG = 15.0

# Where azimuths of one representative of each incident direction lie [°]: from, to, and whether `to` belongs to it.
_RANGES: dict[Symmetry, tuple[float, float, bool]] = {
    "isotropic": (90.0, 90.0, True),
    "quadrilateral": (0.0, 90.0, True),
    # Left and right are alike: the right half of the sky, from below to above, as seen from the room.
    "left-right": (-90.0, 90.0, True),
    # The upper half.
    "up-down": (0.0, 180.0, True),
    "rotational": (0.0, 180.0, False),
    "none": (0.0, 360.0, False),
    "unknown": (0.0, 360.0, False),
}


def polar_angles(largest_deg: float, cut_off_deg: float | None = None) -> list[float]:
    """Angles of incidence [°]: 0, 8, 10, 20, … as far as they go, and every degree near a cut-off."""
    angles = {*np.arange(0.0, 81.0, STEP_DEG).tolist(), NEAR_NORMAL_DEG}
    if cut_off_deg is not None:
        first = np.floor(cut_off_deg - NEAR_CUT_OFF_DEG)
        last = np.ceil(cut_off_deg + NEAR_CUT_OFF_DEG)
        angles |= {*np.arange(max(first, 0.0), last + 0.5, FINE_DEG).tolist()}
    return sorted(a for a in angles if a <= largest_deg + 1e-9)


def azimuths(piece: Piece, *, step_deg: float = AZIMUTH_STEP_DEG) -> list[float]:
    """Azimuths of incidence [°] that symmetry leaves to be measured.

    A weave has three a quadrant, 0°, 45° and 90°; one with rectangular meshes or of rotational symmetry of order 2 has
    those of the next quadrant too.
    """
    if piece.weave != "none":
        first = [0.0, 45.0, 90.0]
        if piece.symmetry == "quadrilateral" and piece.weave == "square":
            return first
        if piece.symmetry in ("none", "unknown"):
            return [45.0 * k for k in range(8)]
        if piece.symmetry == "left-right":
            return [-90.0, -45.0, *first]
        if piece.symmetry == "up-down":
            return [*first, 135.0, 180.0]
        return [*first, 135.0]
    low, high, closed = _RANGES[piece.symmetry]
    count = round((high - low) / step_deg)
    return [low + step_deg * k for k in range(count + (1 if closed else 0))]


def steps(piece: Piece, largest_deg: float, *, azimuth_step_deg: float = AZIMUTH_STEP_DEG) -> list[tuple[float, float]]:
    """Polar angles and azimuths [°] of incidence; along the normal there is one."""
    turns = azimuths(piece, step_deg=azimuth_step_deg)
    made = []
    for theta in polar_angles(largest_deg, piece.cut_off_deg):
        made += [(theta, phi % 360.0) for phi in (turns if theta > 0.0 else turns[:1])]
    return made


def subset(
    name: Directions, symmetry: Symmetry, largest_deg: float, side: Side = "exterior"
) -> list[tuple[float, float]]:
    """Centres of the patches of a basis that symmetry leaves to be measured, as polar angles and azimuths [°].

    For an isotropic sample, one patch of each ring. Patches beyond the largest angle are left out.
    """
    theta, phi = angles(Basis.named(name).incident_centres(side))
    theta, phi = np.round(theta, 6) + 0.0, np.where(theta < 1e-6, 0.0, np.round(phi, 6) % 360.0)
    low, high, closed = _RANGES[symmetry]
    made: list[tuple[float, float]] = []
    seen: set[float] = set()
    for t, p in zip(theta.tolist(), phi.tolist(), strict=True):
        if t > largest_deg + 1e-9:
            continue
        if symmetry == "isotropic":
            if t not in seen:
                made.append((t, p))
                seen.add(t)
            continue
        turned = (p - low) % 360.0
        if turned < high - low - 1e-6 or (closed and turned <= high - low + 1e-6) or t == 0.0:
            made.append((t, p))
    return made


def images(theta_deg: float, phi_deg: float, symmetry: Symmetry) -> list[tuple[float, float]]:
    """All incident directions that a symmetry makes equal to one, itself included (isotropic: itself)."""
    turns = {
        "quadrilateral": (phi_deg, -phi_deg, 180.0 - phi_deg, 180.0 + phi_deg),
        "left-right": (phi_deg, 180.0 - phi_deg),
        "up-down": (phi_deg, -phi_deg),
        "rotational": (phi_deg, 180.0 + phi_deg),
    }.get(symmetry, (phi_deg,))
    return sorted({(theta_deg, round(p % 360.0, 6) % 360.0) for p in turns})
