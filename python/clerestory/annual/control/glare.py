"""Windows as open as glare allows, by what is cheap to know of it.

The cheap glare of a view is the larger of two values: the simplified probability DGPs = 6.22e-5 E_v + 0.184 (Wienold
2007), and DGP with the sun's disc as its only source where the eye sees it through a window's beam (Wienold and
Christoffersen 2006). Bright patches of a window that are not the sun itself count by the illuminance at the eye alone.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory.annual.control.hysteresis import held
from clerestory.annual.frequencies import simplified_dgp

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Doubles = NDArray[np.float64]
    States = NDArray[np.int64]


def cheap_dgp(at_eye: Doubles, disc: Doubles) -> Doubles:
    """The cheap glare of eyes.

    Parameters
    ----------
    at_eye
        Illuminance at the eye [lx].
    disc
        L² ω / P² of the sun's disc that the eye sees [cd² sr/m⁴], with the position index P; 0 where it does not.
    """
    e = np.asarray(at_eye, dtype=np.float64)
    term = np.divide(disc, e**1.87, out=np.zeros(np.broadcast(e, disc).shape), where=e > 0.0)
    of_disc = np.minimum(5.87e-5 * e + 0.0918 * np.log10(1.0 + term) + 0.16, 1.0)
    return np.maximum(simplified_dgp(e), np.where(term > 0.0, of_disc, 0.0))


def most_open(at_eye: Doubles, disc: Doubles, limit: float, *, hysteresis: float = 0.0) -> States:
    """States (groups, steps): as open as the cheap glare of every view stays at or below a limit.

    All groups begin in their first state; while a view is above the limit, the group whose next state helps most goes
    there.

    Parameters
    ----------
    at_eye
        Illuminance at eyes that comes through each group in each of its states (views, groups, states, steps) [lx].
    disc
        L² ω / P² of the sun's disc through each group in each state (views, groups, states, steps) [cd² sr/m⁴].
    limit
        Of DGP.
    hysteresis
        Windows open again only if the glare stays below the limit less this.
    """
    wanted = _within(at_eye, disc, limit)
    if hysteresis <= 0.0:
        return wanted
    allowed = np.maximum(wanted, _within(at_eye, disc, limit - hysteresis))
    return np.stack([held(low, high) for low, high in zip(wanted, allowed, strict=True)])


def _within(at_eye: Doubles, disc: Doubles, limit: float) -> States:
    _, groups, count, steps = at_eye.shape
    found = np.zeros((groups, steps), dtype=np.int64)
    for _ in range(groups * (count - 1)):
        over = _worst(at_eye, disc, found) > limit
        over &= (found < count - 1).any(axis=0)
        if not over.any():
            break
        tried = []
        for group in range(groups):
            closer = found.copy()
            closer[group] = np.minimum(closer[group] + 1, count - 1)
            glare = _worst(at_eye, disc, closer)
            tried.append(np.where(found[group] < count - 1, glare, np.inf))
        best = np.argmin(np.stack(tried), axis=0)
        step = np.flatnonzero(over)
        found[best[step], step] += 1
    return found


def _worst(at_eye: Doubles, disc: Doubles, states: States) -> Doubles:
    """The largest cheap glare of all views (steps)."""
    index = states[None, :, None, :]
    light = np.take_along_axis(at_eye, index, axis=2).sum(axis=(1, 2))
    sun = np.take_along_axis(disc, index, axis=2).sum(axis=(1, 2))
    return np.asarray(cheap_dgp(light, sun).max(axis=0))
