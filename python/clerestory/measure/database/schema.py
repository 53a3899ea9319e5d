"""Versions of the database's schema: made when it is new, brought up to date on request, refused if from the future."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from alembic import command
from alembic.config import Config
from alembic.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import inspect

from clerestory._core import ClerestoryError

if TYPE_CHECKING:
    from sqlalchemy import Connection

VERSION_TABLE = "clerestory_schema"


def prepare(connection: Connection, name: str, *, upgrade: bool, create: bool) -> None:
    """Make a database ready for this program, within the connection's transaction.

    Parameters
    ----------
    name
        Of the database, for messages.
    upgrade
        Bring an older schema up to date.
    create
        Make the tables where there are none.

    Raises
    ------
    ClerestoryError
        It is not a database of Clerestory, is older and `upgrade` is not wanted, or is newer.
    """
    scripts = ScriptDirectory.from_config(_config())
    known = [script.revision for script in scripts.walk_revisions()][::-1]
    found = _revision(connection)
    if found is None:
        tables = inspect(connection).get_table_names()
        if tables:
            raise ClerestoryError(
                f"{name}: holds tables of something else, such as {sorted(tables)[0]!r} (give another file, or an "
                "empty database)"
            )
        if not create:
            raise ClerestoryError(f"{name}: the database is empty (import measurements into it first)")
        migrate(connection, "head")
    elif found not in known:
        raise ClerestoryError(
            f"{name}: its schema, {found}, is of a newer Clerestory (update this program, whose newest is {known[-1]})"
        )
    elif found != known[-1]:
        if not upgrade:
            raise ClerestoryError(
                f"{name}: its schema, {found}, is older than this program's, {known[-1]} (keep a copy of the database, "
                "then `clerestory measure list --upgrade` brings it up to date)"
            )
        migrate(connection, "head")


def migrate(connection: Connection, target: str) -> None:
    """Go to a version of the schema."""
    config = _config()
    config.attributes["connection"] = connection
    command.upgrade(config, target)


def outdated(connection: Connection) -> bool:
    """Whether `prepare` would have to change something."""
    return _revision(connection) != ScriptDirectory.from_config(_config()).get_current_head()


def _revision(connection: Connection) -> str | None:
    context = MigrationContext.configure(connection, opts={"version_table": VERSION_TABLE})
    return context.get_current_revision()


def _config() -> Config:
    config = Config()
    # A percent sign in a path would be taken for the beginning of a variable.
    config.set_main_option("script_location", str(Path(__file__).parent / "migrations").replace("%", "%%"))
    config.set_main_option("path_separator", "os")
    return config
