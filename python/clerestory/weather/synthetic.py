"""A year of weather that nobody measured, for studies of places without a file.

Clear skies are Ineichen's and Perez's (2002, Solar Energy 73, 151–157) for a constant turbidity. Clouds come by a chain
of clear, broken and overcast days, in which a day tends to be as the one before; within a day the share of the clear
sky's light that arrives goes up and down by a first-order process whose values follow a beta distribution of the kind
of day. Global light is divided by Erbs, Klein and Duffie (1982, Solar Energy 28, 293–302). It has the variety of
weather and not the climate of a place: not its seasons, fogs or afternoon clouds.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.weather.calendar import COMMON_YEAR, LEAP_YEAR
from clerestory.weather.inspect import extraterrestrial
from clerestory.weather.weather import Weather

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from clerestory.sky.position import Place

KINDS: tuple[tuple[float, float], ...] = ((0.95, 0.03), (0.68, 0.22), (0.28, 0.13))
"""Mean and standard deviation of the share of the clear sky's global light, of clear, broken and overcast days."""
PERSISTENCE = 0.5
"""Probability that a day is as the one before without a new draw."""
MEMORY_HOURS = 1.5
"""Time in which the share forgets its value by 1/e, within a day [h]."""
LOWEST_DEG = 1.0
"""Below this altitude of the sun there is no direct light [°]."""


def synthetic_year(
    place: Place,
    *,
    elevation: float = 0.0,
    cloudiness: float = 0.5,
    turbidity: float = 3.0,
    step: float = 1.0,
    leap: bool = False,
    seed: int = 0,
) -> Weather:
    """A synthetic year.

    Parameters
    ----------
    place
        Where; its time zone is standard time, in hours ahead of UTC.
    elevation
        Above the sea [m].
    cloudiness
        0: all days are clear; 1: all are overcast. Between, up to a third of the days
        are broken.
    turbidity
        Linke's, of the clear sky: 2 very clean, 3 clean, 5 hazy.
    step
        Length of a step [h]; a day is a whole number of them.
    leap
        With a 29 February.
    seed
        The same seed gives the same year.

    Raises
    ------
    ClerestoryError
        A value is not possible.
    """
    if not 0.0 <= cloudiness <= 1.0:
        raise ClerestoryError(f"a cloudiness of {cloudiness:g} is not possible (give 0, clear, to 1, overcast)")
    if not 1.0 <= turbidity <= 10.0:
        raise ClerestoryError(f"a turbidity of {turbidity:g} is not possible (give 1 to 10; 3 is usual)")
    if not 0.0 < step <= 1.0 or abs(1.0 / step - round(1.0 / step)) > 1e-9:
        raise ClerestoryError(f"a step of {step:g} h does not divide an hour (give 1, 0.5, 0.25, …)")
    days, daily = 366 if leap else 365, 24 * round(1.0 / step)
    first = np.datetime64(f"{LEAP_YEAR if leap else COMMON_YEAR}-01-01T00:00:00", "s")
    seconds = np.round((np.arange(days * daily) + 0.5) * step * 3600.0).astype("timedelta64[s]")
    zero = np.zeros(days * daily)
    words = f"synthetic year: cloudiness {cloudiness:g}, turbidity {turbidity:g}, seed {seed}"
    dark = Weather(place, first + seconds, np.full(len(zero), step), zero, zero, elevation=elevation, source=words)
    altitude, _ = dark.sun_positions()
    clear_global, clear_direct = _clear(dark, altitude, turbidity)
    share = _shares(days, daily, step, cloudiness, np.random.default_rng(seed)).ravel()
    direct, diffuse = _divided(dark, altitude, share * clear_global, clear_direct)
    return Weather(place, dark.times, dark.interval, direct, diffuse, elevation=elevation, source=words)


def _clear(
    weather: Weather, altitude: NDArray[np.float64], turbidity: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Global horizontal and direct normal irradiance (n,) [W/m²] of clear skies."""
    from pvlib.atmosphere import alt2pres, get_absolute_airmass, get_relative_airmass
    from pvlib.clearsky import ineichen

    zenith = np.clip(90.0 - altitude, 0.0, 90.0)
    airmass = get_absolute_airmass(get_relative_airmass(zenith), alt2pres(weather.elevation))
    made = ineichen(zenith, airmass, turbidity, altitude=weather.elevation, dni_extra=extraterrestrial(weather))
    up = altitude > 0.0
    return np.where(up, np.nan_to_num(made["ghi"]), 0.0), np.where(up, np.nan_to_num(made["dni"]), 0.0)


def _shares(days: int, daily: int, step: float, cloudiness: float, random: np.random.Generator) -> NDArray[np.float64]:
    """Share of the clear sky's global light (days, daily)."""
    from scipy.special import ndtr
    from scipy.stats import beta

    broken = (1.0 - abs(2.0 * cloudiness - 1.0)) / 3.0
    chances = np.array([(1.0 - cloudiness) * (1.0 - broken), broken, cloudiness * (1.0 - broken)])
    kinds = random.choice(3, size=days, p=chances)
    stay = random.random(days) < PERSISTENCE
    for day in range(1, days):
        if stay[day]:
            kinds[day] = kinds[day - 1]
    # A stationary process of Gaussian values, which the beta distributions take by their rank.
    memory = np.exp(-step / MEMORY_HOURS)
    draws = random.standard_normal((days, daily))
    values = np.empty_like(draws)
    values[:, 0] = draws[:, 0]
    for k in range(1, daily):
        values[:, k] = memory * values[:, k - 1] + np.sqrt(1.0 - memory**2) * draws[:, k]
    ranks = ndtr(values)
    made: NDArray[np.float64] = np.empty_like(ranks)
    for kind, (mean, deviation) in enumerate(KINDS):
        size = mean * (1.0 - mean) / deviation**2 - 1.0
        chosen = kinds == kind
        made[chosen] = beta.ppf(ranks[chosen], mean * size, (1.0 - mean) * size)
    return made


def _divided(
    weather: Weather,
    altitude: NDArray[np.float64],
    total: NDArray[np.float64],
    clear_direct: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Direct normal and diffuse horizontal irradiance (n,) of global ones.

    The direct part is Erbs', and not above the clear sky's.
    """
    sine = np.sin(np.radians(np.maximum(altitude, LOWEST_DEG)))
    kt = np.clip(total / (extraterrestrial(weather) * sine), 0.0, 1.0)
    middle = 0.9511 - 0.1604 * kt + 4.388 * kt**2 - 16.638 * kt**3 + 12.336 * kt**4
    scattered = np.where(kt <= 0.22, 1.0 - 0.09 * kt, np.where(kt <= 0.8, middle, 0.165))
    direct = np.minimum(total * (1.0 - scattered) / sine, clear_direct)
    direct = np.where(altitude > LOWEST_DEG, direct, 0.0)
    # What is not direct is diffuse: the sum of both is the global light.
    return direct, np.maximum(total - direct * np.sin(np.radians(np.maximum(altitude, 0.0))), 0.0)
