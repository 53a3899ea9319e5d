"""Models and prepared scans in the database, and the way back from each to the raw points."""

from __future__ import annotations

import json
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any

from sqlalchemy import func, insert, select

from clerestory import _core
from clerestory._core import ClerestoryError
from clerestory.measure.database import blobs, tables
from clerestory.measure.database.origins import Origins
from clerestory.measure.database.records import Provenance, StoredModel
from clerestory.measure.source import digest

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping, Sequence

    from sqlalchemy import Column, Table

    from clerestory.measure.database.records import Kind
    from clerestory.measure.scan import Scan
    from clerestory.measure.sphere import SphereValues

_models, _parents = tables.models, tables.model_parents
_of_scans, _of_spheres = tables.model_scans, tables.model_sphere_values


class Models(Origins):
    """What was made of measurements."""

    def add_model(
        self,
        sample: str,
        name: str,
        data: bytes,
        *,
        file_name: str,
        scans: Iterable[Scan] = (),
        sphere_values: Iterable[SphereValues] = (),
        parents: Iterable[int] = (),
        command: str,
        settings: Mapping[str, object] | None = None,
        kind: Kind = "model",
        steps: Sequence[Mapping[str, object]] = (),
        files: Mapping[str, str] | None = None,
    ) -> int:
        """Store a model, or prepared scans, with their provenance; the number that they have.

        What the sample has already, byte by byte, is not stored again.

        Parameters
        ----------
        name
            One a sample.
        data
            The file, usually a `.bsdf.npz` or XML. It is kept in the database, where no path can go stale.
        scans, sphere_values
            What it was made of: as it came from the database, raw, or with the file that it was read from.
        parents
            Numbers of models or prepared scans that it was made from; what those were made of counts too.
        command
            What made it, as a person would type it.
        settings
            With what, all that changes the result.
        kind
            `model`, or `scans` for prepared ones.
        steps
            What was done in order, each with `step`, `what`, and `settings`, `figures`, `warnings`.
        files
            SHA-256 of the files written by name, by which they are known again; the one of `data` by default.

        Raises
        ------
        ClerestoryError
            The sample has another model of this name, or a scan is not in the database.
        """
        self.sample(sample)
        mark = digest(data)
        with self.transaction():
            there = self.models(sample=sample)
            for model in there:
                if model.sha256 == mark:
                    return model.id
            if any(model.name == name for model in there):
                raise ClerestoryError(f"{self.location}: {sample} has a model {name!r} (choose another name)")
            origin = self.origin(scans, sphere_values)
            above = tuple(dict.fromkeys([*parents, *origin.parents]))
            if origin.unknown:
                raise ClerestoryError(
                    f"{self.location}: {', '.join(origin.unknown)} that the model was made of is not in the database "
                    "(import its file first, and give scans as they were measured, not prepared ones)"
                )
            of_scans = self._inherited(_of_scans.c.scan_id, _of_scans, above, origin.scans)
            of_spheres = self._inherited(_of_spheres.c.sphere_value_id, _of_spheres, above, origin.sphere_values)
            if not of_scans:
                raise ClerestoryError(f"model {name!r}: nothing says what it was made of (give its scans)")
            owner = self._rows.put(tables.samples, {"name": sample}, {})
            number = self._rows.insert(
                _models,
                {
                    "sample_id": owner,
                    "name": name,
                    "kind": kind,
                    "file_name": file_name,
                    "blob_id": blobs.keep(self._connection, data),
                    "command": command,
                    "settings": json.dumps(dict(settings or {}), default=str),
                    "steps": json.dumps([dict(step) for step in steps], default=str),
                    "files": json.dumps(dict(files or {file_name: mark})),
                    "version": _core.__version__,
                    "made": datetime.now(UTC),
                },
            )
            for link, column, ids in (
                (_of_scans, "scan_id", of_scans),
                (_of_spheres, "sphere_value_id", of_spheres),
                (_parents, "parent_id", above),
            ):
                for one in ids:
                    self._connection.execute(insert(link).values(**{"model_id": number, column: one}))
        return number

    def unused_name(self, sample: str, wish: str) -> str:
        """A name that no model of a sample has: the wish, or the wish with a number."""
        return unused(wish, {model.name for model in self.models(sample=sample)})

    def _inherited(
        self, column: Column[int], link: Table, parents: Sequence[int], own: Sequence[int]
    ) -> tuple[int, ...]:
        """What something was made of: its own, and that of what it was made from."""
        asked = select(column).where(link.c.model_id.in_(parents)).order_by(column)
        return tuple(dict.fromkeys([*self._connection.execute(asked).scalars(), *own]))

    def models(self, *, sample: str | None = None) -> list[StoredModel]:
        """All models and prepared scans, or those of a sample, the oldest first."""

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
            above: dict[int, list[int]] = {}
            for model, parent in connection.execute(select(_parents.c.model_id, _parents.c.parent_id)):
                above.setdefault(model, []).append(parent)
            return [
                StoredModel(
                    **{
                        **row,
                        "settings": json.loads(row["settings"]),
                        "steps": tuple(json.loads(row["steps"])),
                        "files": json.loads(row["files"]) or {row["file_name"]: row["sha256"]},
                    },
                    parents=tuple(sorted(above.get(row["id"], ()))),
                )
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
            asked = select(_of_spheres.c.sphere_value_id).where(_of_spheres.c.model_id == number)
            sphere_ids = connection.execute(asked).scalars().all()
            runs = {
                run
                for table, link in ((tables.scans, _of_scans), (tables.sphere_values, _of_spheres))
                for run in connection.execute(
                    select(table.c.run_id).join_from(table, link).where(link.c.model_id == number)
                ).scalars()
            }
        scans = tuple(self.stored_scans(ids=ids))
        values = tuple(self.stored_sphere_values(ids=sphere_ids))
        files = {scan.file_id for scan in scans} | {value.file_id for value in values}
        return Provenance(
            model,
            scans,
            values,
            tuple(file for file in self.files() if file.id in files),
            tuple(run for run in self.runs() if run.id in runs),
        )

    def _content(self, table: Table, number: int, what: str) -> bytes:
        with self._reading() as connection:
            blob = connection.execute(select(table.c.blob_id).where(table.c.id == number)).scalar_one_or_none()
            if blob is None:
                raise ClerestoryError(f"{self.location}: no {what} {number}")
            return blobs.fetch(connection, blob)


def unused(wish: str, taken: Collection[str]) -> str:
    """A name that is not taken: the wish, or the wish with a number."""
    name, k = wish, 2
    while name in taken:
        name, k = f"{wish} {k}", k + 1
    return name
