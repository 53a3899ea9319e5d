"""Tables of a BSDF on half and difference angles (Rusinkiewicz 1998)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]


def half_difference(incident: Floats, outgoing: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Polar angle and azimuth of the halfway vector and of the incident direction about it [°].

    Parameters
    ----------
    incident, outgoing
        Unit vectors (..., 3) on the side where z is up; those of transmitted light are mirrored to it.

    References
    ----------
    S. Rusinkiewicz, A New Change of Variables for Efficient BRDF Representation, EGWR 1998.
    """
    half = incident + outgoing
    half /= np.linalg.norm(half, axis=-1, keepdims=True)
    theta_h, phi_h = np.arccos(np.clip(half[..., 2], -1.0, 1.0)), np.arctan2(half[..., 1], half[..., 0])
    cosine, sine = np.cos(phi_h), np.sin(phi_h)
    x = cosine * incident[..., 0] + sine * incident[..., 1]
    y = cosine * incident[..., 1] - sine * incident[..., 0]
    along = np.cos(theta_h) * x - np.sin(theta_h) * incident[..., 2]
    up = np.sin(theta_h) * x + np.cos(theta_h) * incident[..., 2]
    theta_d, phi_d = np.arctan2(np.hypot(along, y), up), np.arctan2(y, along)
    return np.degrees(theta_h), np.degrees(phi_h) % 360.0, np.degrees(theta_d), np.degrees(phi_d) % 360.0


@dataclass(frozen=True)
class HalfDifference:
    """A BSDF [1/sr] on rising lists of half and difference angles [°]."""

    theta_h_deg: Floats
    phi_h_deg: Floats | None
    """None where the BSDF does not depend on it."""
    theta_d_deg: Floats
    phi_d_deg: Floats
    values: Floats
    """(phi_d, theta_d, phi_h, theta_h, channels)"""
    mirrored: bool = False
    """Azimuths of difference beyond 180° are those of the mirrored side."""
    reciprocal: bool = False
    """Azimuths of difference 180° apart are the same."""

    def evaluate(self, theta_i_deg: float, phi_i_deg: float, theta_o_deg: Floats, phi_o_deg: Floats) -> Floats:
        """BSDF [1/sr] (n, channels) toward directions (n,), linear in every angle; NaN beyond the lists.

        Azimuths [°] are those of the table, both from the lit side.
        """
        from scipy.interpolate import RegularGridInterpolator

        incident = np.broadcast_to(_upper(np.array([theta_i_deg]), np.array([phi_i_deg])), (len(theta_o_deg), 3))
        theta_h, phi_h, theta_d, phi_d = half_difference(incident, _upper(theta_o_deg, phi_o_deg))
        if self.reciprocal:
            phi_d = phi_d % 180.0
        if self.mirrored:
            period = 180.0 if self.reciprocal else 360.0
            phi_d = np.minimum(phi_d, period - phi_d)
        axes = [
            (self.phi_d_deg, phi_d),
            (self.theta_d_deg, theta_d),
            (self.phi_h_deg, phi_h),
            (self.theta_h_deg, theta_h),
        ]
        values = self.values
        grid, asked = [], []
        for axis, (angles, where) in enumerate(axes):
            if angles is None or len(angles) == 1:
                continue
            if axis in (0, 2):
                angles, values = _around(angles, values, axis, folded=axis == 0 and (self.mirrored or self.reciprocal))
            grid.append(angles)
            asked.append(where)
        # One angle says that the BSDF does not depend on it.
        kept = [k for k, (angles, _) in enumerate(axes) if angles is not None and len(angles) > 1]
        values = values.reshape(*(values.shape[k] for k in kept), values.shape[-1])
        if not grid:
            return np.broadcast_to(values, (len(theta_o_deg), values.shape[-1])).copy()
        look = RegularGridInterpolator(grid, values, bounds_error=False, fill_value=np.nan)
        found: Floats = look(np.column_stack(asked))
        return found


def _upper(theta_deg: Floats, phi_deg: Floats) -> Floats:
    theta, phi = np.radians(theta_deg), np.radians(phi_deg)
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)


def _around(angles: Floats, values: Floats, axis: int, *, folded: bool) -> tuple[Floats, Floats]:
    """A circle's list that ends before 360° with its begin repeated there."""
    if folded or angles[-1] >= 360.0 or angles[0] > 0.0:
        return angles, values
    return np.append(angles, 360.0), np.concatenate([values, np.take(values, [0], axis=axis)], axis=axis)
