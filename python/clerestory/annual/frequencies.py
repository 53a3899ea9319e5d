"""How often values occur: glare in classes, and illuminance at the eye by size."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.annual.metrics import checked

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True)
class Classes:
    """Classes of a glare index. A limit belongs to the class below it."""

    index: str
    """Name of the index."""
    limits: tuple[float, ...]
    """Between the classes, rising."""
    names: tuple[str, ...]
    """Of the classes, one more than limits."""

    @property
    def ranges(self) -> tuple[str, ...]:
        """The classes as numbers, such as ≤ 0.35."""
        texts = [f"{limit:.2f}" if max(self.limits) < 1.0 else f"{limit:g}" for limit in self.limits]
        between = [f"{low} to {high}" for low, high in pairwise(texts)]
        return (f"≤ {texts[0]}", *between, f"> {texts[-1]}")


DGP_CLASSES = Classes("DGP", (0.35, 0.40, 0.45), ("imperceptible", "perceptible", "disturbing", "intolerable"))
"""Of Wienold and Christoffersen's daylight glare probability, as EN 17037 divides it."""
DGI_CLASSES = Classes("DGI", (18.0, 24.0, 28.0), ("barely perceptible", "acceptable", "uncomfortable", "intolerable"))
"""Of the daylight glare index, as the report of IEA SHC Task 61 (2021, C.2.2) divides it; others have 22 and 31."""


def class_shares(values: ArrayLike, hours: ArrayLike, classes: Classes) -> NDArray[np.float64]:
    """Share of the hours in each class, of every view (classes, views); their sum is 1.

    Parameters
    ----------
    values
        Glare index (steps, views).
    hours
        Hours that each step counts for (steps,) [h].
    classes
        `DGP_CLASSES` or `DGI_CLASSES`.
    """
    made, weights = checked(values, hours)
    total = weights.sum()
    if not total > 0.0:
        raise ClerestoryError("no hour of the weather counts (choose other hours)")
    # Values are stored with 32 bits in places, whose 0.35 is a little more.
    found = np.searchsorted(np.array(classes.limits) * (1.0 + 1e-7), made, side="left")
    shares: NDArray[np.float64] = np.stack([weights @ (found == k) for k in range(len(classes.names))]) / total
    return shares


def histogram(values: ArrayLike, hours: ArrayLike, edges: ArrayLike) -> NDArray[np.float64]:
    """Hours in which values lie between edges (bins, views) [h]; what lies beyond them is in the first and last bin.

    Parameters
    ----------
    values
        (steps, views), such as illuminance at the eye [lx].
    hours
        Hours that each step counts for (steps,) [h].
    edges
        Rising (bins + 1,); a bin has its lower edge.
    """
    made, weights = checked(values, hours)
    limits = np.asarray(edges, dtype=np.float64)
    if limits.ndim != 1 or len(limits) < 2 or not (np.diff(limits) > 0.0).all():
        raise ClerestoryError("edges of bins rise (give at least two)")
    bins = np.clip(np.searchsorted(limits, made, side="right") - 1, 0, len(limits) - 2)
    return np.stack([np.bincount(column, weights, minlength=len(limits) - 1) for column in bins.T], axis=1)


def cumulated(values: ArrayLike, hours: ArrayLike, levels: ArrayLike) -> NDArray[np.float64]:
    """Share of the hours with at least each level (levels, views), 0 to 1, falling.

    Parameters
    ----------
    values
        (steps, views).
    hours
        Hours that each step counts for (steps,) [h].
    levels
        Any (levels,).
    """
    made, weights = checked(values, hours)
    if not weights.sum() > 0.0:
        raise ClerestoryError("no hour of the weather counts (choose other hours)")
    limits = np.asarray(levels, dtype=np.float64)
    shares: NDArray[np.float64] = np.stack([weights @ (made >= level) for level in limits]) / weights.sum()
    return shares


def simplified_dgp(eye_illuminance: ArrayLike) -> NDArray[np.float64]:
    """DGPs: daylight glare probability by the vertical illuminance at the eye [lx] alone, at most 1.

    6.22e-5 E_v + 0.184 (Wienold 2007); of use only where no source of glare is seen.
    """
    made: NDArray[np.float64] = np.minimum(6.22e-5 * np.asarray(eye_illuminance, dtype=np.float64) + 0.184, 1.0)
    return made
