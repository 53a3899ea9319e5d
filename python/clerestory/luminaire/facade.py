"""Where a window looks to, and the light that falls on it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory import _core
from clerestory._core import ClerestoryError
from clerestory.photometry import EFFICACY

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from clerestory.bsdf import Bsdf
    from clerestory.sky import Sky

    Floats = NDArray[np.float64]

STEPS = 64
"""Cells along each axis of the square from which the sky's light is taken."""


@dataclass(frozen=True)
class Facade:
    """Orientation of a window.

    Raises
    ------
    ClerestoryError
        The tilt is not one of 0 to 180°, or the azimuth is no number.
    """

    azimuth_deg: float = 180.0
    """Of its outward normal, clockwise from north: 180 is south [°]."""
    tilt_deg: float = 90.0
    """Of its outward normal from the zenith: 90 is upright [°]."""

    def __post_init__(self) -> None:
        if not (0.0 <= self.tilt_deg <= 180.0 and math.isfinite(self.azimuth_deg)):
            raise ClerestoryError(
                f"a window with azimuth {self.azimuth_deg:g}° and tilt {self.tilt_deg:g}° is not possible"
                " (give a tilt of 0 to 180°)"
            )

    @property
    def frame(self) -> Floats:
        """Axes of the window in the world (3, 3), a row each: x to the right from inside, y up, z into the room."""
        azimuth, tilt = math.radians(self.azimuth_deg), math.radians(self.tilt_deg)
        around = np.array([math.sin(azimuth), math.cos(azimuth), 0.0])
        up = np.array([0.0, 0.0, 1.0])
        inward = -(math.sin(tilt) * around + math.cos(tilt) * up)
        upward = math.sin(tilt) * up - math.cos(tilt) * around
        return np.stack([np.cross(upward, inward), upward, inward])

    def to_world(self, directions: Floats) -> Floats:
        """Directions (n, 3) of the window in the world (x east, y north, z up)."""
        return directions @ self.frame

    def to_window(self, directions: Floats) -> Floats:
        """Directions (n, 3) of the world in the window's frame."""
        return directions @ self.frame.T


@dataclass(frozen=True)
class Falling:
    """Light on a window from outside."""

    incident: Floats
    """Directions (n, 3) toward it, in the window's frame; the last one is the sun's, if it shines on the window."""
    illuminance: Floats
    """On the window by each direction (n,) [lx]."""
    has_sun: bool

    @classmethod
    def of(cls, facade: Facade, sky: Sky) -> Falling:
        """Of a sky, its ground and its sun."""
        incident = -_core.square_directions(STEPS)
        luminance = sky.luminance(facade.to_world(incident))
        illuminance = luminance * math.pi / STEPS**2
        sun = sky.sun
        if sun is None:
            return cls(incident, illuminance, has_sun=False)
        toward = facade.to_window(sun.direction[None])
        cosine = -float(toward[0, 2])
        if cosine <= 0.0:
            return cls(incident, illuminance, has_sun=False)
        by_sun = EFFICACY * sky.direct_normal * cosine
        return cls(np.concatenate([incident, toward]), np.append(illuminance, by_sun), has_sun=True)

    @property
    def total(self) -> float:
        """Illuminance of the window [lx]."""
        return float(self.illuminance.sum())

    def flux(self, bsdf: Bsdf, band: str | None, even: Floats | None = None) -> float:
        """That passes a square metre of the window [lm].

        Parameters
        ----------
        bsdf, band
            Of the window.
        even
            What `even_transmittance` gave, for those who ask for many skies.
        """
        passed = even_transmittance(bsdf, band) if even is None else even
        if self.has_sun:
            passed = np.append(passed, bsdf.integrate(self.incident[-1:], "transmission", band=band))
        return float(passed @ self.illuminance)


def even_transmittance(bsdf: Bsdf, band: str | None) -> Floats:
    """Transmittance (n,) for the directions that the light of all skies is taken from."""
    return np.asarray(bsdf.integrate(-_core.square_directions(STEPS), "transmission", band=band))
