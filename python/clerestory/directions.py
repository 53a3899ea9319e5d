"""Directions: unit vectors pointing away from a sample, and the angles that people type.

The frame is right-handed: +z out of the interior face into the room, +y up, +x to the right as seen from the room.
Incident directions point toward the source, outgoing ones along the light.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

Side = Literal["exterior", "interior"]
Scatter = Literal["transmission", "reflection"]
SIDES: tuple[Side, Side] = ("exterior", "interior")
SCATTERS: tuple[Scatter, Scatter] = ("transmission", "reflection")


def direction(theta_deg: ArrayLike, phi_deg: ArrayLike, *, side: Side = "exterior") -> NDArray[np.float64]:
    """Unit vectors from angles.

    Parameters
    ----------
    theta_deg
        Angle to the normal of `side` [°], 0 to 90. Any shape.
    phi_deg
        Azimuth counter-clockwise from +x as seen from the room [°], the same frame for both sides: a sun above
        has 90. Any shape that broadcasts with `theta_deg`.
    side
        The side that the direction points to.

    Returns
    -------
    Array of shape (..., 3).
    """
    theta, phi = np.broadcast_arrays(np.radians(theta_deg), np.radians(phi_deg))
    sign = 1.0 if side == "interior" else -1.0
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), sign * np.cos(theta)], axis=-1)


def angles(directions: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Angle to the normal of its own side and azimuth [°] of directions (..., 3)."""
    d = np.asarray(directions, dtype=np.float64)
    theta = np.degrees(np.arctan2(np.hypot(d[..., 0], d[..., 1]), np.abs(d[..., 2])))
    phi = np.degrees(np.arctan2(d[..., 1], d[..., 0])) % 360.0
    return theta, phi


def outgoing_side(incident: Side, scatter: Scatter) -> Side:
    """The side that light from `incident` leaves to."""
    if scatter == "reflection":
        return incident
    return "interior" if incident == "exterior" else "exterior"
