"""Weather files: what is read, what is left out, what is refused, and the skies of their hours."""

from pathlib import Path

import numpy as np
import pytest

from clerestory import ClerestoryError, FileFormatError
from clerestory.sky import Place, Sky, SunPosition
from clerestory.weather import read_weather
from samples import ABSENT, sample_root

HEAD = [
    "LOCATION,Town,-,AUT,made up,1,47.3,11.4,1.0,600",
    *[
        "DESIGN CONDITIONS,0",
        "TYPICAL/EXTREME PERIODS,0",
        "GROUND TEMPERATURES,0",
        "HOLIDAYS/DAYLIGHT SAVINGS,No,0,0,0",
    ],
    *["COMMENTS 1,", "COMMENTS 2,", "DATA PERIODS,1,1,Data,Sunday, 1/ 1,12/31"],
]
WEA = "place Town\nlatitude 47.3\nlongitude -11.4\ntime_zone -15\nsite_elevation 600\nweather_data_file_units {}\n"


def epw_row(month=2, day=21, hour=14, minute=60, dew_point="-3.0", direct="700", diffuse="120"):
    cells = ["2005", month, day, hour, minute, "?9", "5.0", dew_point, "70", "95000", "500", "1400", "300", "450"]
    return ",".join(str(c) for c in [*cells, direct, diffuse, *["0"] * 19])


