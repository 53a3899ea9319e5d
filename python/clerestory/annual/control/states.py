"""Data sets with several states, and the law that chooses among them, as tables of a study."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from pydantic import Field

from clerestory.annual.control.tables import Control
from clerestory.room.recipe import System
from clerestory.trace.keys import Number, wrong

if TYPE_CHECKING:
    from numpy.typing import NDArray


class State(System):
    """What stands in the windows in one state."""

    tilt_deg: Number | None = None
    """Angle of its slats [°]: 0 level, positive with the outer edge below the inner one."""


class DataSet(System):
    """What stands in the windows: a system, or several states and the law that chooses among them."""

    states: dict[str, State] = Field(default_factory=dict)
    """By name, the most open one first."""
    control: Control | None = None
    """The law."""

    def _check(self) -> None:
        if not self.states:
            if self.control is not None:
                raise wrong("states", "a control chooses among states, and there are none (add tables states.NAME)")
            super()._check()
            return
        given = sorted(self.model_fields_set - {"states", "control"})
        if given:
            raise wrong(given[0], "each state says it for itself (put it into the tables of states)")
        if self.control is None:
            raise wrong("control", "is missing: states ask for a law that chooses among them (add it)")
        if len(self.states) < 2:
            raise wrong("states", "there is one alone, and nothing to choose (add another)")


@dataclass(frozen=True)
class Operated:
    """How the windows of a room stand over the year."""

    names: tuple[str, ...]
    """Of the states, the most open one first."""
    groups: tuple[str, ...]
    """Names of the groups of windows."""
    states: NDArray[np.int64]
    """State of each group at each step (groups, steps)."""

    def combinations(self) -> list[tuple[tuple[int, ...], NDArray[np.bool_]]]:
        """States of the groups that occur together, and when (steps)."""
        found, which = np.unique(self.states, axis=1, return_inverse=True)
        which = which.reshape(-1)
        return [(tuple(column), which == k) for k, column in enumerate(found.T.tolist())]

    def shares(self, weights: NDArray[np.float64]) -> dict[str, dict[str, float]]:
        """Share of the hours with each state, by group; `weights` (steps) are the hours that each step counts for."""
        whole = float(weights.sum())
        return {
            group: {name: float(weights[row == k].sum()) / whole for k, name in enumerate(self.names)}
            for group, row in zip(self.groups, self.states, strict=True)
        }
