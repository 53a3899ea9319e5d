"""The geometry of slats: profile angle of the sun, what passes between them, and the tilt that keeps it out.

Slats are thin arcs over their chord, one above the other without end. In the section a ray of profile angle Ω is a
line; projected along it a slat is an interval, and the sun is kept out where the interval is at least as long as the
distance between slats, S cos Ω. With ψ = tilt + Ω, half the arc's angle α and its radius R = W / (2 sin α), the
interval is W sin ψ long for ψ ≥ α, as a flat slat's, and R (1 - cos(α + ψ)) below, where the crown is in the way.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Doubles = NDArray[np.float64]


def profile_angle(toward: ArrayLike, frame: ArrayLike) -> Doubles:
    """Profile angle (n) [rad] of directions (n, 3) toward the sun: its height in the section across the slats.

    tan Ω = tan(altitude) / cos(azimuth from the façade's normal) for upright windows. Not a number behind the window.

    Parameters
    ----------
    toward
        In the world.
    frame
        Axes of the window in the world (3, 3), a row each: x along the slats, y up, z into the room.
    """
    local = np.asarray(toward, dtype=np.float64) @ np.asarray(frame, dtype=np.float64).T
    before = local[..., 2] < 0.0
    return np.where(before, np.arctan2(local[..., 1], -local[..., 2]), np.nan)


@dataclass(frozen=True)
class Slats:
    """Slats of a blind; lengths in any one unit."""

    width: float
    """From edge to edge, W."""
    pitch: float
    """From slat to slat, S."""
    crown: float = 0.0
    """Height of the middle over the edges; negative for a hollow slat, which keeps out the same."""

    def __post_init__(self) -> None:
        if not (self.width > 0.0 and self.pitch > 0.0):
            raise ClerestoryError(
                f"slats {self.width:g} wide at a distance of {self.pitch:g} are not possible (give lengths above 0)"
            )
        if abs(self.crown) > 0.5 * self.width:
            raise ClerestoryError(
                f"a crown of {self.crown:g} is more than a half circle over {self.width:g} (give half of that or less)"
            )

    @property
    def edge_angle(self) -> float:
        """Slope of the slat at its edges, α [rad]; 0 for a flat one."""
        return 2.0 * math.atan(2.0 * abs(self.crown) / self.width)

    def passed(self, tilt: ArrayLike, profile: ArrayLike) -> Doubles:
        """Share of the sun's light that passes without meeting a slat, 0 to 1.

        Parameters
        ----------
        tilt
            Angle of the slats [rad]: 0 level, positive with the outer edge below the inner one.
        profile
            Profile angle of the sun [rad], inside ±π/2.
        """
        angle = np.asarray(profile, dtype=np.float64)
        gap = self.pitch * np.cos(angle)
        return np.asarray(np.maximum(0.0, 1.0 - self._shadow(np.asarray(tilt) + angle) / gap))

    def cut_off(self, profile: ArrayLike) -> Doubles:
        """Least tilt [rad] that keeps the sun out: asin(S cos Ω / W) - Ω for flat slats.

        Not a number where none does, and −∞ where any does.

        Parameters
        ----------
        profile
            Profile angle of the sun [rad], inside ±π/2.
        """
        angle = np.asarray(profile, dtype=np.float64)
        gap = self.pitch * np.cos(angle)
        with np.errstate(invalid="ignore"):
            needed = np.arcsin(gap / self.width)
            alpha = self.edge_angle
            if alpha > 0.0:
                radius = 0.5 * self.width / math.sin(alpha)
                by_crown = np.arccos(1.0 - gap / radius) - alpha
                needed = np.where(needed < alpha, np.where(by_crown > 0.0, by_crown, -np.inf), needed)
        return np.asarray(needed - angle)

    def _shadow(self, psi: Doubles) -> Doubles:
        """Length of a slat across the rays that it makes an angle ψ with."""
        if self.crown == 0.0:
            return np.asarray(self.width * np.abs(np.sin(psi)))
        # A slat and its mirror images are alike: ψ from 0 to π/2 stands for all.
        alpha = self.edge_angle
        folded = np.arcsin(np.abs(np.sin(psi)))
        radius = 0.5 * self.width / math.sin(alpha)
        low = radius * (1.0 - np.cos(np.minimum(alpha + folded, math.pi)))
        return np.asarray(np.where(folded < alpha, low, self.width * np.sin(folded)))
