"""What is known of a product besides light, as values."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal


@dataclass(frozen=True)
class Heat:
    """Of the whole window, centre of glass (ISO 15099)."""

    u: float
    """[W/(m² K)]."""
    shgc: float
    """Solar heat gain coefficient along the normal."""
    shgc_diffuse: float
    """For evenly diffuse light."""
    winter: str
    """Name of the climate of `u`."""
    summer: str
    """Name of the climate of the gains."""


@dataclass(frozen=True)
class Curve:
    """Tilts of slats that keep the sun out, by its profile angle."""

    profile_deg: tuple[float, ...]
    """Height of the sun in the section across the slats [°]."""
    tilt_deg: tuple[float | None, ...]
    """0 level, positive with the outer edge below the inner one [°]; None where none keeps the sun out."""
    slats_mm: tuple[float, float, float]
    """Width, distance and crown [mm]."""
    safety_deg: float = 0.0
    """That is in the tilts [°]."""
    step_deg: float = 0.0
    """Of the drive [°]; 0 for any tilt."""


@dataclass(frozen=True)
class Orientation:
    """How a directed element is to be placed."""

    mounting: Literal["facade", "roof"]
    azimuth_deg: float | None
    """Compass azimuth [°] of its up in a roof, or that its exterior looks to in a façade; None for any."""
    within_deg: float = 0.0
    """How far the azimuth may be off [°]."""
    tilt_deg: tuple[float, float] | None = None
    """Least and greatest tilt [°]: 0 is level, 90 upright."""


@dataclass(frozen=True)
class ProductData:
    """What a data set can say of its product besides light."""

    components: tuple[dict[str, Any], ...] = ()
    """Layers and gaps from the exterior to the interior."""
    parameter: str | None = None
    """Name of what changes in the product's family, such as tilt_deg."""
    value: float | None = None
    """Its value in this data set."""
    heat: Heat | None = None
    curve: Curve | None = None
    orientation: Orientation | None = None
