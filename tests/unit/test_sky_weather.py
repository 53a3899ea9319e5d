"""Weather files: what is read, what is left out, what is refused, and the skies of their hours."""

from pathlib import Path

import numpy as np
import pytest

from clerestory import ClerestoryError, FileFormatError
from clerestory.sky import Sky, read_weather
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


def test_a_year(innsbruck):
    assert len(innsbruck) == 8760
    assert (innsbruck.place.latitude, innsbruck.place.longitude, innsbruck.place.timezone) == (47.27, 11.35, 1.0)
    assert innsbruck.elevation == 593
    assert innsbruck.step == 1.0
    assert innsbruck.warnings == ()
    first = innsbruck.hours[0]
    assert (first.month, first.day, first.hour, first.dew_point, first.line) == (1, 1, 0.5, -12.2, 9)
    # The sun is up in the middle of nearly every hour that has direct light.
    lit = [hour for hour in innsbruck.hours[::7] if hour.direct > 20]
    assert min(innsbruck.sun(hour).altitude_deg for hour in lit) > -2


def test_wea_and_epw_of_one_place_agree():
    one = read_weather(sample("USA_CA_Oakland.Intl.AP.724930_TMY3.epw"))
    other = read_weather(sample("oak.wea"))
    assert one.place.longitude == other.place.longitude == -122.22
    assert one.place.timezone == other.place.timezone == -8.0
    assert len(one) == len(other) == 8760
    assert np.array_equal(one.direct, other.direct)
    assert np.array_equal(one.diffuse, other.diffuse)
    assert [h.hour for h in one.hours] == [h.hour for h in other.hours]


@pytest.mark.parametrize("path", samples())
def test_every_sample_is_read(path):
    weather = read_weather(path)
    brightest = max(weather.hours, key=lambda hour: hour.diffuse)
    sky = weather.sky(brightest)
    assert sky.irradiance(part="sky")[0] == pytest.approx(sky.diffuse_horizontal, rel=1e-6)
    assert 80 < sky.diffuse_horizontal_illuminance / brightest.diffuse < 200  # lm/W
    assert sky.settings.light["diffuse"] == brightest.diffuse


def test_an_hour_is_a_sky(tmp_path):
    weather = read_weather(epw(tmp_path, epw_row(), epw_row(hour=15, dew_point="99.9")))
    hour = weather.at("02-21 13:00")
    assert (hour.hour, hour.words) == (13.5, "02-21 13:30")
    assert weather.at("02-21 13:59") is hour
    assert weather.at("2005-2-21 14:00").hour == 14.5
    sky = weather.sky("02-21 13:00")
    same = Sky.perez(weather.sun(hour), direct=700, diffuse=120, dew_point=-3.0)
    assert sky.settings == same.settings
    assert sky.zenith_luminance == same.zenith_luminance
    assert weather.sky("02-21 14:30").settings.dew_point == pytest.approx(10.97353)
    # As the reference programs do: their formula for the sun.
    assert "radiance" in weather.sky("02-21 13:00", preset="radiance").settings.sun.source


def test_what_is_missing_is_named_and_left_out(tmp_path):
    weather = read_weather(epw(tmp_path, epw_row(), epw_row(hour=15, direct="9999"), epw_row(hour=16, diffuse="9999")))
    assert len(weather) == 1
    assert weather.warnings == (
        "2 steps left out, their direct normal or diffuse horizontal irradiance is missing (lines 10, 11)",
    )
    with pytest.raises(ClerestoryError, match="no step of the file at 02-21 14:30"):
        weather.at("02-21 14:30")


def test_several_records_an_hour(tmp_path):
    head = [*HEAD[:-1], "DATA PERIODS,1,4,Data,Sunday, 1/ 1,12/31"]
    rows = [epw_row(minute=m, direct=600 + m) for m in (15, 30, 45, 60)]
    weather = read_weather(epw(tmp_path, *rows, head=head))
    assert weather.step == 0.25
    assert [h.hour for h in weather.hours] == pytest.approx([13.125, 13.375, 13.625, 13.875])
    assert weather.at("02-21 13:30").direct == 645


def test_direct_horizontal_irradiance(tmp_path):
    text = WEA.format(2) + "2 21 14.0 200 120\n2 21 4.0 5 1\n"
    weather = read_weather(written(tmp_path, text))
    assert weather.hours[0].direct == pytest.approx(200 / np.sin(np.radians(28.8)), rel=2e-3)
    assert weather.warnings == (
        "1 step left out, their direct horizontal irradiance has no sun above the horizon (line 8)",
    )


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
    ("rows", "words"),
    [
        ([epw_row(direct="seven")], "line 9: direct normal irradiance is 'seven'"),
        ([epw_row(), epw_row(month=13)], "line 10: there is no day 21 of month 13"),
        ([epw_row(hour=25)], "line 9: hour 25"),
        ([epw_row(diffuse="-3")], "line 9: an irradiance of -3"),
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
