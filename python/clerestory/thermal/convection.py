"""Convection in gaps and at the indoor face (ISO 15099:2003, 5.3.3 and 8.3.2.2)."""

from __future__ import annotations

import math

from clerestory.thermal.gas import Gas, Properties

GRAVITY = 9.807
"""[m/s²]."""
_AIR = Gas()


def _rayleigh(length: float, difference: float, temperature: float, gas: Properties) -> float:
    return (gas.density**2 * length**3 * GRAVITY * gas.heat_capacity * difference) / (
        temperature * gas.viscosity * gas.conductivity
    )


def gap_coefficient(
    gas: Gas, thickness_m: float, height_m: float, temperatures: tuple[float, float], tilt_deg: float = 90.0
) -> float:
    """Conduction and convection between the two faces of a closed gap [W/(m² K)].

    Parameters
    ----------
    gas, thickness_m, height_m
        What fills it, its width, and the height of the glazing [m].
    temperatures
        Of the faces toward the exterior and the interior [K].
    tilt_deg
        Of the window [°]: 0 is level with the exterior above, 90 upright.
    """
    first, second = temperatures
    mean = (first + second) / 2.0
    properties = gas.at(mean)
    rayleigh = _rayleigh(thickness_m, abs(first - second), mean, properties)
    # The correlations count the tilt from heat that rises.
    tilt = tilt_deg if second >= first else 180.0 - tilt_deg
    return nusselt(tilt, rayleigh, height_m / thickness_m) * properties.conductivity / thickness_m


def nusselt(tilt_deg: float, rayleigh: float, aspect: float) -> float:
    """Nusselt number of a gap (equations 43 to 56).

    Parameters
    ----------
    tilt_deg
        0 is level and warm from below, 90 upright, 180 level and warm from above.
    rayleigh
        Rayleigh number by the gap's thickness.
    aspect
        Height over thickness.
    """
    if tilt_deg < 60.0:
        return _nearly_level(tilt_deg, rayleigh)
    if tilt_deg < 90.0:
        share = (tilt_deg - 60.0) / 30.0
        return (1.0 - share) * _sixty(rayleigh, aspect) + share * _upright(rayleigh, aspect)
    return 1.0 + (_upright(rayleigh, aspect) - 1.0) * math.sin(math.radians(tilt_deg))


def _nearly_level(tilt_deg: float, rayleigh: float) -> float:
    across = rayleigh * math.cos(math.radians(tilt_deg))
    if across <= 0.0:
        return 1.0
    wave = 1.0 - 1708.0 * math.sin(math.radians(1.8 * tilt_deg)) ** 1.6 / across
    return float(1.0 + 1.44 * max(0.0, 1.0 - 1708.0 / across) * wave + max(0.0, (across / 5830.0) ** (1.0 / 3.0) - 1.0))


def _sixty(rayleigh: float, aspect: float) -> float:
    damping = 0.5 / (1.0 + (rayleigh / 3160.0) ** 20.6) ** 0.1
    first = (1.0 + (0.0936 * rayleigh**0.314 / (1.0 + damping)) ** 7) ** (1.0 / 7.0)
    return float(max(first, (0.104 + 0.175 / aspect) * rayleigh**0.283))


def _upright(rayleigh: float, aspect: float) -> float:
    if rayleigh > 5e4:
        first = 0.0673838 * rayleigh ** (1.0 / 3.0)
    elif rayleigh > 1e4:
        first = 0.028154 * rayleigh**0.4134
    else:
        first = 1.0 + 1.7596678e-10 * rayleigh**2.2984755
    return float(max(first, 0.242 * (rayleigh / aspect) ** 0.272))


def indoor_coefficient(surface: float, air: float, height_m: float, tilt_deg: float = 90.0) -> float:
    """Natural convection at the indoor face [W/(m² K)], by temperatures [K] of the face and of the air."""
    film = air + 0.25 * (surface - air)
    properties = _AIR.at(film)
    rayleigh = _rayleigh(height_m, abs(surface - air), film, properties)
    tilt = tilt_deg if surface <= air else 180.0 - tilt_deg
    return _indoor_nusselt(tilt, rayleigh) * properties.conductivity / height_m


def _indoor_nusselt(tilt_deg: float, rayleigh: float) -> float:
    if tilt_deg < 15.0:
        return float(0.13 * rayleigh ** (1.0 / 3.0))
    sine = math.sin(math.radians(tilt_deg))
    if tilt_deg <= 90.0:
        critical = 2.5e5 * (math.exp(0.72 * tilt_deg) / sine) ** 0.2
        if rayleigh <= critical:
            return float(0.56 * (rayleigh * sine) ** 0.25)
        third = 1.0 / 3.0
        return float(0.13 * (rayleigh**third - critical**third) + 0.56 * (critical * sine) ** 0.25)
    if tilt_deg <= 179.0:
        return float(0.56 * (rayleigh * sine) ** 0.25)
    return float(0.58 * rayleigh**0.2)
