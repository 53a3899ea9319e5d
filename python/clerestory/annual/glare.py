"""Glare of an eye over a year without pictures.

What an eye sees of the windows are cells of the square of their directions, at the resolution that is asked for. Each
hour a cell has the sky's light through the system, the sun's at the data set's own resolution, and what the room
returns; the sun that is seen through a beam is a source of its own, with its true luminance and size, and what it
lights in the room can be a source. The illuminance at the eye is that of the five-phase method; other surfaces of the
room count in it, and are no sources.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory import _core
from clerestory.picture import View
from clerestory.sky.model import SOLAR_DIAMETER_DEG

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from clerestory.annual.sun import Eye, SunSeen, SunThrough
    from clerestory.bsdf import Bsdf
    from clerestory.glare import Settings

    Doubles = NDArray[np.float64]
    Floats = NDArray[np.float32]

SOLAR_SOLID_ANGLE = 2.0 * math.pi * (1.0 - math.cos(math.radians(SOLAR_DIAMETER_DEG / 2.0)))
"""Of the sun's disc [sr]."""
_INCIDENT = 64
"""Steps along each axis of the square on which incident light is summed."""


@dataclass(frozen=True)
class SkyThrough:
    """The sky's light through the cells of the windows' directions."""

    numbers: NDArray[np.int64]
    """(cells) group · steps² + cell."""
    patch: NDArray[np.int64]
    """(cells) patch of all groups that each lies in."""
    scattered: Floats
    """(cells, groups · patches) radiance of a cell by that of the incident patches; without beams."""
    beam: Floats
    """(cells) transmittance of what goes straight on."""
    behind: NDArray[np.int64]
    """(cells) patch of the sky behind a cell."""
    free: NDArray[np.bool_]
    """(cells) whether nothing but sky and ground is before the group's windows."""

    @classmethod
    def of(cls, through: SunThrough, numbers: NDArray[np.int64], sky: _core.SkyPatches) -> SkyThrough:
        """Of cells that some eye sees."""
        matrices, steps = through.matrices, through.steps
        basis, patches = matrices.basis, len(matrices.basis)
        outgoing = _core.square_directions(steps)[numbers % steps**2]
        group = numbers // steps**2
        patch = basis._core.patch_of(np.ascontiguousarray(outgoing[:, :2])) + group * patches
        scattered = np.zeros((len(numbers), len(through.systems) * patches), dtype=np.float32)
        beam = np.zeros(len(numbers), dtype=np.float32)
        behind = np.zeros(len(numbers), dtype=np.int64)
        free = np.zeros(len(numbers), dtype=bool)
        for number, bsdf in enumerate(through.systems):
            here = np.flatnonzero(group == number)
            if not len(here):
                continue
            columns = slice(number * patches, (number + 1) * patches)
            scattered[here, columns] = _scattered(bsdf, through.band, basis._core, outgoing[here])
            world = -outgoing[here] @ matrices.frame(number)
            beam[here] = through.beams(number, world)
            behind[here] = sky.patch_of(np.ascontiguousarray(world))
            free[here] = not len(matrices.outside_of(number))
        return cls(numbers, patch, scattered, beam, behind, free)

    def radiance(self, arrives: Floats, arrives_directly: Floats, sky: Floats) -> Floats:
        """Radiance (cells, steps).

        Parameters
        ----------
        arrives, arrives_directly
            Radiance (groups · patches, steps) from outside, and that which has met nothing.
        sky
            Radiance (patches of the sky, steps).
        """
        seen = np.where(self.free[:, None], sky[self.behind], arrives_directly[self.patch])
        return np.asarray(self.scattered @ arrives + self.beam[:, None] * seen)


def _scattered(bsdf: Bsdf, band: str | None, basis: _core.Basis, outgoing: Doubles) -> Floats:
    """Radiance of cells (cells, patches) by that of incident patches, each probed at the cells of a square."""
    incident = _core.square_directions(_INCIDENT)
    patch = basis.patch_of(np.ascontiguousarray(incident[:, :2]))
    # Each point stands for an equal part of its patch.
    area = np.asarray(basis.projected_solid_angles())[patch] / np.bincount(patch, minlength=len(basis))[patch]
    found = np.zeros((len(outgoing), len(basis)), dtype=np.float32)
    order = np.argsort(patch, kind="stable")
    first = np.searchsorted(patch[order], np.arange(len(basis)))
    for start in range(0, len(outgoing), 256):
        part = slice(start, start + 256)
        values = bsdf.evaluate(-incident[order][None, :, :], outgoing[part, None, :], band)
        found[part] = np.add.reduceat(np.maximum(values, 0.0) * area[order], first, axis=1)
    return found


def rate(
    eye: Eye,
    numbers: NDArray[np.int64],
    luminances: Floats,
    sun: SunSeen,
    illuminance: Doubles,
    settings: Settings,
) -> dict[str, Doubles]:
    """Indices (steps) by name; not a number where it is dark.

    Parameters
    ----------
    eye
        Who sees.
    numbers, luminances
        Of cells, and their luminances (cells, steps) [cd/m²].
    sun
        What the eye sees of the sun [lx, cd/m²].
    illuminance
        At the eye (steps) [lx].
    settings
        Of the evaluation.
    """
    seen = luminances[np.searchsorted(numbers, eye.seen.number)]
    in_windows = eye.seen.projected @ seen + sun.straight * np.maximum(sun.directions @ eye.direction[0], 0.0)
    around = np.maximum(illuminance - in_windows, 0.0) / np.pi
    # A sunlit surface has the room's light besides the sun's.
    surfaces = np.where(sun.surfaces > 0.0, sun.surfaces + around, 0.0)
    view = View.fisheye(eye.point[0], eye.direction[0])
    disc = np.full(len(illuminance), SOLAR_SOLID_ANGLE)
    return dict(
        _core.rate_glare_hours(
            view._core,
            np.concatenate([eye.seen.direction.astype(np.float64), eye.directions]),
            np.concatenate([eye.seen.solid_angle.astype(np.float64), eye.solid_angles]),
            np.ascontiguousarray(np.concatenate([seen, surfaces]).T, dtype=np.float32),
            np.column_stack([sun.directions, sun.straight / SOLAR_SOLID_ANGLE, disc]),
            np.ascontiguousarray(illuminance),
            settings,
        )
    )
