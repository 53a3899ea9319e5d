"""Measured incident directions around another one.

Incident directions and their images under the sample's symmetry are triangulated on the disk of their projections;
those of an isotropic sample are a chain of polar angles. A direction lies between up to three of them, with shares that
sum to 1.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import Delaunay, QhullError

from clerestory._core import ClerestoryError
from clerestory.measure.prepare.symmetry import MOVES

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from clerestory.measure.prepare.symmetry import Symmetry

    Floats = NDArray[np.float64]

_ONE = np.eye(2)
_SAME = 1e-6
SAME_DEG = 0.25
"""Directions that are nearer were meant to be one."""


@dataclass(frozen=True)
class Between:
    """Where an incident direction lies among the measured ones."""

    scans: NDArray[np.int64]
    """Which of them are around it (n,)."""
    images: Floats
    """What turns the projection of each one's own frame into that of its image there (n, 2, 2)."""
    shares: Floats
    """Weight of each, which sum to 1 (n,)."""
    spread_deg2: float
    """Σ share · (angle to it)² [°²]: 0 in a measured direction, a quarter of the squared gap between two. The error of
    linear interpolation is half of it times the second derivative."""
    beyond: bool
    """Whether the direction lies outside of all measured ones, so that the nearest stands for it."""


class Neighbours:
    """Measured incident directions of one component, as projections (n, 2) onto the sample's plane."""

    def __init__(self, places: Floats, symmetry: Symmetry) -> None:
        self.symmetry = symmetry
        self.places = np.asarray(places, dtype=np.float64)
        if symmetry == "isotropic":
            self._theta = np.degrees(np.arcsin(np.clip(np.linalg.norm(self.places, axis=1), 0.0, 1.0)))
            self._order = np.argsort(self._theta)
            return
        images = _images(symmetry)
        every = np.concatenate([self.places @ image.T for image in images])
        _, first = np.unique(np.round(every / _SAME), axis=0, return_index=True)
        first = np.sort(first)
        self._places = every[first]
        self._which, self._image = first % len(self.places), first // len(self.places)
        try:
            self._mesh = Delaunay(self._places)
        except (QhullError, ValueError) as error:
            raise ClerestoryError(
                "incident directions are too few or lie on one line: no direction is between them (measure other"
                " azimuths, or say that the sample is isotropic)"
            ) from error

    def around(self, place: Floats) -> Between:
        """The measured directions around a projection (2,)."""
        return self._on_chain(place) if self.symmetry == "isotropic" else self._on_mesh(place)

    def _on_chain(self, place: Floats) -> Between:
        theta = float(np.degrees(np.arcsin(min(1.0, float(np.linalg.norm(place))))))
        sorted_theta = self._theta[self._order]
        k = int(np.clip(np.searchsorted(sorted_theta, theta, side="right") - 1, 0, max(len(sorted_theta) - 2, 0)))
        pair = self._order[k : k + 2]
        beyond = bool(theta > sorted_theta[-1] + 1e-6 or theta < sorted_theta[0] - 1e-6)
        if len(pair) == 2 and not beyond:
            share = float(np.clip((theta - self._theta[pair[0]]) / np.ptp(self._theta[pair]), 0.0, 1.0))
            shares = np.array([1.0 - share, share])
        else:
            pair = pair[np.argmin(np.abs(self._theta[pair] - theta))][None]
            shares = np.ones(1)
        turn = np.arctan2(place[1], place[0]) if np.linalg.norm(place) > _SAME else None
        images = np.stack([_turn(self.places[n], turn) for n in pair])
        kept = shares > 1e-9
        spread = float(shares @ (self._theta[pair] - theta) ** 2)
        return Between(pair[kept], images[kept], shares[kept], spread, beyond)

    def _on_mesh(self, place: Floats) -> Between:
        found = int(self._mesh.find_simplex(place[None])[0])
        if found < 0:
            corners = np.array([int(np.argmin(np.sum((self._places - place) ** 2, axis=1)))])
            shares = np.ones(1)
        else:
            corners = self._mesh.simplices[found].astype(np.int64)
            transform = self._mesh.transform[found]
            two = transform[:2] @ (place - transform[2])
            shares = np.clip(np.append(two, 1.0 - two.sum()), 0.0, None)
            shares /= shares.sum()
        kept = shares > 1e-9
        corners, shares = corners[kept], shares[kept]
        angle = _angles_deg(self._places[corners], place)
        images = np.stack([_images(self.symmetry)[k] for k in self._image[corners]])
        beyond = found < 0 and bool(angle[0] > 1e-4)
        return Between(self._which[corners], images, shares, float(shares @ angle**2), beyond)


def spread_out(places: Floats, symmetry: Symmetry) -> NDArray[np.int64]:
    """Indices of half of the places, each the farthest from those before; the first is nearest to the normal.

    Places that are the same under the symmetry count as one.
    """
    images = _images(symmetry)
    if symmetry == "isotropic":
        places = np.column_stack([np.linalg.norm(places, axis=1), np.zeros(len(places))])
    chosen = [int(np.argmin(np.linalg.norm(places, axis=1)))]
    nearest = np.full(len(places), np.inf)
    while True:
        for image in images:
            nearest = np.minimum(nearest, _angles_deg(places, image @ places[chosen[-1]]))
        farthest = int(np.argmax(nearest))
        if nearest[farthest] < SAME_DEG:
            return np.sort(np.array(chosen[: (len(chosen) + 1) // 2], dtype=np.int64))
        chosen.append(farthest)


def _images(symmetry: Symmetry) -> list[Floats]:
    """What the symmetry does to projections of directions, the identity first."""
    return [_ONE, *(move for _, move in MOVES.get(symmetry, ()))]


def _turn(place: Floats, to: float | None) -> Floats:
    if to is None or np.linalg.norm(place) < _SAME:
        return _ONE
    by = to - float(np.arctan2(place[1], place[0]))
    return np.array([[np.cos(by), -np.sin(by)], [np.sin(by), np.cos(by)]])


def _angles_deg(places: Floats, place: Floats) -> Floats:
    """Angles between directions of a hemisphere [°] (n,), by their projections (n, 2) and (2,)."""
    up, one = (np.sqrt(np.maximum(1.0 - (np.atleast_2d(p) ** 2).sum(axis=1), 0.0)) for p in (places, place))
    chord2 = ((np.atleast_2d(places) - place) ** 2).sum(axis=1) + (up - one) ** 2
    return np.asarray(2.0 * np.degrees(np.arcsin(np.clip(0.5 * np.sqrt(chord2), 0.0, 1.0))))
