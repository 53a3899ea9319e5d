"""The laboratory's database, over a SQLite file and a PostgreSQL server alike."""

import dataclasses
import sqlite3
import threading

import numpy as np
import pytest
import sqlalchemy
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext

import laboratory
from clerestory import ClerestoryError
from clerestory.measure import Measurement
from clerestory.measure.contents import Contents
from clerestory.measure.database import Database, connection, location, schema
from clerestory.measure.database.tables import metadata


@pytest.fixture
def database(database_place):
    with Database.open(database_place, create=True) as opened:
        yield opened


def test_scans_come_back_as_they_were(database):
    scans = (
        laboratory.scan(0.0),
        laboratory.scan(40.0, points=70_000),  # more than a chunk
        laboratory.scan(60.0, points=0),
        laboratory.scan(10.0, purpose="beam", standard_errors=None, quantity="signal"),
        laboratory.scan(10.0, purpose="dark", of=None),
    )
    database.add(laboratory.contents(*scans, warnings=("the date is odd",)))
    found = database.measurement("twill")
    assert found.warnings == ("the date is odd",)
    assert len(found.scans) == 5
    for there, here in zip(found.scans, scans, strict=True):
        laboratory.same(there, here)


def test_sphere_values_come_back_as_they_were(database):
    diffuse = dataclasses.replace(
        laboratory.sphere(),
        theta_deg=float("nan"),
        wavelength_nm=None,
        bands=("visible", "solar"),
        values=np.array([0.25, 1.0 / 3.0]),
        standard_errors=np.array([0.01, 0.02]),
    )
    given = [laboratory.sphere(), diffuse]
    database.add(laboratory.contents(spheres=given))
    found = database.sphere_values("twill")
    for there, here in zip(found, given, strict=True):
        assert there.values.tobytes() == here.values.tobytes()
        assert (there.bands, there.source, there.collected) == (here.bands, here.source, here.collected)
        assert (there.wavelength_nm is None) == (here.wavelength_nm is None)
        np.testing.assert_array_equal(there.theta_deg, here.theta_deg)
    np.testing.assert_array_equal(found[1].standard_errors, diffuse.standard_errors)
    assert database.contents("twill").measurements == ()


def test_the_same_file_twice_is_one_copy(database):
    given = laboratory.contents(laboratory.scan(0.0), laboratory.scan(40.0), spheres=[laboratory.sphere()])
    first, second = database.add(given), database.add(given)
    assert (first.files, first.scans, first.sphere_values) == (["a.txt", "sphere.csv"], 2, 1)
    assert (second.files, second.scans, second.sphere_values) == ([], 0, 0)
    assert second.known == ["a.txt", "sphere.csv"]
    assert len(database.measurement("twill").scans) == 2


def test_the_same_scan_under_another_header_is_one_copy(database):
    database.add(laboratory.contents(laboratory.scan()))
    again = database.add(laboratory.contents(laboratory.scan(of="copy.txt")))
    assert again.scans == 0
    assert again.known == ["scan of twill that came with a.txt"]
    assert database.add(laboratory.contents(laboratory.scan(of=None))).scans == 0


def test_equal_scans_of_one_file_are_both_kept(database):
    database.add(laboratory.contents(laboratory.scan(purpose="beam"), laboratory.scan(purpose="beam")))
    assert len(database.stored_scans(purpose="beam")) == 2


def test_a_file_is_kept_with_all_that_is_known_of_it(database, tmp_path):
    path = tmp_path / "a.txt"
    path.write_bytes(b"a.txt")  # what its hash was made of
    database.add(laboratory.contents(laboratory.scan()), choices={"convention": "hslu", "side": None}, originals=[path])
    (file,) = database.files()
    assert (file.name, file.header, file.kept) == ("a.txt", laboratory.source("a.txt").header, True)
    assert file.choices == {"convention": "hslu"}
    assert database.file_bytes(file.id) == b"a.txt"


