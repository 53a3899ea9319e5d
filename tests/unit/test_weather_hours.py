"""Hours that count, synthetic years, and skies of many steps."""

import numpy as np
import pytest

from clerestory import ClerestoryError
from clerestory.sky import Place
from clerestory.weather import Hours, SkyYear, Weather, synthetic_year
from clerestory.weather.figure import sun_hours

ALDRANS = Place(47.3, 11.4, 1.0, "Aldrans")


@pytest.fixture(scope="module")
def year():
    return synthetic_year(ALDRANS, elevation=760, seed=4)


def test_working_hours_are_ten_of_every_day(year):
    assert Hours().mask(year).sum() == 3650
    assert Hours(weekdays=True).mask(year).sum() == 2610  # 2001 has 261 weekdays
    assert set(year.hours[Hours().mask(year)]) == {8.5 + k for k in range(10)}
    assert Hours().words == "08:00 to 18:00"


def test_daylight_hours_have_the_sun_above_the_horizon(year):
    chosen = Hours.all_daylight().mask(year)
    assert np.array_equal(chosen, year.sun_positions()[0] > 0)
    assert chosen.sum() == pytest.approx(4380, abs=40)  # half of the year, by symmetry
    assert Hours.all_daylight().words == "daylight hours"


@pytest.mark.parametrize("clock", ["Europe/Vienna", ("03-25", "10-27")])
def test_clocks_with_daylight_saving_begin_an_hour_earlier_in_summer(year, clock):
    chosen = Hours(clock=clock).mask(year)
    assert chosen.sum() == 3650
    summer = year.months == 7
    assert set(year.hours[chosen & summer]) == {7.5 + k for k in range(10)}
    assert set(year.hours[chosen & (year.months == 1)]) == {8.5 + k for k in range(10)}
    # Of 2001: 25 March to 28 October.
    first = year.times[chosen & (year.hours == 7.5)][0]
    assert str(first)[5:10] == "03-25"


def test_daylight_saving_of_the_south_spans_the_new_year(year):
    chosen = Hours(clock=("10-01", "03-31")).mask(year)
    assert set(year.hours[chosen & (year.months == 1)]) == {7.5 + k for k in range(10)}
    assert set(year.hours[chosen & (year.months == 7)]) == {8.5 + k for k in range(10)}


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"start": 18, "end": 8}, "not part of a day"),
        ({"clock": "Mars/Base"}, "time zone 'Mars/Base' is not known"),
        ({"clock": ("spring", "10-27")}, "day 'spring'"),
    ],
)
def test_hours_that_make_no_sense(options, said):
    with pytest.raises(ClerestoryError, match=said):
        Hours(**options)


@pytest.mark.parametrize(
    ("latitude", "cloudiness", "least", "most"),
    [  # Global horizontal light of a year [kWh/m²], as atlases have it for such places.
        (0, 0.3, 1700, 2200),
        (25, 0.0, 2100, 2500),  # desert
        (47.3, 0.5, 950, 1300),
        (60, 0.7, 550, 900),
        (-33, 0.3, 1450, 1950),
    ],
)
def test_synthetic_years_have_the_light_of_their_latitude(latitude, cloudiness, least, most):
    weather = synthetic_year(Place(latitude, 15.0, 1.0), cloudiness=cloudiness, seed=1)
    sine = np.sin(np.radians(np.maximum(weather.sun_positions()[0], 0)))
    total = (weather.diffuse + weather.direct * sine).sum() / 1e3
    assert least < total < most
    assert [f for f in weather.findings if f.severity != "note"] == []
    assert "synthetic" in weather.source
    share = weather.diffuse.sum() / 1e3 / total
    assert 0.15 < share < 0.8


def test_synthetic_years_differ_by_seed_only():
    one, same, other = (synthetic_year(ALDRANS, seed=seed) for seed in (1, 1, 2))
    assert np.array_equal(one.direct, same.direct)
    assert not np.array_equal(one.direct, other.direct)
    cloudy, clear = (synthetic_year(ALDRANS, cloudiness=c).direct.sum() for c in (0.9, 0.1))
    assert cloudy < 0.5 * clear
    quarters = synthetic_year(ALDRANS, step=0.25, leap=True)
    assert len(quarters) == 366 * 96
    assert quarters.interval.sum() == pytest.approx(8784)
    with pytest.raises(ClerestoryError, match="cloudiness of 2"):
        synthetic_year(ALDRANS, cloudiness=2)
    with pytest.raises(ClerestoryError, match="does not divide an hour"):
        synthetic_year(ALDRANS, step=0.7)


