"""Where and when: places, their clocks, and the position of the sun."""

from __future__ import annotations

import math
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta, timezone, tzinfo
from typing import TYPE_CHECKING, Literal
from zoneinfo import ZoneInfo

import numpy as np

from clerestory import _core
from clerestory._core import ClerestoryError

if TYPE_CHECKING:
    from numpy.typing import NDArray

Method = Literal["spa", "radiance", "almanac"]
METHODS: tuple[Method, ...] = ("spa", "radiance", "almanac")

_COMPASS = ("N", "NNE", "NE", "ENE", "E", "ESE", "SE", "SSE", "S", "SSW", "SW", "WSW", "W", "WNW", "NW", "NNW")
_BEFORE = np.cumsum([0, 31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30])
_FORMATS = ("%Y-%m-%d %H:%M", "%Y-%m-%dT%H:%M", "%Y-%m-%d %H:%M:%S", "%Y-%m-%dT%H:%M:%S")


@dataclass(frozen=True)
class Place:
    """A place and its clock."""

    latitude: float
    """Degrees, north positive."""
    longitude: float
    """Degrees, EAST positive; Radiance's options and WEA files count west."""
    timezone: str | float = 0.0
    """IANA name, such as Europe/Vienna, with its daylight saving; or hours ahead of UTC, without any."""
    name: str = ""
    """What people call it."""

    def __post_init__(self) -> None:
        if not -90.0 <= self.latitude <= 90.0:
            raise ClerestoryError(f"latitude {self.latitude}° is not on Earth (give -90, south, to 90, north)")
        if not -180.0 <= self.longitude <= 180.0:
            raise ClerestoryError(f"longitude {self.longitude}° is not on Earth (give -180, west, to 180, east)")
        _zone(self.timezone)

    @property
    def zone(self) -> tzinfo:
        """The clock."""
        return _zone(self.timezone)

    def standard_hours(self, year: int) -> float:
        """Hours ahead of UTC, without daylight saving."""
        offsets = [self.zone.utcoffset(datetime(year, month, 1)) or timedelta() for month in range(1, 13)]
        return min(offset.total_seconds() for offset in offsets) / 3600.0


def _zone(name: str | float) -> tzinfo:
    if not isinstance(name, str):
        if not -14.0 <= name <= 14.0:
            raise ClerestoryError(f"time zone {name} is not one (give hours ahead of UTC, or a name: Europe/Vienna)")
        return timezone(timedelta(hours=name))
    try:
        return ZoneInfo(name)
    except (KeyError, OSError, ValueError) as error:
        raise ClerestoryError(
            f"time zone {name!r} is not known (give an IANA name such as Europe/Vienna, or hours ahead of UTC)"
        ) from error


def moment(when: str | datetime, place: Place) -> datetime:
    """A time with its zone: as given, or that of the place.

    Raises
    ------
    ClerestoryError
        The text is not a time such as 2021-02-21 14:00.
    """
    if isinstance(when, str):
        when = _parsed(when)
    return when if when.tzinfo is not None else when.replace(tzinfo=place.zone)


def _parsed(text: str) -> datetime:
    for form in _FORMATS:
        try:
            return datetime.strptime(text.strip(), form)
        except ValueError:
            continue
    raise ClerestoryError(f"time {text!r} is not understood (give it as 2021-02-21 14:00)")


@dataclass(frozen=True)
class SunPosition:
    """Where the sun is, and on which day, which tells how far it is."""

    altitude_deg: float
    """Angle above the horizon, without refraction."""
    azimuth_deg: float
    """Compass azimuth: clockwise from north, 180 is south."""
    day: int | None = None
    """Day of the year, 1 to 365; None: the mean distance of the sun."""
    source: str = "given"
    """How it was found."""

    @classmethod
    def at(cls, place: Place, when: str | datetime, *, method: Method = "spa") -> SunPosition:
        """The sun seen from a place at a time of its clock.

        Parameters
        ----------
        place
            The place.
        when
            Time, such as 2021-02-21 14:00; with a zone of its own, or on the clock of the place.
        method
            `spa`: NREL's algorithm (Reda and Andreas 2004), good to 0.0003°; `radiance`: the low-order formula of
            Radiance's sky generators, good to some tenths of a degree; `almanac`: their formula for a known year.
        """
        local = moment(when, place)
        day = _day_of_year(local)
        if method == "spa":
            altitude, azimuth = _spa(place, local)
        else:
            zone = place.standard_hours(local.year)
            standard = local.astimezone(timezone(timedelta(hours=zone)))
            hour = standard.hour + standard.minute / 60.0 + standard.second / 3600.0
            altitude, azimuth = _core.sun_by_radiance(
                (place.latitude, place.longitude, zone),
                standard.month,
                standard.day,
                hour,
                standard.year if method == "almanac" else None,
            )
        return cls(altitude, azimuth % 360.0, day, f"{method}, {local.isoformat(sep=' ', timespec='minutes')}")

    @property
    def direction(self) -> tuple[float, float, float]:
        """Unit vector toward the sun: x east, y north, z up."""
        altitude, azimuth = math.radians(self.altitude_deg), math.radians(self.azimuth_deg)
        return (
            math.sin(azimuth) * math.cos(altitude),
            math.cos(azimuth) * math.cos(altitude),
            math.sin(altitude),
        )

    @property
    def words(self) -> str:
        """In words for people."""
        side = "above" if self.altitude_deg >= 0 else "below"
        return f"{abs(self.altitude_deg):.1f}° {side} the horizon, azimuth {self.azimuth_deg:.1f}° ({self.compass})"

    @property
    def compass(self) -> str:
        """The nearest of sixteen points of the compass."""
        return _COMPASS[round(self.azimuth_deg / 22.5) % 16]


def _day_of_year(when: datetime) -> int:
    """Day 1 to 365; 29 February counts as 60, as in weather files."""
    return int(days_of_year(np.array([when.month]), np.array([when.day]))[0])


def days_of_year(months: NDArray[np.int64], days: NDArray[np.int64]) -> NDArray[np.int64]:
    """Days 1 to 365 (n,) of months and days of the month; 29 February counts as 60, as in weather files."""
    return np.minimum(365, _BEFORE[months - 1] + days)


def _spa(place: Place, when: datetime) -> tuple[float, float]:
    altitude, azimuth = spa(place, np.array([when.astimezone(UTC).replace(tzinfo=None)], dtype="datetime64[ms]"))
    return float(altitude[0]), float(azimuth[0])


def spa(place: Place, universal: NDArray[np.datetime64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Altitude, without refraction, and compass azimuth [°] (n,) at UTC times (n,), by pvlib."""
    from pvlib.spa import calculate_deltat, solar_position

    seconds = universal.astype("datetime64[ms]").astype(np.int64) / 1e3
    months = universal.astype("datetime64[M]").astype(np.int64)
    delta = calculate_deltat(1970 + months // 12, 1 + months % 12)
    # Elevation above the sea, pressure and temperature are read by the refraction, and by a parallax of 0.002°, only.
    found = solar_position(seconds, place.latitude, place.longitude, 0.0, 1013.25, 12.0, delta, 0.5667)
    return found[3], found[4]