def test_what_a_person_says_goes_before_what_files_say(database):
    said = {"laboratory": "LBNL", "operator": "Jo", "date": "2021-02-03"}
    database.add(laboratory.contents(laboratory.scan()), sample="EuroTwill", conditions=said)
    (run,) = database.runs()
    assert (run.laboratory, run.operator, run.date, run.instrument, run.scans) == ("LBNL", "Jo", "2021-02-03", "PG2", 1)
    assert [sample.name for sample in database.samples()] == ["EuroTwill"]
    assert database.sample("EuroTwill").manufacturer == "MechoShade"


def test_runs_are_days_of_a_configuration(database):
    database.add(
        laboratory.contents(
            laboratory.scan(0.0),
            laboratory.scan(10.0, conditions={"laboratory": "HSLU", "date": "2020-06-01T18:00", "lamp": "xenon"}),
            laboratory.scan(20.0, conditions={"laboratory": "HSLU", "date": "2020-06-02"}),
        )
    )
    assert [(run.date, run.instrument) for run in database.runs()] == [
        ("2020-06-01", "PG2"),
        ("2020-06-01", "not named"),
        ("2020-06-02", None),
    ]
    assert [c.lamp for c in database.configurations()] == ["halogen", "xenon"] or len(database.configurations()) == 2
    assert len(database.runs(date="2020-06-01")) == 2
    assert database.runs(laboratory="hslu", date="2020-07") == []


def test_scans_are_found_by_what_they_are(database):
    database.add(
        laboratory.contents(
            laboratory.scan(0.0, phi_deg=45.0),
            laboratory.scan(40.0, phi_deg=359.8),
            laboratory.scan(40.0, phi_deg=90.0, scatter="reflection"),
            laboratory.scan(40.2, phi_deg=90.0, purpose="beam"),
        )
    )
    database.add(laboratory.contents(laboratory.scan(40.0, of="b.txt", seed=2), sample="blind"))

    def thetas(**wanted) -> list[float]:
        return [scan.theta_deg for scan in database.stored_scans(**wanted)]

    assert thetas(sample="twill") == [0.0, 40.0, 40.0, 40.2]
    assert thetas(sample="twill", theta_deg=40.0) == [40.0, 40.0, 40.2]
    assert thetas(theta_deg=40.0, phi_deg=0.0) == [40.0]
    assert thetas(theta_deg=0.0, phi_deg=180.0) == [0.0]
    assert thetas(scatter="reflection") == [40.0]
    assert thetas(purpose="beam", laboratory="HSLU") == [40.2]
    assert thetas(laboratory="EPFL") == []
    assert thetas(date="2020-0%") == []
    assert len(database.measurement("twill", theta_deg=40.0, phi_deg=90.0).scans) == 2


def test_the_summary_of_a_scan_is_that_of_its_points(database):
    scan = laboratory.scan(40.0)
    database.add(laboratory.contents(scan))
    (stored,) = database.stored_scans()
    peak = int(np.argmax(scan.values[:, 0]))
    assert (stored.value_min, stored.value_max) == (scan.values[:, 0].min(), scan.values[:, 0].max())
    assert (stored.peak_theta_deg, stored.peak_phi_deg) == (scan.theta_deg[peak], scan.phi_deg[peak])
    assert stored.outgoing_theta_max_deg == scan.theta_deg.max()
    assert stored.incident_words == "from above, 40°"


