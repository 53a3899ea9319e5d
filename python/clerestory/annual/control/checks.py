"""What tables of control laws are checked for: names that are there, and a state at every step."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory.counts import counted
from clerestory.trace.keys import RecipeError, suggestion

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from numpy.typing import NDArray

    from clerestory.annual.control.stage import Stage

    States = NDArray[np.int64]


def known(name: str, names: Collection[str], key: str, what: str) -> None:
    """Fail if something is not among the names that there are."""
    if name not in names:
        hint = suggestion(name, names) if names else f"add a {what}"
        raise RecipeError(f"{key}: there is no {what} {name!r} ({hint})")


def known_sensors(names: Sequence[str], stage: Stage, key: str) -> None:
    """Fail if the room has no sensors of some name."""
    for name in names:
        try:
            stage.room.sensors(name)
        except RecipeError as error:
            raise RecipeError(f"{key}: {error}") from None


def complete(found: States, stage: Stage, key: str, remedy: str) -> States:
    """The same, if there is a state at every step."""
    groups, steps = np.nonzero(found < 0)
    if len(steps):
        raise RecipeError(
            f"{key}: {counted(len(np.unique(steps)), 'step')} without a state, the first at "
            f"{stage.weather.words(int(steps.min()))}, windows {stage.groups[groups[np.argmin(steps)]]} ({remedy})"
        )
    return found
