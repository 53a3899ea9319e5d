"""Spatial daylight autonomy, annual sunlight exposure, and the rule by which blinds are closed (IES LM-83).

IES LM-83-12, "Approved method: IES spatial daylight autonomy (sDA) and annual sunlight exposure (ASE)". Hours are 08:00
to 18:00 of every day. The standard's points are at most 0.6 m apart, 0.76 m above the floor.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.annual.metrics import checked, share_of_area

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import ArrayLike, NDArray

SUNLIT = 1000.0
"""Direct illuminance of a point that is in the sun [lx]."""
SUNLIT_SHARE = 0.02
"""Share of the points in the sun above which blinds are closed."""
EXPOSED_HOURS = 250.0
"""Hours in the sun above which a point counts as exposed [h]."""
AUTONOMY, AUTONOMY_SHARE = 300.0, 0.5
"""Illuminance [lx] and share of the hours of spatial daylight autonomy."""
HOURS = (8.0, 18.0)
"""Of every day."""
PREFERRED, ACCEPTED = 0.75, 0.55
"""Spatial daylight autonomy of rooms that are preferred, and nominally accepted."""


def spatial_autonomy(autonomy: ArrayLike, area: ArrayLike | None = None, *, share: float = AUTONOMY_SHARE) -> float:
    """Spatial daylight autonomy: share of the room whose autonomy is at least `share`, 0 to 1.

    Parameters
    ----------
    autonomy
        Share of the hours with at least 300 lx (points,), for sDA 300/50 %: `PointMetrics.autonomy_at(300)`.
    area
        That each point stands for (points,) [m²]; all the same by default.
    share
        Of the hours.
    """
    # Sums of hours may lie below their half by rounding.
    return share_of_area(np.asarray(autonomy, dtype=np.float64) >= share - 1e-9, area)


def rating(sda: float) -> str:
    """What LM-83 calls a room of this spatial daylight autonomy."""
    if sda >= PREFERRED - 1e-9:
        return "preferred"
    return "nominally accepted" if sda >= ACCEPTED - 1e-9 else "not accepted"


class SunYear:
    """Collects hours of direct sun at points, from pieces of a year."""

    def __init__(self, points: int, *, limit: float = SUNLIT) -> None:
        """For so many points; in the sun above `limit` [lx]."""
        self._limit = limit
        self._hours = np.zeros(points)

    def add(self, direct: ArrayLike, hours: ArrayLike) -> None:
        """Some steps.

        Parameters
        ----------
        direct
            Illuminance by the sun's disc alone, without blinds and reflections (steps, points) [lx].
        hours
            Hours that each step counts for (steps,) [h].
        """
        values, weights = checked(direct, hours)
        if values.shape[1] != len(self._hours):
            raise ClerestoryError(
                f"direct illuminances of {values.shape[1]} points do not go with {len(self._hours)} (give all points)"
            )
        counted = weights > 0.0
        self._hours += weights[counted] @ (values[counted] > self._limit)

    def result(self) -> NDArray[np.float64]:
        """Hours in the sun of every point (points,) [h]."""
        return self._hours.copy()


def sun_hours(direct: ArrayLike, hours: ArrayLike, *, limit: float = SUNLIT) -> NDArray[np.float64]:
    """Hours of every point with more direct illuminance than the limit (points,) [h]; parameters as for `SunYear`."""
    year = SunYear(np.shape(direct)[-1], limit=limit)
    year.add(direct, hours)
    return year.result()


def sunlight_exposure(hours_in_sun: ArrayLike, area: ArrayLike | None = None, *, limit: float = EXPOSED_HOURS) -> float:
    """Annual sunlight exposure: share of the room with more hours in the sun than the limit, 0 to 1 (ASE 1000,250).

    Parameters
    ----------
    hours_in_sun
        Of every point (points,) [h].
    area
        That each point stands for (points,) [m²]; all the same by default.
    limit
        Hours [h].
    """
    return share_of_area(np.asarray(hours_in_sun, dtype=np.float64) > limit + 1e-9, area)


def blind_states(
    direct: ArrayLike, area: ArrayLike | None = None, *, limit: float = SUNLIT, share: float = SUNLIT_SHARE
) -> NDArray[np.int64]:
    """State of the blinds of one group of windows at every step (steps,), from 0.

    Blinds are opened as far as the sun lets them: to the first state in which no more than `share` of the room gets
    `limit` or more of direct sun through this group; to the last if there is none. With two states, open and
    closed, that is LM-83's rule.

    Parameters
    ----------
    direct
        Illuminance by the sun's disc through the group (steps, states, points) [lx], the most open state first. The
        last state's is not looked at.
    area
        That each point stands for (points,) [m²]; all the same by default.
    limit
        Of a point in the sun [lx].
    share
        Of the room, 0 to 1.
    """
    values = np.asarray(direct, dtype=np.float64)
    if values.ndim != 3 or values.shape[1] < 1:
        raise ClerestoryError(f"direct illuminances {values.shape} are not of states (give (steps, states, points))")
    weights = np.ones(values.shape[2]) if area is None else np.asarray(area, dtype=np.float64)
    if weights.shape != values.shape[2:]:
        raise ClerestoryError(f"areas {weights.shape} do not go with {values.shape[2]} points (give one each)")
    in_sun = (values >= limit) @ weights / weights.sum()
    allowed = in_sun <= share + 1e-12
    allowed[:, -1] = True
    states: NDArray[np.int64] = np.argmax(allowed, axis=1)
    return states


def operated(
    groups: Iterable[tuple[ArrayLike, ArrayLike]], area: ArrayLike | None = None
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Illuminance of a room whose blinds are operated group by group, and their states.

    Parameters
    ----------
    groups
        Of each group of windows the illuminance that it gives, and the direct sun through it, both (steps, states,
        points) [lx], the most open state first.
    area
        That each point stands for (points,) [m²]; all the same by default.

    Returns
    -------
    Illuminance (steps, points) [lx], and the states (groups, steps).
    """
    total: NDArray[np.float64] | None = None
    states = []
    for illuminance, direct in groups:
        values = np.asarray(illuminance, dtype=np.float64)
        if values.shape != np.shape(direct):
            raise ClerestoryError(
                f"illuminances {values.shape} do not go with direct ones {np.shape(direct)} (give them alike)"
            )
        state = blind_states(direct, area)
        chosen = np.take_along_axis(values, state[:, None, None], axis=1)[:, 0]
        total = chosen if total is None else total + chosen
        states.append(state)
    if total is None:
        raise ClerestoryError("a room without a group of windows is dark (give at least one)")
    return total, np.stack(states)
