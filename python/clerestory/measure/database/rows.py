"""Rows of tables: added, found by what they hold, or made where there is none."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast

from sqlalchemy import insert, select, update

if TYPE_CHECKING:
    from collections.abc import Mapping

    from sqlalchemy import Connection, Table


@dataclass(frozen=True)
class Rows:
    """The tables within a transaction."""

    connection: Connection

    def insert(self, table: Table, row: Mapping[str, Any]) -> int:
        """Add a row; its number."""
        done = self.connection.execute(insert(table).values(**row))
        return cast("int", done.inserted_primary_key[0])  # type: ignore[index]  # an insert of one row has one

    def find(self, table: Table, key: Mapping[str, Any]) -> int | None:
        """The number of the row with a key."""
        asked = select(table.c.id).where(*(table.c[name].is_not_distinct_from(value) for name, value in key.items()))
        return cast("int | None", self.connection.execute(asked.order_by(table.c.id)).scalars().first())

    def put(self, table: Table, key: Mapping[str, Any], fields: Mapping[str, Any]) -> int:
        """The number of the row with a key, made if it is new, with these fields written."""
        number = self.find(table, key)
        if number is None:
            return self.insert(table, {**key, **fields})
        if fields:
            self.connection.execute(update(table).where(table.c.id == number).values(**fields))
        return number
