"""Weather of tables: TMY3, NSRDB, CSV and Parquet with named columns."""

import numpy as np
import pytest

from clerestory import ClerestoryError, FileFormatError
from clerestory.sky import Place
from clerestory.weather import read_weather

ALDRANS = Place(47.3, 11.4, 1.0, "Aldrans")
TMY3_HEAD = (
    '724930,"TOWN",CA,-8.0,37.717,-122.217,2\n'
    "Date (MM/DD/YYYY),Time (HH:MM),ETR (W/m^2),GHI (W/m^2),DNI (W/m^2),DHI (W/m^2),Dry-bulb (C),Dew-point (C)\n"
)
NSRDB_HEAD = (
    "Source,Location ID,City,State,Country,Latitude,Longitude,Time Zone,Elevation,Local Time Zone\n"
    "NSRDB,1234,-,-,-,39.74,-105.18,-7,1829,-7\n"
    "Year,Month,Day,Hour,Minute,DHI,DNI,GHI,Dew Point,Temperature\n"
)


def written(tmp_path, text, name="w.csv"):
    path = tmp_path / name
    path.write_text(text)
    return path


def words(weather):
    return [str(finding) for finding in weather.findings]


def test_tmy3_hours_are_named_by_their_end(tmp_path):
    rows = "01/31/1988,23:00,0,0,0,0,5.0,2.0\n01/31/1988,24:00,0,0,0,0,5.0,2.0\n02/01/1997,01:00,0,0,0,0,4.0,-9900\n"
    weather = read_weather(written(tmp_path, TMY3_HEAD + rows))
    assert (weather.place.name, weather.place.longitude, weather.time_zone) == ("TOWN", -122.217, -8.0)
    assert [str(t)[5:16] for t in weather.times] == ["01-31T22:30", "01-31T23:30", "02-01T00:30"]
    assert list(weather.years) == [1988, 1988, 1997]
    assert weather.dew_point[1] == 2.0
    assert np.isnan(weather.dew_point[2])
    assert weather.source == "w.csv (TMY3 with DNI (W/m^2) and DHI (W/m^2) and GHI (W/m^2))"


def test_nsrdb_times_are_the_middle(tmp_path):
    rows = "2020,2,29,12,0,100,800,650,-4,10\n2020,2,29,12,30,110,790,660,-4,10\n2020,2,29,13,0,120,780,655,-4,10\n"
    weather = read_weather(written(tmp_path, NSRDB_HEAD + rows))
    assert weather.step == 0.5
    assert [str(t) for t in weather.times] == [f"2020-02-29T{t}:00" for t in ("12:00", "12:30", "13:00")]
    assert (weather.elevation, weather.place.name) == (1829.0, "1234")
    assert list(weather.direct) == [800, 790, 780]


@pytest.mark.parametrize(
    ("stamp", "first"), [("middle", "02-21T14:00"), ("begin", "02-21T14:30"), ("end", "02-21T13:30")]
)
def test_what_times_of_a_table_name_is_a_choice(tmp_path, stamp, first):
    head = "# measured on the roof\ntime,DNI [W/m²],Diffuse_Horizontal\n"
    text = head + "2021-02-21 14:00,700,120\n2021-02-21 15:00,650,110\n"
    weather = read_weather(written(tmp_path, text), place=ALDRANS, stamp=stamp)
    assert str(weather.times[0])[5:16] == first
    assert list(weather.direct) == [700, 650]
    assert weather.lines[0] == 3
    unsaid = read_weather(written(tmp_path, text), place=ALDRANS)
    assert any("taken as the middle" in text for text in words(unsaid))


def test_an_end_at_midnight_is_of_the_day_before(tmp_path):
    text = "time,dni,dhi\n2021-01-01 00:00,0,0\n2021-01-01 01:00,0,0\n"
    weather = read_weather(written(tmp_path, text), place=ALDRANS, stamp="end")
    assert [str(t) for t in weather.times] == ["2020-12-31T23:30:00", "2021-01-01T00:30:00"]


def test_times_with_a_zone_are_moved_to_standard_time(tmp_path):
    text = "time,dni,dhi\n2021-07-21T14:00+02:00,700,120\n2021-07-21T15:00+02:00,650,110\n"
    weather = read_weather(written(tmp_path, text), place=ALDRANS, stamp="middle")
    assert str(weather.times[0]) == "2021-07-21T13:00:00"


