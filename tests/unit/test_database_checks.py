"""Checks and reports in the laboratory's database: kept once, found by what they are on, gone with what was checked."""

import json
from datetime import UTC, datetime

import pytest
from sqlalchemy import insert, text

import laboratory
from clerestory import ClerestoryError
from clerestory.finding import Finding, tally
from clerestory.measure.database import Database, Origin, connection, location, schema, tables

DRIFT = Finding("warning", "drift", "", "the beam fell by 3 %", "measure again")
ENERGY = Finding("error", "energy", "40°", "more light than there was: 120 %", "find out why")


@pytest.fixture
def database(database_place):
    """A sample with scans of two files and a sphere's values, another sample, and prepared scans."""
    with Database.open(database_place, create=True) as opened:
        scans = (laboratory.scan(0.0), laboratory.scan(40.0), laboratory.scan(60.0, of="b.txt"))
        opened.add(laboratory.contents(*scans, spheres=[laboratory.sphere()]))
        opened.add(laboratory.contents(laboratory.scan(20.0, of="c.txt"), sample="blind"))
        yield opened


def whole(database, sample="twill"):
    return database.origin(database.measurement(sample).scans, database.sphere_values(sample))


def content(database, table):
    with database._reading() as reading:
        return reading.execute(text(f"SELECT count(*) FROM {table}")).scalar()


def test_a_check_is_kept_once_with_what_it_says(database):
    number = database.add_check("twill", [ENERGY, DRIFT], whole(database))
    assert database.add_check("twill", [ENERGY, DRIFT], whole(database)) == number
    other = database.add_check("twill", [DRIFT], whole(database))
    assert other != number
    assert [report.name for report in database.reports()] == ["check of twill", "check of twill 2"]
    first, second = database.checks(sample="twill")
    assert first.findings == (ENERGY, DRIFT)
    assert (first.scans, first.sphere_values, first.models) == ((1, 2, 3), (1,), ())
    assert first.words == f"check of {first.made:%Y-%m-%d %H:%M}: 1 error, 1 warning (report:1)"
    assert tally(second.findings) == "1 warning"
    assert json.loads(database.report_bytes(number))["findings"][0]["what"] == ENERGY.what
    # A check of the same scans without the sphere's values is another one.
    assert database.add_check("twill", [DRIFT], database.origin(database.measurement("twill").scans)) == 3
    nothing = database.add_check("blind", [], whole(database, "blind"))
    assert database.check(nothing).words.endswith(": nothing found (report:4)")


def test_checks_are_found_by_sample_run_and_prepared_scans(database):
    told = {"file_name": "p.txt", "command": "prepare", "kind": "scans"}
    prepared = database.add_model("twill", "p", b"prepared", scans=database.measurement("twill").scans, **told)
    of_raw = database.add_check("twill", [DRIFT], whole(database))
    of_prepared = database.add_check("twill", [], Origin(("twill",), (), (), (prepared,), ()))
    database.add_check("blind", [], whole(database, "blind"))
    assert [check.report for check in database.checks(sample="twill")] == [of_raw, of_prepared]
    assert [check.report for check in database.checks(model=prepared)] == [of_prepared]
    run = database.runs()[0]
    assert database.checks(run=run.id)[0].report == of_raw
    report = database.add_report("r", b"y", file_name="r.pdf", samples=["twill"])
    assert [one.id for one in database.reports(sample="twill")] == [of_raw, of_prepared, report]
    assert database.report(report).samples == ("twill",)
    with pytest.raises(ClerestoryError, match=r"report 'r' \(report:4; r.pdf\) is no check"):
        database.check(report)


def test_a_check_goes_with_what_was_checked_and_keeps_nothing_from_going(database):
    database.add_check("twill", [DRIFT], whole(database))
    database.note("report", 1, "looked at again")
    before = content(database, "blobs")
    database.remove("scan", 2)
    assert (database.reports(), database.notes("report"), content(database, "blobs")) == ([], [], before - 1)
    for subject, number in (("file", database.files(sample="twill")[0].id), ("sample", 1)):
        database.add_check("twill", [DRIFT], whole(database))
        database.add_check("blind", [], whole(database, "blind"))
        database.remove(subject, number)
        assert [report.samples for report in database.reports()] == [("blind",)]
    assert {content(database, name) for name in ("report_sphere_values", "report_models")} == {0}


def test_prepared_scans_go_with_their_checks(database):
    told = {"file_name": "p.txt", "command": "prepare", "kind": "scans"}
    prepared = database.add_model("twill", "p", b"prepared", scans=database.measurement("twill").scans, **told)
    database.add_check("twill", [], Origin(("twill",), (), (), (prepared,), ()))
    database.remove("model", prepared)
    assert (database.reports(), content(database, "blobs")) == ([], 0)


def test_a_check_of_what_is_not_there_is_refused(database):
    stranger = laboratory.scan(10.0, of="d.txt", seed=7)
    with pytest.raises(ClerestoryError, match=r"d\.txt that was checked is not in the database"):
        database.add_check("twill", [], database.origin([stranger]))
    with pytest.raises(ClerestoryError, match="no sample 'twil'"):
        database.add_check("twil", [], whole(database))
    assert database.reports() == []


def test_a_report_on_a_sample(database):
    number = database.add_report("monthly", b"%PDF-1.7", file_name="m.pdf", samples=["twill"])
    assert database.add_report("monthly", b"%PDF-1.7", file_name="m.pdf", samples=["twill"]) == number
    # The same bytes on another sample are another report.
    assert database.add_report("other", b"%PDF-1.7", file_name="m.pdf", samples=["blind"]) != number
    assert database.unused_report_name("monthly") == "monthly 2"
    with pytest.raises(ClerestoryError, match="no sample 'twil'"):
        database.add_report("x", b"x", file_name="x", samples=["twil"])
    with pytest.raises(ClerestoryError, match=r"report 'monthly' is on sample 1 \(remove the report first\)"):
        database.remove("sample", 1)
    assert database.report_bytes(number) == b"%PDF-1.7"
    database.remove("report", number)
    database.remove("sample", 1)


def test_reports_of_an_older_schema_are_still_there(database_place):
    engine = connection._engine(location(database_place))
    with engine.begin() as opened:
        schema.migrate(opened, "3")
        about = {"id": 1, "sha256": "0" * 64, "bytes": 1}
        opened.execute(insert(tables.blobs).values(about))
        row = {"name": "old", "file_name": "old.html", "blob_id": 1, "made": datetime.now(UTC)}
        opened.execute(insert(tables.reports).values(row))
    engine.dispose()
    with Database.open(database_place, upgrade=True) as opened:
        (report,) = opened.reports()
        assert (report.name, report.kind, report.samples) == ("old", "report", ())
