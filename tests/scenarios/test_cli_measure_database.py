"""`clerestory measure import`, `list`, `show` and `export` as a laboratory uses them."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest

import laboratory
from clerestory import ClerestoryError
from clerestory.cli import main
from clerestory.measure import Measurement, Scan, read, write
from clerestory.measure.contents import Contents
from clerestory.measure.database import Database
from clerestory.measure.given import contents_given, one_sample

CONDITIONS = {"laboratory": "HSLU", "date": "2020-06-24", "instrument": "PG2", "lamp": "halogen"}


def scan(theta_deg: float, phi_deg: float = 90.0, *, points: int = 300) -> Scan:
    numbers = np.random.default_rng(int(theta_deg))
    return Scan(
        "exterior",
        "transmission",
        theta_deg,
        phi_deg,
        np.round(numbers.uniform(0.0, 80.0, points), 3),
        np.round(numbers.uniform(0.0, 360.0, points), 3),
        np.round(numbers.lognormal(-2.0, 1.0, (points, 1)), 6),
        conditions=CONDITIONS,
    )


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A laboratory's folder with the files of a sample."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("CLERESTORY_DB", raising=False)
    write(Measurement("twill", (scan(0.0), scan(20.0), scan(40.0, 0.0))), tmp_path / "twill", "mountain")
    return tmp_path


def run(capsys, *words):
    code = main(["measure", *(str(word) for word in words)])
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def test_from_files_to_a_database_and_back(folder, database_place, capsys):
    db = ("--db", database_place)
    code, out, err = run(capsys, "import", "twill", *db)
    assert (code, err) == (0, "")
    assert "took 3 scans of 900 points from 3 files" in out
    code, out, _ = run(capsys, "import", "twill", *db)
    assert code == 0
    assert "known already, not taken again: twill_" in out
    assert "took" not in out
    code, out, _ = run(capsys, "list", *db)
    assert out.splitlines()[1].split() == ["twill", "–", "3", "900", "0", "0"]
    code, _, err = run(capsys, "export", "twill", "-o", "out", *db)
    assert (code, err) == (0, "wrote 3 files to out\n")
    files = {path.name: path.read_bytes() for path in (folder / "twill").iterdir()}
    assert {path.name: path.read_bytes() for path in (folder / "out").iterdir()} == files


def test_lists_by_filters(folder, capsys):
    run(capsys, "import", "twill")
    run(capsys, "import", "twill", "--replace", "--laboratory", "LBNL", "--date", "2021-01-02", "--sample", "other")
    _, out, _ = run(capsys, "list", "scans", "--incident", "40", "--json")
    (found,) = json.loads(out)
    assert (found["sample"], found["theta_deg"], found["points"], found["laboratory"]) == ("other", 40.0, 300, "LBNL")
    assert run(capsys, "list", "scans", "--incident", "40,90")[1] == "no scans\n"
    assert run(capsys, "list", "scans", "--laboratory", "HSLU")[1] == "no scans\n"
    assert len(run(capsys, "list", "scans", "--date", "2021", "--laboratory", "lbnl")[1].splitlines()) == 4
    for kind in ("runs", "files", "models", "reports", "configurations", "notes", "instruments", "software"):
        code, out, err = run(capsys, "list", kind)
        assert (code, err) == (0, ""), kind
        code, out, _ = run(capsys, "list", kind, "--json")
        assert isinstance(json.loads(out), list)
    assert "PG2" in run(capsys, "list", "instruments", "--find", "hslu")[1]
    assert "Mini-Diff" not in run(capsys, "list", "instruments", "--find", "hslu")[1]


def test_the_catalogue_needs_no_database(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert run(capsys, "list", "software")[0] == 0
    assert list(tmp_path.iterdir()) == []


def test_a_sample_in_words(folder, capsys):
    run(capsys, "import", "twill")
    with Database.open("laboratory.sqlite") as database:
        raw = database.measurement("twill")
        told = {"file_name": "m.bsdf.npz", "command": "clerestory measure fit twill", "settings": {"seed": 1}}
        database.add_model("twill", "m", b"x", scans=raw.scans[:2], **told)
        database.note("sample", 1, "torn at a corner")
    _, out, _ = run(capsys, "show", "twill")
    for part in (
        "transmission of light from the exterior: 3 scans, 900 points",
        "incident θ 0°, 20°, 40°; φ 0°, 90°",
        "run: HSLU, 2020-06-24, PG2, halogen",
        "note: torn at a corner",
        "model 'm' (model:1; m.bsdf.npz), made",
        "of 2 scans",
    ):
        assert part in out, part
    _, out, _ = run(capsys, "show", "2")
    assert "light from the exterior, from above, 20°" in out
    assert out == run(capsys, "show", "scan:2")[1]
    name = next(path.name for path in (folder / "twill").iterdir())
    for word in (name, f"twill/{name}"):
        _, out, _ = run(capsys, "show", word)
        assert "pab Mountain" in out
        assert "#sample_name" in out
    _, out, _ = run(capsys, "show", "model:1")
    for part in ("clerestory measure fit twill", "settings: seed = 1", "1 scan of 300 points", "SHA-256"):
        assert part in out, part
    for word in ("twill", "2", name, "model:1"):
        code, out, _ = run(capsys, "show", word, "--json")
        assert code == 0
        json.loads(out)


def test_a_damaged_file_leaves_the_database_as_it_was(folder, capsys):
    run(capsys, "import", "twill")
    before = run(capsys, "list", "files", "--json")[1]
    more = folder / "more"
    write(Measurement("blind", (scan(10.0), scan(30.0))), more, "mountain")
    last = sorted(more.iterdir())[-1]
    last.write_text(last.read_text()[:-40] + "\nnot a number\n")
    code, out, err = run(capsys, "import", "more")
    assert (code, out) == (1, "")
    assert str(last.relative_to(folder)) in err
    assert len(err.splitlines()) == 1
    assert run(capsys, "list", "files", "--json")[1] == before


def test_ctrl_c_leaves_the_database_as_it_was(folder, capsys, monkeypatch):
    run(capsys, "import", "twill")
    before = run(capsys, "list", "files", "--json")[1]
    write(Measurement("blind", (scan(10.0), scan(30.0))), folder / "more", "mountain")
    add, calls = Database.add, []

    def interrupted(*given, **more):
        calls.append(1)
        if len(calls) == 2:
            raise KeyboardInterrupt
        return add(*given, **more)

    monkeypatch.setattr(Database, "add", interrupted)
    code, out, err = run(capsys, "import", "more")
    assert (code, out, err) == (130, "", "error: interrupted\n")
    assert run(capsys, "list", "files", "--json")[1] == before


def test_a_mixed_folder_and_records(folder, capsys):
    (folder / "twill" / "readme.txt").write_text("measured on a rainy day\n")
    (folder / "twill" / "sample.toml").write_text('[[samples]]\nname = "twill"\nmanufacturer = "MechoShade"\n')
    code, out, err = run(capsys, "import", "twill", "roundrobin")
    assert code == 0
    assert err == "warning: twill/readme.txt: no format of measurements is recognised; left out\n"
    assert "wrote down sample twill" in out
    assert "wrote down sample MechoShade EuroTwill 6216" in out
    assert "manufacturer: MechoShade" in run(capsys, "show", "twill")[1]


@pytest.mark.parametrize(
    ("words", "code", "told"),
    [
        (("list",), 1, "laboratory.sqlite: no such database (make one with `clerestory measure import`"),
        (("import", "nothing.txt"), 1, "nothing.txt: no such file"),
        (("import", "twill", "--date", "yesterday"), 2, "--date yesterday: not a day (give it as 2020-06-24)"),
        (("import", "twill", "--convention", "up"), 2, "--convention up: not known (give clerestory or hslu"),
        (("import", "twill", "--convention", "down=1"), 2, "--convention down=1: not known"),
        (("import", "twill", "--side", "front"), 2, "--side front: not known"),
        (("list", "lamps"), 2, "WHAT lamps: not known"),
        (("list", "runs", "--incident", "3"), 2, "--incident: does not choose among runs (it does among scans)"),
        (("list", "scans", "--incident", "120"), 2, "--incident 120"),
        (("export", "-o", "x"), 2, "of which sample?"),
        (
            ("export", "twill", "-o", "x", "--format", "xml", "--date", "2020"),
            2,
            "--format xml: models are not chosen by",
        ),
        (("export", "twill", "-o", "x", "--format", "pdf"), 2, "--format pdf: not known"),
        (("show", "twill", "--db", "mysql://x/y"), 1, "mysql: not a database that is known"),
    ],
)
def test_wrong_words(folder, capsys, words, code, told):
    found, out, err = run(capsys, *words)
    assert (found, out) == (code, "")
    assert told in err
    assert len(err.splitlines()) == 1
    assert not (folder / "laboratory.sqlite").exists()


def test_words_that_the_database_does_not_know(folder, capsys):
    run(capsys, "import", "twill")
    for words, told in (
        (("show", "twil"), "twil: neither a sample nor a file of laboratory.sqlite"),
        (("show", "99"), "no scan 99"),
        (("show", "model:9"), "no model 9"),
        (("list", "scans", "--sample", "twil"), "no sample 'twil' (there are: twill)"),
        (("export", "twil", "-o", "x"), "no sample 'twil'"),
        (("export", "twill", "-o", "x", "--incident", "70"), "twill: no such scans"),
        (("export", "--format", "xml", "-o", "x"), "no models to publish"),
    ):
        code, out, err = run(capsys, *words)
        assert code in (1, 2)
        assert (out, told in err) == ("", True), words
    (folder / "new.txt").write_text("x")
    assert "not in laboratory.sqlite (take it over" in run(capsys, "show", "new.txt")[2]
    assert not (folder / "x").exists()


def test_what_a_model_stands_on_is_not_replaced(folder, capsys):
    run(capsys, "import", "twill")
    with Database.open("laboratory.sqlite") as database:
        told = {"file_name": "m.bsdf.npz", "command": "fit"}
        database.add_model("twill", "m", b"x", scans=database.measurement("twill").scans, **told)
    code, _, err = run(capsys, "import", "twill", "--replace", "--sample", "other")
    assert code == 1
    assert "model 'm' was made of file 1 (remove the model first)" in err
    assert len(json.loads(run(capsys, "list", "scans", "--sample", "twill", "--json")[1])) == 3


def test_two_importers_at_once(folder, database_place, capsys):
    write(Measurement("blind", (scan(10.0), scan(30.0))), folder / "blind", "mountain")
    with Database.open(database_place, create=True):
        pass
    command = [sys.executable, "-m", "clerestory", "measure", "import", "--db", database_place, "twill"]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    running = [
        subprocess.Popen([*command, *more], env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        for more in ([], ["blind"])
    ]
    for process in running:
        _, err = process.communicate(timeout=60.0)
        assert process.returncode == 0, err
    with Database.open(database_place) as database:
        assert [(sample.name, sample.scans) for sample in database.samples()] == [("blind", 2), ("twill", 3)]
        assert len(database.files()) == 5


def test_what_a_person_gives_to_other_commands(folder, capsys):
    run(capsys, "import", "twill", "--db", "lab.sqlite")
    of_files, of_sample = contents_given(["twill"]), contents_given(["twill"], database="lab.sqlite")
    for there, here in zip(of_sample.measurements[0].scans, of_files.measurements[0].scans, strict=True):
        laboratory.same(there, here)
    # A name that is no file is looked up in the default database.
    (folder / "lab.sqlite").rename(folder / "laboratory.sqlite")
    (folder / "twill").rename(folder / "files")
    assert len(one_sample(contents_given(["twill"]), ["twill"]).scans) == 3
    with pytest.raises(ClerestoryError, match=r"other: neither a file nor a sample of laboratory.sqlite"):
        contents_given(["other"])
    both = contents_given(["twill", "files"])
    assert len(both.measurements[0].scans) == 6
    write(Measurement("blind", (scan(10.0),)), folder / "more", "mountain")
    with pytest.raises(ClerestoryError, match=r"several samples: twill, blind \(name one with --sample\)"):
        one_sample(contents_given(["files", "more"]), ["files", "more"])
    assert len(one_sample(contents_given(["files", "more"]), ["files", "more"], "blind").scans) == 1
    with pytest.raises(ClerestoryError, match=r"no scans of sample 'x' \(there are: twill, blind\)"):
        one_sample(contents_given(["files", "more"]), ["files", "more"], "x")
    with pytest.raises(ClerestoryError, match="nothing to read"):
        contents_given([])
    assert isinstance(read("files"), Contents)


@pytest.mark.parametrize("form", ["mountain", "astm", "csv"])
def test_what_is_exported_can_be_imported(folder, capsys, form):
    run(capsys, "import", "twill")
    code, out, err = run(capsys, "export", "twill", "--format", form, "-o", "out", "--json")
    assert code == 0, err
    assert all((folder / path).is_file() for path in json.loads(out)["written"])
    code, _, err = run(capsys, "import", "out", "--db", "other.sqlite", "--sample", "again")
    assert code == 0, err
    with Database.open("other.sqlite") as database:
        assert {scan.theta_deg for scan in database.stored_scans()} == {0.0, 20.0, 40.0}
