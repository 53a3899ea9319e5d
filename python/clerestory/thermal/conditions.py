"""Climates on both sides of a window, as standards ask for them."""

from __future__ import annotations

from dataclasses import dataclass

from clerestory._core import ClerestoryError

KELVIN = 273.15


@dataclass(frozen=True)
class Conditions:
    """Climate outdoors and indoors.

    Raises
    ------
    ClerestoryError
        A coefficient or the irradiance is negative, or a temperature lies below absolute zero.
    """

    name: str
    outdoor_c: float
    """Temperature of the air and of what the window sees outdoors [°C]."""
    indoor_c: float
    outdoor_convection: float
    """[W/(m² K)]."""
    indoor_convection: float | None = None
    """[W/(m² K)]; by natural convection (ISO 15099, 8.3.2.2) where it is not given."""
    irradiance: float = 0.0
    """Of the sun on the window [W/m²]."""

    def __post_init__(self) -> None:
        if self.outdoor_convection < 0.0 or (self.indoor_convection or 0.0) < 0.0 or self.irradiance < 0.0:
            raise ClerestoryError(f"{self.name}: coefficients and irradiance are 0 or more")
        if min(self.outdoor_c, self.indoor_c) <= -KELVIN:
            raise ClerestoryError(f"{self.name}: temperatures are in °C")


CONDITIONS: dict[str, Conditions] = {
    made.name: made
    for made in (
        Conditions("nfrc-winter", -18.0, 21.0, 26.0),
        Conditions("nfrc-summer", 32.0, 24.0, 15.0, irradiance=783.0),
        Conditions("iso-15099-winter", 0.0, 20.0, 20.0, 3.6, 300.0),
        Conditions("iso-15099-summer", 30.0, 25.0, 8.0, 2.5, 500.0),
        Conditions("en-iso-52022-reference", 5.0, 20.0, 18.0, 3.6, 300.0),
        Conditions("en-iso-52022-summer", 25.0, 25.0, 8.0, 2.5, 500.0),
    )
}
"""By name: NFRC 100 (U) and 200 (SHGC), ISO 15099:2003 section 8.2, EN ISO 52022-3:2017."""
