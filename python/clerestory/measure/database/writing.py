"""What goes into the database: the contents of files, words about samples and instruments, notes."""

from __future__ import annotations

import json
from dataclasses import replace
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any

import numpy as np
from sqlalchemy import select

from clerestory._core import ClerestoryError
from clerestory.measure.database import tables
from clerestory.measure.database.columns import pack
from clerestory.measure.database.incoming import Added, Incoming, bytes_of
from clerestory.measure.database.reading import Reading
from clerestory.measure.database.records import SUBJECTS
from clerestory.measure.database.rows import Rows

if TYPE_CHECKING:
    import os
    from collections.abc import Iterable, Mapping

    from numpy.typing import ArrayLike
    from sqlalchemy import Table

    from clerestory.measure.contents import Contents
    from clerestory.measure.database.records import Subject


class Writing(Reading):
    """What is written; each method is done whole or not at all, and several within one `transaction`."""

    def add(
        self,
        contents: Contents,
        *,
        sample: str | None = None,
        conditions: Mapping[str, str] | None = None,
        choices: Mapping[str, object] | None = None,
        originals: Iterable[str | os.PathLike[str]] = (),
    ) -> Added:
        """Take over what files hold; a file that is known by its bytes is not taken again.

        Parameters
        ----------
        sample
            Name of the sample in place of the files'.
        conditions
            What a person knows of all scans, by the keys of `clerestory.measure.scan.CONDITIONS`; it goes before what
            the files say.
        choices
            What the person chose where the files are silent (side, convention, …), kept beside the files.
        originals
            The files themselves; those up to `KEPT_BYTES` are kept in the database.
        """
        added = Added(warnings=list(contents.warnings))
        about = dict(conditions or {})
        with self.transaction():
            incoming = Incoming(self, self._rows, added, choices or {}, bytes_of(originals))
            for measurement in contents.measurements:
                before = added.scans
                for scan in measurement.scans:
                    incoming.scan(sample or measurement.sample, replace(scan, conditions={**scan.conditions, **about}))
                added.warnings += [text for text in measurement.warnings if text not in added.warnings]
                if added.scans > before:
                    self._warn(measurement.warnings, incoming.new_files, [sample or measurement.sample])
            for values in contents.sphere_values:
                incoming.sphere(sample or values.sample, replace(values, conditions={**values.conditions, **about}))
            if added.samples:
                self._warn([*contents.warnings, *incoming.odd], incoming.new_files, added.samples)
            added.warnings += incoming.odd
        return added

    def has_file(self, sha256: str) -> bool:
        """Whether a file of these bytes was imported."""
        with self._reading() as connection:
            asked = select(tables.files.c.id).where(tables.files.c.sha256 == sha256)
            return connection.execute(asked).first() is not None

    def describe_sample(self, name: str, *, pictures: Iterable[str] | None = None, **about: str | float | None) -> int:
        """Write down what is known of a sample, which is made if it is new; the number that it has.

        Parameters
        ----------
        pictures
            Paths or addresses of photographs and CAD drawings.
        about
            manufacturer, description, structure_period_mm, width_mm, height_mm, thickness_mm, symmetry.
        """
        fields: dict[str, Any] = dict(about)
        _refuse_unknown(tables.samples, fields, "sample", leave=("id", "name", "pictures"))
        if pictures is not None:
            fields["pictures"] = json.dumps(list(pictures))
        if not name.strip():
            raise ClerestoryError("a sample needs a name (give --sample NAME)")
        with self.transaction():
            return self._rows.put(tables.samples, {"name": name}, fields)

    def describe_configuration(
        self,
        instrument: str,
        name: str,
        *,
        kind: str | None = None,
        manufacturer: str | None = None,
        lamp_spectrum: tuple[ArrayLike, ArrayLike] | None = None,
        **settings: str | float | None,
    ) -> int:
        """Write down how an instrument is set up; the number that the configuration has.

        Parameters
        ----------
        kind, manufacturer
            Of the instrument.
        lamp_spectrum
            Wavelengths [nm] and relative power.
        settings
            lamp, detector, filters, spot_mm, source_cone_deg, detector_cone_deg.
        """
        fields: dict[str, Any] = dict(settings)
        _refuse_unknown(tables.configurations, fields, "configuration", leave=("id", "name", "instrument_id"))
        if lamp_spectrum is not None:
            columns = [np.asarray(column, dtype=np.float64) for column in lamp_spectrum]
            if columns[0].ndim != 1 or columns[0].shape != columns[1].shape:
                raise ClerestoryError("a lamp's spectrum has as many wavelengths as powers")
            fields["lamp_spectrum"] = pack(columns)
        of = {"kind": kind, "manufacturer": manufacturer}
        with self.transaction():
            owner = self._rows.put(
                tables.instruments, {"name": instrument}, {key: value for key, value in of.items() if value is not None}
            )
            return self._rows.put(tables.configurations, {"instrument_id": owner, "name": name}, fields)

    def note(self, subject: Subject, number: int, text: str, *, author: str | None = None) -> int:
        """Write a note on a sample, instrument, configuration, run, file, scan, model or report.

        Raises
        ------
        ClerestoryError
            There is no such thing.
        """
        if subject not in SUBJECTS:
            raise ClerestoryError(f"nothing is called {subject!r} (give {', '.join(SUBJECTS)})")
        table = tables.metadata.tables[f"{subject}s"]
        with self.transaction():
            if self._connection.execute(select(table.c.id).where(table.c.id == number)).first() is None:
                raise ClerestoryError(f"{self.location}: no {subject} {number}")
            return self._note(subject, number, text, "note", author)

    @property
    def _rows(self) -> Rows:
        return Rows(self._connection)

    def _note(self, subject: Subject, number: int, text: str, kind: str, author: str | None) -> int:
        row = {"subject": subject, "subject_id": number, "text": text, "kind": kind, "author": author}
        return self._rows.insert(tables.notes, {**row, "written": datetime.now(UTC)})

    def _warn(self, texts: Iterable[str], files: list[int], samples: Iterable[str]) -> None:
        """Keep what was odd with the file if there is just one, or else with the samples."""
        subjects: list[tuple[Subject, int]] = [("file", files[0])] if len(files) == 1 else []
        subjects = subjects or [("sample", self.describe_sample(name)) for name in samples]
        for subject in subjects:
            there = {note.text for note in self.notes(*subject)}
            for text in texts:
                if text not in there:
                    self._note(*subject, text, "warning", None)


def _refuse_unknown(table: Table, fields: Mapping[str, Any], what: str, *, leave: tuple[str, ...]) -> None:
    names = [column.name for column in table.c if column.name not in leave]
    for key, value in fields.items():
        if key not in names:
            raise ClerestoryError(f"a {what} has no {key!r} (there are {', '.join(names)})")
        if table.c[key].type.python_type is float and value is not None and not float(value) > 0.0:
            raise ClerestoryError(f"{what}: {key} {value:g} is not a size (give one above 0)")
