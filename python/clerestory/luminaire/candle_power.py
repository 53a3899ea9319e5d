"""Candle power of a window under a sky: what lighting design takes for a luminaire.

I(o) = A cosθ_o Σ_i f(i, o) E_i, with what the sky sends straight through the window, and the sun's beams apart
(IEA SHC Task 61 report C.2.2, section 2.5).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.integrals import straight_through
from clerestory.luminaire.facade import Facade, Falling

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from clerestory.bsdf import Bsdf
    from clerestory.sky import Sky

    Floats = NDArray[np.float64]

_WITHIN = 4
"""Directions along each axis of a cell of angles, for its mean."""


@dataclass(frozen=True)
class Beam:
    """The sun straight through the window."""

    c_deg: float
    gamma_deg: float
    flux: float
    """[lm]."""


@dataclass(frozen=True)
class CandlePower:
    """Luminous intensity of a window by direction.

    γ is the angle from the inward normal of the window, C the azimuth about it: counter-clockwise from +x, as seen from
    the room, so that C = 90° is up.
    """

    c_deg: Floats
    """Azimuths (n,) [°]."""
    gamma_deg: Floats
    """Angles from the normal (m,) [°], 0 to 90."""
    intensity: Floats
    """(n, m) [cd]; means over cells of angles, beams of the sun spread over the cell that they are in."""
    flux: float
    """All that passes the window [lm]."""
    illuminance: float
    """Of the window from outside [lx]."""
    area_m2: float
    beams: tuple[Beam, ...]
    scaled_by: float
    """Factor by which intensities were scaled, so that their integral over the grid is the flux."""

    @property
    def per_klm(self) -> Floats:
        """Intensity by 1,000 lm of the flux (n, m) [cd/klm]."""
        return self.intensity * (1000.0 / self.flux) if self.flux > 0.0 else self.intensity


def flux_of(c_deg: Floats, gamma_deg: Floats, intensity: Floats) -> float:
    """∫ I dω of a grid (n, m) of azimuths around the circle and angles from the axis, with I linear in γ [lm]."""
    mean = intensity.mean(axis=0) if len(c_deg) > 1 else intensity[0]
    gamma = np.radians(gamma_deg)
    a, b = gamma[:-1], gamma[1:]
    # ∫ (I_a + (I_b − I_a)(γ − a)/(b − a)) sinγ dγ in closed form.
    slope = (mean[1:] - mean[:-1]) / (b - a)
    part = mean[:-1] * np.cos(a) - mean[1:] * np.cos(b) + slope * (np.sin(b) - np.sin(a))
    return float(2.0 * math.pi * part.sum())


def candle_power(
    bsdf: Bsdf,
    sky: Sky,
    facade: Facade | None = None,
    *,
    area_m2: float = 1.0,
    c_step_deg: float = 15.0,
    gamma_step_deg: float = 5.0,
    band: str | None = None,
) -> CandlePower:
    """Luminous intensity of a window under a sky.

    Parameters
    ----------
    bsdf
        Of the window.
    sky
        With its sun and ground.
    facade
        Where it looks to; south, upright, by default.
    area_m2
        Of the window.
    c_step_deg, gamma_step_deg
        Steps of the grid; they divide 360 and 90.
    band
        Visible by default.

    Raises
    ------
    ClerestoryError
        Steps do not divide the circle and the right angle, or the area is not more than 0.
    MissingDataError
        The data have no transmission.
    """
    facade = facade or Facade()
    planes, rings = 360.0 / c_step_deg, 90.0 / gamma_step_deg
    if not (planes >= 1.0 and planes.is_integer() and rings >= 1.0 and rings.is_integer()):
        raise ClerestoryError(
            f"steps of {c_step_deg:g}° and {gamma_step_deg:g}° do not divide 360° and 90° (give others)"
        )
    if not area_m2 > 0.0:
        raise ClerestoryError(f"an area of {area_m2:g} m² is none (give more than 0)")
    c_deg: Floats = np.arange(int(planes), dtype=np.float64) * c_step_deg
    gamma_deg: Floats = np.arange(int(rings) + 1, dtype=np.float64) * gamma_step_deg
    falling = Falling.of(facade, sky)
    directions = _cells(c_deg, gamma_deg, c_step_deg, gamma_step_deg)
    flat = np.ascontiguousarray(directions.reshape(-1, 3))
    scattered = bsdf._core.gather(
        falling.incident, falling.illuminance, np.zeros(len(falling.incident), dtype=np.int64), 1, flat, band,
        "transmission",
    )[:, 0]  # fmt: skip
    behind = straight_through(bsdf, -flat, band) * sky.luminance(facade.to_world(-flat))
    every = ((scattered + behind) * flat[:, 2]).reshape(len(c_deg), len(gamma_deg), -1)
    intensity = area_m2 * every.mean(axis=2)
    intensity[:, 0] = intensity[:, 0].mean()
    intensity[:, -1] = 0.0  # nothing leaves along the window
    whole = area_m2 * falling.flux(bsdf, band)
    beams = _beams(bsdf, falling, area_m2, band) if falling.has_sun else ()
    direct = sum(beam.flux for beam in beams)
    # A patch's edges, and beams that are narrower than the grid, leave the integral a little off.
    found = flux_of(c_deg, gamma_deg, intensity)
    scaled = (whole - direct) / found if found > 0.0 else 1.0
    intensity = intensity * scaled
    for beam in beams:
        intensity += _spread(beam, c_deg, gamma_deg)
    return CandlePower(c_deg, gamma_deg, intensity, whole, falling.total, area_m2, beams, scaled)


def _cells(c_deg: Floats, gamma_deg: Floats, c_step: float, gamma_step: float) -> Floats:
    """Directions (n, m, k, 3) in the cells of angles about each node, even in solid angle."""
    inside = (np.arange(_WITHIN) + 0.5) / _WITHIN
    low = np.cos(np.radians(np.maximum(gamma_deg - gamma_step / 2.0, 0.0)))
    high = np.cos(np.radians(np.minimum(gamma_deg + gamma_step / 2.0, 90.0)))
    cosine = low[:, None] + (high - low)[:, None] * inside
    sine = np.sqrt(1.0 - cosine**2)
    c = np.radians(c_deg[:, None] + (inside - 0.5) * c_step)
    shape = (len(c_deg), len(gamma_deg), _WITHIN, _WITHIN)
    x = np.broadcast_to(sine[None, :, :, None] * np.cos(c)[:, None, None, :], shape)
    y = np.broadcast_to(sine[None, :, :, None] * np.sin(c)[:, None, None, :], shape)
    z = np.broadcast_to(cosine[None, :, :, None], shape)
    return np.stack([x, y, z], axis=-1).reshape(len(c_deg), len(gamma_deg), -1, 3)


def _beams(bsdf: Bsdf, falling: Falling, area_m2: float, band: str | None) -> tuple[Beam, ...]:
    found = []
    for peak in bsdf.peaks(falling.incident[-1], "transmission", band):
        x, y, z = (float(v) for v in peak.outgoing)
        flux = area_m2 * float(falling.illuminance[-1]) * peak.value
        c, gamma = math.degrees(math.atan2(y, x)) % 360.0, math.degrees(math.acos(min(1.0, z)))
        found.append(Beam(c, gamma, flux))
    return tuple(found)


def _spread(beam: Beam, c_deg: Floats, gamma_deg: Floats) -> Floats:
    """Intensity (n, m) of a beam over the node next to it, so that its flux is right."""
    row = int(np.argmin(np.abs((c_deg - beam.c_deg + 180.0) % 360.0 - 180.0)))
    column = int(np.argmin(np.abs(gamma_deg - beam.gamma_deg)))
    made = np.zeros((len(c_deg), len(gamma_deg)))
    if column == 0:
        made[:, 0] = 1.0
    else:
        made[row, column] = 1.0
    return made * (beam.flux / flux_of(c_deg, gamma_deg, made))
