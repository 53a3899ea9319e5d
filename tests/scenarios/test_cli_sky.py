"""`clerestory sky` as a person uses it."""

import json

import numpy as np
import pytest

from clerestory.cli import main
from clerestory.sky import Sky

ALDRANS = ["--place", "47.3,11.4", "--timezone", "Europe/Vienna", "--time", "2021-02-21 14:00"]
PEREZ = ["perez", "--direct", 700, "--diffuse", 120]


def run(capsys, *words):
    code = main(["sky", *(str(word) for word in words)])
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def test_what_a_sky_gives_is_printed(capsys):
    code, out, err = run(capsys, *PEREZ, *ALDRANS)
    assert code == 0, err
    assert "28.8° above the horizon, azimuth 206.0° (SSW)" in out
    assert "clearness ε" in out
    assert "vertical   south" in out
    assert err == ""


def test_json_is_all_that_is_printed(capsys):
    code, out, _ = run(capsys, *PEREZ, *ALDRANS, "--json")
    assert code == 0
    made = json.loads(out)
    assert made["sun_altitude_deg"] == pytest.approx(28.8, abs=0.1)
    assert made["settings"]["light"] == {"direct": 700.0, "diffuse": 120.0}
    sky = Sky.perez((made["sun_altitude_deg"], made["sun_azimuth_deg"]), direct=700, diffuse=120)
    # The distance of the sun is that of the day.
    assert made["horizontal_illuminance"] == pytest.approx(sky.horizontal_illuminance, rel=0.01)
    assert made["vertical_illuminance"]["south"] > made["vertical_illuminance"]["north"]


@pytest.mark.parametrize(
    "words",
    [
        ["cie", 12, "--sun", "40,200", "--zenith", 4000],
        ["cie", 1, "--sun", "40,200", "--diffuse-illuminance", 12000],
        ["overcast", "--diffuse-illuminance", 10000],
        ["uniform", "--zenith", 5000],
        ["clear", "--sun", "40,200", "--turbidity", 3, "--sunless"],
        ["intermediate", "--sun", "40,200"],
        ["preetham", "--sun", "40,200", "--turbidity", 4, "--grey"],
        ["perez", "--sun", "40,200", "--global", 500, "--solar"],
        ["perez", "--sun", "40,200", "--direct", 500, "--diffuse", 100, "--preset", "radiance", "--colour", "radiance"],
        ["clear", *ALDRANS, "--method", "almanac", "--north", 30, "--ground", 0.1],
    ],
    ids=lambda words: str(words[0]),
)
def test_every_kind_is_printed_and_written(words, tmp_path, capsys):
    code, out, err = run(capsys, *words)
    assert code == 0, err
    assert "horizontal" in out
    for suffix in ("png", "rad", "mtx") + (() if "--solar" in words else ("csv",)):
        code, out, err = run(capsys, *words, "-o", tmp_path / f"sky.{suffix}")
        assert code == 0, err
        assert out == ""
        assert (tmp_path / f"sky.{suffix}").stat().st_size > 400


def test_a_matrix_is_a_column_of_patches(tmp_path, capsys):
    file = tmp_path / "sky.mtx"
    code, _, err = run(capsys, *PEREZ, *ALDRANS, "-o", file, "--basis", "reinhart:2", "--part", "sun")
    assert code == 0, err
    head, _, body = file.read_text().partition("\n\n")
    assert {"NROWS=578", "NCOLS=1", "NCOMP=3", "FORMAT=ascii", "LATLONG= 47.3 11.4"} <= set(head.splitlines())
    values = np.array([[float(v) for v in line.split()] for line in body.split("\n") if line])
    assert values.shape == (578, 3)
    assert np.count_nonzero(values[:, 0]) == 4
    run(capsys, *PEREZ, *ALDRANS, "-o", file, "--part", "sun", "--five-phase", 0.533)
    body = file.read_text().partition("\n\n")[2]
    assert sum(float(line.split()[0]) > 0 for line in body.split("\n") if line) == 1


def test_a_scene_comes_with_its_functions(tmp_path, capsys):
    code, out, _ = run(capsys, *PEREZ, *ALDRANS, "-o", tmp_path / "my.rad", "--json")
    assert code == 0
    assert json.loads(out)["written"] == [str(tmp_path / "my.cal"), str(tmp_path / "my.rad")]
    assert "sky_r sky_g sky_b my.cal" in (tmp_path / "my.rad").read_text()
    run(capsys, *PEREZ, *ALDRANS, "-o", tmp_path / "other.rad", "--preset", "radiance")
    assert "perezlum.cal" in (tmp_path / "other.rad").read_text()
    assert not (tmp_path / "other.cal").exists()


def test_an_hour_of_weather(tmp_path, capsys):
    file = tmp_path / "town.wea"
    file.write_text(
        "place Town\nlatitude 47.3\nlongitude -11.4\ntime_zone -15\nsite_elevation 600\nweather_data_file_units 1\n"
        "2 21 13.5 700 120\n2 21 14.5 9999 110\n2 21 22.5 0 0\n"
    )
    code, out, err = run(capsys, "weather", file, "--time", "02-21 13:00")
    assert code == 0
    assert "13:30" in out
    assert f"warning: {file}: 1 step: 21 February 14:00 to 15:00: direct or diffuse light is missing" in err
    code, _, err = run(capsys, "weather", file, "--time", "02-21 22:00")
    assert code == 1
    assert f"error: {file}: line 9: no light of the sky at 02-21 22:30" in err


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        (["rainbow"], 2, "KIND rainbow: not known"),
        (["cie"], 2, "its type, 1 to 15, is missing"),
        (["cie", "twelve", "--sun", "30,0", "--zenith", 1], 2, "not a type"),
        (["cie", 16, "--sun", "30,0", "--zenith", 1], 1, "type from 1"),
        (["perez", "--direct", 1, "--diffuse", 1], 2, "position of the sun is unknown"),
        (["clear", "--place", "47,11"], 2, "--time: the position"),
        (["clear", "--sun", "30,0", "--place", "47,11"], 2, "beside a place"),
        (["clear", "--sun", "99,0"], 2, "from -90 to 90"),
        (["clear", "--sun", "-20,0"], 1, "it is night"),
        (["perez", "--sun", "30,0", "--direct", 5], 1, "alone says nothing"),
        (["perez", "--sun", "30,0", "--direct", 5, "--diffuse", 5, "--turbidity", 3], 2, "--turbidity: has no effect"),
        (["clear", "--sun", "30,0", "--grey"], 2, "--grey: has no effect"),
        (["clear", "12", "--sun", "30,0"], 2, "takes no type or file"),
        (["clear", "--sun", "30,0", "--basis", "mf:2"], 2, "--basis: has an effect on matrices only"),
        (["clear", "--sun", "30,0", "-o", "x.doc"], 2, "x.doc: the name of the output ends in .doc"),
        (["clear", "--sun", "30,0", "-o", "x.mtx", "--basis", "klems"], 1, "not known (known: tregenza"),
        (["clear", *ALDRANS[:3], "Mars", *ALDRANS[4:]], 1, "time zone 'Mars'"),
        (["weather", "no.epw", "--time", "02-21 14:00"], 1, "no.epw: no such file"),
        (["weather", "no.epw", "--sun", "30,0"], 2, "light and place are in the file"),
    ],
)
def test_what_makes_no_sense_is_one_line(words, code, message, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    found, out, err = run(capsys, *words)
    assert (found, out) == (code, ""), err
    assert message in err
    assert err.startswith("error: ")
    assert err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []
