"""Rules with conditions: the first that holds says the state."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.annual.control.expression import Expression

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import ArrayLike, NDArray

STATE = "state"
"""Name of the state in the step before."""


@dataclass(frozen=True)
class Rule:
    """A state, and when."""

    state: int
    """Number of the state."""
    when: Expression | None = None
    """None if it always holds."""


def chosen(
    rules: Sequence[Rule],
    states: Sequence[str],
    series: Mapping[str, ArrayLike],
    measured: Mapping[tuple[str, str], NDArray[np.float64]],
    steps: int,
) -> NDArray[np.int64]:
    """State (steps,) by the first rule that holds; -1 where none does.

    Parameters
    ----------
    rules
        In order.
    states
        Names of the states; before the first step the windows are in the first.
    series
        (steps,) of names in conditions but for `state`, the name of the state in the step before.
    measured
        What functions of conditions come to (states, steps) with the windows in each state, by function and name. A
        call that names no state means the rule's own.
    steps
        How many.
    """
    is_sequential = any(rule.when is not None and STATE in rule.when.names for rule in rules)
    before = states if is_sequential else states[:1]
    table: NDArray[np.int64] = np.stack(
        [_of(rules, states, {**series, STATE: name}, measured, steps) for name in before]
    )
    if not is_sequential:
        once: NDArray[np.int64] = table[0]
        return once
    found = np.empty(steps, dtype=np.int64)
    state = 0
    for k in range(steps):
        found[k] = table[state, k]
        if found[k] < 0:
            found[k:] = -1
            break
        state = int(found[k])
    return found


def _of(
    rules: Sequence[Rule],
    states: Sequence[str],
    series: Mapping[str, Any],
    measured: Mapping[tuple[str, str], NDArray[np.float64]],
    steps: int,
) -> NDArray[np.int64]:
    found = np.full(steps, -1, dtype=np.int64)
    for rule in rules:
        holds: Any = True
        if rule.when is not None:
            calls = {
                (name, texts): measured[name, texts[0]][rule.state if len(texts) == 1 else states.index(texts[1])]
                for name, texts in rule.when.calls
            }
            holds = np.asarray(rule.when.value(series, calls))
            if holds.dtype != np.bool_:
                raise ClerestoryError(f"{rule.when.text!r} is a number, not a condition (compare it with something)")
        found[np.broadcast_to(holds, steps) & (found < 0)] = rule.state
    return found
