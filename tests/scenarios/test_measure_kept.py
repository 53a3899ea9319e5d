"""What `measure fit`, `prepare` and `calibrate` make of a database's scans is kept there, with the way back."""

import json
import os
from dataclasses import replace

import numpy as np
import pytest

import synthetic_lab as lab
from clerestory import read
from clerestory.cli import main
from clerestory.measure import Measurement, write
from clerestory.measure.database import Database

CONDITIONS = {"laboratory": "HSLU", "date": "2020-06-24", "instrument": "PG2", "lamp": "halogen"}
SPHERE = "sample,angle,azimuth,side,scatter,collected,band,value\nfilm,8,0,exterior,T,total,visible,0.4\n"


@pytest.fixture
def here(tmp_path, monkeypatch):
    """A laboratory's folder: a database with scans of a film, a scan of the beam, and a sphere's value."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("CLERESTORY_DB", raising=False)
    scans = lab.series(lab.diffuse_and_peak, thetas_deg=(0.0, 8.0, 40.0, 70.0), phis_deg=(0.0,)).scans
    told = tuple(replace(scan, conditions=CONDITIONS) for scan in scans)
    write(Measurement("film", told), tmp_path / "raw", "mountain")
    (tmp_path / "sphere.csv").write_text(SPHERE)
    assert main(["measure", "import", "raw", "sphere.csv", "--db", "lab.sqlite"]) == 0
    return tmp_path


def run(capsys, *words):
    capsys.readouterr()
    code = main(["measure", *(str(word) for word in words)])
    captured = capsys.readouterr()
    return code, captured.out, captured.err


DB = ("--db", "lab.sqlite")


def test_a_fit_by_the_name_of_a_sample(here, capsys):
    words = ("fit", *DB, "--sample", "film", "-o", "film.bsdf.npz", "--report", "film.html", "--note", "first")
    code, out, err = run(capsys, *words)
    assert (code, "of 4 incident directions" in out) == (0, True)
    assert "kept in lab.sqlite as model 'film' (model:1; film.bsdf.npz) of film" in err
    with Database.open("lab.sqlite") as database:
        model = database.model(1)
        assert database.model_bytes(1) == (here / "film.bsdf.npz").read_bytes()
        assert model.command == ("clerestory measure fit --output film.bsdf.npz --report film.html --sample film")
        assert model.settings["method"] == "transport"
        assert [scan.theta_deg for scan in database.provenance(1).scans] == [0.0, 40.0, 70.0, 8.0]
        assert database.report_bytes(1) == (here / "film.html").read_bytes()
    assert (here / "film.html").read_text().count("<img") == 3
    # The same again is one copy; another fit is another one.
    code, _, err = run(capsys, *words)
    assert "lab.sqlite has it already, byte by byte, as model 'film' (model:1" in err
    code, out, _ = run(capsys, "fit", "film", *DB, "-o", "film.bsdf.npz", "--method", "nearest", "--json")
    assert json.loads(out)["kept"] | {"words": ""} == {
        "database": "lab.sqlite", "model": 2, "new": True, "report": None, "words": ""
    }  # fmt: skip
    _, out, _ = run(capsys, "list", "models", *DB)
    assert [line.split()[1] for line in out.splitlines()[1:]] == ["film", "film"]
    _, out, _ = run(capsys, "show", "model:1", *DB)
    for part in ("step fit: visible, transmission", "run: HSLU", "report 'film' (report:1", "note: first"):
        assert part in out, part
    assert "on model 'film' (model:1" in run(capsys, "show", "report:1", *DB)[1]
    assert run(capsys, "export", "model:1", *DB, "-o", "again.npz")[0] == 0
    assert "scattered" not in run(capsys, "show", "again.npz", *DB)[1]
    assert run(capsys, "show", "again.npz", *DB)[1].startswith("model 'film' (model:1")
    assert run(capsys, "fit", "film", *DB, "-o", "film.bsdf.npz", "--no-keep")[2].count("kept") == 0


def test_files_are_kept_only_where_a_database_is_named_and_has_them(here, capsys):
    code, _, err = run(capsys, "fit", "raw", "-o", "film.bsdf.npz")
    assert (code, "kept" in err) == (0, False)
    code, _, err = run(capsys, "fit", "raw", "-o", "film.bsdf.npz", *DB)
    assert (code, "model:1" in err) == (0, True)
    scans = lab.series(lab.diffuse_and_peak, thetas_deg=(0.0, 20.0, 60.0), phis_deg=(0.0,)).scans
    write(Measurement("new", scans), here / "new", "mountain")
    code, _, err = run(capsys, "fit", "new", "-o", "new.bsdf.npz", *DB)
    assert code == 0
    assert "note: not kept in lab.sqlite, which does not have synthetic" in err or "does not have new_" in err


def test_from_raw_scans_to_a_calibrated_model(here, capsys):
    code, _, err = run(capsys, "prepare", "film", *DB, "--symmetry", "none", "-o", "prepared")
    assert (code, "as prepared scans 'film prepared' (model:1; prepared.zip) of film" in err) == (0, True)
    code, _, err = run(capsys, "fit", "prepared", *DB, "-o", "film.bsdf.npz")
    assert (code, "(model:2; film.bsdf.npz)" in err) == (0, True)
    read("film.bsdf.npz").to_matrix("klems-quarter").write("film.xml")
    code, _, err = run(capsys, "calibrate", "film.xml", "--sphere", "film", *DB, "-o", "better.xml")
    assert (code, "note: not kept in lab.sqlite, which does not have film.xml" in err) == (0, True)
    code, _, err = run(capsys, "fit", "prepared", *DB, "-o", "patches.xml", "--basis", "klems-quarter")
    code, _, err = run(capsys, "calibrate", "patches.xml", "--sphere", "film", *DB, "-o", "better.xml")
    assert (code, "as model 'better' (model:4; better.xml) of film" in err) == (0, True)
    with Database.open("lab.sqlite") as database:
        found = database.provenance(4)
        assert found.model.parents == (3,)
        assert {file.name for file in found.files} == {p.name for p in (here / "raw").iterdir()} | {"sphere.csv"}
        assert len(found.scans) == 4
        assert len(found.sphere_values) == 1
        toward = np.array([-np.sin(np.radians(8.0)), 0.0, -np.cos(np.radians(8.0))])
        assert float(read(here / "better.xml").integrate(toward, "transmission")) == pytest.approx(0.4, rel=1e-3)
    code, _, err = run(capsys, "calibrate", "film", "--sphere", "film", *DB, "-o", "scaled")
    assert (code, "prepared scans 'film calibrated' (model:5; scaled.zip)" in err) == (0, True)
    assert run(capsys, "export", "model:1", "-o", "again", *DB)[0] == 0
    assert {p.name: p.read_bytes() for p in (here / "again").iterdir()} == {
        p.name: p.read_bytes() for p in (here / "prepared").iterdir()
    }
    code, _, err = run(capsys, "remove", "model:1", *DB)
    assert (code, "was made of model 1 (remove the model first)" in err) == (1, True)
    for number in (4, 2, 3, 1):
        assert run(capsys, "remove", f"model:{number}", *DB)[0] == 0


def test_a_sphere_with_names_of_its_own_and_a_picture_in_capitals(here, capsys):
    (here / "own.csv").write_text(SPHERE.replace("value", "Messwert"))
    words = ("calibrate", "raw", "--sphere", "own.csv", "--picture", "MAP.PNG")
    code, _, err = run(capsys, *words)
    assert (code, "such as --column value=Messwert)" in err) == (1, True)
    code, out, err = run(capsys, *words, "--column", "value=Messwert", "--column", "phi=Drehung")
    assert (code, "0.4000" in out) == (0, True)
    assert "warning: own.csv: there is no column 'Drehung' (it has: sample, angle," in err
    assert (here / "MAP.PNG").read_bytes().startswith(b"\x89PNG")


def test_what_is_there_is_shown(here, capsys):
    _, out, _ = run(capsys, "list", "spheres", *DB)
    assert "exterior  transmission  hemispherical  θ 8°, φ 0°  visible" in out
    assert "visible: 0.4" in run(capsys, "show", "sphere:1", *DB)[1]
    _, out, _ = run(capsys, "show", "run:1", *DB)
    assert "laboratory: HSLU" in out
    assert "film: 4 scans" in out
    assert "lamp: halogen" in run(capsys, "show", "configuration:1", *DB)[1]
    assert run(capsys, "note", "film", "torn", "--author", "Jo", *DB)[0] == 0
    assert run(capsys, "note", "run:1", "lamp changed", *DB)[0] == 0
    assert "note: torn (Jo)" in run(capsys, "show", "film", *DB)[1]
    assert "note: lamp changed" in run(capsys, "show", "run:1", *DB)[1]
    for word in ("run:1", "sphere:1", "configuration:1", "scan:1", "file:1", "sample:1"):
        code, out, _ = run(capsys, "show", word, *DB, "--json")
        assert code == 0
        json.loads(out)
    beam = replace(lab.scan(lab.diffuse_and_peak, 0.0, 0.0), purpose="beam", quantity="signal")
    with Database.open("lab.sqlite") as database:
        from clerestory.measure.contents import Contents

        database.add(Contents((Measurement("film", (beam,)),)))
        number = database.stored_scans(purpose="beam")[0].id
    assert "profile of visible: centre at θ" in run(capsys, "show", f"scan:{number}", *DB)[1]


@pytest.mark.parametrize(
    ("name", "phi_deg", "words"),
    [
        ("window", 0.0, "those of the light's way"),
        ("hslu", 90.0, "up is azimuth 0°"),
        ("pab-up-90", 0.0, "up is azimuth 90°"),
    ],
)
def test_a_laboratorys_convention_at_import(here, capsys, name, phi_deg, words):
    """Light at the file's azimuth of 180° for WINDOW, 0° for HSLU, 180° for pab with up at 90°."""
    azimuth = {"window": 180, "hslu": 0, "pab-up-90": 180}[name]
    (here / "t.csv").write_text(f"theta_i,phi_i,theta_o,phi_o,bsdf\n40,{azimuth},30,90,1\n40,{azimuth},20,90,2\n")
    code, _, _ = run(capsys, "import", "t.csv", "--scatter", "T", "--convention", name, *DB)
    assert code == 0
    with Database.open("lab.sqlite") as database:
        (scan,) = database.measurement("t").scans
    assert scan.incident_phi_deg == pytest.approx(phi_deg)
    assert scan.source.convention.startswith(f"{name} (as a person said)")
    assert words in scan.source.convention
    assert name in run(capsys, "list", "files", *DB)[1]
    assert f"convention = {name}" in run(capsys, "show", "t.csv", *DB)[1]


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("fit", "-o", "x.xml"), "nothing to read (give files or folders, or --sample NAME of the database)"),
        (("fit", "--sample", "flim", "-o", "x.xml", *DB), "flim: neither a file nor a sample of lab.sqlite"),
        (("fit", "film", "-o", "x.xml", *DB, "--side", "interior"), "side cannot be said of what is in the database"),
        (("fit", "film", "-o", "x.xml", *DB, "--laboratory", "LBNL"), "no scan of 'film' by LBNL (`clerestory measure"),
        (("fit", "raw", "-o", "x.xml", "--date", "2020"), "--laboratory and --date choose scans of the database"),
        (("fit", "film", "-o", "x.xml", "--report", "x.doc", *DB), "--report x.doc: not a kind of report"),
        (("fit", "film", "-o", "x.xml"), "film: no such file or folder (nor is there a database laboratory.sqlite"),
        (("prepare", "raw", "-o", "raw"), "raw: the output would overwrite an input"),
        (("calibrate", "raw", "--sphere", "sphere.csv", "-o", "raw"), "raw: the output would overwrite an input"),
        (("show", "model:9", *DB), "no model 9"),
        (("show", "run:9", *DB), "no run 9 (`clerestory measure list runs` has them)"),
        (("note", "film", " ", *DB), "TEXT: nothing is said"),
        (("note", "lamp:1", "x", *DB), "lamp:1: not something to write a note on (give sample:N, instrument:N"),
        (("remove", "run:1", *DB), "run:1: not something to remove (give file:N, scan:N, model:N, report:N"),
        (("export", "model:1", "-o", "x", "--date", "2020", *DB), "choose scans (leave them out)"),
        (
            ("calibrate", "film", "--sphere", "film", "--picture", "x.doc", *DB),
            "--picture x.doc: not a kind of picture",
        ),
        (("calibrate", "film", "--sphere", "x.csv", *DB), "x.csv: neither a file nor a sample of lab.sqlite"),
        (("import", "raw", "--convention", "epfl", *DB), "--convention epfl: not known (give clerestory or hslu"),
    ],
)
def test_wrong_words_in_one_line(here, capsys, words, told):
    code, out, err = run(capsys, *words)
    assert (code in (1, 2), out) == (True, "")
    assert told in err, err
    assert len(err.splitlines()) == 1
    assert not list(here.glob("x*"))


def test_what_cannot_be_kept_leaves_its_files(here, capsys, monkeypatch):
    if os.geteuid() == 0:  # the owner of all may write everywhere
        monkeypatch.setattr(Database, "add_model", _full)
    else:
        (here / "lab.sqlite").chmod(0o444)
    code, _, err = run(capsys, "fit", "film", *DB, "-o", "film.bsdf.npz")
    assert code == 1
    assert "film.bsdf.npz: written, but not kept in the database: " in err
    assert (here / "film.bsdf.npz").exists()


def _full(*_given, **_more):
    import errno

    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
