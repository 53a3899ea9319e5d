"""Scan paths: directions that a detector passes, one after the other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.directions import angles, direction, outgoing_side

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from clerestory.directions import Side

    Floats = NDArray[np.float64]

Pattern = Literal["circle", "square"]
_MOST = 2_000_000
"""Points of a path."""


@dataclass(frozen=True)
class ScanPath:
    """Directions of outgoing light in the order in which they are passed."""

    kind: Literal["hemisphere", "circle", "square", "in-band"]
    side: Side
    """Side that the light leaves to."""
    theta_deg: Floats
    phi_deg: Floats
    step_deg: float
    """Distance of neighbouring directions [°]."""

    def __len__(self) -> int:
        return len(self.theta_deg)


def hemisphere_path(side: Side, *, step_deg: float = 5.0, largest_theta_deg: float = 85.0) -> ScanPath:
    """Rings from the normal outward, with about the same distance along and between them."""
    _check(step_deg, (360.0 / step_deg) * (largest_theta_deg / step_deg))
    theta, phi = [np.zeros(1)], [np.zeros(1)]
    for k, ring in enumerate(np.arange(step_deg, largest_theta_deg + 1e-9, step_deg)):
        count = max(6, round(360.0 * np.sin(np.radians(ring)) / step_deg))
        around = np.arange(count) * 360.0 / count
        theta.append(np.full(count, ring))
        phi.append(around if k % 2 == 0 else around[::-1])
    return ScanPath("hemisphere", side, np.concatenate(theta), np.concatenate(phi), step_deg)


def circle_path(centre: ArrayLike, *, radius_deg: float, step_deg: float) -> ScanPath:
    """Rings about an outgoing direction (3,), from the inside; what is beyond the horizon is left out."""
    _check(step_deg, 3.2 * (radius_deg / step_deg) ** 2)
    away, around = [np.zeros(1)], [np.zeros(1)]
    for r in np.arange(step_deg, radius_deg + 1e-9, step_deg):
        count = max(6, round(2.0 * np.pi * r / step_deg))
        away.append(np.full(count, r))
        around.append(np.arange(count) * 2.0 * np.pi / count)
    a, p = np.concatenate(away), np.concatenate(around)
    return _about(np.asarray(centre, np.float64), "circle", a * np.cos(p), a * np.sin(p), step_deg)


def square_path(centre: ArrayLike, *, half_width_deg: float, step_deg: float) -> ScanPath:
    """Lines to and fro about an outgoing direction (3,); what is beyond the horizon is left out."""
    return _band(np.asarray(centre, np.float64), half_width_deg, half_width_deg, step_deg, "square", None)


def in_band_path(incident: ArrayLike, side: Side, *, half_width_deg: float, step_deg: float) -> ScanPath:
    """Lines along and beside the plane of scattering, for samples that turn light in it, such as prisms and louvres.

    Parameters
    ----------
    incident
        Direction (3,) toward the source; along the normal the plane is the vertical one.
    side
        Side that the light leaves to.
    half_width_deg
        How far the outer lines are from the plane [°].
    """
    d = np.asarray(incident, dtype=np.float64)
    along = -d[:2] if np.hypot(*d[:2]) > 1e-9 else np.array([0.0, -1.0])
    right = np.array([*along, 0.0]) / np.hypot(*along)
    middle = np.array([0.0, 0.0, 1.0 if side == "interior" else -1.0])
    return _band(middle, 89.0, half_width_deg, step_deg, "in-band", right)


def _band(
    middle: Floats,
    half_length: float,
    half_width: float,
    step: float,
    kind: Literal["square", "in-band"],
    right: Floats | None,
) -> ScanPath:
    _check(step, 4.0 * half_length * half_width / step**2)
    across = step * np.arange(-np.floor(half_width / step + 1e-9), half_width / step + 1e-9)
    along = step * np.arange(-np.floor(half_length / step + 1e-9), half_length / step + 1e-9)
    u = np.concatenate([along if k % 2 == 0 else along[::-1] for k in range(len(across))])
    return _about(middle, kind, u, np.repeat(across, len(along)), step, right)


def _about(
    centre: Floats,
    kind: Literal["circle", "square", "in-band"],
    u_deg: Floats,
    v_deg: Floats,
    step_deg: float,
    right: Floats | None = None,
) -> ScanPath:
    """Directions at angles u along a great circle through the centre, and v from it."""
    middle = centre / np.linalg.norm(centre)
    if right is None:
        # The horizontal, except where that is the centre itself.
        aside = np.array([1.0, 0.0, 0.0]) if abs(middle[0]) < 0.9 else np.array([0.0, 1.0, 0.0])
        right = aside - (aside @ middle) * middle
        right /= np.linalg.norm(right)
    up = np.cross(middle, right)
    u, v = np.radians(u_deg)[:, None], np.radians(v_deg)[:, None]
    if kind == "circle":  # equal angles from the centre
        away = np.hypot(u, v)
        made = np.cos(away) * middle + np.sinc(away / np.pi) * (u * right + v * up)
    else:
        made = np.cos(v) * (np.cos(u) * middle + np.sin(u) * right) + np.sin(v) * up
    side: Side = "interior" if middle[2] > 0.0 else "exterior"
    theta, phi = angles(made[made[:, 2] * middle[2] > 1e-9])
    return ScanPath(kind, side, theta, phi, step_deg)


def without_source(path: ScanPath, incident: ArrayLike, incident_side: Side, shield_deg: float) -> ScanPath:
    """A path less what lies so close to the source that the detector shades its beam; only where light is reflected."""
    if path.side != outgoing_side(incident_side, "reflection") or shield_deg <= 0.0:
        return path
    d = direction(path.theta_deg, path.phi_deg, side=path.side)
    kept = d @ np.asarray(incident, np.float64) < np.cos(np.radians(shield_deg))
    return ScanPath(path.kind, path.side, path.theta_deg[kept], path.phi_deg[kept], path.step_deg)


def _check(step_deg: float, count: float) -> None:
    if not step_deg > 0.0 or count > _MOST:
        raise ClerestoryError(f"steps of {step_deg:g}° make no path (give more, up to {_MOST:,} points in all)")
