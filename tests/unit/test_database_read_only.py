"""A database that may be read and not written, as on a share that others keep."""

import os

import pytest

import laboratory
from clerestory import ClerestoryError
from clerestory.measure.database import Database, connection


@pytest.fixture
def place(tmp_path):
    """A database of a sample, in a folder with a name that addresses would take apart."""
    folder = tmp_path / "lab 100%?#"
    folder.mkdir()
    with Database.open(folder / "lab.sqlite", create=True) as database:
        database.add(laboratory.contents(laboratory.scan()))
    return folder / "lab.sqlite"


@pytest.fixture
def denied(monkeypatch):
    """What may not be written, also by the owner of all."""
    paths = set()
    access = os.access
    monkeypatch.setattr(
        connection.os, "access", lambda path, mode: not (mode & os.W_OK and path in paths) and access(path, mode)
    )
    return paths


@pytest.mark.parametrize("of_folder", [False, True])
def test_it_is_read_and_not_written(place, denied, of_folder):
    denied |= {place, place.parent} if of_folder else {place}
    before = place.read_bytes()
    with Database.open(place) as database:
        laboratory.same(database.measurement("twill").scans[0], laboratory.scan())
        with pytest.raises(ClerestoryError, match=r"lab.sqlite: attempt to write a readonly database \(check the perm"):
            database.describe_sample("twill", description="new")
        assert database.sample("twill").description is None
    assert place.read_bytes() == before
    if of_folder:
        assert [path.name for path in place.parent.iterdir()] == ["lab.sqlite"]


def test_what_another_program_is_writing_is_read_as_it_was(place, denied):
    with Database.open(place) as writer:
        writer.describe_sample("twill", description="written, and not yet in the file itself")
        denied |= {place, place.parent}
        with Database.open(place) as reader, writer.transaction():
            writer.describe_sample("twill", description="not done")
            assert reader.sample("twill").description == "written, and not yet in the file itself"


def test_a_place_without_a_database_stays_so(tmp_path, denied):
    denied |= {tmp_path}
    with pytest.raises(ClerestoryError, match="no such database"):
        Database.open(tmp_path / "none.sqlite")
