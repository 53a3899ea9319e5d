"""Where scans and sphere values that a command was given are in the database."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from sqlalchemy import select

from clerestory.measure.database import tables
from clerestory.measure.database.marks import mark_of_scan, mark_of_sphere
from clerestory.measure.database.records import Origin
from clerestory.measure.database.writing import Writing
from clerestory.measure.scan import Scan

if TYPE_CHECKING:
    from collections.abc import Iterable

    from sqlalchemy import Connection, Table

    from clerestory.measure.source import Source
    from clerestory.measure.sphere import SphereValues

_models = tables.models


class Origins(Writing):
    """Measured values found again by what they hold, or by the file that they came from."""

    def origin(self, scans: Iterable[Scan], sphere_values: Iterable[SphereValues] = ()) -> Origin:
        """What of the database scans and sphere values are.

        They are known by all that they hold; else by the SHA-256 of their file, if that was imported, or was written by
        a command whose result is in the database (prepared scans, say).
        """
        found = _Found()
        with self._reading() as connection:
            for scan in scans:
                self._place(connection, found, tables.scans, scan, mark_of_scan(scan))
            for values in sphere_values:
                self._place(connection, found, tables.sphere_values, values, mark_of_sphere(values))
        return Origin(
            tuple(found.samples), tuple(found.scans), tuple(found.spheres), tuple(found.parents), tuple(found.unknown)
        )

    def made_as(self, sha256: str) -> int | None:
        """The number of the model or of the prepared scans that have a file of these bytes."""
        with self._reading() as connection:
            return _product(connection, sha256, {})

    def _place(self, connection: Connection, found: _Found, table: Table, item: Scan | SphereValues, mark: str) -> None:
        # Marks are indexed by sample: without naming all, every scan would be looked at for each that is asked for.
        of_any = table.c.sample_id.in_(select(tables.samples.c.id))
        marked = _numbered(table).where(table.c.mark == mark, of_any)
        rows: list[tuple[int, str]] = [(row[0], row[1]) for row in connection.execute(marked)]
        if not rows and item.source is not None:
            parent = _product(connection, item.source.sha256, found.products)
            if parent is not None:
                asked = select(tables.samples.c.name).join_from(_models, tables.samples).where(_models.c.id == parent)
                found.samples.setdefault(connection.execute(asked).scalar_one())
                found.parents.setdefault(parent)
                return
            rows = _of_file(connection, table, item, item.source)
        if not rows:
            found.unknown.setdefault(_words(item))
        for number, sample in rows:
            found.samples.setdefault(sample)
            (found.scans if table is tables.scans else found.spheres).setdefault(number)


class _Found:
    """Numbers and names, each once, in the order in which they were met."""

    def __init__(self) -> None:
        self.samples: dict[str, None] = {}
        self.scans: dict[int, None] = {}
        self.spheres: dict[int, None] = {}
        self.parents: dict[int, None] = {}
        self.unknown: dict[str, None] = {}
        self.products: dict[str, int] = {}  # by the SHA-256 of their files


def _numbered(table: Table):  # type: ignore[no-untyped-def]  # noqa: ANN202  # SQLAlchemy's select
    return select(table.c.id, tables.samples.c.name).join_from(table, tables.samples).order_by(table.c.id)


def _of_file(connection: Connection, table: Table, item: Scan | SphereValues, source: Source) -> list[tuple[int, str]]:
    """What the file that it came from gave when it was imported; of a scan, that of the same light."""
    asked = _numbered(table).join(tables.files).where(tables.files.c.sha256 == source.sha256)
    if isinstance(item, Scan):
        asked = asked.where(table.c.purpose == item.purpose, table.c.theta_deg == item.incident_theta_deg)
    return [(row[0], row[1]) for row in connection.execute(asked)]


def _product(connection: Connection, sha256: str, known: dict[str, int]) -> int | None:
    if not known:
        for number, files in connection.execute(select(_models.c.id, _models.c.files).order_by(_models.c.id)):
            for mark in json.loads(files).values():
                known.setdefault(mark, number)
        known.setdefault("", 0)  # asked once, also where there are none
    return known.get(sha256) or None


def _words(item: Scan | SphereValues) -> str:
    what = "a scan" if isinstance(item, Scan) else "a value of a sphere"
    return what if item.source is None else item.source.name
