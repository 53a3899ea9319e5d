"""Checks and reports in a laboratory's database, as the commands of `measure` keep, show, export and remove them."""

import json
import os

import pytest

import laboratory
from clerestory.cli import main
from clerestory.measure.database import Database

DB = ("--db", "lab.sqlite")
PDF = b"%PDF-1.7\n\xff\x00\x01"


@pytest.fixture
def here(tmp_path, monkeypatch):
    """A folder with a database of a sample, and documents of all kinds."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("CLERESTORY_DB", raising=False)
    with Database.open("lab.sqlite", create=True) as database:
        scans = database_scans()
        database.add(laboratory.contents(*scans))
        database.add_model("twill", "m", b"x", scans=scans, file_name="m.bsdf.npz", command="fit")
    (tmp_path / "monthly.pdf").write_bytes(PDF)
    (tmp_path / "page.html").write_text("<!DOCTYPE html><p>fine")
    (tmp_path / "words.txt").write_bytes("Größe".encode("cp1252"))
    (tmp_path / "wide.txt").write_bytes("wide".encode("utf-16"))
    (tmp_path / "picture.png").write_bytes(b"\x89PNG\r\n\x1a\n\0\0")
    (tmp_path / "fake.pdf").write_bytes(b"\x89PNG\r\n\x1a\n\0\0")
    (tmp_path / "text.pdf").write_text("not printed")
    (tmp_path / "empty.txt").write_bytes(b" \n")
    (tmp_path / "folder").mkdir()
    return tmp_path


def database_scans():
    return tuple(laboratory.scan(theta, scatter="transmission", quantity="bsdf") for theta in (0.0, 40.0))


def run(capsys, *words):
    capsys.readouterr()
    code = main(["measure", *(str(word) for word in words)])
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def test_a_check_is_shown_with_its_sample_and_its_run(here, capsys):
    code, out, err = run(capsys, "check", "twill", *DB)
    assert (code, err) == (1, "kept in lab.sqlite as report:1 of twill\n")  # with more light than there was
    head, *findings = out.splitlines()
    tally = head.partition("): ")[2]
    assert "error" in tally
    assert run(capsys, "check", "twill", *DB)[2] == "lab.sqlite has this check already, as report:1 of twill\n"
    for word in ("twill", "run:1"):
        _, out, _ = run(capsys, "show", word, *DB)
        assert sum(line.startswith("  check of ") for line in out.splitlines()) == 1
        assert f": {tally} (report:1)" in out
    _, out, _ = run(capsys, "show", "report:1", *DB)
    assert "of 2 scans, by clerestory" in out
    assert [line.strip() for line in findings] == [line.strip() for line in out.splitlines()[-len(findings) :]]
    told = json.loads(run(capsys, "show", "twill", *DB, "--json")[1])
    assert [finding["severity"] for finding in told["checks"][0]["findings"]].count("error") >= 1
    assert json.loads(run(capsys, "show", "report:1", *DB, "--json")[1])["check"]["scans"] == [1, 2]
    _, out, _ = run(capsys, "list", "checks", "--sample", "twill", *DB)
    assert out.splitlines()[1].split("  ")[-1] == tally
    assert json.loads(run(capsys, "list", "checks", *DB, "--json")[1])[0]["sample"] == "twill"
    assert run(capsys, "remove", "report:1", *DB)[0] == 0
    told = json.loads(run(capsys, "check", "twill", *DB, "--no-keep", "--json")[1])
    assert told["samples"][0]["kept"] is None
    told = json.loads(run(capsys, "check", "twill", *DB, "--json")[1])
    assert told["samples"][0]["kept"]["report"] == 1


def test_findings_are_told_where_they_cannot_be_kept(here, capsys, monkeypatch):
    if os.geteuid() == 0:  # the owner of all may write everywhere
        monkeypatch.setattr(Database, "add_check", _full)
    else:
        (here / "lab.sqlite").chmod(0o444)
    code, out, err = run(capsys, "check", "twill", *DB)
    assert (code, "error" in out) == (1, True)
    assert err.startswith("warning: not kept in the database: ")
    assert len(err.splitlines()) == 1


def _full(*_args, **_kwargs):
    raise OSError(28, "No space left on device")


def test_documents_come_in_and_out_as_they_are(here, capsys):
    code, out, _ = run(capsys, "import", "monthly.pdf", "words.txt", "wide.txt", "--report-on", "twill", *DB)
    assert (code, out.splitlines()[0]) == (
        0, "lab.sqlite: took report 'monthly' (report:1; monthly.pdf) on sample 'twill'"
    )  # fmt: skip
    code, out, _ = run(capsys, "import", "page.html", "--report-on", "model:1", *DB)
    assert "took report 'page' (report:4; page.html) on model 'm' (model:1; m.bsdf.npz)" in out
    told = json.loads(run(capsys, "import", "monthly.pdf", "--report-on", "twill", *DB, "--json")[1])
    assert told["reports"] == [{"file": "monthly.pdf", "report": 1, "new": False}]
    # The same document on something else is another report.
    assert "'monthly 2' (report:5" in run(capsys, "import", "monthly.pdf", "--report-on", "model:1", *DB)[1]
    _, out, _ = run(capsys, "show", "twill", *DB)
    assert [line for line in out.splitlines() if "report" in line] == [
        "    report 'page' (report:4; page.html)",
        "    report 'monthly 2' (report:5; monthly.pdf)",
        "  report 'monthly' (report:1; monthly.pdf)",
        "  report 'words' (report:2; words.txt)",
        "  report 'wide' (report:3; wide.txt)",
    ]
    assert "on sample 'twill'" in run(capsys, "show", "monthly.pdf", *DB)[1]
    assert len(json.loads(run(capsys, "list", "reports", "--sample", "twill", *DB, "--json")[1])) == 5
    assert run(capsys, "export", "report:1", "-o", "out.pdf", *DB)[0] == 0
    assert (here / "out.pdf").read_bytes() == PDF
    assert run(capsys, "export", "report:2", "-o", "folder", *DB)[0] == 0
    assert (here / "folder" / "words.txt").read_bytes() == (here / "words.txt").read_bytes()
    code, _, err = run(capsys, "remove", "model:1", *DB)
    assert (code, "report 'page', 'monthly 2' is on model 1 (remove the report first)" in err) == (1, True)
    assert run(capsys, "remove", "report:1", *DB)[1] == "lab.sqlite: removed report:1\n"
    assert "report:1;" not in run(capsys, "show", "twill", *DB)[1]


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("import", "picture.png", "--report-on", "twill"), "picture.png: neither PDF, HTML nor text"),
        (("import", "fake.pdf", "--report-on", "twill"), "fake.pdf: PDF by its name, something else by its content"),
        (("import", "text.pdf", "--report-on", "twill"), "text.pdf: PDF by its name, text by its content"),
        (("import", "empty.txt", "--report-on", "twill"), "empty.txt: the file is empty"),
        (("import", "folder", "--report-on", "twill"), "folder: a folder, and reports are files"),
        (("import", "monthly.pdf", "none.pdf", "--report-on", "twill"), "none.pdf: no such file or directory"),
        (("import", "monthly.pdf", "fake.pdf", "--report-on", "twill"), "fake.pdf: PDF by its name"),
        (("import", "monthly.pdf", "--report-on", "twil"), "no sample 'twil' (there are: twill)"),
        (("import", "monthly.pdf", "--report-on", "model:7"), "no model 7 (`clerestory measure list models` has"),
        (
            ("import", "monthly.pdf", "--report-on", "twill", "--sample", "x"),
            "--report-on: other options tell of scans",
        ),
        (("import", "monthly.pdf", "--report-on", "twill", "--side", "f"), "--side f: not known"),
        (("import", "monthly.pdf"), "monthly.pdf: no measurement (--report-on SAMPLE keeps it as a report)"),
        (("export", "model:1", "-o", "x.xml"), "x.xml: model:1 is m.bsdf.npz (end the name with .npz, or name a"),
        (("export", "report:1", "-o", "x.pdf"), "no report 1 (`clerestory measure list reports` has them)"),
        (("list", "reports", "--sample", "twil"), "no sample 'twil'"),
        (("remove", "report:1"), "no report 1 (`clerestory measure list reports` has them)"),
    ],
)
def test_wrong_words_in_one_line(here, capsys, words, told):
    code, out, err = run(capsys, *words, *DB)
    assert (code in (1, 2), out) == (True, "")
    assert told in err, err
    assert len(err.splitlines()) == 1
    assert not list(here.glob("x*"))
    with Database.open("lab.sqlite") as database:
        assert database.reports() == []


def test_a_report_needs_a_database(here, capsys):
    code, _, err = run(capsys, "import", "monthly.pdf", "--report-on", "twill", "--db", "new.sqlite")
    assert (code, "new.sqlite: no such database" in err) == (1, True)
    assert not (here / "new.sqlite").exists()
