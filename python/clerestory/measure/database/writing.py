"""What goes into the database: the contents of files, words about samples and instruments, notes."""

from __future__ import annotations

import json
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from sqlalchemy import insert, select, update

from clerestory import _core
from clerestory._core import ClerestoryError
from clerestory.measure.database import blobs, tables
from clerestory.measure.database.columns import POINTS_A_CHUNK, pack
from clerestory.measure.database.marks import mark_of_scan, mark_of_sphere
from clerestory.measure.database.reading import Reading
from clerestory.measure.database.records import SUBJECTS
from clerestory.measure.source import digest

if TYPE_CHECKING:
    import os
    from collections.abc import Iterable, Mapping

    from numpy.typing import ArrayLike
    from sqlalchemy import Table

    from clerestory.measure.contents import Contents
    from clerestory.measure.database.records import Subject
    from clerestory.measure.scan import Scan
    from clerestory.measure.source import Source
    from clerestory.measure.sphere import SphereValues

KEPT_BYTES = 64 << 20
"""Files up to this size are kept as they were, so that a later version can read them again."""

_ABOUT_SAMPLES = ("manufacturer", "description", "symmetry", "thickness_mm")
_SETTINGS = ("lamp", "detector", "filters", "spot_mm", "source_cone_deg", "detector_cone_deg")


@dataclass
class Added:
    """What an import did."""

    files: list[str] = field(default_factory=list)
    """Names of files that are new."""
    known: list[str] = field(default_factory=list)
    """What was there already, in words."""
    samples: list[str] = field(default_factory=list)
    scans: int = 0
    points: int = 0
    sphere_values: int = 0
    warnings: list[str] = field(default_factory=list)
    """What was odd but understood."""

    def __add__(self, other: Added) -> Added:
        return Added(
            self.files + other.files,
            self.known + other.known,
            list(dict.fromkeys(self.samples + other.samples)),
            self.scans + other.scans,
            self.points + other.points,
            self.sphere_values + other.sphere_values,
            list(dict.fromkeys(self.warnings + other.warnings)),
        )


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
        known: dict[str, int | None] = {}
        with self.transaction():
            import_ = _Import(self, added, choices or {}, _bytes_of(originals), known)
            for measurement in contents.measurements:
                name = sample or measurement.sample
                files = {scan.source for scan in measurement.scans}
                new = False
                for scan in measurement.scans:
                    new |= import_.scan(name, replace(scan, conditions={**scan.conditions, **about}))
                added.warnings += [text for text in measurement.warnings if text not in added.warnings]
                if new:
                    of = next(iter(files)) if len(files) == 1 else None
                    self._warn(name, None if of is None else known.get(of.sha256), measurement.warnings)
            for values in contents.sphere_values:
                import_.sphere(sample or values.sample, replace(values, conditions={**values.conditions, **about}))
            for text in contents.warnings:
                for number in {n for n in known.values() if n is not None} if len(known) == 1 else ():
                    self._note("file", number, text, "warning", None)
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
            return self._put(tables.samples, {"name": name}, fields)

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
            owner = self._put(
                tables.instruments, {"name": instrument}, {key: value for key, value in of.items() if value is not None}
            )
            return self._put(tables.configurations, {"instrument_id": owner, "name": name}, fields)

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

    def _note(self, subject: Subject, number: int, text: str, kind: str, author: str | None) -> int:
        row = {"subject": subject, "subject_id": number, "text": text, "kind": kind, "author": author}
        return self._insert(tables.notes, {**row, "written": datetime.now(UTC)})

    def _warn(self, sample: str, file: int | None, texts: Iterable[str]) -> None:
        subject: tuple[Subject, int] = ("sample", self._put(tables.samples, {"name": sample}, {}))
        if file is not None:
            subject = ("file", file)
        there = {note.text for note in self.notes(*subject)}
        for text in texts:
            if text not in there:
                self._note(*subject, text, "warning", None)

    def _insert(self, table: Table, row: dict[str, Any]) -> int:
        done = self._connection.execute(insert(table).values(**row))
        return cast("int", done.inserted_primary_key[0])  # type: ignore[index]  # an insert of one row has one

    def _find(self, table: Table, key: Mapping[str, Any]) -> int | None:
        asked = select(table.c.id).where(*(table.c[name].is_not_distinct_from(value) for name, value in key.items()))
        return cast("int | None", self._connection.execute(asked.order_by(table.c.id)).scalars().first())

    def _put(self, table: Table, key: Mapping[str, Any], fields: Mapping[str, Any]) -> int:
        """The number of the row with a key, made if it is new, with these fields written."""
        number = self._find(table, key)
        if number is None:
            return self._insert(table, {**key, **fields})
        if fields:
            self._connection.execute(update(table).where(table.c.id == number).values(**fields))
        return number


