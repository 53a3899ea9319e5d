"""Values of integrating spheres in the database."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from sqlalchemy import select

from clerestory._core import ClerestoryError
from clerestory.measure.database import records, tables
from clerestory.measure.database.columns import unpack
from clerestory.measure.database.connection import Connected
from clerestory.measure.source import Source
from clerestory.measure.sphere import SphereValues

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sqlalchemy import ColumnElement, Connection, RowMapping

_spheres, _samples, _files = tables.sphere_values, tables.samples, tables.files


class Spheres(Connected):
    """What integrating spheres gave."""

    def stored_sphere_values(
        self, *, sample: str | None = None, ids: Sequence[int] | None = None, run: int | None = None
    ) -> list[records.StoredSphereValues]:
        """Sphere values without their numbers, in the order in which they were imported."""
        wanted = []
        if sample is not None:
            wanted.append(_samples.c.name == sample)
        if ids is not None:
            wanted.append(_spheres.c.id.in_(list(ids)))
        if run is not None:
            wanted.append(_spheres.c.run_id == run)
        names = ("id", "file_id", "side", "scatter", "collected", "theta_deg", "phi_deg", "bands")
        asked = (
            select(*(_spheres.c[name] for name in names), _samples.c.name.label("sample"), _files.c.name.label("file"))
            .select_from(_spheres.join(_samples).outerjoin(_files))
            .where(*wanted)
            .order_by(_spheres.c.id)
        )
        with self._reading() as connection:
            return [
                records.StoredSphereValues(**{**row, "bands": tuple(json.loads(row["bands"]))})
                for row in connection.execute(asked).mappings()
            ]

    def sphere_values(self, sample: str) -> list[SphereValues]:
        """What integrating spheres gave for a sample."""
        with self._reading() as connection:
            return _found(connection, _samples.c.name == sample)

    def sphere_value(self, number: int) -> SphereValues:
        """One set of values.

        Raises
        ------
        ClerestoryError
            There is none of this number.
        """
        with self._reading() as connection:
            found = _found(connection, _spheres.c.id == number)
        if not found:
            raise ClerestoryError(
                f"{self.location}: no sphere value {number} (`clerestory measure list spheres` has them)"
            )
        return found[0]


def source_of(connection: Connection, number: int | None, sources: dict[int, Source]) -> Source | None:
    """The file of a scan or of sphere values; `sources` keeps those that were asked for."""
    if number is None:
        return None
    if number not in sources:
        columns = (_files.c.name, _files.c.sha256, _files.c.format, _files.c.header, _files.c.convention)
        row = connection.execute(select(*columns).where(_files.c.id == number)).one()
        sources[number] = Source(row.name, row.sha256, row.format, tuple(json.loads(row.header)), row.convention)
    return sources[number]


def _found(connection: Connection, wanted: ColumnElement[bool]) -> list[SphereValues]:
    asked = select(_spheres, _samples.c.name.label("sample")).join(_samples).where(wanted).order_by(_spheres.c.id)
    sources: dict[int, Source] = {}
    return [_sphere(connection, row, sources) for row in connection.execute(asked).mappings()]


def _sphere(connection: Connection, row: RowMapping, sources: dict[int, Source]) -> SphereValues:
    columns, bands = unpack(row["data"]), tuple(json.loads(row["bands"]))
    wavelengths = None if bands else columns.pop(0)
    return SphereValues(
        row["sample"],
        row["side"],
        row["scatter"],
        float("nan") if row["theta_deg"] is None else row["theta_deg"],
        columns[0],
        collected=row["collected"],
        wavelength_nm=wavelengths,
        bands=bands,
        phi_deg=row["phi_deg"],
        standard_errors=columns[1] if row["errors"] else None,
        conditions=json.loads(row["conditions"]),
        source=source_of(connection, row["file_id"], sources),
    )