def written(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "w.epw"
    path.write_text(text)
    return path


def epw(tmp_path, *rows, head=HEAD):
    return written(tmp_path, "\n".join([*head, *rows]) + "\n")


def sample(name):
    root = sample_root()
    if root is None:
        pytest.skip(ABSENT)
    return root / "weather" / name


def samples():
    root = sample_root()
    if root is None:
        return [pytest.param(None, marks=pytest.mark.skip(reason=ABSENT), id="absent")]
    return [pytest.param(p, id=p.name) for p in sorted((root / "weather").iterdir()) if p.suffix in (".epw", ".wea")]


@pytest.fixture(scope="module")
def innsbruck():
    return read_weather(sample("AUT_Innsbruck.111200_IWEC.epw"))


def words(weather):
    return [str(finding) for finding in weather.findings]


def test_a_year(innsbruck):
    assert len(innsbruck) == 8760
    assert innsbruck.is_year
    assert (innsbruck.place.latitude, innsbruck.place.longitude, innsbruck.time_zone) == (47.27, 11.35, 1.0)
    assert innsbruck.elevation == 593
    assert innsbruck.step == 1.0
    assert words(innsbruck) == []
    assert (innsbruck.words(0), innsbruck.dew_point[0], innsbruck.dry_bulb[0]) == ("01-01 00:30", -12.2, -9.3)
    assert (innsbruck.lines[0], str(innsbruck.utc[0])) == (9, "2000-12-31T23:30:00")
    # The sun is up in the middle of nearly every hour that has direct light.
    assert innsbruck.sun_positions()[0][innsbruck.direct > 20].min() > -2


def test_wea_and_epw_of_one_place_agree():
    one = read_weather(sample("USA_CA_Oakland.Intl.AP.724930_TMY3.epw"))
    other = read_weather(sample("oak.wea"))
    assert one.place.longitude == other.place.longitude == -122.22
    assert one.time_zone == other.time_zone == -8.0
    assert len(one) == len(other) == 8760
    assert np.array_equal(one.direct, other.direct)
    assert np.array_equal(one.diffuse, other.diffuse)
    assert np.array_equal(one.times, other.times)


@pytest.mark.parametrize("path", samples())
def test_every_sample_is_read(path):
    weather = read_weather(path)
    brightest = int(np.argmax(weather.diffuse))
    sky = weather.sky(brightest)
    assert sky.irradiance(part="sky")[0] == pytest.approx(sky.diffuse_horizontal, rel=1e-6)
    assert 80 < sky.diffuse_horizontal_illuminance / weather.diffuse[brightest] < 200  # lm/W
    assert sky.settings.light["diffuse"] == weather.diffuse[brightest]
    assert not [text for text in words(weather) if text.startswith("error")]


def test_an_hour_is_a_sky(tmp_path):
    weather = read_weather(epw(tmp_path, epw_row(), epw_row(hour=15, dew_point="99.9")))
    hour = weather.at("02-21 13:00")
    assert (weather.hours[hour], weather.words(hour)) == (13.5, "02-21 13:30")
    assert weather.at("02-21 13:59") == hour
    assert weather.hours[weather.at("2005-2-21 14:00")] == 14.5
    sky = weather.sky("02-21 13:00")
    same = Sky.perez(weather.sun(hour), direct=700, diffuse=120, dew_point=-3.0)
    assert sky.settings == same.settings
    assert sky.zenith_luminance == same.zenith_luminance
    assert weather.sky("02-21 14:30").settings.dew_point == pytest.approx(10.97353)
    # As the reference programs do: their formula for the sun.
    assert "radiance" in weather.sky("02-21 13:00", preset="radiance").settings.sun.source


def test_the_sun_is_that_of_the_year_of_the_record(tmp_path):
    weather = read_weather(epw(tmp_path, epw_row(), epw_row(month=6)))
    for step, day in enumerate(("02-21", "06-21")):
        same = SunPosition.at(Place(47.3, 11.4, 1.0), f"2005-{day} 13:30")
        assert weather.sun(step).direction == pytest.approx(same.direction, abs=1e-9)
        almanac = SunPosition.at(Place(47.3, 11.4, 1.0), f"2005-{day} 13:30", method="almanac")
        assert weather.sun(step, method="almanac").direction == pytest.approx(almanac.direction, abs=1e-12)


def test_what_is_missing_is_named_and_kept(tmp_path):
    rows = [epw_row(), epw_row(hour=15, direct="9999"), epw_row(hour=16, diffuse="9999"), epw_row(hour=17)]
    weather = read_weather(epw(tmp_path, *rows))
    assert len(weather) == 4
    assert words(weather)[0] == (
        "error: 2 steps: 21 February 14:00 to 16:00: direct or diffuse light is missing while the sun is above the "
        "horizon (fill short gaps: --fill-hours N, or weather.filled(N))"
    )
    with pytest.raises(ClerestoryError, match="line 10: the light at 02-21 14:30 is missing"):
        weather.sky("02-21 14:30")


def test_short_gaps_are_filled_and_long_ones_refused(tmp_path):
    rows = [epw_row(direct="600"), epw_row(hour=15, direct="9999"), epw_row(hour=16, direct="9999"), epw_row(hour=17)]
    file = epw(tmp_path, *rows)
    filled = read_weather(file, fill_hours=2)
    assert filled.direct == pytest.approx([600, 600 + 100 / 3, 600 + 200 / 3, 700])
    assert "note: 2 steps: 21 February 14:00 to 16:00: light that was missing was interpolated" in words(filled)
    with pytest.raises(ClerestoryError, match="a gap of 2 h is longer than the 1 h") as caught:
        read_weather(file, fill_hours=1)
    assert str(caught.value).startswith(str(file))


def test_several_records_an_hour(tmp_path):
    head = [*HEAD[:-1], "DATA PERIODS,1,4,Data,Sunday, 1/ 1,12/31"]
    rows = [epw_row(minute=m, direct=600 + m) for m in (15, 30, 45, 60)]
    weather = read_weather(epw(tmp_path, *rows, head=head))
    assert weather.step == 0.25
    assert weather.hours == pytest.approx([13.125, 13.375, 13.625, 13.875], abs=1e-3)
    assert weather.direct[weather.at("02-21 13:30")] == 645


def test_a_leap_day_is_kept(tmp_path):
    rows = [epw_row(day=28, hour=24), epw_row(day=29, hour=1), epw_row(month=3, day=1, hour=1)]
    weather = read_weather(epw(tmp_path, *rows))  # of 2005, which has no 29 February
    assert [str(t)[5:16] for t in weather.times] == ["02-28T23:30", "02-29T00:30", "03-01T00:30"]
    assert list(weather.days_of_year) == [59, 60, 60]
    assert weather.at("02-29 00:00") == 1


def test_direct_horizontal_irradiance(tmp_path):
    text = WEA.format(2) + "2 21 14.0 200 120\n2 21 4.0 5 1\n"
    weather = read_weather(written(tmp_path, text))
    assert weather.direct[0] == pytest.approx(200 / np.sin(np.radians(28.8)), rel=2e-3)
    assert weather.direct[1] == 0.0
    assert any("direct horizontal irradiance with the sun at the horizon or below" in text for text in words(weather))


def test_illuminances(tmp_path):
    weather = read_weather(written(tmp_path, WEA.format(3) + "2 21 14.0 60000 12000\n"))
    assert weather.illuminances
    sky = weather.sky("02-21 14:00")
    assert sky.diffuse_horizontal_illuminance == pytest.approx(12000)
    assert 179 * sky.direct_normal == pytest.approx(60000)


def test_night_has_no_sky(tmp_path):
    weather = read_weather(epw(tmp_path, epw_row(hour=2, direct="0", diffuse="0"), epw_row(hour=3, diffuse="10")))
    with pytest.raises(ClerestoryError, match="no light of the sky at 02-21 01:30"):
        weather.sky("02-21 01:00")
    with pytest.raises(ClerestoryError, match="night"):
        weather.sky("02-21 02:00")


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        (
            [epw_row(direct="1600")],
            "warning: 1 step: 21 February 13:00 to 14:00: more direct light than outside of the",
        ),
        (
            [epw_row(hour=2)],
            "warning: 1 step: 21 February 01:00 to 02:00: light up to 820 W/m² in the middle of the night",
        ),
        (
            [epw_row(diffuse="0")],
            "warning: 1 step: 21 February 13:00 to 14:00: direct light up to 700 W/m² without any",
        ),
        ([epw_row(), epw_row()], "warning: 1 step: 21 February 13:00 to 14:00: the step is there more than once"),
        (
            [epw_row(direct="-700")],
            "warning: line 9: 1 value of direct normal irradiance far below 0, taken as missing",
        ),
        (
            [epw_row(hour=2, direct="-3", diffuse="-1")],
            "note: line 9: 1 value of direct normal irradiance slightly below",
        ),
        ([epw_row(direct="0", diffuse="30")], "warning: 1 step: 21 February 13:00 to 14:00: global light differs"),
        ([epw_row(hour=15), epw_row()], "warning: 1 step: 21 February 13:00 to 14:00: the steps are not in the order"),
        ([epw_row()], "note: 1 step of 1 day, not a year"),
    ],
)
def test_what_is_odd_is_said(tmp_path, rows, said):
    # A second, sound hour, so that a file with nothing else is still one.
    weather = (
        read_weather(epw(tmp_path, *rows, epw_row(day=22)))
        if "not a year" not in said
        else read_weather(epw(tmp_path, *rows))
    )
    assert any(text.startswith(said) for text in words(weather)), words(weather)


