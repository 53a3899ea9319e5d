"""What a controller outdoors knows of every step: clock, sun, and the light on the façades."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from clerestory import _core
from clerestory.annual.control.slats import profile_angle

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from clerestory.annual.matrices import RoomMatrices
    from clerestory.weather import SkyYear
    from clerestory.weather.weather import Times

    Doubles = NDArray[np.float64]

_PATCHES = "reinhart:2"
"""Of the sky, for irradiances of façades."""
_PROBES = 256
"""Steps along each axis of the square by which a façade weighs the patches of the sky."""


@dataclass(frozen=True)
class Outdoors:
    """Series of a year outdoors."""

    times: Times
    """Middle of each step (steps,) on the clock that people live by."""
    interval: Doubles
    """Length of the steps (steps,) [h]."""
    altitude_deg: Doubles
    """Of the sun (steps,) [°]."""
    azimuth_deg: Doubles
    """Of the sun by the compass (steps,) [°]."""
    direct_normal: Doubles
    """Direct normal irradiance (steps,) [W/m²]."""
    diffuse_horizontal: Doubles
    """Diffuse horizontal irradiance (steps,) [W/m²]."""
    profile: Doubles
    """Profile angle of the sun before each group of windows (groups, steps) [rad]; not a number behind it."""
    incidence_deg: Doubles
    """Angle of the sun to each group's normal (groups, steps) [°], 0 to 180."""
    direct: Doubles
    """Irradiance of each façade by the sun (groups, steps) [W/m²]; what stands before the windows shades it."""
    diffuse: Doubles
    """Irradiance of each façade by sky and ground (groups, steps) [W/m²], as if nothing stood before it."""

    @property
    def irradiance(self) -> Doubles:
        """Irradiance of each façade (groups, steps) [W/m²]."""
        return self.direct + self.diffuse


def outdoors(matrices: RoomMatrices, sky: SkyYear, times: Times) -> Outdoors:
    """The series of a room's windows.

    Parameters
    ----------
    matrices
        Of the room: its windows.
    sky
        Skies of the year.
    times
        Middle of each step on the clock that people live by.
    """
    weather = sky.weather
    solar = replace(sky, basis=_PATCHES, quantity="solar")
    altitude, azimuth = weather.sun_positions()
    suns, normal_irradiance = solar.suns.directions, solar.suns.irradiance
    up = np.flatnonzero(normal_irradiance > 0.0)
    radiance = solar.columns(part="sky", dtype=np.float64)
    probes, area = _core.square_directions(_PROBES), np.pi / _PROBES**2
    profile, incidence, direct, diffuse = [], [], [], []
    for group in range(len(matrices)):
        frame = matrices.frame(group)
        facing = -suns @ frame[2]
        profile.append(profile_angle(suns, frame))
        incidence.append(np.degrees(np.arccos(np.clip(facing, -1.0, 1.0))))
        lit = np.zeros(len(suns))
        lit[up] = matrices.sunlit_share(group, suns[up])
        direct.append(normal_irradiance * np.maximum(facing, 0.0) * lit)
        # The square has equal parts of the projected solid angle.
        patch = solar.patches.index_of((probes * [1.0, 1.0, -1.0]) @ frame)
        weights = area * np.bincount(patch, minlength=len(solar.patches))
        diffuse.append(weights @ radiance)
    horizontal = solar.patches.projected_solid_angles[1:] @ radiance[1:]
    return Outdoors(
        times,
        weather.interval,
        altitude,
        azimuth,
        normal_irradiance,
        horizontal,
        np.stack(profile),
        np.stack(incidence),
        np.stack(direct),
        np.stack(diffuse),
    )
