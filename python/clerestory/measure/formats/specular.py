"""Directions about the specular one, as optics programs write them, and azimuths as seen from the lit side.

The specular direction is the mirrored one for reflection and straight through for transmission. Its polar angle from
there is the radial one; azimuth 0 points from it toward the normal, counter-clockwise as seen against the light.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory.directions import angles, direction, outgoing_side

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from clerestory.directions import Scatter, Side

    Floats = NDArray[np.float64]

HORIZON = 1e-6
"""Cosine up to which a direction counts as one along the surface, where no BSDF can be measured."""


def seen_from(side: Side, azimuth_deg: ArrayLike) -> Floats:
    """Azimuth [°] in the sample's frame of one counted counter-clockwise from the right by who looks at a side.

    Up is up for both, right and left swap for the exterior. The same turns an azimuth of the frame into theirs.
    """
    azimuth = np.asarray(azimuth_deg, dtype=np.float64)
    return (azimuth if side == "interior" else 180.0 - azimuth) % 360.0


def specular_frame(theta_deg: float, phi_deg: float, side: Side, scatter: Scatter) -> Floats:
    """Rows (3, 3): the specular direction of light from a direction, azimuth 0 about it, and azimuth 90°.

    Parameters
    ----------
    theta_deg
        Of the specular direction from the normal of the side that it leaves to [°].
    phi_deg
        Of the direction to the source [°].
    side
        That the light comes from.
    """
    exit_side = outgoing_side(side, scatter)
    specular = direction(theta_deg, phi_deg + 180.0, side=exit_side)
    theta, phi = np.radians(theta_deg), np.radians(phi_deg + 180.0)
    sign = 1.0 if exit_side == "interior" else -1.0
    # Minus the derivative of the specular direction by its polar angle, which has a limit at normal incidence, too.
    toward_normal = np.array([-np.cos(theta) * np.cos(phi), -np.cos(theta) * np.sin(phi), sign * np.sin(theta)])
    return np.stack([specular, toward_normal, np.cross(specular, toward_normal)])


def from_specular(
    radial_deg: ArrayLike, azimuth_deg: ArrayLike, theta_deg: float, phi_deg: float, side: Side, scatter: Scatter
) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    """Polar angles and azimuths [°] in the sample's frame, and which of them lie above the horizon.

    Parameters
    ----------
    radial_deg, azimuth_deg
        About the specular direction [°]. Any shapes that broadcast.
    theta_deg, phi_deg, side, scatter
        As of `specular_frame`.
    """
    radial, azimuth = np.broadcast_arrays(np.radians(radial_deg), np.radians(azimuth_deg))
    specular, zero, quarter = specular_frame(theta_deg, phi_deg, side, scatter)
    sine = np.sin(radial)
    outgoing = (
        np.cos(radial)[..., None] * specular
        + (sine * np.cos(azimuth))[..., None] * zero
        + (sine * np.sin(azimuth))[..., None] * quarter
    )
    sign = 1.0 if outgoing_side(side, scatter) == "interior" else -1.0
    theta, phi = angles(outgoing)
    return theta, phi, sign * outgoing[..., 2] > HORIZON


def to_specular(
    outgoing: Floats, theta_deg: float, phi_deg: float, side: Side, scatter: Scatter
) -> tuple[Floats, Floats]:
    """Radial angles and azimuths [°] about the specular direction of outgoing directions (..., 3)."""
    frame = specular_frame(theta_deg, phi_deg, side, scatter)
    along, zero, quarter = np.moveaxis(outgoing @ frame.T, -1, 0)
    return (
        np.degrees(np.arctan2(np.hypot(zero, quarter), along)),
        np.degrees(np.arctan2(quarter, zero)) % 360.0,
    )


def distinct(theta_deg: Floats, phi_deg: Floats, values: Floats) -> NDArray[np.bool_]:
    """Which points (n,) are not the repetition of an earlier one: the same direction with the same values.

    Tables repeat the pole in every row, and azimuth 0 as 360°.
    """
    # Azimuths lose their meaning toward the pole; directions do not.
    flat = direction(theta_deg, phi_deg)[..., :2]
    keys = np.column_stack([np.round(flat, 7) + 0.0, values])
    _, first = np.unique(keys, axis=0, return_index=True)
    kept = np.zeros(len(keys), dtype=bool)
    kept[first] = True
    return kept
