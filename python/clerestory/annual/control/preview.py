"""What a room would be like with its windows in each of their states, by three phases.

The sun that passes straight through a window is not spread over patches: points and eyes see it or do not.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory import _core
from clerestory.annual.phases import Transfer, leaving
from clerestory.annual.sun import SunThrough
from clerestory.photometry import EFFICACY

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from clerestory.annual.arrivals import Light
    from clerestory.annual.matrices import RoomMatrices
    from clerestory.bsdf import Bsdf
    from clerestory.picture import View

    Doubles = NDArray[np.float64]


class Preview:
    """Points of a room, and its windows in each of their states.

    What comes through a group of windows is found with all groups in the same state: only what they return to each
    other would be another.

    Parameters
    ----------
    matrices
        Of the room.
    states
        Data set of the windows in each state.
    points, normals
        (n, 3) [m], and (n, 3) of length 1.
    samples, returned
        Paths of a point, and of a patch of the windows into the room.
    """

    def __init__(
        self,
        matrices: RoomMatrices,
        states: Sequence[Bsdf],
        points: Doubles,
        normals: Doubles,
        *,
        samples: int,
        returned: int,
    ) -> None:
        self.points, self.normals = points, normals
        self._matrices = matrices
        groups, patches = len(matrices), len(matrices.basis)
        view = matrices.view(points, normals, samples=samples)
        back = [matrices.returned(g, samples=returned).all for g in range(groups)]
        self._parts = [slice(g * patches, (g + 1) * patches) for g in range(groups)]
        self._view, self._leaving, self._scattered, self._through = view, [], [], []
        for bsdf in states:
            transfer = Transfer.of(bsdf, matrices.basis)
            self._leaving.append(leaving([transfer] * groups, back))
            self._scattered.append(transfer.transmission - np.diag(transfer.beam))
            self._through.append(SunThrough(matrices, (bsdf,) * groups))

    def illuminance(self, light: Light) -> Doubles:
        """By all light through each group in each state (groups, states, points, steps) [lx]."""
        found, arrives = self._empty(light), light.arrives
        for group, part in enumerate(self._parts):
            for state, sent in enumerate(self._leaving):
                found[group, state] = self._view.all @ (sent[:, part] @ arrives[part])
        np.maximum(found, 0.0, out=found)
        found *= EFFICACY
        return found

    def direct(self, light: Light) -> Doubles:
        """By the sun through each group in each state, which has met nothing in the room; shape as above [lx]."""
        found = self._beams(light)
        found *= np.maximum(self.normals @ light.suns.T, 0.0)
        for group, part in enumerate(self._parts):
            for state, scattered in enumerate(self._scattered):
                found[group, state] += self._view.direct[:, part] @ (scattered @ light.directly[part])
        np.maximum(found, 0.0, out=found)
        found *= EFFICACY
        return found

    def discs(self, light: Light, eyes: Sequence[View], omega: float) -> Doubles:
        """L² ω / P² of the sun's disc of `omega` [sr] that each point, an eye, sees; shape as above [cd² sr/m⁴]."""
        luminance = EFFICACY * self._beams(light) / omega
        index = np.stack([_position_index(view, light.suns) for view in eyes])
        return luminance**2 * omega / index**2

    def _empty(self, light: Light) -> Doubles:
        return np.zeros((len(self._parts), len(self._through), len(self.points), light.steps))

    def _beams(self, light: Light) -> Doubles:
        """Irradiance of a plane that faces the sun, by what is seen of it; shape as above."""
        groups = range(len(self._parts))
        found = self._empty(light)
        up = np.flatnonzero(light.irradiance > 0.0)
        passed = np.array([through.beams(light.suns, light.irradiance) for through in self._through])
        if not passed.any():
            return found
        seen = self._matrices.outlooks(self.points, light.suns[up])
        for group in groups:
            for state, beams in enumerate(passed[:, group, up]):
                found[group, state][:, up] = np.where(seen == group, beams, 0.0)
        return found


def _position_index(view: View, suns: Doubles) -> Doubles:
    """Position index of suns (steps, 3); infinite behind the eye, where they are no source."""
    from clerestory.glare import rate

    found = np.full(len(suns), np.inf)
    before = np.flatnonzero(suns @ view.frame[2] > 0.0)
    # Only the places count.
    rated = rate([(suns[k], 1e9, 1e-5) for k in before], view, 1e4)
    if len(rated.sources) != len(before):
        raise _core.ClerestoryError("the sun before an eye was not rated (look along another direction)")
    found[before] = [source.position_index for source in rated.sources]
    return found
