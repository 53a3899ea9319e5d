"""Daylight supply: the light that passes a window over clear days, by orientation.

IEA SHC Task 61 report C.2.2 (2021), section 2.6: the flux behind glass and shading, cumulated over a day.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory.luminaire.facade import Facade, Falling, even_transmittance
from clerestory.sky import Sky, SunPosition

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from clerestory.bsdf import Bsdf
    from clerestory.sky import Place

    Floats = NDArray[np.float64]

DAYS = ("2021-06-15", "2021-12-15")
"""Of the report."""
ORIENTATIONS = {"north": 0.0, "east": 90.0, "south": 180.0, "west": 270.0}
CLEAR = 12
"""CIE's standard clear sky of low turbidity."""


@dataclass(frozen=True)
class Supply:
    """Light that passes a square metre of a window in a day."""

    day: str
    orientation: str
    luminous_energy: float
    """[lm h/m²]."""
    exposure: float
    """Of the window from outside [lx h]."""
    times: tuple[str, ...]
    """Middles of the steps, with the sun above the horizon."""
    flux: Floats
    """At these times [lm/m²]."""


def daylight_supply(
    bsdf: Bsdf,
    place: Place,
    *,
    days: Sequence[str] = DAYS,
    orientations: Sequence[str] | None = None,
    step_min: int = 15,
    band: str | None = None,
) -> list[Supply]:
    """Light through a window over clear days, sky of CIE type 12 with the sun.

    Sun and sky are as bright as those of `Sky.clear`.

    Parameters
    ----------
    bsdf
        Of the whole window, with its shading drawn.
    place
        Where it stands.
    days
        As YYYY-MM-DD.
    orientations
        Names in `ORIENTATIONS`; all by default.
    step_min
        Minutes from one sky to the next.
    band
        Visible by default.
    """
    facades = {name: Facade(ORIENTATIONS[name]) for name in orientations or ORIENTATIONS}
    even = even_transmittance(bsdf, band)
    found = []
    for day in days:
        times, skies = [], []
        for minute in range(step_min // 2, 24 * 60, step_min):
            time = f"{day} {minute // 60:02d}:{minute % 60:02d}"
            sun = SunPosition.at(place, time)
            if sun.altitude_deg > 0.0:
                times.append(time)
                level = Sky.clear(sun)
                skies.append(Sky.cie(CLEAR, sun, direct=level.direct_normal, diffuse=level.diffuse_horizontal))
        for name, facade in facades.items():
            falling = [Falling.of(facade, sky) for sky in skies]
            flux = np.array([light.flux(bsdf, band, even) for light in falling])
            hours = step_min / 60.0
            outside = sum(light.total for light in falling)
            found.append(Supply(day, name, float(flux.sum()) * hours, outside * hours, tuple(times), flux))
    return found
