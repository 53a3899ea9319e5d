"""What stands before a façade, as a matrix of its own: the six-phase method.

I = V T F D s (Wang, Ward and Lee 2018, Energy and Buildings 174): F takes light from the ports, openings before the
façade, to the windows through whatever stands between, and D takes it from the sky to the ports. So another awning or
screen before the façade asks for F alone. Light that reaches the windows beside the ports is added to it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory import _core
from clerestory.annual.cache import digest
from clerestory.annual.matrices import Matrix, RoomMatrices, group_of, photopic
from clerestory.trace.keys import RecipeError

if TYPE_CHECKING:
    from clerestory.sky import SkyPatches


class Facade:
    """The façade of a room with ports.

    Parameters
    ----------
    matrices
        Of the room.

    Raises
    ------
    RecipeError
        The room has no ports.
    """

    def __init__(self, matrices: RoomMatrices) -> None:
        room = matrices.room
        if not room.ports:
            raise RecipeError("ports: the six-phase method needs openings before the façade (add [ports.NAME])")
        self.matrices = matrices
        keys = [group_of(port) for port in room.ports]
        names = list(dict.fromkeys(keys))
        self._ports = [len(matrices) + k for k in range(len(names))]
        of_window = matrices.of_window + [len(matrices) + names.index(key) for key in keys]
        far = room.without_facade()
        corners = [port.corners.tolist() for port in room.ports]
        self._near = _core.WindowGroups(room.bare(ports=True), of_window, matrices.basis._core)
        self._far = _core.WindowGroups(far.bare(ports=True), of_window, matrices.basis._core)
        self.key: dict[str, object] = matrices.key | {"ports": corners}
        """What the matrices of the façade depend on."""
        # What stands before the façade does not matter to the ports.
        self._far_key = self.key | {"room": digest(*far.described())}

    def daylight(self, group: int, patches: SkyPatches, *, samples: int = 4096) -> Matrix:
        """As `RoomMatrices.daylight`, through the ports."""
        seed, cache = self.matrices.seed, self.matrices.cache
        how: dict[str, object] = {"group": group, "samples": samples, "basis": self.matrices.basis.name}
        through = Matrix(
            **cache.get("facade", self.key | how, lambda: photopic(self._near.facade_matrix(group, samples, seed)))
        )
        beside = Matrix(
            **cache.get(
                "beside",
                self.key | how | {"patches": patches.name},
                lambda: photopic(self._near.daylight_matrix(group, patches._core, samples, seed)),
            )
        )
        size = len(self.matrices.basis)
        every, direct = beside.all.astype(np.float64), beside.direct.astype(np.float64)
        variance = beside.standard_error.astype(np.float64) ** 2
        for port in self._ports:
            before = self._before(port, patches, samples)
            columns = slice(port * size, (port + 1) * size)
            every += through.all[:, columns] @ before.all
            direct += through.direct[:, columns] @ before.direct
            variance += through.standard_error[:, columns] ** 2 @ before.all**2
            variance += through.all[:, columns] ** 2 @ before.standard_error**2
        return Matrix(*(part.astype(np.float32) for part in (every, direct, np.sqrt(variance))))

    def _before(self, port: int, patches: SkyPatches, samples: int) -> Matrix:
        """From the sky to a group of ports."""
        how: dict[str, object] = {"group": port, "samples": samples, "patches": patches.name}
        key = self._far_key | how | {"basis": self.matrices.basis.name}
        seed = self.matrices.seed
        return Matrix(
            **self.matrices.cache.get(
                "before", key, lambda: photopic(self._far.daylight_matrix(port, patches._core, samples, seed))
            )
        )
