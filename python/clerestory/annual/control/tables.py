"""Control laws as tables of a study: their keys, and how each chooses the states of a room's windows."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import BeforeValidator, Field, model_validator

from clerestory._core import ClerestoryError
from clerestory.annual.control import cut_off, glare, schedule
from clerestory.annual.control.checks import complete, known, known_sensors
from clerestory.annual.control.conditions import Rules
from clerestory.annual.control.hysteresis import levels
from clerestory.annual.control.slats import Slats
from clerestory.counts import counted
from clerestory.files import named
from clerestory.trace.keys import Keys, NotNegative, Number, Positive, RecipeError, wrong
from clerestory.trace.reading import reading

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from clerestory.annual.control.stage import Stage

    States = NDArray[np.int64]

_DAYS = ("mon", "tue", "wed", "thu", "fri", "sat", "sun")
Day = Literal["mon", "tue", "wed", "thu", "fri", "sat", "sun"]
Month = Annotated[int, Field(ge=1, le=12)]
Hour = Annotated[Number, Field(ge=0.0, le=24.0)]


def _several(value: object) -> object:
    return value if isinstance(value, list) else [value]


Limits = Annotated[list[Positive], BeforeValidator(_several)]
"""One limit or several that rise, one for each state but the first."""


class Times(Keys):
    """Hours with one state."""

    state: str | None = None
    """The state; or give tilt_deg."""
    tilt_deg: Number | None = None
    """The state whose slats are nearest to this angle [°]."""
    start: Hour = 0.0
    """Hour of the day at which they begin."""
    end: Hour = 24.0
    """Hour of the day at which they end; before `start` they go on past midnight."""
    weekdays: list[Day] = Field(default_factory=list)
    """Days: mon, tue, wed, thu, fri, sat, sun; all by default."""
    months: list[Month] = Field(default_factory=list)
    """Months, 1 to 12; all by default."""
    groups: list[str] = Field(default_factory=list)
    """Groups of windows; all by default."""

    @model_validator(mode="after")
    def _sound(self) -> Times:
        if (self.state is None) == (self.tilt_deg is None):
            raise wrong("state", "either a state or tilt_deg is asked for (give one of them)")
        if self.start == self.end:
            raise wrong("end", f"the hours end at {self.end:g}, where they start (give another, or neither)")
        return self


class Schedule(Keys):
    """States by the clock, or step by step from a file."""

    kind: Literal["schedule"]
    file: str | None = None
    """CSV or Parquet file with a row a step of the weather, and a column `all` or one a group; or give times."""
    times: list[Times] = Field(default_factory=list)
    """Hours and their states; the first that a step lies in counts."""

    @model_validator(mode="after")
    def _one(self) -> Schedule:
        if (self.file is None) != bool(self.times):
            raise wrong("file", "either a file or times are asked for (give one of them)")
        return self

    def check(self, stage: Stage, key: str) -> None:
        """Fail if it does not go with the room, its windows or the weather."""
        for k, times in enumerate(self.times):
            place = f"{key}.times[{k + 1}]"
            self._state(times, stage, place)
            for group in times.groups:
                known(group, stage.groups, f"{place}.groups", "group of windows")
        self.chosen(stage, key)

    def chosen(self, stage: Stage, key: str) -> States:
        """States (groups, steps)."""
        if self.file is None:
            spans = [
                schedule.Span(
                    self._state(t, stage, f"{key}.times[{k + 1}]"),
                    t.start,
                    t.end,
                    tuple(_DAYS.index(day) for day in t.weekdays),
                    tuple(t.months),
                    tuple(stage.groups.index(group) for group in t.groups),
                )
                for k, t in enumerate(self.times)
            ]
            found = schedule.from_spans(spans, stage.times, len(stage.groups))
            return complete(found, stage, f"{key}.times", "add one without hours as the last")
        path = stage.folder / self.file
        with reading(f"{key}.file"), named(path):
            return schedule.read(path, stage.weather, stage.states, stage.groups, tilts_deg=stage.tilts_deg)

    @staticmethod
    def _state(times: Times, stage: Stage, place: str) -> int:
        """Number of a state, by its name or its tilt."""
        if times.tilt_deg is None:
            name = times.state or ""
            known(name, stage.states, f"{place}.state", "state")
            return stage.states.index(name)
        try:
            return cut_off.nearest_state(times.tilt_deg, stage.tilts_deg)
        except ClerestoryError as error:
            raise RecipeError(f"{place}.tilt_deg: {error}") from None


class CutOff(Keys):
    """Slats no more closed than keeps the direct sun out; states have `tilt_deg`."""

    kind: Literal["cut-off"]
    width_mm: Positive
    """Of a slat, from edge to edge [mm]."""
    pitch_mm: Positive
    """Distance from slat to slat [mm]."""
    crown_mm: Number = 0.0
    """Height of a slat's middle over its edges [mm]."""
    rest: str | None = None
    """State without direct sun on the façade, and below `irradiance_w_m2`; the first by default."""
    irradiance_w_m2: NotNegative = 150.0
    """Irradiance of the façade from which the blind is in use [W/m²]."""
    hysteresis_w_m2: NotNegative = 50.0
    """It stays in use until the irradiance is less by this [W/m²]."""
    safety_deg: NotNegative = 3.0
    """Added to the tilt that just keeps the sun out [°]."""
    step_deg: NotNegative = 0.0
    """Of the drive [°]: tilts are asked for in multiples of it; any by default."""
    hysteresis_deg: NotNegative = 0.0
    """Slats open to a tilt only if it would do with so much more [°]."""

    def check(self, stage: Stage, key: str) -> None:
        """Fail if it does not go with the room, its windows or the weather."""
        try:
            self._slats()
        except ClerestoryError as error:
            raise RecipeError(f"{key}.crown_mm: {error}") from None
        if self.rest is not None:
            known(self.rest, stage.states, f"{key}.rest", "state")
        where = key.removesuffix(".control")
        tilted = self._tilted(stage)
        for name, tilt in zip(stage.states, stage.tilts_deg, strict=True):
            if tilt is None and name != self._rest(stage):
                raise RecipeError(f"{where}.states.{name}.tilt_deg: is missing, and cut-off asks for it (add it)")
        if not tilted:
            raise RecipeError(f"{where}.states: none has tilt_deg, and cut-off asks for them (add them)")
        if len({tilt for tilt, _ in tilted}) < len(tilted):
            raise RecipeError(f"{where}.states: two have the same tilt_deg (give each its own)")

    def chosen(self, stage: Stage, key: str) -> States:
        """States (groups, steps)."""
        del key
        slats, tilted, rest = self._slats(), self._tilted(stage), stage.states.index(self._rest(stage))
        tilts, numbers = [tilt for tilt, _ in tilted], np.array([number for _, number in tilted])
        seen = stage.outdoors
        found = []
        for profile, irradiance, direct in zip(seen.profile, seen.irradiance, seen.direct, strict=True):
            start = max(self.irradiance_w_m2, 1e-9)
            bright = levels(irradiance, [start], seen.interval, hysteresis=min(self.hysteresis_w_m2, 0.999 * start))
            in_use = (bright > 0) & (direct > 0.0)
            needed = cut_off.needed_tilt_deg(
                slats,
                np.where(in_use, profile, np.nan),
                safety_deg=self.safety_deg,
                step_deg=self.step_deg,
                least_deg=tilts[0],
            )
            chosen = numbers[cut_off.tilt_states(needed, tilts, hysteresis_deg=self.hysteresis_deg)]
            found.append(np.where(in_use, chosen, rest))
        return np.stack(found)

    def _slats(self) -> Slats:
        return Slats(self.width_mm, self.pitch_mm, self.crown_mm)

    def _rest(self, stage: Stage) -> str:
        return self.rest or stage.states[0]

    def _tilted(self, stage: Stage) -> list[tuple[float, int]]:
        """Tilts and numbers of the states that have one, from open to closed."""
        return sorted((tilt, k) for k, tilt in enumerate(stage.tilts_deg) if tilt is not None)


