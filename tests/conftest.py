"""Fixtures for all tests."""

import os
import uuid
from pathlib import Path

import pytest

import postgres
from samples import ABSENT, sample_root


@pytest.fixture(scope="session", autouse=True)
def own_cache(tmp_path_factory):
    """Nothing is kept in the cache of the person who runs the tests, or taken from it."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("CLERESTORY_CACHE", str(tmp_path_factory.mktemp("cache")))
        yield


@pytest.fixture(scope="session")
def sample_data() -> Path:
    """The folder of the sample data; skips where it is absent."""
    root = sample_root()
    if root is None:
        pytest.skip(ABSENT)
    return root


@pytest.fixture(scope="session")
def require_pyradiance():
    """Radiance as the package pyradiance, with RAYPATH set; its programs lie in `pyradiance.anci.BINPATH`.

    It is among the locked test dependencies, so it is absent only where it has no wheel.
    """
    pyradiance = pytest.importorskip("pyradiance", reason="pyradiance absent")
    os.environ.setdefault("RAYPATH", f".:{Path(pyradiance.__file__).parent / 'lib'}")
    return pyradiance


@pytest.fixture(scope="session")
def postgres_server():
    """The address of a PostgreSQL server to throw away; skips where its programs are absent."""
    folder = postgres.programs()
    if folder is None:
        pytest.skip(postgres.ABSENT)
    with postgres.server(folder) as address:
        yield address


@pytest.fixture(params=["sqlite", "postgresql"])
def database_place(request, tmp_path) -> str:
    """Where a database can be made that only this test uses: a SQLite file, and a schema of a server's."""
    if request.param == "sqlite":
        return str(tmp_path / "lab.sqlite")
    import psycopg

    address = request.getfixturevalue("postgres_server")
    name = f"t{uuid.uuid4().hex[:12]}"
    with psycopg.connect(address, autocommit=True) as connection:
        connection.execute(f"CREATE DATABASE {name}")
    return address.replace("/postgres?", f"/{name}?")
