"""Light between layers: beams exactly in every direction, scattered light from patch to patch.

Each layer has two faces. Light *arrives* at a face and is *emitted* from one; faces are counted 2k (exterior) and 2k
+ 1 (interior) for layer k, outermost first. Gaps are optically nothing and layers have no lateral extent, so a beam
keeps its point of the disk through the whole system, and beams are a small linear system for every direction.

With b what beams make of arrivals, s what scattering makes of them, and h the way from a face across its gap:

    emitted = b · arrived + s · arrived,   arrived = h · emitted + what comes from outside.

References
----------
Klems 1994, "A new method for predicting the solar heat gain of complex fenestration systems", ASHRAE Transactions
100, with beams kept apart from scattered light.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from threadpoolctl import threadpool_limits

from clerestory._core import ClerestoryError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Beams:
    """How beams travel through layers, for m directions."""

    gain: Floats
    """Emitted from each face for light emitted by scattering from each face, after all ways along beams (m, 2L, 2L)."""
    arriving: Floats
    """Arriving at each face for the same (m, 2L, 2L)."""
    entering: Floats
    """Arriving at each face for light from outside, by side (2, m, 2L)."""
    leaving: Floats
    """Beams that leave: by side of incidence and side where they leave (2, 2, m)."""

    @classmethod
    def of(cls, transmittance: Floats, reflectance: Floats) -> Beams:
        """From the beams' transmittance and reflectance by layer and side of incidence (L, 2, m).

        Raises
        ------
        ClerestoryError
            Light that gets between two layers never leaves them.
        """
        count, _, m = transmittance.shape
        b = np.zeros((m, 2 * count, 2 * count))
        h = np.zeros((2 * count, 2 * count))
        for k in range(count):
            outer, inner = 2 * k, 2 * k + 1
            b[:, inner, outer], b[:, outer, inner] = transmittance[k]
            b[:, outer, outer], b[:, inner, inner] = reflectance[k]
            if k + 1 < count:
                h[inner + 1, inner] = h[inner, inner + 1] = 1.0
        kept = np.eye(2 * count) - b @ h
        try:
            gain = np.linalg.inv(kept)
        except np.linalg.LinAlgError:
            raise ClerestoryError(
                "light that gets between two layers never leaves them (one of them must let some go)"
            ) from None
        outside = np.zeros((2, 2 * count))
        outside[0, 0] = outside[1, -1] = 1.0
        emitted = np.einsum("mij,mjk,sk->smi", gain, b, outside)
        return cls(
            gain,
            h @ gain,
            outside[:, None, :] + emitted @ h.T,
            np.stack([emitted[..., 0], emitted[..., -1]], axis=1),
        )

    def by_patch(self, count: int) -> Beams:
        """Means over patches of as many directions each, in the order of the patches."""
        m = self.gain.shape[0] // count

        def mean(values: Floats, axis: int) -> Floats:
            shape = (*values.shape[:axis], count, m, *values.shape[axis + 1 :])
            return np.asarray(values.reshape(shape).mean(axis=axis + 1))

        return Beams(mean(self.gain, 0), mean(self.arriving, 0), mean(self.entering, 1), mean(self.leaving, 2))

    def escaping(self, side: int) -> Floats:
        """What leaves to a side of light that scattering emits from each face (m, 2L)."""
        return self.gain[:, 0 if side == 0 else -1, :]


@dataclass(frozen=True)
class Scattered:
    """Scattered light between patches, for the faces of the layers that scatter."""

    faces: list[int]
    """Faces (f,) of layers that scatter."""
    once: Floats
    """Emitted from each face for a beam that arrives at each, scattered once (f, n, f, n): face and patch."""
    often: Floats
    """The same for all light, scattered once or more often."""

    @classmethod
    def of(cls, beams: Beams, shares: dict[int, Floats]) -> Scattered:
        """From what layers scatter.

        Parameters
        ----------
        shares
            By layer, flux shares (2, 2, n, n): side of incidence, side that they are emitted to, outgoing and incident
            patch.

        Raises
        ------
        ClerestoryError
            Light that gets between two layers never leaves them.
        """
        faces = [face for layer in sorted(shares) for face in (2 * layer, 2 * layer + 1)]
        n = beams.gain.shape[0]
        once = np.zeros((len(faces), n, len(faces), n))
        for place, layer in enumerate(sorted(shares)):
            for side in range(2):
                for to in range(2):
                    once[2 * place + to, :, 2 * place + side, :] = shares[layer][side, to]
        # Scattered light that arrives again: patch by patch, from face to face.
        again = beams.arriving[:, faces][:, :, faces]
        onward = np.einsum("fpgq,qgh->fphq", once, again)
        size = len(faces) * n
        try:
            # One thread: the same digits on any machine, and no waiting where others compute too.
            with threadpool_limits(1, user_api="blas"):
                often = np.linalg.solve(np.eye(size) - onward.reshape(size, size), once.reshape(size, size))
        except np.linalg.LinAlgError:
            raise ClerestoryError(
                "light that gets between two layers never leaves them (one of them must let some go)"
            ) from None
        return cls(faces, once, often.reshape(once.shape))

    def emitted(self, beams: Beams, side: int) -> Floats:
        """Emitted from each face (f, n, n) for light from outside: face, outgoing patch, incident patch."""
        return np.asarray(np.einsum("fpgq,qg->fpq", self.often, beams.entering[side][:, self.faces]))


@dataclass(frozen=True)
class Solution:
    """What layers make of light from both sides, on patches."""

    beam: Floats
    """Light that leaves along beams: side of incidence, side where it leaves, patch (2, 2, n)."""
    scattered: Floats
    """Flux shares of scattered light: the same sides, outgoing and incident patch (2, 2, n, n)."""
    absorbed: Floats
    """By side of incidence, absorber and incident patch (2, k, n)."""


def solve(beams: Beams, shares: dict[int, Floats], absorbers: list[Floats]) -> Solution:
    """Light of one wavelength or band through all layers.

    Parameters
    ----------
    beams
        Beams at the patches.
    shares
        What layers scatter, as for `Scattered.of`.
    absorbers
        What the absorbers of each layer take of the light that arrives, (k, 2, n) by side: one of a plain layer,
        several of a run of panes that counts as one.
    """
    n, faces = beams.gain.shape[0], beams.gain.shape[1]
    scattered = np.zeros((2, 2, n, n))
    arrived = np.zeros((2, faces, n, n))
    for side in range(2):
        for face in range(faces):
            np.fill_diagonal(arrived[side, face], beams.entering[side, :, face])
    if shares:
        between = Scattered.of(beams, shares)
        for side in range(2):
            emitted = between.emitted(beams, side)
            for to in range(2):
                scattered[side, to] = np.einsum("pf,fpq->pq", beams.escaping(to)[:, between.faces], emitted)
            arrived[side] += np.einsum("pgf,fpq->gpq", beams.arriving[:, :, between.faces], emitted)
    absorbed = np.stack(
        [
            np.concatenate(
                [
                    np.einsum("ksp,spq->kq", takes, arrived[side, 2 * layer : 2 * layer + 2])
                    for layer, takes in enumerate(absorbers)
                ]
            )
            for side in range(2)
        ]
    )
    return Solution(beams.leaving, scattered, absorbed)