class Threshold(Keys):
    """A state for each limit that the light has reached."""

    kind: Literal["threshold"]
    irradiance_w_m2: Limits | None = None
    """Irradiance of the façade from which the second state is taken, and the third, and so on [W/m²]."""
    illuminance_lx: Limits | None = None
    """The same by the illuminance at sensors, with all windows in their first state [lx]."""
    sensors: str | None = None
    """Name of these sensors."""
    reading: Literal["mean", "least", "highest"] = "mean"
    """Of the sensors."""
    hysteresis: NotNegative = 0.0
    """A state is left when the light falls below its limit less this [W/m² or lx]."""
    close_after_min: NotNegative = 0.0
    """For so long the light has asked for a more closed state in the steps before [min]."""
    open_after_min: NotNegative = 0.0
    """For so long the light has asked for a more open state in the steps before [min]."""

    @model_validator(mode="after")
    def _sound(self) -> Threshold:
        if (self.irradiance_w_m2 is None) == (self.illuminance_lx is None):
            raise wrong("irradiance_w_m2", "either irradiance_w_m2 or illuminance_lx is asked for (give one of them)")
        if (self.illuminance_lx is None) != (self.sensors is None):
            raise wrong("sensors", "sensors go with illuminance_lx (give both, or neither)")
        name = "irradiance_w_m2" if self.illuminance_lx is None else "illuminance_lx"
        limits = self._limits()
        if any(low >= high for low, high in pairwise(limits)):
            raise wrong(name, "limits rise (give the lowest first)")
        if self.hysteresis >= limits[0]:
            raise wrong("hysteresis", f"{self.hysteresis:g} reaches below 0 (give less than {limits[0]:g})")
        return self

    def check(self, stage: Stage, key: str) -> None:
        """Fail if it does not go with the room, its windows or the weather."""
        name = "irradiance_w_m2" if self.illuminance_lx is None else "illuminance_lx"
        limits, states = self._limits(), len(stage.states)
        if len(limits) != states - 1:
            raise RecipeError(
                f"{key}.{name}: {counted(len(limits), 'limit')} for {counted(states, 'state')} "
                f"(give {states - 1}, one for each state but the first)"
            )
        if self.sensors is not None:
            known_sensors([self.sensors], stage, f"{key}.sensors")

    def chosen(self, stage: Stage, key: str) -> States:
        """States (groups, steps)."""
        del key
        if self.sensors is None:
            values = stage.outdoors.irradiance
        else:
            reading = stage.readings([self.sensors])[self.reading, self.sensors][0]
            values = np.broadcast_to(reading, (len(stage.groups), len(reading)))
        return np.stack(
            [
                levels(
                    series,
                    self._limits(),
                    stage.weather.interval,
                    hysteresis=self.hysteresis,
                    close_after=self.close_after_min / 60.0,
                    open_after=self.open_after_min / 60.0,
                )
                for series in values
            ]
        )

    def _limits(self) -> list[float]:
        return self.irradiance_w_m2 or self.illuminance_lx or []


