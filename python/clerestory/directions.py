"""Directions: unit vectors pointing away from a sample, and the angles that people type.

The frame is right-handed: +z out of the interior face into the room, +y up, +x to the right as seen from the room.
Incident directions point toward the source, outgoing ones along the light.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from clerestory._core import ClerestoryError

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

    Raises
    ------
    ClerestoryError
        An angle to the normal is not one of 0 to 90°, an azimuth is not finite, or there is no such side.
    """
    if side not in SIDES:
        raise ClerestoryError(f"side {side!r} is not known (give exterior or interior)")
    polar, azimuth = np.asarray(theta_deg, dtype=np.float64), np.asarray(phi_deg, dtype=np.float64)
    beyond = polar[~((polar >= 0.0) & (polar <= 90.0))]
    if beyond.size:
        raise ClerestoryError(f"theta_deg {beyond[0]:g} is not an angle to the normal (give 0 to 90°, and a side)")
    if not np.isfinite(azimuth).all():
        raise ClerestoryError(f"phi_deg {azimuth[~np.isfinite(azimuth)][0]:g} is not an azimuth (give degrees)")
    theta, phi = np.broadcast_arrays(np.radians(polar), np.radians(azimuth))
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


_FROM = (
    "from the right",
    "from the upper right",
    "from above",
    "from the upper left",
    "from the left",
    "from the lower left",
    "from below",
    "from the lower right",
)
_TO = (
    "to the right",
    "up to the right",
    "upward",
    "up to the left",
    "to the left",
    "down to the left",
    "downward",
    "down to the right",
)


def incident_in_words(incident: ArrayLike) -> str:
    """Where light comes from, as seen from the room; a sun above gives "from above, 30°".

    Parameters
    ----------
    incident
        Direction (3,) toward the source.
    """
    return _in_words(incident, _FROM)


def outgoing_in_words(outgoing: ArrayLike) -> str:
    """Where light goes to, as seen from the room; "downward, 30°" for a sun above, straight through.

    Parameters
    ----------
    outgoing
        Direction (3,) along the light.
    """
    return _in_words(outgoing, _TO)


def _in_words(direction: ArrayLike, sectors: tuple[str, ...]) -> str:
    """The nearest of eight sectors and the polar angle; the azimuth too where the sector would mislead."""
    theta, phi = (round(float(a), 1) for a in angles(direction))
    if theta < 0.1:
        return "along the normal"
    sector = round(phi / 45.0)
    exact = abs(phi - 45.0 * sector) < 0.15
    return f"{sectors[sector % 8]}, {theta:g}°" + ("" if exact else f" (azimuth {phi:g}°)")