def test_a_model_leads_back_to_its_raw_points(database):
    database.add(laboratory.contents(laboratory.scan(0.0), laboratory.scan(40.0), spheres=[laboratory.sphere()]))
    database.add(laboratory.contents(laboratory.scan(60.0, of="b.txt")))
    raw = database.measurement("twill")
    spheres = database.sphere_values("twill")
    settings = {"resolution": 12, "extrapolation": "clamped"}
    number = database.add_model(
        "twill",
        "first",
        b"model" * 1000,
        file_name="twill.bsdf.npz",
        scans=raw.scans[:2],
        sphere_values=spheres,
        command="clerestory measure fit twill",
        settings=settings,
    )
    found = database.provenance(number)
    assert [file.name for file in found.files] == ["a.txt", "sphere.csv"]
    assert found.model.settings == settings
    assert [run.laboratory for run in found.runs] == ["HSLU", None]
    for stored, scan in zip(found.scans, raw.scans[:2], strict=True):
        laboratory.same(database.scan(stored.id), scan)
    text = "\n".join(found.lines())
    for part in (
        "'first'",
        "clerestory measure fit twill",
        "resolution = 12",
        "a.txt",
        "2 scans of 1000 points",
        "HSLU",
    ):
        assert part in text
    assert database.model_bytes(number) == b"model" * 1000
    report = database.add_report("monthly", b"<html>", file_name="m.html", models=[number])
    assert database.reports()[0].models == ("first",)
    assert database.report_bytes(report) == b"<html>"


def test_a_model_of_what_is_not_there_is_refused_whole(database):
    database.add(laboratory.contents(laboratory.scan()))
    prepared = dataclasses.replace(laboratory.scan().as_bsdf(), source=None)  # which no file tells of
    told = {"file_name": "x.bsdf.npz", "command": "fit"}
    with pytest.raises(ClerestoryError, match=r"not in the database \(import its file first"):
        database.add_model("twill", "m", b"x", scans=[prepared], **told)
    with pytest.raises(ClerestoryError, match="what it was made of"):
        database.add_model("twill", "m", b"x", scans=[], **told)
    with pytest.raises(ClerestoryError, match=r"no sample 'twil' \(there are: twill\)"):
        database.add_model("twil", "m", b"x", scans=[laboratory.scan()], **told)
    assert database.models() == []
    database.add_model("twill", "m", b"x", scans=[laboratory.scan()], **told)
    with pytest.raises(ClerestoryError, match="choose another name"):
        database.add_model("twill", "m", b"another", scans=[laboratory.scan()], **told)
    assert database.unused_name("twill", "m") == "m 2"


def test_the_same_model_twice_is_one_copy(database):
    database.add(laboratory.contents(laboratory.scan()))
    told = {"file_name": "x.bsdf.npz", "command": "fit", "scans": [laboratory.scan()]}
    number = database.add_model("twill", "m", b"x", **told)
    assert database.add_model("twill", "m 2", b"x", **told) == number
    assert len(database.models()) == 1
    report = database.add_report("r", b"y", file_name="r.html", models=[number])
    assert database.add_report("r 2", b"y", file_name="r.html", models=[number]) == report
    with pytest.raises(ClerestoryError, match="there is a report 'r'"):
        database.add_report("r", b"z", file_name="r.html", models=[number])


def test_measured_values_are_found_again(database):
    scans = (laboratory.scan(0.0), laboratory.scan(40.0), laboratory.scan(60.0, of="b.txt"))
    database.add(laboratory.contents(*scans, spheres=[laboratory.sphere()]), conditions={"operator": "Jo"})
    # What a person said at the import changed what the scans hold; the file still tells.
    found = database.origin([scans[1], scans[2]], [laboratory.sphere()])
    assert (found.samples, found.scans, found.sphere_values) == (("twill",), (2, 3), (1,))
    raw = database.measurement("twill").scans
    assert database.origin([dataclasses.replace(raw[0], source=None)]).scans == (1,)
    stranger = laboratory.scan(10.0, of="c.txt", seed=7)
    assert database.origin([stranger, raw[0]]).unknown == ("c.txt",)