@pytest.mark.parametrize("given", ["dhi", "dni"])
def test_the_third_kind_of_light_follows_from_two(tmp_path, given):
    text = f"Month,Day,Hour,GHI,{given.upper()}\n2,21,14,457.4,{120 if given == 'dhi' else 700}\n2,21,23,0,0\n"
    weather = read_weather(written(tmp_path, text), place=ALDRANS, stamp="middle")
    sine = np.sin(np.radians(28.8056))
    assert weather.direct[0] == pytest.approx((457.4 - 120) / sine if given == "dhi" else 700, rel=2e-3)
    assert weather.diffuse[0] == pytest.approx(120 if given == "dhi" else 457.4 - 700 * sine, rel=1e-2)
    assert (weather.direct[1], weather.diffuse[1]) == (0, 0)
    assert any("by the sun's altitude" in text for text in words(weather))


def test_columns_are_named_by_hand(tmp_path):
    text = "when,beam,sky\n21.02.2021 14:00,700,\n21.02.2021 15:00,650,110\n"
    columns = {"time": "when", "dni": "beam", "dhi": "sky"}
    weather = read_weather(written(tmp_path, text), place=ALDRANS, stamp="middle", columns=columns)
    assert np.isnan(weather.diffuse[0])
    assert weather.is_missing.tolist() == [True, False]


def test_parquet_is_read(tmp_path):
    pyarrow = pytest.importorskip("pyarrow", reason="pyarrow reads Parquet")
    from pyarrow import parquet

    times = np.datetime64("2021-02-21T14:00", "ns") + np.arange(3) * np.timedelta64(15, "m")
    table = pyarrow.table({"time": times, "dni": [700.0, None, 640.0], "dhi": [120.0, 118.0, 115.0]})
    parquet.write_table(table, tmp_path / "w.parquet")
    weather = read_weather(tmp_path / "w.parquet", place=ALDRANS, stamp="begin", fill_hours=0.5)
    assert weather.direct == pytest.approx([700, 670, 640])
    assert [str(t)[11:] for t in weather.times] == ["14:07:30", "14:22:30", "14:37:30"]


def test_damaged_parquet_is_refused(tmp_path):
    pytest.importorskip("pyarrow", reason="pyarrow reads Parquet")
    (tmp_path / "w.parquet").write_bytes(b"PAR1 and nothing else")
    with pytest.raises(FileFormatError, match="it is not whole, or no Parquet file"):
        read_weather(tmp_path / "w.parquet", place=ALDRANS)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("time,dni\n2021-02-21 14:00,1\n", "there is none beside dni among the columns time, dni"),
        ("time,power\n2021-02-21 14:00,1\n", "there is none among the columns"),
        ("a,b\n1,2\n", "nor a table with columns of weather; its first are a, b"),
        ("when,dni,dhi\n2021-02-21 14:00,1,1\n", "no column of times, and none of month"),
        ("time,dni,dhi\nnoon,1,1\n", "line 2: 'noon' is not a time"),
        ("time,dni,dhi\n2021-02-21 14:00,much,1\n", "line 2: dni is 'much'"),
        ("time,dni,dhi\n2021-02-21 14:00,1\n", "line 2: 2 fields instead of 3"),
        ("time,dni,dhi\n", "no steps"),
        ("month,day,hour,dni,dhi\n2,30,1,1,1\n", "line 2: there is no day 30"),
        ("month,day,hour,dni,dhi\n2,3,26,1,1\n", "line 2: hour 26"),
        (TMY3_HEAD + "01/31/1988,25:00,0,0,0,0,5.0,2.0\n", "line 3: 25:00 is not a time"),
        (TMY3_HEAD + "31.01.1988,1:00,0,0,0,0,5.0,2.0\n", "line 3: '31.01.1988' '1:00'"),
    ],
)
def test_faulty_tables(tmp_path, text, said):
    with pytest.raises(FileFormatError, match=said) as caught:
        read_weather(written(tmp_path, text), place=ALDRANS)
    assert str(caught.value).startswith(str(tmp_path))


def test_what_does_not_go_together_is_refused(tmp_path):
    table = written(tmp_path, "time,dni,dhi\n2021-02-21 14:00,1,1\n")
    with pytest.raises(FileFormatError, match="does not say where it is"):
        read_weather(table)
    with pytest.raises(ClerestoryError, match="no column 'x' for dni"):
        read_weather(table, place=ALDRANS, columns={"dni": "x"})
    with pytest.raises(ClerestoryError, match="column of 'sun': not known"):
        read_weather(table, place=ALDRANS, columns={"sun": "dni"})
    with pytest.raises(ClerestoryError, match="stamp 'start' is not known"):
        read_weather(table, place=ALDRANS, stamp="start")
    with pytest.raises(ClerestoryError, match="standard time"):
        read_weather(table, place=Place(47.3, 11.4, "Europe/Vienna"))
    wea = "place T\nlatitude 1\nlongitude 1\ntime_zone 0\nsite_elevation 0\nweather_data_file_units 1\n2 21 14 1 1\n"
    with pytest.raises(ClerestoryError, match="a WEA file says itself where"):
        read_weather(written(tmp_path, wea), place=ALDRANS)
