"""The database as a whole, and what is taken out of it: nothing that a model or a report stands on."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sqlalchemy import delete, or_, select

from clerestory._core import ClerestoryError
from clerestory.measure.database import blobs, tables
from clerestory.measure.database.checks import Checks

if TYPE_CHECKING:
    from sqlalchemy import ColumnElement, Select, Table

    from clerestory.measure.database.records import Subject

# What is measured, with models and checks that name it.
_MEASURED = (
    (tables.scans, tables.model_scans, tables.report_scans),
    (tables.sphere_values, tables.model_sphere_values, tables.report_sphere_values),
)
_REMOVABLE: tuple[Subject, ...] = ("sample", "file", "scan", "model", "report")


class Database(Checks):
    """A laboratory's database that is open: see `Database.open`."""

    def remove(self, subject: Subject, number: int) -> None:
        """Remove a sample with all of its scans, a file with its scans, a scan, a model or a report, and their notes.

        Raises
        ------
        ClerestoryError
            There is no such thing, or a model or report was made of it. Checks of it go with it.
        """
        if subject not in _REMOVABLE:
            raise ClerestoryError(f"a {subject} goes with its scans (remove {', '.join(_REMOVABLE)})")
        table = tables.metadata.tables[f"{subject}s"]
        with self.transaction():
            if self._connection.execute(select(table.c.id).where(table.c.id == number)).first() is None:
                raise ClerestoryError(
                    f"{self.location}: no {subject} {number} (`clerestory measure list {subject}s` has them)"
                )
            if subject in ("model", "report"):
                self._remove_product(subject, table, number)
            else:
                self._remove_measured(subject, table, number)
            self._tidy()

    def _remove_product(self, subject: Subject, table: Table, number: int) -> None:
        if subject == "model":
            self._refuse_reports(tables.report_models, number, f"model {number}")
            made = tables.model_parents
            on = select(table.c.name).join_from(table, made, table.c.id == made.c.model_id)
            self._refuse(on.where(made.c.parent_id == number), "model", f"model {number}")
            self._drop_checks(select(tables.report_models.c.report_id).where(tables.report_models.c.model_id == number))
        blob = self._connection.execute(select(table.c.blob_id).where(table.c.id == number)).scalar_one()
        self._delete(table, table.c.id == number)
        blobs.drop(self._connection, blob)

    def _remove_measured(self, subject: Subject, table: Table, number: int) -> None:
        name = f"{subject} {number}"
        for measured, of_models, of_checks in _MEASURED:
            if subject == "scan" and measured is not tables.scans:
                continue
            column = measured.c.id if subject == "scan" else measured.c[f"{subject}_id"]
            models = tables.models
            on = select(models.c.name).join_from(models, of_models).join(measured).where(column == number).distinct()
            self._refuse(on, "model", name)
            self._drop_checks(select(of_checks.c.report_id).join(measured).where(column == number))
        if subject == "sample":
            models_left = select(tables.models.c.name).where(tables.models.c.sample_id == number)
            self._refuse(models_left, "model", name)
            self._refuse_reports(tables.report_samples, number, name)
        if subject != "scan":
            for measured, *_ in _MEASURED:
                self._delete(measured, measured.c[f"{subject}_id"] == number)
        if subject == "file":
            blob = self._connection.execute(select(table.c.blob_id).where(table.c.id == number)).scalar_one()
            self._delete(table, table.c.id == number)
            blobs.drop(self._connection, blob)
        else:
            self._delete(table, table.c.id == number)

    def _refuse_reports(self, link: Table, number: int, name: str) -> None:
        reports = tables.reports
        on = select(reports.c.name).join_from(reports, link).where(link.c[1] == number, reports.c.kind == "report")
        self._refuse(on, "report", name)

    def _drop_checks(self, asked: Select[Any]) -> None:
        """Checks of what goes would tell of something that is not there."""
        reports = tables.reports
        found = select(reports.c.id, reports.c.blob_id).where(reports.c.kind == "check", reports.c.id.in_(asked))
        for number, blob in self._connection.execute(found).all():
            self._delete(reports, reports.c.id == number)
            blobs.drop(self._connection, blob)

    def _refuse(self, asked: Select[Any], what: str, name: str) -> None:
        names = self._connection.execute(asked).scalars().all()
        if names:
            stands = "is on" if what == "report" else "was made of"
            raise ClerestoryError(
                f"{self.location}: {what} {', '.join(map(repr, names))} {stands} {name} (remove the {what} first)"
            )

    def _tidy(self) -> None:
        """Runs without scans, files without content and notes on nothing go, too."""
        scans, spheres, runs, files, notes = (
            tables.scans,
            tables.sphere_values,
            tables.runs,
            tables.files,
            tables.notes,
        )
        used = or_(runs.c.id.in_(select(scans.c.run_id)), runs.c.id.in_(select(spheres.c.run_id)))
        self._delete(runs, ~used)
        of_files = (select(table.c.file_id).where(table.c.file_id.is_not(None)) for table in (scans, spheres))
        empty = ~or_(*(files.c.id.in_(asked) for asked in of_files))
        for blob in self._connection.execute(select(files.c.blob_id).where(empty)).scalars().all():
            blobs.drop(self._connection, blob)
        self._delete(files, empty)
        for subject in ("sample", "run", "file", "scan", "model", "report"):
            table = tables.metadata.tables[f"{subject}s"]
            self._delete(notes, (notes.c.subject == subject) & notes.c.subject_id.not_in(select(table.c.id)))

    def _delete(self, table: Table, condition: ColumnElement[bool]) -> None:
        self._connection.execute(delete(table).where(condition))
