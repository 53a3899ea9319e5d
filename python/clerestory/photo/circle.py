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
"""Share of the directions in which the border must be seen."""
TOLERANCE = 0.01
"""Borders further than this share of the radius from the circle are not of it."""


@dataclass(frozen=True)
class Circle:
    """A circle of pixels."""

    centre: tuple[float, float]
    """Column and row from the upper left corner; the first pixel's centre is 0.5, 0.5."""
    radius: float
    """[pixels]"""
    share: float
    """Of the directions in which its border was seen."""
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
    From outside the first bright run on rays toward the middle is taken for the border; a circle is fitted to these
    points by algebraic least squares, starting from the best of circles through three of them (drawn in a fixed order),
    with those left out that are further away than `TOLERANCE`. A circle that is cut by the picture's edges is found by
    the rest of its border.
    """
    grey = levels.max(axis=2).astype(np.float32)
    grey /= np.iinfo(levels.dtype).max
    points = _border(grey)
    if len(points) < LEAST_ARC * RAYS:
        raise _none("its border is seen in too few directions")
    start = _by_three(points)
    inside = _near(points, start)
    for _ in range(20):
        circle = _fit(points[inside])
        again = _near(points, circle)
        if (again == inside).all():
            break
        inside = again
    share = float(inside.sum()) / RAYS
    x, y, radius = circle
    height, width = grey.shape
    if share < LEAST_ARC or not (0.15 * min(height, width) < radius < max(height, width)):
        raise _none("what stands out from black is no circle")
    distance = np.hypot(points[inside, 0] - x, points[inside, 1] - y) - radius
    return Circle((x, y), radius, share, float(np.sqrt(np.mean(distance**2))))


def _none(why: str) -> MissingDataError:
    return MissingDataError(
        f"no circle of a fisheye was found, since {why} (give --centre and --radius; or --projection none if the lens "
        "is no fisheye)"
    )


def _border(grey: NDArray[np.float32]) -> NDArray[np.float64]:
    """Columns and rows (n, 2) where rays from outside first meet what is bright and stays so."""
    height, width = grey.shape
    # Black surrounds have noise and a haze of flare; the frame's corners show how much.
    side = max(4, min(height, width) // 40)
    corners = np.concatenate(
        [grey[a, b].ravel() for a in (slice(side), slice(-side, None)) for b in (slice(side), slice(-side, None))]
    )
    threshold = max(float(np.median(corners)) + 6.0 * float(np.median(np.abs(corners - np.median(corners)))), 0.0)
    threshold += 0.04
    middle = np.array([0.5 * width, 0.5 * height])
    found = []
    for angle in 2.0 * np.pi * (np.arange(RAYS) + 0.5) / RAYS:
        step = np.array([np.cos(angle), np.sin(angle)])
        length = float(np.min(np.where(np.abs(step) > 1e-9, middle / np.maximum(np.abs(step), 1e-9), np.inf)))
        distance = np.arange(length - 0.51, 0.0, -0.5)
        places = middle + distance[:, None] * step
        columns = np.clip(places[:, 0].astype(int), 0, width - 1)
        rows = np.clip(places[:, 1].astype(int), 0, height - 1)
        bright = grey[rows, columns] > threshold
        run = 8  # four pixels, so that a hot one does not count
        if bright.size < 2 * run or bright[:run].any():
            continue  # the edge of the picture cuts the circle here
        held = np.convolve(bright, np.ones(run), "valid") >= run
        if held.any():
            found.append(places[int(np.argmax(held))])
    return np.array(found).reshape(-1, 2)


def _by_three(points: NDArray[np.float64]) -> tuple[float, float, float]:
    """The circle through three of the points that most of the others are near to."""
    count = len(points)
    best, most = (0.0, 0.0, 0.0), -1
    random = np.random.default_rng(1)
    for _ in range(400):
        three = points[random.choice(count, 3, replace=False)]
        if abs(np.linalg.det(np.column_stack([three, np.ones(3)]))) < 1e-3 * count:
            continue
        circle = _fit(three)
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
