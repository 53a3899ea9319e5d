"""Where an eye is and what it sees."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory import _core

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


class View:
    """Place, direction, projection and size of a picture, in the words of Radiance.

    Points of a picture are x from 0 at the left to 1 at the right, and y from 0 at the bottom to 1 at the top. The
    world's frame has x to the east, y to the north, z up.

    Parameters
    ----------
    options
        Such as `-vta -vp 0 0 1.2 -vd 0 1 0 -vu 0 0 1 -vh 180 -vv 180`. What is missing is Radiance's default.

    Raises
    ------
    ClerestoryError
        An option is faulty, the upward direction is parallel to the line of sight, or a size is not possible.
    """

    def __init__(self, options: str) -> None:
        self._core = _core.View(options)

    @classmethod
    def _of(cls, core: _core.View) -> View:
        view = cls.__new__(cls)
        view._core = core
        return view

    @classmethod
    def fisheye(cls, point: ArrayLike, direction: ArrayLike) -> View:
        """An angular fisheye of 180° at a point [m], as glare is evaluated on."""
        p, d = (" ".join(repr(float(v)) for v in np.asarray(a, dtype=np.float64)) for a in (point, direction))
        return cls(f"-vta -vp {p} -vd {d} -vu 0 0 1 -vh 180 -vv 180")

    def updated(self, options: str) -> View:
        """The view with some options overridden."""
        return View._of(self._core.updated(options))

    @property
    def options(self) -> str:
        """The options that make this view."""
        return self._core.options

    @property
    def projection(self) -> str:
        """Letter of the projection: v, l, h, a, s or c."""
        return self._core.projection

    @property
    def projection_name(self) -> str:
        """The projection in words."""
        return self._core.projection_name

    @property
    def size_deg(self) -> tuple[float, float]:
        """Horizontal and vertical size [°] (metres for a parallel view)."""
        return self._core.size

    @property
    def frame(self) -> NDArray[np.float64]:
        """Directions (3, 3) to the right, up and along the line of sight."""
        return self._core.frame()

    def size_within(self, width: int, height: int) -> tuple[int, int]:
        """Width and height with square pixels within a largest width and height."""
        return self._core.size_within(width, height)

    def rays(self, points: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Origins and directions (..., 3) through points (..., 2); NaN outside of the projection."""
        p = np.asarray(points, dtype=np.float64)
        made = self._core.rays(np.ascontiguousarray(p.reshape(-1, 2))).reshape(*p.shape[:-1], 6)
        return made[..., :3], made[..., 3:]

    def locate(self, directions: ArrayLike) -> NDArray[np.float64]:
        """Points (..., 2) where directions (..., 3) are seen; NaN where there is none, or no single one."""
        d = np.asarray(directions, dtype=np.float64)
        return self._core.locate(np.ascontiguousarray(d.reshape(-1, 3))).reshape(*d.shape[:-1], 2)

    def solid_angles(self, width: int, height: int, *, exact: bool = False) -> NDArray[np.float64]:
        """Solid angle [sr] of each pixel (height, width), row by row from the top.

        By corner directions as `evalglare` takes them, where a pixel with a corner outside of the projection has none;
        or exact, where it counts with what is inside.
        """
        return self._core.solid_angles(width, height, exact)

    def pixel_directions(self, width: int, height: int) -> NDArray[np.float64]:
        """Directions (height, width, 3) through the centres of pixels; NaN outside of the projection."""
        x, y = (np.arange(width) + 0.5) / width, 1.0 - (np.arange(height) + 0.5) / height
        return self.rays(np.stack(np.meshgrid(x, y), axis=-1))[1]

    def __eq__(self, other: object) -> bool:
        return isinstance(other, View) and self.options == other.options

    def __hash__(self) -> int:
        return hash(self.options)

    def __repr__(self) -> str:
        return f"View({self.options!r})"
