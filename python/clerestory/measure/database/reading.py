"""What is in the database: lists of all that there is, and scans with their points."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np
from sqlalchemy import and_, func, or_, select

from clerestory._core import ClerestoryError
from clerestory.measure.contents import Contents
from clerestory.measure.database import blobs, records, tables
from clerestory.measure.database.columns import unpack
from clerestory.measure.database.spheres import Spheres, source_of
from clerestory.measure.scan import Measurement, Scan

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from sqlalchemy import ColumnElement, Connection, RowMapping

    from clerestory.directions import Scatter, Side
    from clerestory.measure.scan import Purpose
    from clerestory.measure.source import Source

NEAR_DEG = 0.5
"""Incident directions within this angle [°] are the one that was asked for."""

_scans, _files, _runs, _samples = tables.scans, tables.files, tables.runs, tables.samples
_spheres, _notes, _models = tables.sphere_values, tables.notes, tables.models
_instruments, _configurations = tables.instruments, tables.configurations


class Reading(Spheres):
    """Questions to the database."""

    def samples(self) -> list[records.Sample]:
        """All samples, by name."""

        def number(table: Any, what: Any = None) -> Any:  # noqa: ANN401  # SQLAlchemy's expressions
            counted = func.count() if what is None else func.coalesce(func.sum(what), 0)
            return select(counted).where(table.c.sample_id == _samples.c.id).scalar_subquery()

        asked = select(
            _samples,
            number(_scans).label("scans"),
            number(_scans, _scans.c.points).label("points"),
            number(_spheres).label("sphere_values"),
            number(_models).label("models"),
        ).order_by(_samples.c.name)
        with self._reading() as connection:
            return [
                records.Sample(**{**row, "pictures": tuple(json.loads(row["pictures"] or "[]"))})
                for row in _rows(connection, asked)
            ]

    def sample(self, name: str) -> records.Sample:
        """One sample.

        Raises
        ------
        ClerestoryError
            There is none of this name.
        """
        found = self.samples()
        for sample in found:
            if sample.name == name:
                return sample
        names = ", ".join(sample.name for sample in found) or "none"
        raise ClerestoryError(f"{self.location}: no sample {name!r} (there are: {names})")

    def configurations(self) -> list[records.Configuration]:
        """Instruments as they were set up."""
        columns = [c for c in _configurations.c if c.name not in ("instrument_id", "lamp_spectrum")]
        asked = (
            select(*columns, _instruments.c.name.label("instrument"))
            .join_from(_configurations, _instruments)
            .order_by(_instruments.c.name, _configurations.c.name)
        )
        with self._reading() as connection:
            return [records.Configuration(**row) for row in _rows(connection, asked)]

    def lamp_spectrum(self, configuration: int) -> tuple[np.ndarray, np.ndarray] | None:
        """Wavelengths [nm] and relative power of a configuration's lamp, where it is known."""
        asked = select(_configurations.c.lamp_spectrum).where(_configurations.c.id == configuration)
        with self._reading() as connection:
            data = connection.execute(asked).scalar_one_or_none()
        if data is None:
            return None
        wavelengths, power = unpack(data)
        return wavelengths, power

    def runs(self, *, laboratory: str | None = None, date: str | None = None) -> list[records.Run]:
        """Measurement runs of a laboratory, and of days that begin with `date`."""

        def number(table: Any) -> Any:  # noqa: ANN401
            return select(func.count()).where(table.c.run_id == _runs.c.id).scalar_subquery()

        asked = (
            select(
                *(c for c in _runs.c if c.name != "configuration_id"),
                _instruments.c.name.label("instrument"),
                _configurations.c.name.label("configuration"),
                number(_scans).label("scans"),
                number(_spheres).label("sphere_values"),
            )
            .select_from(_runs.outerjoin(_configurations).outerjoin(_instruments))
            .where(*_of_run(laboratory, date))
            .order_by(_runs.c.date.nulls_last(), _runs.c.id)
        )
        with self._reading() as connection:
            return [records.Run(**row) for row in _rows(connection, asked)]

    def files(self, *, sample: str | None = None) -> list[records.File]:
        """Files that were imported, those with scans or sphere values of a sample."""

        def number(table: Any) -> Any:  # noqa: ANN401
            return select(func.count()).where(table.c.file_id == _files.c.id).scalar_subquery()

        asked = select(_files, number(_scans).label("scans"), number(_spheres).label("sphere_values")).order_by(
            _files.c.id
        )
        if sample is not None:
            within = [
                _files.c.id.in_(select(table.c.file_id).join(_samples).where(_samples.c.name == sample))
                for table in (_scans, _spheres)
            ]
            asked = asked.where(or_(*within))
        with self._reading() as connection:
            return [_file(row) for row in _rows(connection, asked)]

    def file_bytes(self, file: int) -> bytes | None:
        """A file as it was imported, where it was kept."""
        with self._reading() as connection:
            blob = connection.execute(select(_files.c.blob_id).where(_files.c.id == file)).scalar_one_or_none()
            return None if blob is None else blobs.fetch(connection, blob)

    def stored_scans(
        self,
        *,
        sample: str | None = None,
        laboratory: str | None = None,
        date: str | None = None,
        theta_deg: float | None = None,
        phi_deg: float | None = None,
        purpose: Purpose | None = None,
        side: Side | None = None,
        scatter: Scatter | None = None,
        run: int | None = None,
        ids: Sequence[int] | None = None,
    ) -> list[records.StoredScan]:
        """Scans without their points, in the order in which they were imported.

        Parameters
        ----------
        date
            Beginning of a day of ISO 8601, such as `2020-06`.
        theta_deg, phi_deg
            Of the direction to the source [°], within `NEAR_DEG`.
        """
        wanted = [*_of_run(laboratory, date)]
        pairs: tuple[tuple[ColumnElement[str], str | None], ...] = (
            (_samples.c.name, sample),
            (_scans.c.purpose, purpose),
            (_scans.c.side, side),
            (_scans.c.scatter, scatter),
        )
        wanted += [column == value for column, value in pairs if value is not None]
        if theta_deg is not None:
            wanted.append(_scans.c.theta_deg.between(theta_deg - NEAR_DEG, theta_deg + NEAR_DEG))
        if run is not None:
            wanted.append(_scans.c.run_id == run)
        if ids is not None:
            wanted.append(_scans.c.id.in_(list(ids)))
        columns = [c for c in _scans.c if c.name not in _NOT_LISTED]
        asked = (
            select(
                *columns,
                _samples.c.name.label("sample"),
                _files.c.name.label("file"),
                _runs.c.laboratory,
                _runs.c.date,
            )
            .select_from(_scans.join(_samples).join(_runs).outerjoin(_files))
            .where(*wanted)
            .order_by(_scans.c.id)
        )
        with self._reading() as connection:
            found = [
                records.StoredScan(**{**row, "channels": tuple(json.loads(row["channels"]))})
                for row in _rows(connection, asked)
            ]
        if phi_deg is None:
            return found
        # At normal incidence the azimuth means nothing.
        return [
            s for s in found if s.theta_deg == 0.0 or abs((s.phi_deg - phi_deg + 180.0) % 360.0 - 180.0) <= NEAR_DEG
        ]

    def scan(self, number: int) -> Scan:
        """A scan with its points, exactly as they were imported."""
        asked = select(_scans).where(_scans.c.id == number)
        with self._reading() as connection:
            row = next(iter(_rows(connection, asked)), None)
            if row is None:
                raise ClerestoryError(f"{self.location}: no scan {number} (`clerestory measure list scans` has them)")
            return _scan(connection, row, {})

    def scans(self, stored: Sequence[records.StoredScan]) -> Iterator[Scan]:
        """Scans with their points, one at a time."""
        sources: dict[int, Source] = {}
        with self._reading() as connection:
            for one in stored:
                row = next(iter(_rows(connection, select(_scans).where(_scans.c.id == one.id))))
                yield _scan(connection, row, sources)

    def measurement(
        self,
        sample: str,
        *,
        laboratory: str | None = None,
        date: str | None = None,
        theta_deg: float | None = None,
        phi_deg: float | None = None,
    ) -> Measurement:
        """All scans of a sample, beams and dark ones included, or those of one laboratory, day or incident direction.

        Raises
        ------
        ClerestoryError
            There is no such sample.
        """
        self.sample(sample)
        stored = self.stored_scans(
            sample=sample, laboratory=laboratory, date=date, theta_deg=theta_deg, phi_deg=phi_deg
        )
        return Measurement(sample, tuple(self.scans(stored)), self._warnings(sample))

    def contents(self, sample: str, *, laboratory: str | None = None, date: str | None = None) -> Contents:
        """Scans (of a laboratory, of days that begin so) and all sphere values of a sample, as a file would hold them.

        Raises
        ------
        ClerestoryError
            There is no such sample, or no such scan of it.
        """
        measurement = self.measurement(sample, laboratory=laboratory, date=date)
        if not measurement.scans and (laboratory, date) != (None, None):
            raise ClerestoryError(
                f"{self.location}: no scan of {sample!r} by {laboratory or 'any laboratory'}"
                f"{f' of {date}' if date else ''} (`clerestory measure list runs` has laboratories and days)"
            )
        values = tuple(self.sphere_values(sample))
        return Contents((measurement,) if measurement.scans else (), values)

    def notes(self, subject: records.Subject | None = None, subject_id: int | None = None) -> list[records.Note]:
        """Notes and warnings, on one thing or on all, the oldest first."""
        wanted = []
        if subject is not None:
            wanted.append(_notes.c.subject == subject)
        if subject_id is not None:
            wanted.append(_notes.c.subject_id == subject_id)
        with self._reading() as connection:
            return [
                records.Note(**row) for row in _rows(connection, select(_notes).where(*wanted).order_by(_notes.c.id))
            ]

    def _warnings(self, sample: str) -> tuple[str, ...]:
        """What was odd in a sample's files."""
        ids = [file.id for file in self.files(sample=sample)]
        of_files = and_(_notes.c.subject == "file", _notes.c.subject_id.in_(ids))
        of_sample = and_(_notes.c.subject == "sample", _notes.c.subject_id == self.sample(sample).id)
        asked = select(_notes.c.text).where(_notes.c.kind == "warning", or_(of_files, of_sample)).order_by(_notes.c.id)
        with self._reading() as connection:
            return tuple(connection.execute(asked).scalars())


