"""A study of a few days from the command line."""

import json
import shutil

import pytest

from clerestory.cli import main
from clerestory.glare import evaluate
from clerestory.picture import Picture
from short_study import ROOM, days

STUDY = """
name = "two panes"
room = "room.toml"
weather = "days.wea"
patches = "reinhart:2"
paths = 1024
[data_sets.clear]
glass = 0.7
[data_sets.dark]
glass = 0.1
"""


@pytest.fixture
def study(tmp_path):
    (tmp_path / "days.wea").write_text(days((20, 21)))
    (tmp_path / "room.toml").write_text(ROOM)
    (tmp_path / "study.toml").write_text(STUDY)
    return tmp_path


def run(*args):
    return main(["annual", *map(str, args)])


def test_a_study(study, capsys):
    out = study / "results"
    assert run(study / "study.toml", "-o", out, "--cache", study / "cache", "--json") == 0
    told = json.loads(capsys.readouterr().out)
    clear, dark = told["data_sets"]
    # Seven times at normal incidence; dark glass swallows more of what comes slanting.
    means = [record["sensors"]["plane"]["mean_illuminance_lx"] for record in (clear, dark)]
    assert 7.0 < means[0] / means[1] < 9.0
    assert clear["views"]["desk"]["dgp_exceeded_5"] > dark["views"]["desk"]["dgp_exceeded_5"]
    assert sum(clear["views"]["desk"]["dgp_classes"].values()) == pytest.approx(1.0)
    import xarray

    with xarray.open_dataset(out / "results.nc") as stored:
        assert stored.illuminance.sizes == {"data_set": 2, "time": 48, "point": 12}
        sunny, grey = stored.dgp.sel(data_set="clear", view="desk").values.reshape(2, 24)[:, 11]
        assert sunny > grey > 0.1
    for name in ("autonomy-plane.png", "dgp-desk.png", "eye-illuminance-desk.png", "plane-clear.csv"):
        assert (out / name).stat().st_size > 500
    # The room's matrices are kept: the same study again gives the same numbers.
    files = {path.name: path.stat().st_mtime_ns for path in (study / "cache").iterdir()}
    assert run(study / "study.toml", "--cache", study / "cache", "--json") == 0
    assert json.loads(capsys.readouterr().out)["data_sets"] == told["data_sets"]
    assert {path.name: path.stat().st_mtime_ns for path in (study / "cache").iterdir()} == files


def test_hours_that_the_weather_lacks_are_named(study, capsys):
    lines = (study / "days.wea").read_text().splitlines(keepends=True)
    lacking = [line for line in lines if not line.startswith("3 20 12.5 ")]
    assert len(lacking) == len(lines) - 1
    (study / "days.wea").write_text("".join(lacking))
    assert run(study / "study.toml", "--cache", study / "cache") == 0
    said = "warning: weather: 1 step: 20 March 12:00 to 13:00: the file has nothing for these daylight hours"
    assert said in capsys.readouterr().err


def test_glare_by_pictures(study, capsys):
    path, out = study / "study.toml", study / "results"
    # A sky of March at noon, and a grey one.
    path.write_text(path.read_text().replace("paths = 1024", 'paths = 1024\nglare = "pictures"\npicture_px = 120'))
    chosen = ("--picture", "03-20 12:00", "--picture", "03-21 12:00")
    assert run(path, "-o", out, "--cache", study / "cache", "--json", *chosen) == 0
    told = json.loads(capsys.readouterr().out)
    names = [f"desk-{name}-03-{day}-1230.hdr" for name in ("clear", "dark") for day in (20, 21)]
    assert sorted(name for name in told["written"] if name.endswith(".hdr")) == sorted(str(out / n) for n in names)
    import xarray

    with xarray.open_dataset(out / "results.nc") as stored:
        for name in names:
            _, data_set, _, day, _ = name.split("-")
            step = 12 + 24 * (int(day) - 20)
            year = stored.sel(data_set=data_set, view="desk").isel(time=step)
            found = evaluate(Picture.read(out / name))
            # A file of four bytes a pixel.
            assert found.vertical_illuminance == pytest.approx(float(year.eye_illuminance), rel=0.01)
            assert found.dgp == pytest.approx(float(year.dgp), abs=0.003)
    assert run(path, "--cache", study / "cache", "--picture", "03-20 12:00") == 2
    assert "--output" in capsys.readouterr().err


def test_a_plan_computes_nothing(study, capsys):
    assert run(study / "study.toml", "--cache", study / "cache", "--dry-run") == 0
    assert "steps: 48" in capsys.readouterr().out
    assert not (study / "cache").exists()


def test_a_full_disk_leaves_nothing(study, capsys, monkeypatch):
    out = study / "results"
    monkeypatch.setattr("shutil.disk_usage", lambda folder: shutil._ntuple_diskusage(2**20, 2**20, 0))
    assert run(study / "study.toml", "-o", out, "--cache", study / "cache") == 1
    assert capsys.readouterr().err == f"error: {out / 'results.nc'}: no space left on device (free some space)\n"
    assert not list(out.iterdir())


def test_critical_moments(study, capsys):
    out = study / "moments"
    assert run(study / "study.toml", "-o", out, "--cache", study / "cache", "--critical", "--json") == 0
    found = json.loads(capsys.readouterr().out)["moments"]
    # Dark glass has none, and neither has the grey day.
    assert {moment["data_set"] for moment in found} == {"clear"}
    for moment in found:
        assert moment["time"].startswith("2001-03-20")
        assert moment["dgp"] >= 0.35
        assert moment["cause"] == "bright"
    assert sum(moment["hours"] for moment in found) >= 3.0
    assert len((out / "moments.csv").read_text().splitlines()) == 1 + len(found)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('weather = "days.wea"', 'weather = "nights.wea"', "nights.wea"),
        ('room = "room.toml"', 'room = "castle"', "castle"),
        ("paths = 1024", "paths = 1000", "paths"),
        ("paths = 1024", 'method = "4-phase"', "method"),
        ("paths = 1024", 'basis = "klems"', "klems-full"),
        ("paths = 1024", 'views = ["sofa"]', "views: there is no view 'sofa'"),
        ("paths = 1024", 'sensors = ["roof"]', "there are no sensors 'roof'"),
        ("glass = 0.1", 'file = "lost.xml"', "lost.xml does not exist"),
        ("paths = 1024", 'views = ["desk"]\nmethod = "3-phase"', "give the method 5-phase"),
    ],
)
def test_faults_are_named(study, capsys, old, new, words):
    path = study / "study.toml"
    path.write_text(path.read_text().replace(old, new))
    assert run(path, "--cache", study / "cache") in (1, 2)
    told = capsys.readouterr().err
    assert told.startswith("error: ")
    assert words in told
    assert told.count("\n") == 1