class _Import:
    """Scans and sphere values on their way in."""

    def __init__(
        self,
        database: Writing,
        added: Added,
        choices: Mapping[str, object],
        originals: Mapping[str, bytes],
        known: dict[str, int | None],
    ) -> None:
        self._database = database
        self._added = added
        self._choices = json.dumps({key: str(value) for key, value in choices.items() if value is not None})
        self._originals = originals
        self._files = known  # number of each new file by its hash; none where it was there before
        self._runs: dict[tuple[str | None, ...], int] = {}
        self._samples: dict[str, int] = {}

    def scan(self, sample: str, scan: Scan) -> bool:
        """Store a scan if it is new."""
        mark = mark_of_scan(scan)
        row = self._place(tables.scans, "scan", sample, scan, mark)
        if row is None:
            return False
        first = scan.values[:, 0] if scan.channels and len(scan) else np.empty(0)
        finite = np.flatnonzero(np.isfinite(first))
        if finite.size:
            peak = finite[np.argmax(first[finite])]
            row |= {
                "value_min": float(first[finite].min()),
                "value_max": float(first[peak]),
                "peak_theta_deg": float(scan.theta_deg[peak]),
                "peak_phi_deg": float(scan.phi_deg[peak]),
            }
        row |= {
            "purpose": scan.purpose,
            "side": scan.incident_side,
            "scatter": scan.scatter,
            "quantity": scan.quantity,
            "channels": json.dumps(scan.channels),
            "theta_deg": float(scan.incident_theta_deg),
            "phi_deg": float(scan.incident_phi_deg),
            "conditions": json.dumps(dict(scan.conditions)),
            "points": len(scan),
            "errors": int(scan.standard_errors is not None),
            "outgoing_theta_max_deg": float(scan.theta_deg.max()) if len(scan) else None,
        }
        number = self._database._insert(tables.scans, row)
        columns = [scan.theta_deg, scan.phi_deg, *scan.values.T]
        if scan.standard_errors is not None:
            columns += [*scan.standard_errors.T]
        for k, start in enumerate(range(0, len(scan), POINTS_A_CHUNK)):
            data = pack([column[start : start + POINTS_A_CHUNK] for column in columns])
            chunk = {"scan_id": number, "number": k, "data": data}
            self._database._connection.execute(insert(tables.chunks).values(**chunk))
        self._added.scans += 1
        self._added.points += len(scan)
        return True

    def sphere(self, sample: str, values: SphereValues) -> None:
        """Store sphere values if they are new."""
        row = self._place(tables.sphere_values, "sphere values", sample, values, mark_of_sphere(values))
        if row is None:
            return
        columns = [values.wavelength_nm, values.values, values.standard_errors]
        row |= {
            "side": values.incident_side,
            "scatter": values.scatter,
            "collected": values.collected,
            "theta_deg": None if np.isnan(values.theta_deg) else float(values.theta_deg),
            "phi_deg": float(values.phi_deg),
            "bands": json.dumps(values.bands),
            "conditions": json.dumps(dict(values.conditions)),
            "data": pack([column for column in columns if column is not None]),
            "errors": int(values.standard_errors is not None),
        }
        self._database._insert(tables.sphere_values, row)
        self._added.sphere_values += 1

    def _place(
        self, table: Table, what: str, sample: str, item: Scan | SphereValues, mark: str
    ) -> dict[str, Any] | None:
        """Where something belongs (sample, run, file); nothing if it is there already."""
        file = None
        if item.source is not None:
            file = self._file(item.source)
            if file is None:
                return None
        owner = self._sample(sample, item.conditions)
        there = (
            select(tables.files.c.name)
            .select_from(table.outerjoin(tables.files))
            .where(table.c.sample_id == owner, table.c.mark == mark, table.c.file_id.is_distinct_from(file))
        )
        if file is None:
            there = select(table.c.id).where(table.c.sample_id == owner, table.c.mark == mark)
        twin = self._database._connection.execute(there).first()
        if twin is not None:
            name = "an import before" if file is None or twin[0] is None else str(twin[0])
            text = f"{what} of {sample} that came with {name}"
            self._added.known += [] if text in self._added.known else [text]
            return None
        if sample not in self._added.samples:
            self._added.samples.append(sample)
        return {"sample_id": owner, "run_id": self._run(item.conditions), "file_id": file, "mark": mark}

    def _file(self, source: Source) -> int | None:
        """The number of a file that is new."""
        if source.sha256 not in self._files:
            self._files[source.sha256] = None
            if self._database.has_file(source.sha256):
                self._added.known.append(source.name)
                return None
            original = self._originals.get(source.sha256)
            self._files[source.sha256] = self._database._insert(
                tables.files,
                {
                    "name": source.name,
                    "sha256": source.sha256,
                    "format": source.format,
                    "convention": source.convention,
                    "header": json.dumps(source.header),
                    "choices": self._choices,
                    "imported": datetime.now(UTC),
                    "version": _core.__version__,
                    "blob_id": None if original is None else blobs.keep(self._database._connection, original),
                },
            )
            self._added.files.append(source.name)
        return self._files[source.sha256]

    def _sample(self, name: str, conditions: Mapping[str, str]) -> int:
        """The number of a sample; what files say of it is written where nothing is known yet."""
        if name not in self._samples:
            number = self._database.describe_sample(name)
            self._samples[name] = number
            asked = select(*(tables.samples.c[key] for key in _ABOUT_SAMPLES)).where(tables.samples.c.id == number)
            now = self._database._connection.execute(asked).mappings().one()
            said = {key: conditions[key] for key in _ABOUT_SAMPLES if now[key] is None and conditions.get(key)}
            fields = {key: _number(text) if key.endswith("_mm") else text for key, text in said.items()}
            self._database.describe_sample(name, **{k: v for k, v in fields.items() if v is not None})
        return self._samples[name]

    def _run(self, conditions: Mapping[str, str]) -> int:
        """The number of the run: all of a laboratory's day with one person and one configuration."""
        who = (conditions.get("laboratory"), conditions.get("operator"), (conditions.get("date") or "")[:10] or None)
        settings = {key: conditions.get("filter" if key == "filters" else key) for key in _SETTINGS}
        key = (*who, conditions.get("instrument"), *settings.values())
        if key not in self._runs:
            configuration = None
            if conditions.get("instrument") or any(settings.values()):
                fields = {k: _number(v) if k.endswith(("_mm", "_deg")) else v for k, v in settings.items()}
                words = [f"{key.rsplit('_', 1)[0]} {v:g}" if isinstance(v, float) else v for key, v in fields.items()]
                name = ", ".join(str(word) for word in words if word) or "as in its files"
                configuration = self._database.describe_configuration(
                    conditions.get("instrument") or "not named",
                    name,
                    **{k: v for k, v in fields.items() if v is not None},
                )
            run = dict(zip(("laboratory", "operator", "date"), who, strict=True))
            self._runs[key] = self._database._put(tables.runs, {**run, "configuration_id": configuration}, {})
        return self._runs[key]


def _bytes_of(paths: Iterable[str | os.PathLike[str]]) -> dict[str, bytes]:
    found = {}
    for path in map(Path, paths):
        if path.stat().st_size <= KEPT_BYTES:
            data = path.read_bytes()
            found[digest(data)] = data
    return found


def _number(text: str | None) -> float | None:
    """A number with its unit, as headers have it; none where it is not one."""
    try:
        value = float((text or "").split()[0])
    except (ValueError, IndexError):
        return None
    return value if np.isfinite(value) else None


def _refuse_unknown(table: Table, fields: Mapping[str, Any], what: str, *, leave: tuple[str, ...]) -> None:
    names = [column.name for column in table.c if column.name not in leave]
    for key, value in fields.items():
        if key not in names:
            raise ClerestoryError(f"a {what} has no {key!r} (there are {', '.join(names)})")
        if table.c[key].type.python_type is float and value is not None and not float(value) > 0.0:
            raise ClerestoryError(f"{what}: {key} {value:g} is not a size (give one above 0)")
