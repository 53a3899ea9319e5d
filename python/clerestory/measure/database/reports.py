"""Reports on samples and models in the database."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import TYPE_CHECKING

from sqlalchemy import insert, or_, select

from clerestory._core import ClerestoryError
from clerestory.measure.database import blobs, tables
from clerestory.measure.database.models import Models, unused
from clerestory.measure.database.records import StoredReport
from clerestory.measure.source import digest

if TYPE_CHECKING:
    from collections.abc import Iterable

    from sqlalchemy import Column, Connection, Table

_models, _reports = tables.models, tables.reports
_on_models, _on_samples = tables.report_models, tables.report_samples
_CHECKED = ((tables.scans, tables.report_scans), (tables.sphere_values, tables.report_sphere_values))


class Reports(Models):
    """What was written about samples and models."""

    def add_report(
        self, name: str, data: bytes, *, file_name: str, models: Iterable[int] = (), samples: Iterable[str] = ()
    ) -> int:
        """Store a report; the number that it has, or that the same report on the same things has already.

        Parameters
        ----------
        name
            One in the database.
        data
            The file, which comes out again as it is.
        models, samples
            What it is on: numbers of models, names of samples.

        Raises
        ------
        ClerestoryError
            There is another one of this name, or no such model or sample.
        """
        on_models = {self.model(model).id for model in models}
        on_samples = {self.sample(sample).id for sample in samples}
        mark = digest(data)
        with self.transaction():
            there = self.reports()
            for report in there:
                on = (_linked(self._connection, link, report.id) for link in (_on_models, _on_samples))
                if report.kind == "report" and report.sha256 == mark and [*on] == [on_models, on_samples]:
                    return report.id
            if any(report.name == name for report in there):
                raise ClerestoryError(f"{self.location}: there is a report {name!r} (choose another name)")
            number = self._rows.insert(
                _reports,
                {
                    "name": name,
                    "file_name": file_name,
                    "made": datetime.now(UTC),
                    "blob_id": blobs.keep(self._connection, data),
                },
            )
            self._link(number, _on_models, on_models)
            self._link(number, _on_samples, on_samples)
        return number

    def unused_report_name(self, wish: str) -> str:
        """A name that no report has: the wish, or the wish with a number."""
        return unused(wish, {report.name for report in self.reports()})

    def reports(
        self, *, model: int | None = None, sample: str | None = None, run: int | None = None
    ) -> list[StoredReport]:
        """Reports and checks, the oldest first.

        Parameters
        ----------
        model
            On this model only.
        sample
            On this sample, or a model of it.
        run
            Checks of what this run measured.
        """
        columns = (_reports.c.id, _reports.c.name, _reports.c.kind, _reports.c.file_name, _reports.c.made)
        content = (tables.blobs.c.bytes, tables.blobs.c.sha256)
        asked = select(*columns, *content).select_from(_reports.join(tables.blobs)).order_by(_reports.c.id)
        if model is not None:
            asked = asked.where(_reports.c.id.in_(select(_on_models.c.report_id).where(_on_models.c.model_id == model)))
        if sample is not None:
            samples = tables.samples
            own = select(_on_samples.c.report_id).join_from(_on_samples, samples).where(samples.c.name == sample)
            of_models = select(_on_models.c.report_id).join_from(_on_models, _models)
            of_models = of_models.join(samples, samples.c.id == _models.c.sample_id).where(samples.c.name == sample)
            asked = asked.where(or_(_reports.c.id.in_(own), _reports.c.id.in_(of_models)))
        if run is not None:
            of_run = (select(link.c.report_id).join(table).where(table.c.run_id == run) for table, link in _CHECKED)
            asked = asked.where(or_(*(_reports.c.id.in_(one) for one in of_run)))
        with self._reading() as connection:
            on_models = _names(connection, _on_models, _models.c.name)
            on_samples = _names(connection, _on_samples, tables.samples.c.name)
            return [
                StoredReport(
                    **row, models=tuple(on_models.get(row["id"], ())), samples=tuple(on_samples.get(row["id"], ()))
                )
                for row in connection.execute(asked).mappings()
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

    def _link(self, report: int, link: Table, numbers: Iterable[int]) -> None:
        column = link.c[1].name
        rows = [{"report_id": report, column: number} for number in sorted(numbers)]
        if rows:
            self._connection.execute(insert(link), rows)


def _linked(connection: Connection, link: Table, report: int) -> set[int]:
    return set(connection.execute(select(link.c[1]).where(link.c.report_id == report)).scalars())


def _names(connection: Connection, link: Table, name: Column[str]) -> dict[int, list[str]]:
    """What reports are on, by their numbers."""
    found: dict[int, list[str]] = {}
    asked = select(link.c.report_id, name).select_from(link.join(name.table)).order_by(name.table.c.id)
    for report, text in connection.execute(asked):
        found.setdefault(report, []).append(text)
    return found
