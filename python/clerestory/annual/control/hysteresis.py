"""What keeps windows from changing all the time: hysteresis and delays."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray


def held(wanted: ArrayLike, allowed: ArrayLike) -> NDArray[np.int64]:
    """States (n,) that close at once, and open no further than a stricter limit allows.

    Parameters
    ----------
    wanted
        State that the limit asks for (n,), the larger the more closed.
    allowed
        State that the stricter limit asks for (n,); nowhere more open than `wanted`.
    """
    low, high = np.asarray(wanted, dtype=np.int64), np.asarray(allowed, dtype=np.int64)
    found = np.empty_like(low)
    state = 0
    for k, (least, most) in enumerate(zip(low.tolist(), high.tolist(), strict=True)):
        state = max(least, min(state, most))
        found[k] = state
    return found


def levels(
    values: ArrayLike,
    limits: Sequence[float],
    interval: ArrayLike,
    *,
    hysteresis: float = 0.0,
    close_after: float = 0.0,
    open_after: float = 0.0,
) -> NDArray[np.int64]:
    """State (n,) by a value and rising limits: how many of them it has reached, 0 before the first step.

    Parameters
    ----------
    values
        (n,).
    limits
        Rising; state k begins at `limits[k - 1]`.
    interval
        Length of the steps (n,) [h].
    hysteresis
        A state is left when the value falls below its limit less this.
    close_after, open_after
        For so long [h] the value has asked for a more closed, or a more open, state in the steps before.
    """
    edges = np.asarray(limits, dtype=np.float64)
    if not len(edges) or np.any(np.diff(edges) <= 0.0):
        raise ClerestoryError("limits of states rise (give at least one, the lowest first)")
    v = np.asarray(values, dtype=np.float64)
    reached = np.searchsorted(edges, v, side="right")
    kept = np.searchsorted(edges - hysteresis, v, side="right")
    found = np.empty(len(v), dtype=np.int64)
    state, closing, opening = 0, 0.0, 0.0
    for k, hours in enumerate(np.asarray(interval, dtype=np.float64).tolist()):
        # What is kept depends on the state that the windows are in, not on the one that they would be in.
        wish = max(int(reached[k]), min(state, int(kept[k])))
        waited, delay = (closing, close_after) if wish > state else (opening, open_after)
        if waited >= delay - 1e-9:
            state = wish
        closing = closing + hours if int(reached[k]) > state else 0.0
        opening = opening + hours if int(kept[k]) < state else 0.0
        found[k] = state
    return found