def test_a_model_of_prepared_scans_leads_back_to_the_raw_ones(database):
    database.add(laboratory.contents(laboratory.scan(0.0), laboratory.scan(40.0), spheres=[laboratory.sphere()]))
    raw = database.measurement("twill").scans
    written = laboratory.source("prepared.txt")
    prepared = database.add_model(
        "twill",
        "prepared",
        b"zip",
        file_name="prepared.zip",
        scans=raw,
        command="prepare",
        kind="scans",
        steps=[{"step": "noise", "what": "all are kept", "warnings": ["few points"]}],
        files={written.name: written.sha256},
    )
    assert database.made_as(written.sha256) == prepared
    read = [dataclasses.replace(laboratory.scan(0.0, seed=9), source=written)]
    assert database.origin(read).parents == (prepared,)
    model = database.add_model(
        "twill",
        "m",
        b"x",
        file_name="x.xml",
        scans=read,
        sphere_values=database.sphere_values("twill"),
        command="calibrate",
    )
    found = database.provenance(model)
    assert [scan.id for scan in found.scans] == [1, 2]
    assert len(found.sphere_values) == 1
    assert found.model.parents == (prepared,)
    assert database.provenance(prepared).model.steps[0]["step"] == "noise"
    text = "\n".join(database.provenance(prepared).lines())
    assert "step noise: all are kept" in text
    assert "warning: few points" in text
    with pytest.raises(ClerestoryError, match=f"model 'm' was made of model {prepared}"):
        database.remove("model", prepared)
    database.remove("model", model)
    database.remove("model", prepared)


def test_nothing_is_removed_under_a_model(database):
    database.add(laboratory.contents(laboratory.scan(), warnings=("odd",), spheres=[laboratory.sphere()]))
    scans, spheres = database.measurement("twill").scans, database.sphere_values("twill")
    told = {"file_name": "x.bsdf.npz", "command": "fit"}
    number = database.add_model("twill", "m", b"x", scans=scans, sphere_values=spheres, **told)
    report = database.add_report("r", b"y", file_name="r.html", models=[number])
    for subject in ("sample", "file", "scan"):
        with pytest.raises(ClerestoryError, match=f"model 'm' was made of {subject} 1 \\(remove the model first"):
            database.remove(subject, 1)
    with pytest.raises(ClerestoryError, match="report 'r' is on model 1"):
        database.remove("model", number)
    database.remove("report", report)
    database.remove("model", number)
    database.remove("scan", 1)
    assert [file.name for file in database.files()] == ["sphere.csv"]
    assert database.notes("file") == []
    database.remove("sample", 1)
    assert (database.samples(), database.files(), database.runs()) == ([], [], [])
    with database._reading() as reading:  # every piece of content went with its owner
        assert reading.execute(sqlalchemy.text("SELECT count(*) FROM blobs")).scalar() == 0
        assert reading.execute(sqlalchemy.text("SELECT count(*) FROM chunks")).scalar() == 0
    with pytest.raises(ClerestoryError, match="no sample 1"):
        database.remove("sample", 1)
    with pytest.raises(ClerestoryError, match="goes with its scans"):
        database.remove("run", 1)


def test_notes_on_anything(database):
    database.add(laboratory.contents(laboratory.scan()))
    database.note("sample", 1, "torn at a corner", author="Jo")
    database.note("run", 1, "lamp changed")
    assert [(n.subject, n.text, n.author) for n in database.notes()] == [
        ("sample", "torn at a corner", "Jo"),
        ("run", "lamp changed", None),
    ]
    assert database.measurement("twill").warnings == ()  # a note is no warning
    with pytest.raises(ClerestoryError, match="no model 7"):
        database.note("model", 7, "?")
    with pytest.raises(ClerestoryError, match="nothing is called 'lamp'"):
        database.note("lamp", 7, "?")


def test_words_about_samples_and_instruments(database):
    number = database.describe_sample(
        "twill", structure_period_mm=0.9, symmetry="rotation of order 2", pictures=["front.jpg", "twill.dxf"]
    )
    database.describe_sample("twill", manufacturer="MechoShade")
    sample = database.sample("twill")
    assert (sample.id, sample.structure_period_mm, sample.manufacturer) == (number, 0.9, "MechoShade")
    assert sample.pictures == ("front.jpg", "twill.dxf")
    spectrum = (np.arange(380.0, 781.0, 10.0), np.linspace(0.1, 1.0, 41))
    configuration = database.describe_configuration(
        "PG2", "halogen", kind="scanning", lamp_spectrum=spectrum, spot_mm=12.0
    )
    assert database.configurations()[0].spot_mm == 12.0
    np.testing.assert_array_equal(database.lamp_spectrum(configuration), spectrum)
    with pytest.raises(ClerestoryError, match="a sample has no 'colour'"):
        database.describe_sample("twill", colour="slate")
    with pytest.raises(ClerestoryError, match="not a size"):
        database.describe_sample("twill", width_mm=-3.0)


