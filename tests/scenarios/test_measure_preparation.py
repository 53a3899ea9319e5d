"""A laboratory's afternoon on the command line: check, prepare, calibrate."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest

from clerestory import Basis, Bsdf, Model
from clerestory import read as read_bsdf
from clerestory.cli import main
from clerestory.directions import direction
from clerestory.measure import read, write
from synthetic_lab import diffuse_and_peak, hemisphere, series, twill


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def sphere_file(sample="film", values=(0.5, 0.48, 0.42)):
    rows = "".join(f"{sample},exterior,transmission,{t},visible,{v}\n" for t, v in zip((0, 8, 40), values, strict=True))
    Path("sphere.csv").write_text("sample,side,scatter,theta,band,value\n" + rows)
    return "sphere.csv"


def lab(sample=twill, **options):
    phis = options.pop("phis_deg", (0.0, 90.0))
    measurement = series(sample, thetas_deg=(8.0, 40.0), phis_deg=phis, points=hemisphere(7.5), **options)
    write(measurement, "scans", "mountain")
    return measurement


def test_check_prints_findings_and_tells_errors_by_its_code(here, capsys):
    lab()
    assert main(["measure", "check", "scans"]) == 0
    assert "synthetic (4 scans)" in capsys.readouterr().out
    for file in here.joinpath("scans").iterdir():
        text = file.read_text().splitlines()
        scaled = [line if line.startswith("#") else _times(line, 20.0) for line in text]
        file.write_text("\n".join(scaled) + "\n")
    assert main(["measure", "check", "scans", "--json"]) == 1
    found = json.loads(capsys.readouterr().out)["samples"][0]["findings"]
    assert "energy" in {finding["check"] for finding in found if finding["severity"] == "error"}


def _times(line, factor):
    words = line.split()
    return " ".join([*words[:2], *(str(float(word) * factor) for word in words[2:])]) if words else line


def test_prepare_writes_scans_and_record_and_leaves_what_it_read(here):
    lab()
    before = {file.name: file.read_bytes() for file in here.joinpath("scans").iterdir()}
    assert main(["measure", "prepare", "scans", "--symmetry", "rotational", "-o", "done"]) == 0
    assert {file.name: file.read_bytes() for file in here.joinpath("scans").iterdir()} == before
    made = read("done").measurements[0]
    assert len(made) == 8  # every azimuth and its half turn
    for scan in made.scans:
        truth = twill(scan.incident, scan.outgoing, "transmission")
        np.testing.assert_allclose(scan.values[:, 0], truth, rtol=1e-4)
    record = json.loads(here.joinpath("done.record.json").read_text())
    assert [step["step"] for step in record["steps"]][-1] == "symmetry"


def test_calibrate_a_data_set(here, capsys):
    klems = Basis.named("klems-full")
    Bsdf.from_models({("exterior", "transmission"): Model.matrix(np.full((145, 145), 0.2), klems)}).write("film.xml")
    given = sphere_file()
    assert main(["measure", "calibrate", "film.xml", "--sphere", given]) == 0
    assert "RMS difference" in capsys.readouterr().out
    words = ["measure", "calibrate", "film.xml", "--sphere", given, "-o", "new.bsdf.npz", "--picture", "film.png"]
    assert main(words) == 0
    made = read_bsdf("new.bsdf.npz")
    for theta, value in ((0.0, 0.5), (8.0, 0.48), (40.0, 0.42)):
        assert float(made.integrate(direction(theta, 0.0), "transmission")) == pytest.approx(value, abs=1e-6)
    assert here.joinpath("film.png").stat().st_size > 1000


def test_calibrate_scans(here, capsys):
    lab(diffuse_and_peak, phis_deg=(0.0,))
    given = sphere_file("synthetic")
    assert main(["measure", "calibrate", "scans", "--sphere", given, "-o", "done", "--json"]) == 0
    after = json.loads(capsys.readouterr().out)["after"]
    assert [row["theta_deg"] for row in after] == [8.0, 40.0]
    assert all(abs(row["difference"]) < 1e-9 for row in after)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["prepare", "nowhere", "-o", "x"], "nowhere"),
        (["prepare", "scans", "-o", "x", "--preset", "mars"], "--preset mars"),
        (["prepare", "scans", "-o", "x", "--grazing", "low"], "--grazing"),
        (["prepare", "scans", "-o", "x", "--band", "solar=VIS:0.5"], "sum to 0.5"),
        (["prepare", "scans", "-o", "x", "--band", "solar=VIS"], "--band solar=VIS"),
        (["calibrate", "scans", "--sphere", "scans"], "no values of a sphere"),
        (["calibrate", "scans", "--sphere", "sphere.csv", "--reciprocal", "-o", "x"], "fit a model first"),
        (["calibrate", "scans", "--sphere", "sphere.csv", "--picture", "x.bmp"], "--picture x.bmp"),
        (["check", "nothing.txt"], "nothing.txt"),
    ],
)
def test_what_cannot_be_done_is_said_in_one_line(here, capsys, words, message):
    lab()
    sphere_file("synthetic")
    assert main(["measure", *words]) != 0
    said = capsys.readouterr().err.strip().splitlines()
    assert said[-1].startswith("error: ")
    assert message in said[-1]
    assert not here.joinpath("x").exists()
    assert "Traceback" not in "".join(said)
    assert sys.exc_info() == (None, None, None)
