"""Seams: what two screens say of the same direction, where one goes over into the other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.ndimage import map_coordinates

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from clerestory.measure.camera.screen import Screen

    Floats = NDArray[np.float64]

_ALONG = 24
"""Points of an edge."""
_APART = 0.02
"""Screens whose edges are no farther from each other than this part of their size go over into one another."""
_STEP = 0.02
"""Values at an edge come from points so far inside, in parts of the size: the edge's own pixels show both sides."""
_LEAST_COSINE = 0.15
_LEAST_SHARE = 0.01
"""Of the largest value; darker points tell of noise."""


@dataclass(frozen=True)
class Seam:
    """Where two positions meet or overlap."""

    first: str
    second: str
    points: int
    ratio: float
    """Median of the first's BSDF over the second's."""
    mismatch: float
    """Median of their relative difference, without sign."""


def seams_of(screens: Sequence[Screen], bsdf: Sequence[Floats]) -> list[Seam]:
    """Every pair of screens that share a seam.

    Parameters
    ----------
    screens
        Positions.
    bsdf
        A picture (height, width) of each, times what turns luminance at a place into BSDF is left to `Screen.factor`:
        luminance over the lit area and the illuminance of the sample.
    """
    made = []
    for i, first in enumerate(screens):
        for j in range(i + 1, len(screens)):
            ratios = np.concatenate(
                [_ratios(first, screens[j], bsdf[i], bsdf[j]), -_ratios(screens[j], first, bsdf[j], bsdf[i])]
            )
            if len(ratios) >= 4:
                made.append(
                    Seam(
                        first.name,
                        screens[j].name,
                        len(ratios),
                        float(np.exp(np.median(ratios))),
                        float(np.expm1(np.median(np.abs(ratios)))),
                    )
                )
    return made


def _ratios(own: Screen, other: Screen, own_picture: Floats, other_picture: Floats) -> Floats:
    """Logarithms of own over other along own's edges, where the other goes on."""
    share = (np.arange(_ALONG) + 0.5) / _ALONG
    ends = np.roll(own.corners, -1, axis=0)
    edges = (own.corners[:, None] * (1.0 - share[:, None]) + ends[:, None] * share[:, None]).reshape(-1, 2)
    points = own.at(edges)
    d = points / np.linalg.norm(points, axis=1)[:, None]
    there = other.hit(d)
    with np.errstate(invalid="ignore"):
        distance = np.nan_to_num(other.edge_distance(there), nan=-np.inf)
    kept = (distance > -_APART * other.size) & (np.abs(d[:, 2]) > _LEAST_COSINE)
    if not kept.any():
        return np.zeros(0)
    mine = _at_edge(own, edges[kept], own_picture)
    deep = distance[kept] > 3.0 * _STEP * other.size
    theirs = np.where(deep, _looked_up(other, there[kept], other_picture), _at_edge(other, there[kept], other_picture))
    with np.errstate(invalid="ignore"):
        bright = (np.minimum(mine, theirs) > _LEAST_SHARE * np.nanmax(np.maximum(mine, theirs), initial=0.0)) & (
            mine > 0.0
        )
    return np.asarray(np.log(mine[bright] / theirs[bright]))


def _at_edge(screen: Screen, places: Floats, picture: Floats) -> Floats:
    """BSDF at places on the edge, by a line through two points farther inside."""
    inward = screen.corners.mean(axis=0) - places
    inward /= np.linalg.norm(inward, axis=1)[:, None]
    step = _STEP * screen.size
    near, far = (_looked_up(screen, places + k * step * inward, picture) for k in (1.0, 3.0))
    return 1.5 * near - 0.5 * far


def _looked_up(screen: Screen, places: Floats, picture: Floats) -> Floats:
    """BSDF at places inside, between the middles of pixels; NaN outside of the picture."""
    pixels = screen.pixels(places)
    found = map_coordinates(picture, [pixels[:, 1] - 0.5, pixels[:, 0] - 0.5], order=1, cval=np.nan)
    return np.asarray(found * screen.factor(places)[0])
