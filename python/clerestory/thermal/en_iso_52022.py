"""g of glazing with a shading device by EN ISO 52022-1:2017 (EN 13363-1): the simplified method.

The detailed method, EN ISO 52022-3, is `clerestory.thermal.solar_gain` with its conditions.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from clerestory._core import ClerestoryError

Position = Literal["exterior", "interior", "integrated"]
POSITIONS: tuple[Position, ...] = ("exterior", "interior", "integrated")


@dataclass(frozen=True)
class Glazing:
    """A reference glazing."""

    name: str
    u: float
    """[W/(m² K)]."""
    g: float


REFERENCE_GLAZINGS: dict[str, Glazing] = {
    "A": Glazing("single clear", 5.8, 0.85),
    "B": Glazing("double clear", 2.9, 0.76),
    "C": Glazing("double with low-emissivity coating and argon", 1.2, 0.59),
    "D": Glazing("double with solar control coating and argon", 1.1, 0.32),
}
"""By letter, of EN 14501:2005."""


@dataclass(frozen=True)
class Total:
    """Of a glazing with a device."""

    g: float
    doubts: tuple[str, ...]
    """Where the method is asked for more than it was made for."""


def g_total(position: Position, u: float, g: float, transmittance: float, reflectance: float) -> Total:
    """Total g of a glazing with a shading device (clause 6).

    Parameters
    ----------
    position
        Where the device is: exterior, interior, or integrated between the panes.
    u, g
        Of the glazing [W/(m² K)], [-].
    transmittance, reflectance
        Solar, of the device at normal incidence; reflectance of the face toward the sun.

    Raises
    ------
    ClerestoryError
        A position is not known, or a value is not one of 0 to 1.
    """
    absorptance = 1.0 - transmittance - reflectance
    values = {"g": g, "transmittance": transmittance, "reflectance": reflectance, "absorptance": absorptance}
    for name, value in values.items():
        if not -1e-9 <= value <= 1.0:
            raise ClerestoryError(f"{name} of {value:g} (give 0 to 1)")
    if not u > 0.0:
        raise ClerestoryError(f"U of {u:g} W/(m² K) (give more than 0)")
    if position == "exterior":
        first, second = 5.0, 10.0
        whole = 1.0 / (1.0 / u + 1.0 / first + 1.0 / second)
        found = transmittance * g + absorptance * whole / second + transmittance * (1.0 - g) * whole / first
    elif position == "interior":
        whole = 1.0 / (1.0 / u + 1.0 / 30.0)
        found = g * (1.0 - g * reflectance - absorptance * whole / 30.0)
    elif position == "integrated":
        whole = 1.0 / (1.0 / u + 1.0 / 3.0)
        found = g * transmittance + g * (absorptance + (1.0 - g) * reflectance) * whole / 3.0
    else:
        raise ClerestoryError(f"a position {position!r} is not known (known: {', '.join(POSITIONS)})")
    doubts = []
    if not 0.15 <= g <= 0.85:
        doubts.append(f"the method is for glazing with g of 0.15 to 0.85, not {g:.2f}")
    if transmittance > 0.5:
        doubts.append(f"the method is for devices that transmit 0.5 at most, not {transmittance:.2f}")
    if not 0.1 <= reflectance <= 0.8:
        doubts.append(f"the method is for devices that reflect 0.1 to 0.8, not {reflectance:.2f}")
    return Total(found, tuple(doubts))