def test_what_fails_half_way_leaves_nothing(database):
    database.add(laboratory.contents(laboratory.scan()))

    def fails():
        with database.transaction():
            database.add(laboratory.contents(laboratory.scan(of="b.txt", seed=2), sample="blind"))
            assert len(database.samples()) == 2
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fails()
    assert [sample.name for sample in database.samples()] == ["twill"]
    assert [file.name for file in database.files()] == ["a.txt"]
    assert database.add(laboratory.contents(laboratory.scan(of="b.txt", seed=2))).scans == 1


def test_one_who_writes_waits_for_another(database, database_place):
    waited, errors = threading.Event(), []

    def second():
        try:
            with Database.open(database_place) as other, other.transaction(waiting=waited.set):
                other.add(laboratory.contents(laboratory.scan(of="b.txt", seed=2)))
                other.add(laboratory.contents(laboratory.scan()))  # which the first has by then
        except BaseException as error:
            errors.append(error)

    thread = threading.Thread(target=second)
    with database.transaction():
        thread.start()
        assert waited.wait(30.0)
        with Database.open(database_place) as reader:  # who reads does not wait, and sees what was
            assert reader.samples() == []
        database.add(laboratory.contents(laboratory.scan()))
    thread.join(30.0)
    assert errors == []
    assert [file.name for file in database.files()] == ["a.txt", "b.txt"]
    assert len(database.measurement("twill").scans) == 2


def test_waiting_has_an_end(database, database_place, monkeypatch):
    monkeypatch.setattr(connection, "WAIT_S", 0.1)
    told = pytest.raises(ClerestoryError, match=r"another program has been writing .* \(let it end, or end it\)")
    with database.transaction(), Database.open(database_place) as other, told:
        other.describe_sample("twill")


def test_migrations_lead_to_the_tables(database):
    with database._reading() as reading:
        context = MigrationContext.configure(reading, opts={"version_table": schema.VERSION_TABLE})
        assert compare_metadata(context, metadata) == []


def older(place: str) -> None:
    """A database of the first version, with a scan in it."""
    engine = connection._engine(location(place))
    with engine.begin() as opened:
        schema.migrate(opened, "1")
    engine.dispose()


def test_an_older_schema_is_brought_up_to_date_on_request(database_place):
    older(database_place)
    with pytest.raises(ClerestoryError, match=r"its schema, 1, is older than this program's, 4 \(keep a copy"):
        Database.open(database_place)
    with Database.open(database_place, upgrade=True) as opened:
        opened.add(laboratory.contents(laboratory.scan()))
        assert opened.models() == []
    with Database.open(database_place) as opened:
        assert len(opened.measurement("twill").scans) == 1


def test_a_newer_schema_is_refused(database, database_place):
    with database.transaction():
        database._connection.execute(sqlalchemy.text("UPDATE clerestory_schema SET version_num = '999'"))
    with pytest.raises(ClerestoryError, match=r"its schema, 999, is of a newer Clerestory \(update this program"):
        Database.open(database_place, create=True, upgrade=True)


def test_tables_of_something_else_are_left_alone(database_place):
    engine = connection._engine(location(database_place))
    with engine.begin() as opened:
        opened.execute(sqlalchemy.text("CREATE TABLE invoices (id INTEGER)"))
    with pytest.raises(ClerestoryError, match="holds tables of something else, such as 'invoices'"):
        Database.open(database_place, create=True)
    with engine.connect() as opened:
        assert sqlalchemy.inspect(opened).get_table_names() == ["invoices"]
    engine.dispose()