def test_sunrise_and_sunset_are_where_the_sun_crosses_the_horizon(year):
    sun = sun_hours(year)
    assert len(sun.days) == 365
    june = list(sun.days.astype(str)).index("2001-06-21")
    # Of the sun's centre and without refraction, by half of the almanac's day arc at 47.3°: 2 h 46 min before six.
    middle = (sun.sunrise[june] + sun.sunset[june]) / 2
    assert middle == pytest.approx(12 + (15 - 11.4) / 15 + 1.8 / 60, abs=0.02)
    arc = np.degrees(np.arccos(-np.tan(np.radians(47.3)) * np.tan(np.radians(23.437)))) / 15
    assert sun.sunset[june] - sun.sunrise[june] == pytest.approx(2 * arc, abs=0.02)
    polar = sun_hours(synthetic_year(Place(80.0, 0.0, 0.0)))
    assert np.isnan(polar.sunrise[170])


@pytest.mark.parametrize("preset", ["clerestory", "radiance-matrix"])
def test_columns_are_the_skies_of_their_hours(year, preset):
    some = year.selected(slice(2000, 2048))
    skies = SkyYear(some, "reinhart:2", preset=preset, north_deg=20)
    matrix = skies.columns()
    assert matrix.shape == (578, 48)
    assert matrix.dtype == np.float32
    for step in range(48):
        if some.diffuse[step] <= 0:
            assert not matrix[:, step].any()
            continue
        alone = some.sky(step, preset=preset, north_deg=20).patches("reinhart:2")[:, 0]
        assert matrix[:, step] == pytest.approx(alone, rel=1e-6, abs=1e-6)


def test_skies_conserve_the_light_they_were_given(year):
    skies = SkyYear(year.selected(slice(4000, 4100)), "tregenza", quantity="solar")
    weights = skies.patches.projected_solid_angles[1:]
    found = weights @ skies.columns(part="sky", dtype=np.float64)[1:]
    assert found == pytest.approx(np.where(skies.is_lit, skies.weather.diffuse, 0.0), rel=1e-5, abs=1e-6)
    up = skies.is_lit & (skies.weather.sun_positions()[0] > 0)
    assert skies.suns.irradiance == pytest.approx(np.where(up, skies.weather.direct, 0.0), rel=1e-5, abs=1e-6)


def test_suns_shine_as_the_discs_of_skies(year):
    some = year.selected(slice(4000, 4024))
    suns = SkyYear(some, north_deg=30).suns
    for step in np.flatnonzero(some.direct > 50):
        disc = some.sky(int(step), north_deg=30).sun
        assert suns.directions[step] == pytest.approx(disc.direction, abs=1e-9)
        assert suns.radiance[step] == pytest.approx(disc.radiance[1], rel=1e-4)


def test_chunks_are_the_columns(year):
    skies = SkyYear(year.selected(slice(0, 100)), "tregenza")
    whole = skies.columns()
    pieces = list(skies.chunks(33))
    assert [(s.start, s.stop) for s, _ in pieces] == [(0, 33), (33, 66), (66, 99), (99, 100)]
    assert np.array_equal(np.concatenate([values for _, values in pieces], axis=1), whole)


def test_years_with_gaps_have_no_skies(year):
    direct = year.direct.copy()
    direct[1690:1692] = np.nan
    from dataclasses import replace

    broken = replace(year, direct=direct)
    with pytest.raises(ClerestoryError, match=r"2 steps: 12 March 10:00 to 12:00 \(fill short gaps"):
        SkyYear(broken)
    assert np.isfinite(SkyYear(broken.filled(2), "tregenza").columns(slice(1690, 1692))).all()


def test_weather_is_checked_when_it_is_made():
    times = np.datetime64("2001-01-01T12:00:00") + np.arange(2) * np.timedelta64(3600, "s")
    with pytest.raises(ClerestoryError, match=r"direct has \(3,\) values for 2 steps"):
        Weather(ALDRANS, times, np.ones(2), np.ones(3), np.ones(2))
    with pytest.raises(ClerestoryError, match="hours above 0"):
        Weather(ALDRANS, times, np.zeros(2), np.ones(2), np.ones(2))
    with pytest.raises(ClerestoryError, match="without a step"):
        Weather(ALDRANS, times[:0], np.ones(0), np.ones(0), np.ones(0))
