"""Whether a sample fits, what the spot covers, and how far incidence may go.

Source: IEA SHC Task 61 report C.2.2 (2021), sections 2.2 (spot of 70 mm for periods up to 15 mm, so that at least
four periods are covered; the aperture grows with the angle of incidence) and 2.3 (sizes of samples).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from clerestory.measure.plan.instrument import Holder, Instrument
    from clerestory.measure.plan.job import Piece

PERIODS = 4.0
"""Of the structure, that the spot must cover."""


@dataclass(frozen=True)
class Extent:
    """How a sample sits in an instrument."""

    holder: str | None
    """The first holder that takes the sample; None if none does."""
    turns_in_its_plane: bool
    spot_mm: float
    """Diameter of the spot at normal incidence [mm]."""
    periods: float
    """Periods of the structure that the spot covers; infinite without a structure."""
    covers: bool
    """Whether these are enough."""
    largest_theta_deg: float
    """Largest angle of incidence at which the spot stays on the sample, and that the instrument reaches [°]."""
    limited_by: str
    """`sample` or `instrument`: what ends the incident angles."""
    grows: bool
    """Whether the spot grows with the angle of incidence; an aperture on the sample does not."""

    def lit_mm(self, theta_deg: float) -> float:
        """Length [mm] of the lit patch along the plane of incidence."""
        return lit_width_mm(self.spot_mm, theta_deg) if self.grows else self.spot_mm


def lit_width_mm(spot_mm: float, theta_deg: float) -> float:
    """Length [mm] of the spot on the sample along the plane of incidence, spot/cos θ."""
    return spot_mm / math.cos(math.radians(theta_deg))


def largest_theta(spot_mm: float, sample_mm: float) -> float:
    """Largest angle of incidence [°] at which the spot is no longer than the sample; 0 if it never fits."""
    return math.degrees(math.acos(min(1.0, spot_mm / sample_mm))) if sample_mm > 0.0 else 0.0


def covers_periods(period_mm: float, spot_mm: float) -> bool:
    """Whether a spot covers at least four periods of a structure."""
    return period_mm * PERIODS <= spot_mm


def extent_of(piece: Piece, instrument: Instrument) -> Extent:
    """How a sample sits in an instrument, with the smallest of its spots that covers four periods.

    The largest spot is taken if none does, and a smaller one than all where the sample is smaller than they are.
    """
    holder = next((h for h in instrument.holders if _holds(h, piece)), None)
    narrow = min(piece.width_mm, piece.height_mm)
    enough = [s for s in instrument.spots_mm if covers_periods(piece.period_mm, s)]
    spot = enough[0] if enough else instrument.spots_mm[-1]
    if spot > narrow:
        on_sample = [s for s in instrument.spots_mm if s <= narrow]
        spot = on_sample[-1] if on_sample else instrument.smallest_spot_mm
    fits = largest_theta(spot, narrow)
    if instrument.aperture_on_sample and spot <= narrow:
        fits = 90.0
    limit = min(fits, instrument.largest_theta_deg)
    return Extent(
        None if holder is None else holder.name,
        holder is not None and holder.turns_in_its_plane,
        spot,
        spot / piece.period_mm if piece.period_mm > 0.0 else math.inf,
        covers_periods(piece.period_mm, spot),
        limit,
        "sample" if fits < instrument.largest_theta_deg else "instrument",
        not instrument.aperture_on_sample,
    )


def _holds(holder: Holder, piece: Piece) -> bool:
    sizes, least, most = (sorted(v) for v in ((piece.width_mm, piece.height_mm), holder.smallest_mm, holder.largest_mm))
    if any(size < small for size, small in zip(sizes, least, strict=True)):
        return False
    if holder.round:
        # Round samples are given by their diameter twice, and have no diagonal; corners are cut by who mounts them.
        return sizes[1] <= holder.largest_mm[0]
    return all(size <= large for size, large in zip(sizes, most, strict=True))