_NOT_LISTED = ("sample_id", "run_id", "mark", "conditions", "errors")


def _of_run(laboratory: str | None, date: str | None) -> list[ColumnElement[bool]]:
    wanted: list[ColumnElement[bool]] = []
    if laboratory is not None:
        wanted.append(func.lower(_runs.c.laboratory) == laboratory.lower())
    if date is not None:
        wanted.append(_runs.c.date.startswith(date, autoescape=True))
    return wanted


def _rows(connection: Connection, asked: Any) -> Iterator[RowMapping]:  # noqa: ANN401
    yield from connection.execute(asked).mappings()


def _file(row: RowMapping) -> records.File:
    fields = {key: value for key, value in row.items() if key != "blob_id"}
    fields["header"], fields["choices"] = tuple(json.loads(row["header"])), json.loads(row["choices"])
    return records.File(**fields, kept=row["blob_id"] is not None)


def _scan(connection: Connection, row: RowMapping, sources: dict[int, Source]) -> Scan:
    channels = tuple(json.loads(row["channels"]))
    count, width = row["points"], len(channels)
    theta, phi, values = np.empty(count), np.empty(count), np.empty((count, width))
    errors = np.empty((count, width)) if row["errors"] else None
    chunks, at = tables.chunks, 0
    asked = select(chunks.c.data).where(chunks.c.scan_id == row["id"]).order_by(chunks.c.number)
    asked = asked.execution_options(yield_per=16)  # neither side holds all chunks at once
    for data in connection.execute(asked).scalars():
        columns = unpack(data)
        here = slice(at, at + len(columns[0]))
        theta[here], phi[here] = columns[0], columns[1]
        values[here] = np.stack(columns[2 : 2 + width], axis=-1)
        if errors is not None:
            errors[here] = np.stack(columns[2 + width :], axis=-1)
        at = here.stop
    if at != count:
        raise ClerestoryError(f"scan {row['id']}: {at} of {count} points are stored (restore the database from a copy)")
    return Scan(
        row["side"],
        row["scatter"],
        row["theta_deg"],
        row["phi_deg"],
        theta,
        phi,
        values,
        quantity=row["quantity"],
        channels=channels,
        standard_errors=errors,
        purpose=row["purpose"],
        conditions=json.loads(row["conditions"]),
        source=source_of(connection, row["file_id"], sources),
    )
