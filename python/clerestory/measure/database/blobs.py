"""Large contents (models, reports, files as they were) kept in pieces, compressed."""

from __future__ import annotations

import zlib
from typing import TYPE_CHECKING

from sqlalchemy import delete, insert, select

from clerestory._core import ClerestoryError
from clerestory.measure.database.tables import blobs, pieces
from clerestory.measure.source import digest

if TYPE_CHECKING:
    from sqlalchemy import Connection

_PIECE = 8 << 20  # neither SQLite nor PostgreSQL takes a value of a gigabyte


def keep(connection: Connection, data: bytes) -> int:
    """Store bytes; the number to ask for them by."""
    row = connection.execute(insert(blobs).values(sha256=digest(data), bytes=len(data)))
    number = int(row.inserted_primary_key[0])  # type: ignore[index]  # an insert of one row has one
    for k, start in enumerate(range(0, len(data), _PIECE)):
        piece = zlib.compress(data[start : start + _PIECE], 1)
        connection.execute(insert(pieces).values(blob_id=number, number=k, data=piece))
    return number


def fetch(connection: Connection, number: int) -> bytes:
    """The bytes again.

    Raises
    ------
    ClerestoryError
        They are not those that were stored.
    """
    stored = connection.execute(select(pieces.c.data).where(pieces.c.blob_id == number).order_by(pieces.c.number))
    wanted = connection.execute(select(blobs.c.sha256).where(blobs.c.id == number)).scalar_one()
    try:
        data = b"".join(zlib.decompress(piece) for piece in stored.scalars())
    except zlib.error as error:
        raise ClerestoryError(f"stored content is damaged: {error} (restore the database from a copy)") from error
    if digest(data) != wanted:
        raise ClerestoryError("stored content is not what was stored (restore the database from a copy)")
    return data


def drop(connection: Connection, number: int | None) -> None:
    """Forget bytes."""
    if number is not None:
        connection.execute(delete(blobs).where(blobs.c.id == number))
