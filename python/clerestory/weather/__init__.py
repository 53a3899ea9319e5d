"""Weather of a year, or of any set of steps: what the sun and the sky gave, hour by hour.

All times are local standard time, without daylight saving, at the middle of their interval.
"""

from clerestory.weather.hours import Hours
from clerestory.weather.read import read_weather
from clerestory.weather.skies import SkyYear, Suns
from clerestory.weather.synthetic import synthetic_year
from clerestory.weather.weather import Weather

__all__ = ["Hours", "SkyYear", "Suns", "Weather", "read_weather", "synthetic_year"]
