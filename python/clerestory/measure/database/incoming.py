"""Scans and sphere values on their way in: each to its sample, its run and its file, unless it is there already."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from sqlalchemy import insert, select

from clerestory import _core
from clerestory.measure.database import blobs, tables
from clerestory.measure.database.columns import POINTS_A_CHUNK, pack
from clerestory.measure.database.marks import mark_of_scan, mark_of_sphere
from clerestory.measure.source import digest

if TYPE_CHECKING:
    import os
    from collections.abc import Iterable, Mapping

    from sqlalchemy import Table

    from clerestory.measure.database.rows import Rows
    from clerestory.measure.database.writing import Writing
    from clerestory.measure.scan import Scan
    from clerestory.measure.source import Source
    from clerestory.measure.sphere import SphereValues

KEPT_BYTES = 64 << 20
"""Files up to this size are kept as they were, so that a later version can read them again."""

_TELL_APART = ("manufacturer", "thickness_mm")
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


class Incoming:
    """Scans and sphere values on their way in."""

    def __init__(
        self,
        database: Writing,
        rows: Rows,
        added: Added,
        choices: Mapping[str, object],
        originals: Mapping[str, bytes],
    ) -> None:
        self._database = database
        self._rows = rows
        self._added = added
        self._choices = json.dumps({key: str(value) for key, value in choices.items() if value is not None})
        self._originals = originals
        self._files: dict[str, int | None] = {}  # number of each file by its hash; none where it was there before
        self._runs: dict[tuple[str | None, ...], int] = {}
        self._samples: dict[str, tuple[int, dict[str, Any]]] = {}
        self.odd: list[str] = []

    @property
    def new_files(self) -> list[int]:
        """Numbers of the files that were not there before."""
        return [number for number in self._files.values() if number is not None]

    def scan(self, sample: str, scan: Scan) -> None:
        """Store a scan if it is new."""
        mark = mark_of_scan(scan)
        row = self._place(tables.scans, "scan", sample, scan, mark)
        if row is None:
            return
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
        number = self._rows.insert(tables.scans, row)
        columns = [scan.theta_deg, scan.phi_deg, *scan.values.T]
        if scan.standard_errors is not None:
            columns += [*scan.standard_errors.T]
        for k, start in enumerate(range(0, len(scan), POINTS_A_CHUNK)):
            data = pack([column[start : start + POINTS_A_CHUNK] for column in columns])
            chunk = {"scan_id": number, "number": k, "data": data}
            self._rows.connection.execute(insert(tables.chunks).values(**chunk))
        self._added.scans += 1
        self._added.points += len(scan)

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
        self._rows.insert(tables.sphere_values, row)
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
        owner = self._sample(sample, item)
        there = (
            select(tables.files.c.name)
            .select_from(table.outerjoin(tables.files))
            .where(table.c.sample_id == owner, table.c.mark == mark, table.c.file_id.is_distinct_from(file))
        )
        if file is None:
            there = select(table.c.id).where(table.c.sample_id == owner, table.c.mark == mark)
        twin = self._rows.connection.execute(there).first()
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
            self._files[source.sha256] = self._rows.insert(
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
                    "blob_id": None if original is None else blobs.keep(self._rows.connection, original),
                },
            )
            self._added.files.append(source.name)
        return self._files[source.sha256]

    def _sample(self, name: str, item: Scan | SphereValues) -> int:
        """The number of a sample; what files say of it is written where nothing is known yet."""
        if name not in self._samples:
            number = self._database.describe_sample(name)
            asked = select(*(tables.samples.c[key] for key in _ABOUT_SAMPLES)).where(tables.samples.c.id == number)
            self._samples[name] = (number, dict(self._rows.connection.execute(asked).mappings().one()))
        number, known = self._samples[name]
        said = {key: item.conditions.get(key) for key in _ABOUT_SAMPLES}
        fields: dict[str, Any] = {k: _number(text) if k.endswith("_mm") else text for k, text in said.items()}
        new = {key: value for key, value in fields.items() if value and known[key] is None}
        if new:
            known |= new
            self._database.describe_sample(name, **new)
        for key in _TELL_APART:
            if fields[key] and fields[key] != known[key]:
                text = (
                    f"{'' if item.source is None else f'{item.source.name}: '}{key} {fields[key]}, and {known[key]} of "
                    f"sample {name} so far (--sample names another one)"
                )
                self.odd += [] if text in self.odd else [text]
        return number

    def _run(self, conditions: Mapping[str, str]) -> int:
        """The number of the run: all of a laboratory's day with one person and one configuration."""
        who = (conditions.get("laboratory"), conditions.get("operator"), (conditions.get("date") or "")[:10] or None)
        settings = {key: conditions.get("filter" if key == "filters" else key) for key in _SETTINGS}
        key = (*who, conditions.get("instrument"), *settings.values())
        if key not in self._runs:
            configuration = None
            if conditions.get("instrument") or any(settings.values()):
                fields: dict[str, Any] = {
                    k: _number(v) if k.endswith(("_mm", "_deg")) else v for k, v in settings.items()
                }
                words = [f"{key.rsplit('_', 1)[0]} {v:g}" if isinstance(v, float) else v for key, v in fields.items()]
                name = ", ".join(str(word) for word in words if word) or "as in its files"
                configuration = self._database.describe_configuration(
                    conditions.get("instrument") or "not named",
                    name,
                    **{k: v for k, v in fields.items() if v is not None},
                )
            run = dict(zip(("laboratory", "operator", "date"), who, strict=True))
            self._runs[key] = self._rows.put(tables.runs, {**run, "configuration_id": configuration}, {})
        return self._runs[key]


def bytes_of(paths: Iterable[str | os.PathLike[str]]) -> dict[str, bytes]:
    """Files that are small enough to be kept, by their hashes."""
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
