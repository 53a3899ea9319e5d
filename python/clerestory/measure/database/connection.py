"""The way into a database: a SQLite file, or a PostgreSQL server; transactions that are done whole or not at all."""

from __future__ import annotations

import os
import sqlite3
import time
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self, TypeVar

import sqlalchemy
from sqlalchemy import event, text
from sqlalchemy.exc import ArgumentError, DBAPIError, OperationalError
from sqlalchemy.pool import NullPool

from clerestory._core import ClerestoryError
from clerestory.measure.database import schema

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from sqlalchemy import URL, Connection, Engine

DEFAULT = "laboratory.sqlite"
VARIABLE = "CLERESTORY_DB"
WAIT_S = 600.0
"""How long one who writes waits for another [s]."""

_POLL_S = 0.2
_BUSY_S = 10.0  # how long SQLite waits for moments in which others may not read [s]
_LOCK = 0x436C6572  # of PostgreSQL: one importer at a time
_MISSING = "psycopg"

T = TypeVar("T")


@dataclass(frozen=True)
class Location:
    """Where a database is."""

    url: URL
    path: Path | None
    """Of a SQLite file."""

    def __str__(self) -> str:
        if self.path is not None:
            return str(self.path)
        return self.url.set(drivername="postgresql").render_as_string(hide_password=True)

    def exists(self) -> bool:
        """Whether there is something; a server is asked when it is opened."""
        return self.path is None or self.path.exists()


def location(given: str | os.PathLike[str] | None = None) -> Location:
    """Where a database is: as given, by the environment variable CLERESTORY_DB, or `laboratory.sqlite` in this folder.

    Raises
    ------
    ClerestoryError
        It is an address of something that is neither SQLite nor PostgreSQL.
    """
    word = os.fspath(given) if given is not None else os.environ.get(VARIABLE) or DEFAULT
    if "://" not in word:
        path = Path(word)
        if path.is_dir():
            raise ClerestoryError(f"{path}: a folder, not a database (give a file, such as {path / DEFAULT})")
        return Location(sqlalchemy.URL.create("sqlite", database=str(path)), path)
    try:
        url = sqlalchemy.make_url(word)
    except (ArgumentError, ValueError):
        raise ClerestoryError("the database's address cannot be understood (postgresql://user@host/name)") from None
    if url.get_backend_name() in ("postgresql", "postgres"):
        return Location(url.set(drivername="postgresql+psycopg"), None)
    if url.get_backend_name() == "sqlite" and url.database:
        return Location(url, Path(url.database))
    raise ClerestoryError(f"{url.get_backend_name()}: not a database that is known (give a file, or postgresql://…)")


class Connected:
    """A database that is open."""

    def __init__(self, place: Location, engine: Engine) -> None:
        self.location = place
        self._engine = engine
        self._writer: Connection | None = None

    @classmethod
    def open(
        cls,
        given: str | os.PathLike[str] | Location | None = None,
        *,
        create: bool = False,
        upgrade: bool = False,
        waiting: Callable[[], None] | None = None,
    ) -> Self:
        """Open a database; it is closed by `close`, or as a context manager.

        Parameters
        ----------
        given
            SQLite file or `postgresql://…`; see `location`.
        create
            Make it if it does not exist, or is an empty database of a server.
        upgrade
            Bring an older schema up to date.
        waiting
            Called once when another program writes, and this one has to wait.

        Raises
        ------
        ClerestoryError
            There is none, it is something else, of a newer version, or the server does not answer.
        """
        place = given if isinstance(given, Location) else location(given)
        if not create and not place.exists():
            raise ClerestoryError(
                f"{place}: no such database (make one with `clerestory measure import`, or name another with --db)"
            )
        if place.path is not None and not place.path.absolute().parent.is_dir():
            raise ClerestoryError(f"{place}: the folder {place.path.absolute().parent} does not exist (make it first)")
        try:
            engine = _engine(place)
        except ModuleNotFoundError as error:
            if error.name != _MISSING:
                raise
            raise ClerestoryError(
                f"{place}: PostgreSQL needs the package psycopg (pip install 'clerestory[postgres]')"
            ) from None
        opened = cls(place, engine)
        try:
            opened._prepare(create=create, upgrade=upgrade, waiting=waiting)
        except BaseException:
            opened.close()
            raise
        return opened

    def _prepare(self, *, create: bool, upgrade: bool, waiting: Callable[[], None] | None) -> None:
        with self._reading() as connection:
            outdated = schema.outdated(connection)
        if outdated:  # looked at again within the lock: another program may have been faster
            with self.transaction(waiting=waiting):
                schema.prepare(self._connection, str(self.location), upgrade=upgrade, create=create)

    def close(self) -> None:
        """Let go of the file or the server."""
        self._engine.dispose()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @contextmanager
    def transaction(self, *, waiting: Callable[[], None] | None = None) -> Iterator[None]:
        """All that is written within is stored together when it ends, or not at all if it fails or is killed.

        Within another transaction it is a part of that one. One program writes at a time; others wait up to `WAIT_S`.

        Parameters
        ----------
        waiting
            Called once if another program writes now.

        Raises
        ------
        ClerestoryError
            The other program does not come to an end, or the database cannot be written to.
        """
        if self._writer is not None:
            yield
            return
        with self._named(), _patient(self._begin, self.location, waiting) as connection:
            self._writer = connection
            try:
                yield
                connection.commit()
            except BaseException:
                connection.rollback()
                raise
            finally:
                self._writer = None

    @property
    def _connection(self) -> Connection:
        """That of the transaction at hand."""
        if self._writer is None:
            raise ClerestoryError("nothing is written outside of a transaction")
        return self._writer

    @contextmanager
    def _reading(self) -> Iterator[Connection]:
        """A connection to ask, which sees one state of the database; that of the transaction within one."""
        if self._writer is not None:
            yield self._writer
            return
        with self._named(), self._engine.connect() as connection:
            yield connection

    def _begin(self) -> Connection:
        """A connection that holds the lock of those who write."""
        connection = self._engine.connect()
        try:
            if self.location.path is not None:
                connection.execution_options(writes=True).begin()
                return connection
            connection.execution_options(isolation_level="READ COMMITTED").begin()
            if connection.execute(text("SELECT pg_try_advisory_xact_lock(:key)"), {"key": _LOCK}).scalar():
                return connection
        except OperationalError as error:
            connection.close()
            if "database is locked" in str(error.orig):
                raise _BusyError from error
            raise
        connection.close()
        raise _BusyError

    @contextmanager
    def _named(self) -> Iterator[None]:
        """What the database says, in one line with its name."""
        try:
            yield
        except DBAPIError as error:
            lines = str(error.orig).strip().splitlines() or [type(error.orig).__name__]
            raise ClerestoryError(f"{self.location}: {lines[0]} ({_remedy(error, self.location)})") from error


