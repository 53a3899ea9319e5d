"""Skies of all steps: sky matrices, and the suns themselves."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Literal

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.sky.patches import SkyPatches
from clerestory.sky.position import Method
from clerestory.sky.settings import PARTS, PRESETS, SOLAR_DIAMETER_DEG, Part, Preset, Quantity, default_dew_point
from clerestory.weather.calendar import spells
from clerestory.weather.inspect import TWILIGHT_DEG
from clerestory.weather.weather import sun_method

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import DTypeLike, NDArray

    from clerestory.weather.weather import Weather

_GREY = (1.0, 1.0, 1.0)


@dataclass(frozen=True)
class Suns:
    """The sun of every step (n), where it shines."""

    directions: NDArray[np.float64]
    """Unit vectors (n, 3) toward it, in the world of the building: x and y turned by `north_deg`, z up."""
    irradiance: NDArray[np.float64]
    """On a plane that faces it (n,) [W/m² of the skies' quantity]; 179 lx each for visible watts. 0 where it does not
    shine."""

    @property
    def radiance(self) -> NDArray[np.float64]:
        """Of its disc of 0.533° (n,) [W/(m² sr)]."""
        half = math.radians(SOLAR_DIAMETER_DEG / 2.0)
        return self.irradiance / (2.0 * math.pi * (1.0 - math.cos(half)))


@dataclass(frozen=True)
class SkyYear:
    """Perez's skies of all steps of weather, in patches.

    Radiances are W/(m² sr), of visible watts of 179 lm each, or of solar ones. Nights are black, and so are steps that
    `findings` of the weather name as left out.
    """

    weather: Weather
    """Its steps are the columns."""
    basis: str = "reinhart:4"
    """Patches: tregenza or reinhart:N, with the ground at 0."""
    preset: Preset = "clerestory"
    """Whose practice, see `Sky`; `radiance-matrix` is that of `gendaymtx`."""
    quantity: Quantity = "visible"
    """What the watts are."""
    ground_reflectance: float = 0.2
    """0 to 1."""
    north_deg: float = 0.0
    """Compass azimuth of the world's y axis, for a building that is turned."""
    method: Method | None = None
    """How the sun is found, see `SunPosition.at`; by default as the preset's programs find it."""

    def __post_init__(self) -> None:
        if self.preset not in PRESETS:
            raise ClerestoryError(f"a preset {self.preset!r} is not known (known: {', '.join(PRESETS)})")
        missing = np.flatnonzero(self.weather.is_missing)
        if len(missing):
            raise ClerestoryError(
                f"{self.weather.source}: direct or diffuse light is missing in daylight, "
                f"{spells(self.weather, missing)} (fill short gaps: --fill-hours N, or weather.filled(N))"
            )

    @cached_property
    def patches(self) -> SkyPatches:
        """Directions and solid angles of the rows."""
        return SkyPatches.named(self.basis)

    @property
    def is_lit(self) -> NDArray[np.bool_]:
        """Steps (n,) that have a sky."""
        altitude, _ = self._sun
        return (altitude >= -TWILIGHT_DEG) & (np.nan_to_num(self.weather.diffuse) > 0.0)

    @property
    def _sun(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        return self.weather.sun_positions(self.method or sun_method(self.preset))

    def columns(
        self,
        steps: slice | NDArray[np.int64] | None = None,
        *,
        part: Part = "all",
        sun: Literal["spread", "nearest"] = "spread",
        disc_deg: float = SOLAR_DIAMETER_DEG,
        value: Literal["mean", "centre"] | None = None,
        dtype: DTypeLike = np.float32,
    ) -> NDArray[np.floating]:
        """Radiance of ground and patches (patches, steps): a sky matrix, or some of its columns.

        Parameters
        ----------
        steps
            Which of the steps; all by default.
        part, sun, disc_deg, value
            As for `Sky.patches`: `part="sun", sun="nearest"` is the sun's matrix of the five-phase method.
        dtype
            Of the result; values are found with 32 bits.
        """
        if part not in PARTS:
            raise ClerestoryError(f"a part {part!r} is not known (known: {', '.join(PARTS)})")
        if value is None:
            value = "centre" if self.preset == "radiance-matrix" else "mean"
        numbers = np.arange(len(self.weather))[slice(None) if steps is None else steps]
        lit = numbers[self.is_lit[numbers]]
        made = np.zeros((len(numbers), len(self.patches)), dtype=dtype)
        if len(lit):
            disc = disc_deg if sun == "nearest" else None
            made[self.is_lit[numbers]] = self._lit(lit, part, disc, mean=value == "mean")
        return made.T

    def chunks(
        self,
        size: int = 256,
        *,
        part: Part = "all",
        sun: Literal["spread", "nearest"] = "spread",
        disc_deg: float = SOLAR_DIAMETER_DEG,
        value: Literal["mean", "centre"] | None = None,
        dtype: DTypeLike = np.float32,
    ) -> Iterator[tuple[slice, NDArray[np.floating]]]:
        """The columns of `size` steps after another, so that the whole matrix is never in memory.

        Parameters
        ----------
        size
            Steps at a time; the last may be fewer.
        part, sun, disc_deg, value, dtype
            As for `columns`.
        """
        if size < 1:
            raise ClerestoryError(f"chunks of {size} steps are not possible (give 1 or more)")
        for first in range(0, len(self.weather), size):
            steps = slice(first, min(first + size, len(self.weather)))
            yield steps, self.columns(steps, part=part, sun=sun, disc_deg=disc_deg, value=value, dtype=dtype)

    @cached_property
    def suns(self) -> Suns:
        """The sun of every step."""
        altitude, azimuth = (np.radians(angle) for angle in self._sun)
        azimuth = azimuth - math.radians(self.north_deg)
        directions = np.stack(
            [np.cos(altitude) * np.sin(azimuth), np.cos(altitude) * np.cos(azimuth), np.sin(altitude)], axis=-1
        )
        irradiance = np.zeros(len(self.weather))
        lit = np.flatnonzero(self.is_lit)
        if len(lit):
            # A disc of 0.533° in one patch has the sun's radiance; the core takes its solid angle as flat.
            found = self._lit(lit, "sun", SOLAR_DIAMETER_DEG, mean=False, patches=SkyPatches.named("tregenza"))
            irradiance[lit] = found.max(axis=1) * (math.pi * math.radians(SOLAR_DIAMETER_DEG / 2.0) ** 2)
        return Suns(directions, irradiance)

    def _lit(
        self, steps: NDArray[np.int64], part: Part, disc: float | None, *, mean: bool, patches: SkyPatches | None = None
    ) -> NDArray[np.float32]:
        """Columns (steps, patches) of steps that have a sky."""
        weather = self.weather
        altitude, azimuth = self._sun
        dew = np.full(len(weather), default_dew_point(self.preset))
        if weather.dew_point is not None and self.preset != "radiance-matrix":
            dew = np.where(np.isfinite(weather.dew_point), weather.dew_point, dew)
        moments = np.stack([altitude, azimuth - self.north_deg, weather.days_of_year, dew], axis=-1)[steps]
        light = np.stack([weather.direct, weather.diffuse], axis=-1)[steps]
        choices = (self.preset, self.quantity, _GREY, float(self.ground_reflectance))
        kind = "illuminance" if weather.illuminances else "irradiance"
        core = (patches or self.patches)._core
        try:
            return core.columns(np.ascontiguousarray(moments), kind, light, choices, part, disc, mean)
        except ClerestoryError as error:
            text = re.sub(
                r"^step (\d+)", lambda found: f"step of {weather.words(int(steps[int(found[1])]))}", str(error)
            )
            raise ClerestoryError(text) from error
