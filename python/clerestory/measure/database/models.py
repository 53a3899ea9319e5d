"""Models and reports in the database, and the way back from each to the raw points."""

from __future__ import annotations

import json
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any

from sqlalchemy import func, insert, select

from clerestory import _core
from clerestory._core import ClerestoryError
from clerestory.measure.database import blobs, tables
from clerestory.measure.database.marks import mark_of_scan, mark_of_sphere
from clerestory.measure.database.records import Provenance, StoredModel, StoredReport, StoredSphereValues
from clerestory.measure.database.writing import Writing

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from sqlalchemy import Table

    from clerestory.measure.scan import Scan
    from clerestory.measure.sphere import SphereValues

_models, _reports = tables.models, tables.reports
_of_scans, _of_spheres = tables.model_scans, tables.model_sphere_values


class Models(Writing):
    """What was made of measurements."""

    def add_model(
        self,
        sample: str,
        name: str,
        data: bytes,
        *,
        file_name: str,
        scans: Iterable[Scan],
        sphere_values: Iterable[SphereValues] = (),
        command: str,
        settings: Mapping[str, object] | None = None,
    ) -> int:
        """Store a model with its provenance; the number that it has.

        Parameters
        ----------
        name
            One a sample.
        data
            The model's file, usually a `.bsdf.npz`. It is kept in the database, where no path can go stale.
        scans, sphere_values
            What it was made of, as it came from the database: raw, not prepared.
        command
            What made it, as a person would type it.
        settings
            With what, all that changes the result.

        Raises
        ------
        ClerestoryError
            The sample has another model of this name, or a scan is not in the database.
        """
        self.sample(sample)
        with self.transaction():
            if any(model.name == name for model in self.models(sample=sample)):
                raise ClerestoryError(f"{self.location}: {sample} has a model {name!r} (choose another name)")
            owner = self._rows.put(tables.samples, {"name": sample}, {})
            number = self._rows.insert(
                _models,
                {
                    "sample_id": owner,
                    "name": name,
                    "file_name": file_name,
                    "blob_id": blobs.keep(self._connection, data),
                    "command": command,
                    "settings": json.dumps(dict(settings or {}), default=str),
                    "version": _core.__version__,
                    "made": datetime.now(UTC),
                },
            )
            marks = [mark_of_scan(scan) for scan in scans]
            if not marks:
                raise ClerestoryError(f"model {name!r}: nothing says what it was made of (give its scans)")
            self._link(_of_scans, tables.scans, owner, number, marks)
            self._link(
                _of_spheres, tables.sphere_values, owner, number, [mark_of_sphere(values) for values in sphere_values]
            )
        return number

    def _link(self, link: Table, table: Table, sample: int, model: int, marks: Sequence[str]) -> None:
        asked = select(table.c.mark, table.c.id).where(table.c.sample_id == sample)
        there: dict[str, list[int]] = {}
        for mark, number in self._connection.execute(asked):
            there.setdefault(mark, []).append(number)
        column = f"{table.name.removesuffix('s')}_id"
        for mark in dict.fromkeys(marks):
            if mark not in there:
                raise ClerestoryError(
                    f"{self.location}: a scan or sphere value that the model was made of is not in the database "
                    "(import its file first, and give scans as they were measured, not prepared ones)"
                )
            for number in there[mark]:
                self._connection.execute(insert(link).values(**{"model_id": model, column: number}))

    def models(self, *, sample: str | None = None) -> list[StoredModel]:
        """All models, or those of a sample, the oldest first."""

        def number(link: Table) -> Any:  # noqa: ANN401  # SQLAlchemy's expressions
            return select(func.count()).where(link.c.model_id == _models.c.id).scalar_subquery()

        asked = (
            select(
                *(c for c in _models.c if c.name not in ("sample_id", "blob_id")),
                tables.samples.c.name.label("sample"),
                tables.blobs.c.bytes,
                tables.blobs.c.sha256,
                number(_of_scans).label("scans"),
                number(_of_spheres).label("sphere_values"),
            )
            .select_from(_models.join(tables.samples).join(tables.blobs))
            .order_by(_models.c.id)
        )
        if sample is not None:
            asked = asked.where(tables.samples.c.name == sample)
        with self._reading() as connection:
            return [
                StoredModel(**{**row, "settings": json.loads(row["settings"])})
                for row in connection.execute(asked).mappings()
            ]

    def model(self, number: int) -> StoredModel:
        """One model.

        Raises
        ------
        ClerestoryError
            There is none of this number.
        """
        for model in self.models():
            if model.id == number:
                return model
        raise ClerestoryError(f"{self.location}: no model {number} (`clerestory measure list models` has them)")

    def model_bytes(self, number: int) -> bytes:
        """The file of a model."""
        return self._content(_models, number, "model")

    def provenance(self, number: int) -> Provenance:
        """What a model was made of."""
        model = self.model(number)
        with self._reading() as connection:
            ids = connection.execute(select(_of_scans.c.scan_id).where(_of_scans.c.model_id == number)).scalars().all()
            spheres = tables.sphere_values
            columns = [c for c in spheres.c if c.name in StoredSphereValues.__dataclass_fields__]
            asked = (
                select(*columns, tables.samples.c.name.label("sample"), tables.files.c.name.label("file"))
                .select_from(spheres.join(_of_spheres).join(tables.samples).outerjoin(tables.files))
                .where(_of_spheres.c.model_id == number)
                .order_by(spheres.c.id)
            )
            values = tuple(StoredSphereValues(**row) for row in connection.execute(asked).mappings())
            runs = {
                run
                for table, link in ((tables.scans, _of_scans), (spheres, _of_spheres))
                for run in connection.execute(
                    select(table.c.run_id).join_from(table, link).where(link.c.model_id == number)
                ).scalars()
            }
        scans = tuple(self.stored_scans(ids=ids))
        files = {scan.file_id for scan in scans} | {value.file_id for value in values}
        return Provenance(
            model,
            scans,
            values,
            tuple(file for file in self.files() if file.id in files),
            tuple(run for run in self.runs() if run.id in runs),
        )

    def add_report(self, name: str, data: bytes, *, file_name: str, models: Iterable[int] = ()) -> int:
        """Store a report on models; the number that it has.

        Raises
        ------
        ClerestoryError
            There is another one of this name, or no such model.
        """
        with self.transaction():
            if any(report.name == name for report in self.reports()):
                raise ClerestoryError(f"{self.location}: there is a report {name!r} (choose another name)")
            row = {"name": name, "file_name": file_name, "made": datetime.now(UTC)}
            number = self._rows.insert(_reports, {**row, "blob_id": blobs.keep(self._connection, data)})
            for model in models:
                link = {"report_id": number, "model_id": self.model(model).id}
                self._connection.execute(insert(tables.report_models).values(**link))
        return number

    def reports(self) -> list[StoredReport]:
        """All reports, the oldest first."""
        columns = (_reports.c.id, _reports.c.name, _reports.c.file_name, _reports.c.made, tables.blobs.c.bytes)
        asked = select(*columns).select_from(_reports.join(tables.blobs)).order_by(_reports.c.id)
        names = (
            select(tables.report_models.c.report_id, _models.c.name)
            .select_from(tables.report_models.join(_models))
            .order_by(_models.c.id)
        )
        with self._reading() as connection:
            on: dict[int, list[str]] = {}
            for report, model in connection.execute(names):
                on.setdefault(report, []).append(model)
            return [
                StoredReport(**row, models=tuple(on.get(row["id"], ()))) for row in connection.execute(asked).mappings()
            ]

    def report_bytes(self, number: int) -> bytes:
        """The file of a report."""
        return self._content(_reports, number, "report")

    def _content(self, table: Table, number: int, what: str) -> bytes:
        with self._reading() as connection:
            blob = connection.execute(select(table.c.blob_id).where(table.c.id == number)).scalar_one_or_none()
            if blob is None:
                raise ClerestoryError(f"{self.location}: no {what} {number}")
            return blobs.fetch(connection, blob)
