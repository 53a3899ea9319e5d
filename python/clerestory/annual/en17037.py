"""Daylight provision and protection from glare by EN 17037:2018.

Provision is by the calculation of illuminances (method 2): a target illuminance over half of the room, and a lesser one
over 95 % of it, for half of the daylight hours. Daylight hours are those with the sun above the horizon in the middle
of the interval (`Hours.all_daylight`); the standard's own are the half of the year with the most light.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.annual.metrics import checked, share_of_area

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from clerestory.annual.metrics import PointMetrics

Level = Literal["minimum", "medium", "high"]
LEVELS: tuple[Level, ...] = ("minimum", "medium", "high")
PROVISION: dict[Level, tuple[float, float]] = {
    "minimum": (300.0, 100.0),
    "medium": (500.0, 300.0),
    "high": (750.0, 500.0),
}
"""Target illuminance over `TARGET_AREA` and minimum target over `MINIMUM_AREA` of the room [lx]."""
TARGET_AREA, MINIMUM_AREA, SHARE_OF_HOURS = 0.50, 0.95, 0.50
GLARE: dict[Level, float] = {"minimum": 0.45, "medium": 0.40, "high": 0.35}
"""DGP that is exceeded in no more than `GLARE_SHARE` of the reference usage time."""
GLARE_SHARE = 0.05


@dataclass(frozen=True)
class Provision:
    """One level of daylight provision."""

    level: Level
    """minimum, medium or high."""
    target: float
    """Over half of the room [lx]."""
    target_area: float
    """Share of the room that has it for half of the daylight hours, 0 to 1."""
    minimum_target: float
    """Over 95 % of the room [lx]."""
    minimum_area: float
    """Share of the room that has that for half of the daylight hours, 0 to 1."""

    @property
    def is_met(self) -> bool:
        """Whether both areas are large enough."""
        return self.target_area >= TARGET_AREA - 1e-9 and self.minimum_area >= MINIMUM_AREA - 1e-9


def provision(metrics: PointMetrics, area: ArrayLike | None = None) -> tuple[Provision, Provision, Provision]:
    """Daylight provision of a room at the three levels.

    Parameters
    ----------
    metrics
        Of the room's points over the daylight hours, with autonomies of 100, 300, 500 and 750 lx.
    area
        That each point stands for (points,) [m²]; all the same by default.
    """

    def share(illuminance: float) -> float:
        return share_of_area(metrics.autonomy_at(illuminance) >= SHARE_OF_HOURS - 1e-9, area)

    minimum, medium, high = (
        Provision(level, target, share(target), least, share(least)) for level, (target, least) in PROVISION.items()
    )
    return minimum, medium, high


def provision_level(levels: tuple[Provision, ...]) -> Level | None:
    """The highest level that a room meets; None if it meets none."""
    met = [found.level for found in levels if found.is_met]
    return met[-1] if met else None


def exceeded(values: ArrayLike, hours: ArrayLike, share: float = GLARE_SHARE) -> NDArray[np.float64]:
    """Value that is exceeded in no more than a share of the hours, of every view (views,): DGP_e,5 % for 0.05.

    It is the least of the values that occurred with that property.

    Parameters
    ----------
    values
        (steps, views).
    hours
        Hours that each step counts for (steps,) [h].
    share
        0 to 1.
    """
    if not 0.0 <= share < 1.0:
        raise ClerestoryError(
            f"a share of {share:g} of the hours is not possible (give 0 to 1; EN 17037 asks for 0.05)"
        )
    made, weights = checked(values, hours)
    counted = weights > 0.0
    made, weights = made[counted], weights[counted]
    if not len(weights):
        raise ClerestoryError("no hour of the weather counts (choose other hours)")
    order = np.argsort(-made, axis=0, kind="stable")
    falling = np.take_along_axis(made, order, axis=0)
    # Hours up to and with each value, from the largest down.
    until = np.cumsum(weights[order], axis=0)
    allowed = share * weights.sum() * (1.0 + 1e-12) + 1e-9
    # The first value whose hours no longer fit into the share is exceeded by those before it only.
    first = np.argmax(until > allowed, axis=0)
    found: NDArray[np.float64] = np.take_along_axis(falling, first[None], axis=0)[0]
    return found


def glare_level(exceeded_dgp: float) -> Level | None:
    """The highest level of protection from glare of a view with this DGP_e,5 %; None if it has none."""
    met = [level for level in LEVELS if exceeded_dgp <= GLARE[level] + 1e-12]
    return met[-1] if met else None
