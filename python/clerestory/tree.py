"""Tensor trees: BSDFs that are fine where they change and coarse where they do not."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory import _core

if TYPE_CHECKING:
    from typing import Self

    from numpy.typing import ArrayLike


@dataclass(frozen=True)
class ReductionReport:
    """What a reduction left of a tensor tree, and the error that it caused."""

    rms_error: float
    """RMS difference of the BSDF over its mean, all directions weighted by projected solid angle on both sides."""
    worst_direct_hemispherical: float
    """Largest difference of a direct-hemispherical value over all incident directions."""
    leaves_before: int
    leaves_after: int


class TreeOperations:
    """The methods of `Model` that make, describe and reduce tensor trees."""

    def __init__(self, core: _core.Model) -> None:
        self._core = core

    @classmethod
    def tree_from_grid(cls, values: ArrayLike) -> Self:
        """Tensor tree of an array; parts of equal values are merged.

        Parameters
        ----------
        values
            BSDF [1/sr] of 2, 4, 8, … cells an axis. Four axes make an anisotropic tree: two of the incident and two of
            the outgoing direction's point of the unit square (Shirley and Chiu's map of the disk of travel). Three axes
            make an isotropic one: the incident radius, from grazing (0) to normal (0.5), and the outgoing point, where
            the light travels toward +x; the upper half of axis 0 is unused and may be left out.
        """
        array = np.ascontiguousarray(values, dtype=np.float32)
        cells = array.shape[-1] if array.ndim else 0
        levels = max(cells.bit_length() - 1, 0)
        lengths = {(cells,) * array.ndim}
        if array.ndim == 3:
            lengths.add((cells // 2, cells, cells))
        if cells != 1 << levels or array.shape not in lengths:
            raise _core.ClerestoryError(
                f"an array of shape {array.shape} does not make a tensor tree "
                "(give 2, 4, 8, … cells, the same number on each of 3 or 4 axes)"
            )
        return cls(_core.Model.tree_from_grid(array.ndim, levels, array.ravel()))

    @property
    def tree_rank(self) -> int:
        """3 for an isotropic tensor tree, 4 for an anisotropic one."""
        return self._core.tree_shape()[0]

    @property
    def tree_depth(self) -> int:
        """Levels of a tensor tree: 2^depth cells an axis where it is finest."""
        return self._core.tree_shape()[1]

    @property
    def tree_leaves(self) -> int:
        """Number of values of a tensor tree."""
        return self._core.tree_shape()[2]

    def reduced(self, *, percent: float | None = None, max_error: float | None = None) -> tuple[Self, ReductionReport]:
        """A tensor tree with fewer leaves, and the error that this caused. Give one of the two.

        Parameters
        ----------
        percent
            Share [%] of the finest blocks that are merged, those of the least contrast; what is smooth above them
            follows. The same as Radiance's `rttree_reduce` does: 90 to 95 is usual.
        max_error
            Bound on `ReductionReport.rms_error`, as a fraction: blocks are merged as long as it is kept, those of the
            least error first.
        """
        if percent is not None and max_error is None:
            core, row = self._core.reduced_by_percent(percent)
        elif max_error is not None and percent is None:
            core, row = self._core.reduced_by_error(max_error)
        else:
            raise TypeError("give either percent or max_error")
        return type(self)(core), ReductionReport(*row)
