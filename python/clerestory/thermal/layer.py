"""Layers and gaps as heat meets them."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from clerestory._core import ClerestoryError
from clerestory.thermal.gas import Gas


@dataclass(frozen=True)
class Openings:
    """Where air passes a shading layer: gaps at its edges, and holes in it (ISO 15099:2003, section 7)."""

    top_m: float = 0.0
    """Between the layer's top and the frame [m]."""
    bottom_m: float = 0.0
    left_m: float = 0.0
    right_m: float = 0.0
    front: float = 0.0
    """Share of the layer's area that air passes as through an opening; see `front_of_cloth` and `front_of_slats`."""

    def __post_init__(self) -> None:
        for name in ("top_m", "bottom_m", "left_m", "right_m", "front"):
            if not getattr(self, name) >= 0.0:
                raise ClerestoryError(f"openings: {name} is {getattr(self, name):g} (give 0 or more)")

    @property
    def any(self) -> bool:
        """Whether air passes at all."""
        return max(self.top_m, self.bottom_m, self.left_m, self.right_m, self.front) > 0.0


def front_of_cloth(permeability: float) -> float:
    """Effective openness of woven or perforated layers by the open share of their area (Hart and others, WINDOW 7)."""
    return 0.078 * float(permeability**1.2)


def front_of_slats(permeability: float, tilt_deg: float) -> float:
    """Effective openness of level slats by the open share at their tilt (Hart and others, WINDOW 7)."""
    cosine = max(math.cos(math.radians(tilt_deg)), 1e-9)
    return 0.016 * float((permeability * cosine**-0.63) ** 0.53)


def permeability_of_slats(
    width_m: float, spacing_m: float, tilt_deg: float, thickness_m: float = 0.0, rise_m: float = 0.0
) -> float:
    """Open share of slats at a tilt, for air (Windows-CalcEngine); width, spacing, thickness and rise in metres."""
    tilt = math.radians(abs(tilt_deg))
    length = width_m
    if rise_m > 0.0:
        radius = (rise_m**2 + width_m**2 / 4.0) / (2.0 * rise_m)
        length = 2.0 * radius * math.asin(min(1.0, width_m / (2.0 * radius)))
    tilt = min(tilt, math.acos(min(1.0, thickness_m / (spacing_m + thickness_m))))
    across = length * math.cos(tilt) + thickness_m * math.sin(tilt)
    if across <= 0.0:
        return 0.0
    return max(0.0, 1.0 - thickness_m * length / (across * (spacing_m + thickness_m)))


@dataclass(frozen=True)
class ThermalLayer:
    """A pane or a shading layer.

    Raises
    ------
    ClerestoryError
        A number is out of its range; the text names it.
    """

    name: str
    thickness_m: float
    conductivity: float = 1.0
    """[W/(m K)]."""
    emissivity_exterior: float = 0.84
    """Hemispherical, long-wave, of the face toward the exterior."""
    emissivity_interior: float = 0.84
    ir_transmittance: float = 0.0
    """Hemispherical, long-wave."""
    openings: Openings = field(default_factory=Openings)

    def __post_init__(self) -> None:
        if not self.thickness_m > 0.0 or not self.conductivity > 0.0:
            raise ClerestoryError(
                f"{self.name}: thickness {self.thickness_m:g} m with conductivity {self.conductivity:g} W/(m K)"
                " (give more than 0)"
            )
        for side, emissivity in (("exterior", self.emissivity_exterior), ("interior", self.emissivity_interior)):
            if not (0.0 < emissivity <= 1.0 and 0.0 <= self.ir_transmittance <= 1.0 - emissivity + 1e-9):
                raise ClerestoryError(
                    f"{self.name}: emissivity {emissivity:g} of the {side} face with long-wave transmittance"
                    f" {self.ir_transmittance:g} (give an emissivity of more than 0, and a sum of 1 at most)"
                )


@dataclass(frozen=True)
class Gap:
    """Gas between two layers.

    Raises
    ------
    ClerestoryError
        The thickness is not more than 0, or the speed of forced air is negative.
    """

    thickness_m: float
    gas: Gas = field(default_factory=Gas)
    forced_speed_m_s: float = 0.0
    """Of air that is blown through; 0 for none."""
    forced_temperature_c: float = 20.0
    """Of that air where it comes in."""

    def __post_init__(self) -> None:
        if not self.thickness_m > 0.0:
            raise ClerestoryError(f"a gap of {self.thickness_m:g} m is none (give more than 0)")
        if not self.forced_speed_m_s >= 0.0:
            raise ClerestoryError(f"air is blown through a gap at {self.forced_speed_m_s:g} m/s (give 0 or more)")