def test_damaged_points_are_named(database):
    database.add(laboratory.contents(laboratory.scan()))
    with database.transaction():
        database._connection.execute(sqlalchemy.text("DELETE FROM chunks"))
    with pytest.raises(ClerestoryError, match="0 of 500 points are stored"):
        database.measurement("twill")


def test_places_that_cannot_be(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("CLERESTORY_DB", raising=False)
    with pytest.raises(ClerestoryError, match=r"laboratory.sqlite: no such database \(make one with"):
        Database.open()
    assert list(tmp_path.iterdir()) == []
    (tmp_path / "text.sqlite").write_text("this is no database, whatever its name says" * 100)
    with pytest.raises(
        ClerestoryError, match=r"text.sqlite: file is not a database \(give a file that Clerestory made"
    ):
        Database.open("text.sqlite", create=True)
    with pytest.raises(ClerestoryError, match="a folder, not a database"):
        Database.open(tmp_path, create=True)
    with pytest.raises(ClerestoryError, match=r"folder .* does not exist"):
        Database.open(tmp_path / "none" / "lab.sqlite", create=True)
    with pytest.raises(ClerestoryError, match="mysql: not a database that is known"):
        Database.open("mysql://somewhere/lab")
    with pytest.raises(ClerestoryError, match="address cannot be understood"):
        Database.open("postgresql://host:port/lab")
    with pytest.raises(ClerestoryError, match=r"postgresql.*\*\*\*.*\(check the address"):
        Database.open(f"postgresql://me:secret@/lab?host={tmp_path}")
    monkeypatch.setenv("CLERESTORY_DB", str(tmp_path / "other.sqlite"))
    with Database.open(create=True) as opened:
        assert str(opened.location) == str(tmp_path / "other.sqlite")


def test_a_closed_database_is_one_file(tmp_path):
    with Database.open(tmp_path / "lab.sqlite", create=True) as opened:
        opened.add(laboratory.contents(laboratory.scan()))
    assert [path.name for path in tmp_path.iterdir()] == ["lab.sqlite"]
    with sqlite3.connect(tmp_path / "lab.sqlite") as plain:
        assert plain.execute("SELECT name FROM samples").fetchall() == [("twill",)]
    plain.close()


def test_contents_of_several_samples(database):
    both = Contents(
        (Measurement("a", (laboratory.scan(),)), Measurement("b", (laboratory.scan(of="b.txt", seed=2),))),
        warnings=("b.txt: odd",),
    )
    added = database.add(both)
    assert added.samples == ["a", "b"]
    assert added.warnings == ["b.txt: odd"]


def test_files_that_tell_of_another_sample_of_that_name_are_odd(database):
    def thick(name: str, millimetres: str) -> Contents:
        conditions = {"thickness_mm": millimetres, "manufacturer": "Generic"}
        return laboratory.contents(laboratory.scan(of=name, seed=len(name), conditions=conditions), sample="clear")

    assert database.add(thick("3.txt", "3.05 mm")).warnings == []
    assert database.add(thick("3-2.txt", "3.05")).warnings == []
    added = database.add(thick("thick.txt", "5.7"))
    assert added.warnings == [
        "thick.txt: thickness_mm 5.7, and 3.05 of sample clear so far (--sample names another one)"
    ]
    assert added.scans == 1
    assert database.measurement("clear").warnings == tuple(added.warnings)
    assert database.sample("clear").thickness_mm == 3.05


def test_several_who_make_one_at_once(tmp_path):
    start, errors = threading.Barrier(4), []

    def make():
        start.wait()
        try:
            with Database.open(tmp_path / "lab.sqlite", create=True) as opened:
                opened.describe_sample("twill")
        except BaseException as error:
            errors.append(error)

    threads = [threading.Thread(target=make) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60.0)
    assert errors == []
    with Database.open(tmp_path / "lab.sqlite") as opened:
        assert [sample.name for sample in opened.samples()] == ["twill"]
