"""`clerestory weather` as a person uses it."""

import json

import pytest

from clerestory.cli import main

HEAD = "place Town\nlatitude 47.3\nlongitude -11.4\ntime_zone -15\nsite_elevation 600\nweather_data_file_units 1\n"


def run(capsys, *words):
    code = main(["weather", *(str(word) for word in words)])
    captured = capsys.readouterr()
    return code, captured.out, captured.err


@pytest.fixture
def town(tmp_path):
    file = tmp_path / "town.wea"
    file.write_text(HEAD + "2 21 13.5 700 120\n2 21 14.5 650 110\n2 21 22.5 0 0\n")
    return file


def test_a_file_is_described(town, capsys):
    code, out, err = run(capsys, town)
    assert code == 0, err
    assert "Town: 47.3° N, 11.4° E, 600 m, UTC+1" in out
    assert "direct normal 1, diffuse horizontal 0, global horizontal 1 kWh/m²" in out
    assert "note: 3 steps of 1 day, not a year" in out
    assert err == ""


def test_json_is_all_that_is_printed(town, capsys):
    code, out, _ = run(capsys, town, "--json")
    assert code == 0
    made = json.loads(out)
    assert made["sums_kwh_m2"]["direct_normal"] == pytest.approx(1.35)
    assert (made["steps"], made["is_year"], made["time_zone"]) == (3, False, 1.0)
    assert [finding["check"] for finding in made["findings"]] == ["gap", "extent", "nights"]


@pytest.mark.parametrize("suffix", ["png", "pdf", "svg", "wea"])
def test_pictures_and_wea_files_are_written(town, tmp_path, capsys, suffix):
    out = tmp_path / f"out.{suffix}"
    code, _, err = run(capsys, town, "-o", out)
    assert code == 0, err
    assert f"wrote {out}" in err
    assert out.stat().st_size > 100
    if suffix == "wea":
        assert out.read_text() == town.read_text()


def test_missing_light_fails_until_it_is_filled(tmp_path, capsys):
    file = tmp_path / "gap.wea"
    file.write_text(HEAD + "2 21 12.5 690 120\n2 21 13.5 9999 120\n2 21 14.5 650 110\n")
    code, out, _ = run(capsys, file)
    assert code == 1
    assert "error: 1 step: 21 February 13:00 to 14:00: direct or diffuse light is missing" in out
    code, out, _ = run(capsys, file, "--fill-hours", 1)
    assert code == 0
    assert "light that was missing was interpolated" in out


def test_a_table_with_columns_of_its_own(tmp_path, capsys):
    file = tmp_path / "roof.csv"
    file.write_text("when,beam,sky\n2021-02-21 14:00,700,120\n")
    words = [file, "--place", "47.3,11.4", "--timezone", 1, "--column", "time=when", "--column", "dni=beam"]
    code, out, err = run(capsys, *words, "--column", "dhi=sky", "--stamp", "begin")
    assert code == 0, err
    assert "roof: 47.3° N" in out


def test_a_synthetic_year(capsys, tmp_path):
    words = ["--synthetic", "--place", "47.3,11.4", "--timezone", 1]
    code, out, err = run(capsys, *words, "-o", tmp_path / "year.wea", "--seed", 3, "--cloudiness", 0.2)
    assert code == 0, err
    assert "synthetic year: cloudiness 0.2, turbidity 3, seed 3" in out
    code, out, _ = run(capsys, tmp_path / "year.wea", "--json")
    assert json.loads(out)["is_year"]


@pytest.mark.parametrize(
    ("words", "said", "code"),
    [
        ([], "the file is missing", 2),
        (["none.epw"], "none.epw: no such file or directory (check the path)", 1),
        (["town.wea", "-o", "town.wea"], "would overwrite an input", 2),
        (["town.wea", "-o", "year"], "has no suffix", 2),
        (["town.wea", "-o", "year.txt"], "ends in .txt, which is not known", 2),
        (["town.wea", "--seed", "1"], "have an effect on a synthetic year only", 2),
        (["town.wea", "--timezone", "1"], "give --place LAT,LON, too", 2),
        (["town.wea", "--place", "1,2"], "the clock is not known", 2),
        (["town.wea", "--column", "dni"], "write dni=NAME", 2),
        (["town.wea", "--column", "dni=x"], "a WEA file says itself where", 1),
        (["--synthetic"], "the place is not known", 2),
        (["town.wea", "--synthetic"], "leave one of them out", 2),
        (["--synthetic", "--place", "1,2", "--timezone", "1", "--fill-hours", "2"], "has no gaps", 2),
        (["--synthetic", "--place", "1,2", "--timezone", "1", "--stamp", "end"], "are of tables", 2),
        (["--synthetic", "--place", "1,2", "--timezone", "1", "--cloudiness", "3"], "cloudiness of 3", 1),
    ],
)
def test_wrong_words(town, capsys, monkeypatch, words, said, code):
    monkeypatch.chdir(town.parent)
    found, out, err = run(capsys, *words)
    assert found == code
    assert said in err
    assert err.startswith("error: ")
    assert err.count("\n") == 1
    assert out == ""
