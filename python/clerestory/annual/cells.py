"""The windows as points see them, at a finer resolution than that of the patches.

Directions, such as cells of the square of a group's directions, have the sky's light through the system, by the
patches that it arrives in, and the sun's at the data set's own resolution. Beams show the sky itself.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory import _core
from clerestory.annual.phases import probes
from clerestory.annual.sun import Outgoing, SunThrough

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from clerestory.annual.arrivals import Light
    from clerestory.annual.matrices import RoomMatrices
    from clerestory.basis import Basis
    from clerestory.bsdf import Bsdf

    Doubles = NDArray[np.float64]
    Floats = NDArray[np.float32]

_INCIDENT, _OUTGOING = 64, 128
"""Steps along each axis of the squares on which the sky's light is summed, and found."""


@dataclass(frozen=True)
class SkyThrough:
    """The sky's light through the windows, by directions."""

    patch: NDArray[np.int64]
    """(directions) patch of all groups that each lies in."""
    cell: NDArray[np.int64]
    """(directions) cell of the square that each lies in, of those in `scattered`."""
    scattered: Floats
    """(cells, groups · patches) radiance by that of the incident patches; without beams."""
    beam: Floats
    """(directions) transmittance of what goes straight on."""
    behind: NDArray[np.int64]
    """(directions) patch of the sky behind the window."""
    free: NDArray[np.bool_]
    """(directions) whether nothing but sky and ground is before the group's windows."""

    @classmethod
    def of(cls, through: SunThrough, outgoing: Outgoing, sky: _core.SkyPatches) -> SkyThrough:
        """Of directions that some eye sees."""
        matrices, count = through.matrices, len(outgoing.group)
        basis, patches = matrices.basis, len(matrices.basis)
        disk = np.ascontiguousarray(outgoing.direction[:, :2])
        patch = basis._core.patch_of(disk) + outgoing.group * patches
        numbers = _core.square_cells(disk, _OUTGOING) + outgoing.group * _OUTGOING**2
        numbers, cell = np.unique(numbers, return_inverse=True)
        cells = Outgoing.of_cells(numbers, _OUTGOING)
        scattered = np.zeros((len(numbers), len(through.systems) * patches), dtype=np.float32)
        beam = np.zeros(count, dtype=np.float32)
        behind = np.zeros(count, dtype=np.int64)
        free = np.zeros(count, dtype=bool)
        for number, bsdf in enumerate(through.systems):
            here = np.flatnonzero(outgoing.group == number)
            if not len(here):
                continue
            columns = slice(number * patches, (number + 1) * patches)
            of_group = np.flatnonzero(cells.group == number)
            directions = cells.direction[of_group]
            scattered[of_group, columns] = _scattered(bsdf, through.band, basis, directions)
            world = -outgoing.direction[here] @ matrices.frame(number)
            beam[here] = through.passed(number, world)
            behind[here] = sky.patch_of(np.ascontiguousarray(world))
            free[here] = not len(matrices.outside_of(number))
        return cls(patch, cell, scattered, beam, behind, free)

    def radiance(self, arrives: Floats, sky: Floats) -> Floats:
        """Radiance (directions, steps).

        Parameters
        ----------
        arrives
            Radiance (groups · patches, steps) from outside, without what comes from the sun directly.
        sky
            Radiance (patches of the sky, steps), without the sun.
        """
        seen = np.where(self.free[:, None], sky[self.behind], arrives[self.patch])
        return np.asarray((self.scattered @ arrives)[self.cell] + self.beam[:, None] * seen)


def _scattered(bsdf: Bsdf, band: str | None, basis: Basis, outgoing: Doubles) -> Floats:
    """Radiance (directions, patches) by that of incident patches, each probed at the cells of a square."""
    incident, patch = probes(basis, _INCIDENT)
    # Each point stands for an equal part of its patch.
    area = basis.projected_solid_angles[patch] / np.bincount(patch, minlength=len(basis))[patch]
    return bsdf._core.gather(-incident, area, patch, len(basis), np.ascontiguousarray(outgoing), band, "transmission")


@dataclass(frozen=True)
class CellLight:
    """What the cells of windows send at some steps, and the sun straight through them."""

    sky: Floats
    """(cells, steps) radiance by sky and ground."""
    sun: Floats
    """(cells, steps) radiance by the sun, without its disc."""
    beams: Doubles
    """(groups, steps) on a plane that faces the sun, of what goes straight through windows."""
    straight: Doubles
    """(points, steps) of that, what is seen through windows."""


class SeenCells:
    """Cells of the windows' directions that points see; the same for all data sets.

    Parameters
    ----------
    matrices
        Of the room.
    points, normals
        (n, 3) [m], and (n, 3) of length 1.
    steps
        Cells along each axis of the square.
    """

    def __init__(self, matrices: RoomMatrices, points: Doubles, normals: Doubles, steps: int) -> None:
        from scipy.sparse import csr_array

        seen = matrices.apertures(points, normals, steps)
        self.matrices = matrices
        self.points, self.normals = points, normals
        self.numbers, columns = np.unique(seen.number, return_inverse=True)
        """Of the cells that any point sees."""
        self.outgoing = Outgoing.of_cells(self.numbers, steps)
        """Their directions."""
        self.weights = csr_array((seen.projected, columns, seen.first), shape=(len(points), len(self.numbers)))
        """(points, cells) projected solid angle that each is seen under [sr]."""


class SeenWindows:
    """What points see of the windows' cells with one choice of systems.

    Parameters
    ----------
    cells
        What the points see.
    systems
        Data set of each group.
    sky
        Patches of the sky.
    """

    def __init__(self, cells: SeenCells, systems: Sequence[Bsdf], sky: _core.SkyPatches) -> None:
        self.cells = cells
        self.through = SunThrough(cells.matrices, tuple(systems))
        self.sky = SkyThrough.of(self.through, cells.outgoing, sky)

    def from_cells(self, radiance: Floats | Doubles) -> Doubles:
        """Irradiance (points, steps) by the radiance of cells (cells, steps)."""
        return np.asarray(self.cells.weights @ radiance, dtype=np.float64)

    def light(self, light: Light) -> CellLight:
        """What the cells and the sun send at some steps."""
        beams = self.through.beams(light.suns, light.irradiance)
        return CellLight(
            self.sky.radiance(light.diffuse, light.sky),
            self.through.radiance(self.cells.outgoing, light.suns, light.irradiance),
            beams,
            self.through.through(self.cells.points, light.suns, light.irradiance, beams),
        )

    def irradiance_of_sun(self, light: Light, cells: CellLight) -> Doubles:
        """Irradiance (points, steps) that the sun gives directly through the windows."""
        return self.from_cells(cells.sun) + cells.straight * np.maximum(self.cells.normals @ light.suns.T, 0.0)
