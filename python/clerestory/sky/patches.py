"""The sky in patches, as daylight matrices count them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory import _core
from clerestory.counts import counted

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


class SkyPatches:
    """Tregenza's 145 patches of the sky or Reinhart's subdivisions of them, and the ground.

    Patch 0 is the ground. Rows follow from the horizon up; each begins in the north and runs clockwise seen from above;
    the zenith is last. That is the order of Radiance's `gendaymtx`.
    """

    def __init__(self, core: _core.SkyPatches) -> None:
        self._core = core

    @classmethod
    def named(cls, name: str) -> SkyPatches:
        """By name: tregenza, reinhart:4.

        Raises
        ------
        ClerestoryError
            The name is not known.
        """
        return cls(_core.SkyPatches.named(name))

    @property
    def name(self) -> str:
        """Name, as `named` takes it."""
        return "tregenza" if self.subdivision == 1 else f"reinhart:{self.subdivision}"

    @property
    def subdivision(self) -> int:
        """The n of Reinhart MF:n; 1 is Tregenza's."""
        return self._core.subdivision

    def __len__(self) -> int:
        """Number of patches with the ground: 144 n² + 2."""
        return len(self._core)

    def __repr__(self) -> str:
        return f"<SkyPatches {self.name!r}: {counted(len(self) - 1, 'patch', 'patches')} and the ground>"

    @property
    def centres(self) -> NDArray[np.float64]:
        """Unit vectors (n, 3) toward the patches' centres; down for the ground."""
        return self._core.centres()

    @property
    def solid_angles(self) -> NDArray[np.float64]:
        """Solid angle of each patch [sr]; 2π for the ground and for all of the sky."""
        return self._core.solid_angles()

    @property
    def projected_solid_angles(self) -> NDArray[np.float64]:
        """Solid angle projected onto the horizontal plane [sr]; π for the ground and for all of the sky."""
        return self._core.projected_solid_angles()

    def index_of(self, directions: ArrayLike) -> NDArray[np.int64]:
        """Patch of directions (..., 3); 0 below the horizon."""
        vectors = np.asarray(directions, dtype=np.float64)
        flat = np.ascontiguousarray(vectors.reshape(-1, 3))
        return self._core.patch_of(flat).reshape(vectors.shape[:-1])
