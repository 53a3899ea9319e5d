"""The circle of a fisheye, found by its border."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import MissingDataError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from clerestory.photo.photograph import Levels

RAYS = 720
"""Directions in which the border is looked for, from the outside."""
LEAST_ARC = 0.25
"""Share of the circle over which its border must be seen."""
RISE = 0.05
"""Least step of the level, of 1, at the border. Stray light around the circle falls off without a step."""
TOLERANCE = 0.01
"""Borders further than this share of the radius from the circle are not of it."""
_SECTORS = 120
_HALF = 6
"""Half pixels on either side of a step."""


@dataclass(frozen=True)
class Circle:
    """A circle of pixels."""

    centre: tuple[float, float]
    """Column and row from the upper left corner; the first pixel's centre is 0.5, 0.5."""
    radius: float
    """[pixels]"""
    share: float
    """Of the circle over which its border was seen."""
    residual: float
    """Root mean square distance of the border from the circle [pixels]."""

    @property
    def words(self) -> str:
        """Such as radius 1832.4 pixels about 2808.1, 1871.9."""
        return (
            f"radius {self.radius:.1f} pixels about {self.centre[0]:.1f}, {self.centre[1]:.1f} "
            f"(border seen over {100.0 * self.share:.0f} %, ± {self.residual:.1f} pixels)"
        )


def find_circle(levels: Levels) -> Circle:
    """Find the circle that a fisheye draws on its black surround.

    Parameters
    ----------
    levels
        The longest exposure (height, width, 3), in which even a dark room stands out.

    Raises
    ------
    MissingDataError
        There is none: the lens fills the picture, or the scene is too dark at the border.

    Notes
    -----
    The first step from dark to bright on rays from outside toward the middle is taken for the border; a circle is
    fitted to these points by algebraic least squares, starting from the best of circles through three of them (drawn in
    a fixed order), with those left out that are further away than `TOLERANCE`. A circle that is cut by the picture's
    edges is found by the rest of its border.
    """
    grey = levels.max(axis=2).astype(np.float32)
    grey /= np.iinfo(levels.dtype).max
    points = _border(grey)
    if len(points) < LEAST_ARC * RAYS:
        raise _none("its border is seen in too few directions")
    height, width = grey.shape
    sizes = (0.15 * min(height, width), float(max(height, width)))
    start = _by_three(points, sizes)
    inside = _near(points, start)
    for _ in range(20):
        circle = _fit(points[inside])
        again = _near(points, circle)
        if (again == inside).all():
            break
        inside = again
    x, y, radius = circle
    # As seen from the circle's own middle, so that straight edges of other things are no arcs.
    sectors = np.floor(np.arctan2(points[inside, 1] - y, points[inside, 0] - x) * (0.5 * _SECTORS / np.pi))
    share = np.unique(sectors % _SECTORS).size / _SECTORS
    if share < LEAST_ARC or not sizes[0] < radius < sizes[1]:
        raise _none("what stands out from black is no circle")
    distance = np.hypot(points[inside, 0] - x, points[inside, 1] - y) - radius
    return Circle((x, y), radius, share, float(np.sqrt(np.mean(distance**2))))


def _none(why: str) -> MissingDataError:
    return MissingDataError(
        f"no circle of a fisheye was found, since {why} (give --centre and --radius; or --projection none if the lens "
        "is no fisheye)"
    )


def _border(grey: NDArray[np.float32]) -> NDArray[np.float64]:
    """Columns and rows (n, 2) of the first step from dark to bright that rays from outside meet."""
    height, width = grey.shape
    # Black surrounds have noise and a haze of stray light; the frame's corners show how much.
    side = max(4, min(height, width) // 40)
    corners = np.concatenate(
        [grey[a, b].ravel() for a in (slice(side), slice(-side, None)) for b in (slice(side), slice(-side, None))]
    )
    black = float(np.median(corners))
    step_height = RISE + 3.0 * float(np.median(np.abs(corners - black)))
    middle = np.array([0.5 * width, 0.5 * height])
    found = []
    for angle in 2.0 * np.pi * (np.arange(RAYS) + 0.5) / RAYS:
        inward = np.array([np.cos(angle), np.sin(angle)])
        length = float(np.min(np.where(np.abs(inward) > 1e-9, middle / np.maximum(np.abs(inward), 1e-9), np.inf)))
        places = middle + np.arange(length - 0.51, 0.0, -0.5)[:, None] * inward
        columns = np.clip(places[:, 0].astype(int), 0, width - 1)
        rows = np.clip(places[:, 1].astype(int), 0, height - 1)
        profile = grey[rows, columns].astype(np.float64)
        if profile.size < 4 * _HALF or profile[: 2 * _HALF].mean() > black + 2.0 * step_height:
            continue  # the edge of the picture cuts the circle here
        sums = np.concatenate([[0.0], np.cumsum(profile)])
        means = (sums[_HALF:] - sums[:-_HALF]) / _HALF
        rise = means[_HALF:] - means[:-_HALF]  # of the part that begins _HALF further on over the one before it
        steep = rise > step_height
        if steep.any():
            first = int(np.argmax(steep))
            # Where it is steepest, as long as it rises.
            last = first + int(np.argmin(np.append(steep[first:], False)))
            at = first + int(np.argmax(rise[first:last])) + _HALF
            found.append(0.5 * (places[at - 1] + places[at]))
    return np.array(found).reshape(-1, 2)


def _by_three(points: NDArray[np.float64], sizes: tuple[float, float]) -> tuple[float, float, float]:
    """The circle through three of the points, within limits of the radius, that most of the others are near to."""
    count = len(points)
    best, most = (0.0, 0.0, 0.0), -1
    random = np.random.default_rng(1)
    for _ in range(400):
        three = points[random.choice(count, 3, replace=False)]
        if abs(np.linalg.det(np.column_stack([three, np.ones(3)]))) < 1e-3 * count:
            continue
        circle = _fit(three)
        if not sizes[0] < circle[2] < sizes[1]:
            continue
        near = int(_near(points, circle).sum())
        if near > most:
            best, most = circle, near
    return best


def _fit(points: NDArray[np.float64]) -> tuple[float, float, float]:
    """Centre and radius by Kåsa's least squares of x² + y² = 2 a x + 2 b y + c."""
    offset = points.mean(axis=0)
    p = points - offset
    a, b, c = np.linalg.lstsq(np.column_stack([2.0 * p, np.ones(len(p))]), (p**2).sum(axis=1), rcond=None)[0]
    return float(a + offset[0]), float(b + offset[1]), float(np.sqrt(max(c + a * a + b * b, 0.0)))


def _near(points: NDArray[np.float64], circle: tuple[float, float, float]) -> NDArray[np.bool_]:
    x, y, radius = circle
    distance = np.abs(np.hypot(points[:, 0] - x, points[:, 1] - y) - radius)
    return np.asarray(distance <= max(TOLERANCE * radius, 1.0))