class Glare(Keys):
    """As open as the glare of views allows, by a cheap criterion."""

    kind: Literal["glare"]
    views: list[str] = Field(default_factory=list)
    """Names of views; all of the room's by default."""
    limit: Annotated[Number, Field(gt=0.184, lt=1.0)] = 0.40
    """Of DGP; DGPs is 0.184 in the dark."""
    hysteresis: NotNegative = 0.0
    """Windows open again only if the glare stays below the limit less this."""

    @model_validator(mode="after")
    def _sound(self) -> Glare:
        if self.limit - self.hysteresis <= 0.184:
            raise wrong(
                "hysteresis", f"no glare is below {self.limit - self.hysteresis:g}: it is 0.184 in the dark (lower it)"
            )
        return self

    def check(self, stage: Stage, key: str) -> None:
        """Fail if it does not go with the room, its windows or the weather."""
        for name in self._views(stage):
            try:
                stage.room.view(name)
            except RecipeError as error:
                raise RecipeError(f"{key}.views: {error}") from None
        if not self._views(stage):
            raise RecipeError(f"{key}.views: the room has no views (add some to its recipe)")

    def chosen(self, stage: Stage, key: str) -> States:
        """States (groups, steps)."""
        del key
        return glare.most_open(*stage.at_eyes(self._views(stage)), self.limit, hysteresis=self.hysteresis)

    def _views(self, stage: Stage) -> list[str]:
        return self.views or list(stage.room.recipe.views)


class Lm83(Keys):
    """LM-83's blinds: a group is closed while more than 2 % of the points get 1000 lx or more of direct sun by it."""

    kind: Literal["lm-83"]
    sensors: list[str] = Field(default_factory=list)
    """Names of sensors; all of the room's by default."""

    def check(self, stage: Stage, key: str) -> None:
        """Fail if it does not go with the room, its windows or the weather."""
        known_sensors(self.sensors, stage, f"{key}.sensors")
        if not self.names(stage):
            raise RecipeError(f"{key}.sensors: the room has no sensors (add some to its recipe)")

    def chosen(self, stage: Stage, key: str) -> States:
        """States (groups, steps)."""
        del key
        grids = [stage.room.sensors(name) for name in self.names(stage)]
        return stage.by_lm83(np.concatenate([g[0] for g in grids]), np.concatenate([g[1] for g in grids]))

    def names(self, stage: Stage) -> list[str]:
        """Names of the sensors."""
        return self.sensors or list(stage.room.recipe.sensors)


Control = Annotated[
    Schedule | CutOff | Threshold | Glare | Lm83 | Rules,
    Field(discriminator="kind"),
]
"""A law by its kind."""
