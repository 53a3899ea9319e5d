"""Weather: light of sun and sky by step, with the sun that belongs to it."""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from clerestory import _core
from clerestory._core import ClerestoryError
from clerestory.sky.model import Sky
from clerestory.sky.position import METHODS, Method, Place, SunPosition, days_of_year, spa
from clerestory.weather import inspect
from clerestory.weather.calendar import nominal, stamp
from clerestory.weather.gaps import filled

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from clerestory.finding import Finding

    Times = NDArray[np.datetime64]

_DAYS = (31, 29, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31)


@dataclass(frozen=True, eq=False)
class Weather:
    """Weather of a year, or of any set of steps (n of them). It does not change."""

    place: Place
    """Where; its clock is standard time, in hours ahead of UTC."""
    times: Times
    """Middle of each interval (n,), local standard time. Files of typical years are put together from several: they are
    laid into 2001, or into 2000 if they have a 29 February."""
    interval: NDArray[np.float64]
    """Length of each interval (n,) [h]."""
    direct: NDArray[np.float64]
    """Direct normal irradiance (n,) [W/m²], or illuminance [lx]; NaN where it is missing."""
    diffuse: NDArray[np.float64]
    """Diffuse horizontal irradiance (n,) [W/m²], or illuminance [lx]; NaN where it is missing."""
    illuminances: bool = False
    """Whether direct and diffuse are illuminances rather than irradiances."""
    elevation: float = 0.0
    """Above the sea [m]."""
    global_horizontal: NDArray[np.float64] | None = None
    """Global horizontal irradiance (n,) [W/m²], if the file has it beside the others."""
    dew_point: NDArray[np.float64] | None = None
    """(n,) [°C], NaN where it is missing."""
    dry_bulb: NDArray[np.float64] | None = None
    """(n,) [°C], NaN where it is missing."""
    years: NDArray[np.int64] | None = None
    """Year of each record (n,), if the file has it: the sun is that of its day."""
    lines: NDArray[np.int64] | None = None
    """Line of each step in its file (n,)."""
    source: str = ""
    """Where it comes from: file and format, or how it was made."""
    notes: tuple[Finding, ...] = field(default=())
    """What was odd in reading or making it."""

    def __post_init__(self) -> None:
        n = len(self.times)
        if n == 0:
            raise ClerestoryError("weather without a step (give at least one)")
        standard_hours(self.place)
        for name in ("interval", "direct", "diffuse", "global_horizontal", "dew_point", "dry_bulb", "years", "lines"):
            values = getattr(self, name)
            if values is not None and np.shape(values) != (n,):
                raise ClerestoryError(f"{name} has {np.shape(values)} values for {n} steps (give one a step)")
        if not (np.isfinite(self.interval).all() and (self.interval > 0.0).all()):
            raise ClerestoryError("the intervals of weather are hours above 0 (give one a step)")

    def __len__(self) -> int:
        """Number of steps."""
        return len(self.times)

    def __repr__(self) -> str:
        return f"<Weather {self.place.name or 'without a name'!r}: {len(self)} steps, {self.source}>"

    # Time

    @property
    def time_zone(self) -> float:
        """Hours of its clock ahead of UTC."""
        return standard_hours(self.place)

    @property
    def utc(self) -> Times:
        """Middle of each interval (n,) in UTC."""
        return self.times - np.timedelta64(round(self.time_zone * 3600.0), "s")

    @property
    def step(self) -> float:
        """The commonest length of a step [h]."""
        lengths, counts = np.unique(np.round(self.interval, 6), return_counts=True)
        return float(lengths[np.argmax(counts)])

    @property
    def months(self) -> NDArray[np.int64]:
        """Month of each step (n,), 1 to 12."""
        return self.times.astype("datetime64[M]").astype(np.int64) % 12 + 1

    @property
    def days(self) -> NDArray[np.int64]:
        """Day of the month of each step (n,), from 1."""
        since: NDArray[np.int64] = (self.times.astype("datetime64[D]") - self.times.astype("datetime64[M]")).astype(
            np.int64
        )
        return since + 1

    @property
    def hours(self) -> NDArray[np.float64]:
        """Middle of each interval (n,) [h since midnight]."""
        since = self.times - self.times.astype("datetime64[D]")
        seconds: NDArray[np.float64] = since.astype("timedelta64[s]").astype(np.float64)
        return seconds / 3600.0

    @property
    def is_year(self) -> bool:
        """Whether at least 360 days of one year have all their steps."""
        days, inverse = np.unique(self.times.astype("datetime64[D]"), return_inverse=True)
        whole = np.bincount(inverse, self.interval) > 24.0 - 1e-6
        return len(days) <= 366 and int(whole.sum()) >= 360

    def at(self, when: str) -> int:
        """Number of the step that a time such as `02-21 14:00` lies in; it may be the beginning of the step.

        Raises
        ------
        ClerestoryError
            The text is not a time, or there is nothing then.
        """
        found = re.fullmatch(r"(?:\d{4}-)?(\d{1,2})-(\d{1,2})[ T](\d{1,2}):(\d{2})", when.strip())
        if found is None:
            raise ClerestoryError(f"time {when!r} is not understood (give month, day and time: 02-21 14:00)")
        month, day, hour, minute = (int(part) for part in found.groups())
        clock = hour + minute / 60.0
        if not (1 <= month <= 12 and 1 <= day <= _DAYS[month - 1] and clock <= 24.0 and minute < 60):
            raise ClerestoryError(f"time {when!r} does not exist (give month, day and time: 02-21 14:00)")
        on_day = (self.months == month) & (self.days == day)
        since = clock - self.hours + self.interval / 2.0
        hits = np.flatnonzero(on_day & (since >= -1e-4) & (since < self.interval - 1e-4))
        if len(hits):
            return int(hits[0])
        if on_day.any():
            raise ClerestoryError(f"there is no step at {when} (see the lines of that day)")
        first, last = self.times.min(), self.times.max()
        raise ClerestoryError(
            f"there is no step on {month:02d}-{day:02d} (they reach from {stamp(first)[:5]} to {stamp(last)[:5]})"
        )

    def words(self, step: int) -> str:
        """Day and clock of a step, such as 02-21 14:30."""
        return stamp(self.times[step])

    # Sun and sky

    def sun_positions(self, method: Method = "spa") -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Altitude, without refraction, and compass azimuth [°] (n,) of the sun in the middle of each step.

        Parameters
        ----------
        method
            As for `SunPosition.at`.
        """
        if method not in METHODS:
            raise ClerestoryError(f"method {method!r} is not known (give {', '.join(METHODS)})")
        if method not in self._suns:
            self._suns[method] = self._positions(method)
        return self._suns[method]

    @cached_property
    def _suns(self) -> dict[Method, tuple[NDArray[np.float64], NDArray[np.float64]]]:
        return {}

    def _positions(self, method: Method) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        months, days, hours = self.months, self.days, self.hours
        years = self.times.astype("datetime64[Y]").astype(np.int64) + 1970 if self.years is None else self.years
        if method == "spa":
            local = nominal(years, months, days, hours)
            altitude, azimuth = spa(self.place, local - np.timedelta64(round(self.time_zone * 3600.0), "s"))
            return altitude, azimuth % 360.0
        where = (self.place.latitude, self.place.longitude, self.time_zone)
        known = years.tolist() if method == "almanac" else [None] * len(self)
        pairs = [
            _core.sun_by_radiance(where, month, day, hour, year)
            for month, day, hour, year in zip(months.tolist(), days.tolist(), hours.tolist(), known, strict=True)
        ]
        altitude, azimuth = np.array(pairs).T
        return altitude, azimuth % 360.0

    @property
    def days_of_year(self) -> NDArray[np.int64]:
        """Day of the year (n,), 1 to 365; 29 February counts as 60."""
        return days_of_year(self.months, self.days)

    def sun(self, step: int, *, method: Method = "spa") -> SunPosition:
        """The sun in the middle of a step."""
        altitude, azimuth = self.sun_positions(method)
        return SunPosition(
            float(altitude[step]),
            float(azimuth[step]),
            int(self.days_of_year[step]),
            f"{method}, {self.words(step)} standard time",
        )

    @property
    def is_daylight(self) -> NDArray[np.bool_]:
        """Whether the sun is above the horizon in the middle of each step (n,)."""
        return self.sun_positions()[0] > 0.0

    def sky(self, step: int | str, *, method: Method | None = None, **common: Any) -> Sky:  # noqa: ANN401
        """Perez's sky of a step.

        Parameters
        ----------
        step
            Its number, or a time such as 02-21 14:00.
        method
            How the sun is found, see `SunPosition.at`; by default as the preset's programs find it.
        **common
            See `Sky`. The dew point is that of the step, if it is known.

        Raises
        ------
        ClerestoryError
            It is night, or its light is missing.
        """
        k = self.at(step) if isinstance(step, str) else step
        preset = common.get("preset", "clerestory")
        sun = self.sun(k, method=sun_method(preset) if method is None else method)
        direct, diffuse = float(self.direct[k]), float(self.diffuse[k])
        line = "" if self.lines is None else f"line {self.lines[k]}: "
        if not np.isfinite(direct + diffuse):
            raise ClerestoryError(f"{line}the light at {self.words(k)} is missing (choose another time, or fill gaps)")
        if diffuse <= 0.0:
            raise ClerestoryError(
                f"{line}no light of the sky at {self.words(k)}, sun {sun.words} (choose another time)"
            )
        if self.dew_point is not None and np.isfinite(self.dew_point[k]) and preset != "radiance-matrix":
            common.setdefault("dew_point", float(self.dew_point[k]))
        if self.illuminances:
            return Sky.perez(sun, direct_illuminance=direct, diffuse_illuminance=diffuse, **common)
        return Sky.perez(sun, direct=direct, diffuse=diffuse, **common)

    # What is odd, and what can be done

    @cached_property
    def findings(self) -> tuple[Finding, ...]:
        """What is missing, impossible or odd, with its hours; errors first."""
        return inspect.findings(self)

    @property
    def is_missing(self) -> NDArray[np.bool_]:
        """Steps (n,) whose light is not known although the sun is above the horizon."""
        return ~np.isfinite(self.direct + self.diffuse) & self.is_daylight

    def filled(self, hours: float) -> Weather:
        """The same with gaps of up to so many hours filled: see `clerestory.weather.gaps`.

        Raises
        ------
        ClerestoryError
            A gap is longer; the text has its hours.
        """
        return filled(self, hours)

    def selected(self, steps: NDArray[Any] | slice) -> Weather:
        """Some of the steps: numbers, a slice, or a mask (n,)."""

        def of(values: NDArray[Any] | None) -> Any:  # noqa: ANN401 (an array as it was, or nothing)
            return None if values is None else values[steps]

        names = ("times", "interval", "direct", "diffuse", "global_horizontal", "dew_point", "dry_bulb", "years")
        return replace(self, **{name: of(getattr(self, name)) for name in (*names, "lines")})


def standard_hours(place: Place) -> float:
    """Hours of a clock without daylight saving ahead of UTC.

    Raises
    ------
    ClerestoryError
        The clock is named, and may have daylight saving.
    """
    if isinstance(place.timezone, str):
        raise ClerestoryError(f"time zone {place.timezone!r}: weather is in standard time (give hours ahead of UTC)")
    return float(place.timezone)


def sun_method(preset: str) -> Method:
    """How the programs of a preset find the sun."""
    return "spa" if preset == "clerestory" else "radiance"
