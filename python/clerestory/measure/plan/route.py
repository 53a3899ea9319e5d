"""Whether to measure a system itself, or its material, and trace the rest.

Source: IEA SHC Task 61 report C.2.2 (2021), sections 2.2 (tracing for large structures with known geometry, for what
does not fit, and for many configurations; hybrid models for large angles), 2.3 (slats are traced from measured
surfaces, roller blinds are measured; or several positions of the sample) and 2.10.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from clerestory.measure.plan.extent import PERIODS

if TYPE_CHECKING:
    from clerestory.measure.plan.extent import Extent
    from clerestory.measure.plan.job import Piece

Way = Literal["measure", "positions", "material", "cut"]
"""Measure the system; measure it at several positions and take the mean; measure its material and trace the system; or
nothing goes before a piece is cut that fits."""
MANY_STATES = 3
"""From so many configurations on, tracing a known geometry is less work than measuring."""


@dataclass(frozen=True)
class Route:
    """What to do, and why."""

    way: Way
    positions: int
    """Places of the sample to measure at."""
    why: str


def route_of(piece: Piece, extent: Extent) -> Route:
    """The way to the data of a sample in an instrument."""
    traced = "measure the material of its parts and trace the system (`clerestory trace`)"
    if extent.holder is None:
        size = f"{piece.width_mm:g} mm × {piece.height_mm:g} mm fit in no holder"
        if piece.geometry_known:
            return Route("material", 1, f"{size}, and the geometry is known: {traced}")
        return Route("cut", 1, f"{size}: cut a piece that fits, or scan its geometry and trace it")
    if not extent.covers:
        few = (
            f"the spot of {extent.spot_mm:g} mm covers {extent.periods:.2g} periods of {piece.period_mm:g} mm, "
            f"not {PERIODS:g}"
        )
        if piece.geometry_known:
            return Route("material", 1, f"{few}, and the geometry is known: {traced}")
        along = math.ceil(PERIODS / extent.periods)
        return Route(
            "positions",
            along**2,
            f"{few}: measure at {along} × {along} positions spread over a period and take the mean, "
            "or scan the geometry and trace it",
        )
    if piece.states >= MANY_STATES and piece.geometry_known:
        return Route("material", 1, f"{piece.states} configurations of a known geometry: {traced}")
    enough = (
        "it has no structure"
        if math.isinf(extent.periods)
        else f"the spot of {extent.spot_mm:g} mm covers {extent.periods:.2g} periods"
    )
    return Route("measure", 1, f"measure the system itself: {enough}")
