"""What arrives at the windows from outside, step by step; the same for all data sets."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Literal

import numpy as np

from clerestory.annual.cache import digest

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from clerestory.annual.facade import Facade
    from clerestory.annual.matrices import RoomMatrices
    from clerestory.weather import SkyYear

    Doubles = NDArray[np.float64]
    Floats = NDArray[np.float32]


@dataclass(frozen=True)
class Light:
    """What comes from outside at some steps."""

    sky: Floats
    """(patches of the sky, steps) radiance without the sun."""
    sun: Floats
    """(patches of the sky, steps) the sun's, spread over the patches next to it."""
    diffuse: Floats
    """(groups · patches, steps) radiance that arrives at windows, but for the sun's that has met nothing."""
    directly: Floats
    """(groups · patches, steps) the sun's that has met nothing, spread over patches."""
    suns: Doubles
    """(steps, 3) toward the sun."""
    irradiance: Doubles
    """(steps) of a plane that faces it."""

    def part(self, steps: slice | NDArray[np.bool_]) -> Light:
        """Some of the steps."""
        sky, sun, diffuse, directly = (a[:, steps] for a in (self.sky, self.sun, self.diffuse, self.directly))
        return Light(sky, sun, diffuse, directly, self.suns[steps], self.irradiance[steps])

    @property
    def steps(self) -> int:
        """How many."""
        return len(self.irradiance)

    @property
    def arrives(self) -> Floats:
        """(groups · patches, steps) all that arrives at windows."""
        return self.diffuse + self.directly

    def only(self, steps: NDArray[np.bool_]) -> Light:
        """With the sun at some of its steps (n) alone, for those who want to know no others.

        The arrays keep their shapes: products of matrices have other last digits for fewer columns.
        """
        return replace(self, irradiance=np.where(steps, self.irradiance, 0.0))

    @property
    def size(self) -> int:
        """In memory [B]."""
        return sum(a.nbytes for a in (self.sky, self.sun, self.diffuse, self.directly, self.suns, self.irradiance))


class Arrivals:
    """The light of a year's steps at the windows of a room.

    Parameters
    ----------
    matrices
        Of the room.
    sky
        The skies.
    samples
        Paths of a patch of the windows.
    value
        Whether patches of the sky have its mean, or the value at their centre, which is quicker.
    facade
        Through which daylight comes to the windows, for the six-phase method.
    keep
        Light that is kept for the next who asks [B].
    """

    def __init__(
        self,
        matrices: RoomMatrices,
        sky: SkyYear,
        *,
        samples: int = 4096,
        value: Literal["mean", "centre"] = "mean",
        facade: Facade | None = None,
        keep: int = 1 << 28,
    ) -> None:
        self.matrices = matrices
        self.sky = sky
        self.samples = samples
        self.value: Literal["mean", "centre"] = value
        self._facade = facade
        self._keep = keep
        self._kept: OrderedDict[tuple[int, int], Light] = OrderedDict()

    def __len__(self) -> int:
        """Number of steps."""
        return len(self.sky.weather)

    @property
    def key(self) -> dict[str, object]:
        """What they depend on beside the room."""
        sky, weather = self.sky, self.sky.weather
        dew = np.zeros(0) if weather.dew_point is None else weather.dew_point
        years = np.zeros(0) if weather.years is None else weather.years
        series = (weather.times.astype(np.int64), weather.interval, weather.direct, weather.diffuse, dew, years)
        where = [weather.place.latitude, weather.place.longitude, weather.time_zone, weather.illuminances]
        choices = [sky.basis, sky.preset, sky.quantity, sky.ground_reflectance, sky.north_deg, sky.method, self.value]
        facade = None if self._facade is None else self._facade.key
        return {"sky": digest(*series, where, choices), "daylight": self.samples, "facade": facade}

    def chunks(self, size: int) -> list[slice]:
        """All steps, so many at a time."""
        return [slice(first, min(first + size, len(self))) for first in range(0, len(self), size)]

    def at(self, steps: slice) -> Light:
        """The light of those of some steps that have a sky."""
        key = (steps.start, steps.stop)
        if key not in self._kept:
            self._kept[key] = self._found(steps)
            while len(self._kept) > 1 and sum(light.size for light in self._kept.values()) > self._keep:
                self._kept.popitem(last=False)
        self._kept.move_to_end(key)
        return self._kept[key]

    @cached_property
    def matrix(self) -> tuple[Floats, Floats]:
        """Radiance at groups' patches by the sky's (groups · patches, patches of the sky): all, and the direct."""
        groups = range(len(self.matrices))
        source = self.matrices if self._facade is None else self._facade
        found = [source.daylight(g, self.sky.patches, samples=self.samples) for g in groups]
        every: Floats = np.concatenate([d.all for d in found])
        return every, np.concatenate([d.direct for d in found])

    def _found(self, steps: slice) -> Light:
        every, direct = self.matrix
        lit = np.flatnonzero(self.sky.is_lit[steps])
        sky = np.asarray(self.sky.columns(steps, part="sky", value=self.value), dtype=np.float32)[:, lit]
        sun = np.asarray(self.sky.columns(steps, part="sun"), dtype=np.float32)[:, lit]
        return Light(
            sky=sky,
            sun=sun,
            diffuse=np.asarray(every @ sky + (every - direct) @ sun, dtype=np.float32),
            directly=direct @ sun,
            suns=self.sky.suns.directions[steps][lit],
            irradiance=self.sky.suns.irradiance[steps][lit],
        )