def _engine(place: Location) -> Engine:
    if place.path is None:
        # A repeatable read sees one state, as SQLite's transactions do.
        return sqlalchemy.create_engine(
            place.url,
            connect_args={"connect_timeout": 10},
            isolation_level="REPEATABLE READ",
        )
    address = _read_only(place.path)
    if address is None:
        engine = sqlalchemy.create_engine(place.url, connect_args={"timeout": _BUSY_S})
    else:
        engine = sqlalchemy.create_engine("sqlite://", creator=lambda: _connect_to(address), poolclass=NullPool)

    @event.listens_for(engine, "connect")
    def _connect(connection: Any, _record: object) -> None:  # noqa: ANN401  # the driver's own
        connection.isolation_level = None  # the driver would begin transactions late, and never for the schema
        connection.execute("PRAGMA foreign_keys = ON")
        if address is None:
            # Readers see the last state while another program writes, and nobody waits for them.
            _write_ahead(connection)

    @event.listens_for(engine, "begin")
    def _sqlite_begin(connection: Connection) -> None:
        writes = connection.get_execution_options().get("writes", False)
        if not writes:
            connection.exec_driver_sql("BEGIN")
            return
        # The driver's wait cannot be interrupted by Ctrl-C; `_patient` waits in its place.
        connection.exec_driver_sql("PRAGMA busy_timeout = 100")
        connection.exec_driver_sql("BEGIN IMMEDIATE")
        connection.exec_driver_sql(f"PRAGMA busy_timeout = {1000.0 * _BUSY_S:.0f}")

    return engine


def _read_only(path: Path) -> str | None:
    """How a file is opened that may be read and not written; none for others."""
    if not path.exists():
        return None
    may_make_files = os.access(path.absolute().parent, os.W_OK)
    if may_make_files and os.access(path, os.W_OK):
        return None
    # Beside a file that is written to lie others, which tell what is going on; where there are none and none can be
    # made, nobody writes.
    is_still = not may_make_files and not path.with_name(f"{path.name}-wal").exists()
    return f"{path.absolute().as_uri()}?mode=ro{'&immutable=1' if is_still else ''}"


def _connect_to(address: str) -> sqlite3.Connection:
    return sqlite3.connect(address, uri=True, timeout=_BUSY_S, check_same_thread=False)


class _BusyError(Exception):
    """Another program writes."""


def _write_ahead(connection: Any) -> None:  # noqa: ANN401
    """Choose the journal of a new file; SQLite does not wait by itself where two programs make one at once."""
    started = time.monotonic()
    while True:
        try:
            connection.execute("PRAGMA journal_mode = WAL")
        except sqlite3.OperationalError as error:
            if "locked" not in str(error) or time.monotonic() - started > _BUSY_S:
                raise
            time.sleep(_POLL_S / 10.0)
        else:
            return


def _patient(action: Callable[[], T], place: Location, waiting: Callable[[], None] | None) -> T:
    started, told = time.monotonic(), False
    while True:
        try:
            return action()
        except _BusyError:
            if time.monotonic() - started > WAIT_S:
                raise ClerestoryError(
                    f"{place}: another program has been writing for {WAIT_S / 60:.0f} minutes (let it end, or end it)"
                ) from None
        if waiting is not None and not told:
            waiting()
            told = True
        time.sleep(_POLL_S)


def _remedy(error: DBAPIError, place: Location) -> str:
    words = str(error.orig).lower()
    if "not a database" in words or "malformed" in words:
        return "give a file that Clerestory made, or restore it from a copy"
    if "readonly" in words or "read-only" in words or "permission" in words:
        return "check the permissions of the file and its folder"
    if "locked" in words:
        return "another program holds it; try again"
    if "full" in words:
        return "free some space"
    if place.path is None and isinstance(error, OperationalError):
        return "check the address, the user and that the server runs"
    return "check the database"