def test_hours_that_a_year_lacks_are_found(innsbruck):
    kept = np.delete(np.arange(8760), [1690, 1691, 1700])  # 12 March 10:00 to 12:00, and 20:00 to 21:00
    weather = innsbruck.selected(kept)
    assert words(weather) == [
        "warning: 2 steps: 12 March 10:00 to 12:00: the file has nothing for these daylight hours "
        "(take a whole file, or mind the sums)",
        "note: 1 step of the night is not in the file",
    ]


def test_hours_that_a_day_lacks_are_found(innsbruck):
    week = innsbruck.selected(np.delete(np.arange(24 * 7), [12, 24, 47]))  # the first and the last may lack
    assert words(week) == [
        "warning: 1 step: 1 January 12:00 to 13:00: the file has nothing for these daylight hours "
        "(take a whole file, or mind the sums)",
        "note: 165 steps of 7 days, not a year",
    ]


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        ([epw_row(direct="seven")], "line 9: direct normal irradiance is 'seven'"),
        ([epw_row(), epw_row(month=13)], "line 10: there is no day 21 of month 13"),
        ([epw_row(hour=25)], "line 9: hour 25"),
        (["2005,2,21"], "line 9: 3 fields"),
        ([], "no step"),
        ([epw_row(direct="9999")], "no step"),
    ],
)
def test_faulty_epw(tmp_path, rows, words):
    with pytest.raises(FileFormatError, match=words):
        read_weather(epw(tmp_path, *rows))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("hello\n", "line 1: neither LOCATION"),
        ("", "line 1"),
        ("LOCATION,Town\n", "line 1: LOCATION has 2 fields"),
        (",".join(["LOCATION,Town,-,AUT,x,1,97.3,11.4,1.0,600"]), "line 1: latitude 97.3"),
        ("place Town\nlongitude 3\n", "line 2: 'longitude' instead of latitude"),
        ("place Town\n", "line 2"),
        (WEA.format(4), "line 6: weather_data_file_units 4"),
        (WEA.format(1), "no steps"),
        (WEA.format(1) + "2 21 14.0 700\n", "line 7: 4 values"),
        (WEA.format(1) + "2 30 14.0 700 120\n", "line 7: there is no day 30"),
        (WEA.format(1) + "2 21 25.0 700 120\n", "line 7: hour 25"),
        (WEA.format(1) + "2 21 x 700 120\n", "line 7: hour is 'x'"),
    ],
)
def test_faulty_files(tmp_path, text, words):
    with pytest.raises(FileFormatError, match=words) as caught:
        read_weather(written(tmp_path, text))
    assert str(caught.value).startswith(str(tmp_path))


@pytest.mark.parametrize("when", ["noon", "02-30 12:00", "02-21 25:00", "02-21"])
def test_times_that_do_not_exist(tmp_path, when):
    weather = read_weather(epw(tmp_path, epw_row()))
    with pytest.raises(ClerestoryError, match=r"not understood|does not exist"):
        weather.at(when)
