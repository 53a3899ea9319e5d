"""Reports on models in the database."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import TYPE_CHECKING

from sqlalchemy import insert, select

from clerestory._core import ClerestoryError
from clerestory.measure.database import blobs, tables
from clerestory.measure.database.models import Models
from clerestory.measure.database.records import StoredReport
from clerestory.measure.source import digest

if TYPE_CHECKING:
    from collections.abc import Iterable

_models, _reports = tables.models, tables.reports


class Reports(Models):
    """What was written about models."""

    def add_report(self, name: str, data: bytes, *, file_name: str, models: Iterable[int] = ()) -> int:
        """Store a report on models; the number that it has, or that the same report on the same models has already.

        Raises
        ------
        ClerestoryError
            There is another one of this name, or no such model.
        """
        on = [self.model(model) for model in dict.fromkeys(models)]
        mark = digest(data)
        with self.transaction():
            for report in self.reports():
                if report.sha256 == mark and report.models == tuple(model.name for model in on):
                    return report.id
            if any(report.name == name for report in self.reports()):
                raise ClerestoryError(f"{self.location}: there is a report {name!r} (choose another name)")
            row = {"name": name, "file_name": file_name, "made": datetime.now(UTC)}
            number = self._rows.insert(_reports, {**row, "blob_id": blobs.keep(self._connection, data)})
            for model in on:
                self._connection.execute(insert(tables.report_models).values(report_id=number, model_id=model.id))
        return number

    def reports(self, *, model: int | None = None) -> list[StoredReport]:
        """All reports, or those on a model, the oldest first."""
        columns = (_reports.c.id, _reports.c.name, _reports.c.file_name, _reports.c.made)
        content = (tables.blobs.c.bytes, tables.blobs.c.sha256)
        asked = select(*columns, *content).select_from(_reports.join(tables.blobs)).order_by(_reports.c.id)
        link = tables.report_models
        if model is not None:
            asked = asked.where(_reports.c.id.in_(select(link.c.report_id).where(link.c.model_id == model)))
        names = select(link.c.report_id, _models.c.name).select_from(link.join(_models)).order_by(_models.c.id)
        with self._reading() as connection:
            on: dict[int, list[str]] = {}
            for report, name in connection.execute(names):
                on.setdefault(report, []).append(name)
            return [
                StoredReport(**row, models=tuple(on.get(row["id"], ()))) for row in connection.execute(asked).mappings()
            ]

    def report(self, number: int) -> StoredReport:
        """One report.

        Raises
        ------
        ClerestoryError
            There is none of this number.
        """
        for report in self.reports():
            if report.id == number:
                return report
        raise ClerestoryError(f"{self.location}: no report {number} (`clerestory measure list reports` has them)")

    def report_bytes(self, number: int) -> bytes:
        """The file of a report."""
        return self._content(_reports, number, "report")
