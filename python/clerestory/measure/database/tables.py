"""The tables of the laboratory's database, as this version of Clerestory knows them.

A sample is measured in runs; a run, of one configuration of an instrument, gives files; a file holds scans and values
of spheres; a scan's points lie in chunks. Models and reports name what they were made of, so that nothing can be
removed under them; checks, which are reports too, go with what was checked. `migrations` holds the way here from older
schemas.
"""

from __future__ import annotations

from datetime import UTC, datetime
from typing import TYPE_CHECKING

from sqlalchemy import (
    Column,
    DateTime,
    Float,
    ForeignKey,
    Index,
    Integer,
    LargeBinary,
    MetaData,
    String,
    Table,
    Text,
    TypeDecorator,
    UniqueConstraint,
)

if TYPE_CHECKING:
    from sqlalchemy import Dialect


class Moment(TypeDecorator[datetime]):
    """A time in UTC; SQLite forgets the zone."""

    impl = DateTime(timezone=True)
    cache_ok = True

    def process_bind_param(self, value: datetime | None, dialect: Dialect) -> datetime | None:  # noqa: ARG002
        """To the database."""
        return None if value is None else value.astimezone(UTC)

    def process_result_value(self, value: datetime | None, dialect: Dialect) -> datetime | None:  # noqa: ARG002
        """From the database."""
        if value is None:
            return None
        return value.replace(tzinfo=UTC) if value.tzinfo is None else value.astimezone(UTC)


metadata = MetaData(
    naming_convention={
        "pk": "pk_%(table_name)s",
        "fk": "fk_%(table_name)s_%(column_0_name)s",
        "uq": "uq_%(table_name)s_%(column_0_name)s",
        "ix": "ix_%(table_name)s_%(column_0_name)s",
    }
)


def _key() -> Column[int]:
    return Column("id", Integer, primary_key=True)


def _of(table: str, *, optional: bool = False, cascade: bool = False, primary: bool = False) -> Column[int]:
    """A reference; rows go with what they refer to (`cascade`), or keep it from being removed."""
    return Column(
        f"{table.removesuffix('s')}_id",
        ForeignKey(f"{table}.id", ondelete="CASCADE" if cascade else None),
        primary_key=primary,
        nullable=optional,
    )


def _link(owner: str, what: str) -> Table:
    """Rows of one table that name rows of another: they go with the owner's, and keep the others from being removed."""
    return Table(f"{owner[:-1]}_{what}", metadata, _of(owner, cascade=True, primary=True), _of(what, primary=True))


# Large contents (files as they were, models, reports) in pieces, beside the rows that lists are made of.
blobs = Table(
    "blobs",
    metadata,
    _key(),
    Column("sha256", String(64), nullable=False),
    Column("bytes", Integer, nullable=False),
)
pieces = Table(
    "pieces",
    metadata,
    _of("blobs", cascade=True, primary=True),
    Column("number", Integer, primary_key=True),
    Column("data", LargeBinary, nullable=False),
)

samples = Table(
    "samples",
    metadata,
    _key(),
    Column("name", Text, nullable=False, unique=True),
    Column("manufacturer", Text),
    Column("description", Text),
    Column("structure_period_mm", Float),
    Column("width_mm", Float),
    Column("height_mm", Float),
    Column("thickness_mm", Float),
    Column("symmetry", Text),
    Column("pictures", Text),  # JSON: paths or addresses of photographs and CAD drawings
)

instruments = Table(
    "instruments",
    metadata,
    _key(),
    Column("name", Text, nullable=False, unique=True),
    Column("kind", Text),
    Column("manufacturer", Text),
    Column("description", Text),
)
configurations = Table(
    "configurations",
    metadata,
    _key(),
    _of("instruments"),
    Column("name", Text, nullable=False),
    Column("lamp", Text),
    Column("lamp_spectrum", LargeBinary),  # columns: wavelength [nm], relative power
    Column("detector", Text),
    Column("filters", Text),
    Column("spot_mm", Float),
    Column("source_cone_deg", Float),
    Column("detector_cone_deg", Float),
    UniqueConstraint("instrument_id", "name"),
)
runs = Table(
    "runs",
    metadata,
    _key(),
    Column("laboratory", Text),
    Column("operator", Text),
    Column("date", Text),  # ISO 8601: a day, or day and time, as the file has it
    _of("configurations", optional=True),
)

files = Table(
    "files",
    metadata,
    _key(),
    Column("name", Text, nullable=False),
    Column("sha256", String(64), nullable=False, unique=True),
    Column("format", Text, nullable=False),
    Column("convention", Text, nullable=False),
    Column("header", Text, nullable=False),  # JSON: its lines
    Column("choices", Text, nullable=False),  # JSON: what a person said where the file is silent
    Column("imported", Moment, nullable=False),
    Column("version", Text, nullable=False),  # of Clerestory, which read it
    _of("blobs", optional=True),
)
scans = Table(
    "scans",
    metadata,
    _key(),
    _of("samples"),
    _of("runs"),
    _of("files", optional=True, cascade=True),
    Column("mark", String(64), nullable=False),  # SHA-256 of all that it holds
    Column("purpose", String(16), nullable=False),
    Column("side", String(16), nullable=False),
    Column("scatter", String(16), nullable=False),
    Column("quantity", String(16), nullable=False),
    Column("channels", Text, nullable=False),  # JSON
    Column("theta_deg", Float, nullable=False),
    Column("phi_deg", Float, nullable=False),
    Column("conditions", Text, nullable=False),  # JSON
    Column("points", Integer, nullable=False),
    Column("errors", Integer, nullable=False),  # 1 if chunks hold standard errors
    Column("outgoing_theta_max_deg", Float),
    # Of the first channel; none of a scan without points.
    Column("value_min", Float),
    Column("value_max", Float),
    Column("peak_theta_deg", Float),
    Column("peak_phi_deg", Float),
    Index("ix_scans_mark", "sample_id", "mark"),
    Index("ix_scans_file_id", "file_id"),
)
chunks = Table(
    "chunks",
    metadata,
    _of("scans", cascade=True, primary=True),
    Column("number", Integer, primary_key=True),
    Column("data", LargeBinary, nullable=False),  # columns: θ, φ, values by channel, their standard errors
)
sphere_values = Table(
    "sphere_values",
    metadata,
    _key(),
    _of("samples"),
    _of("runs"),
    _of("files", optional=True, cascade=True),
    Column("mark", String(64), nullable=False),
    Column("side", String(16), nullable=False),
    Column("scatter", String(16), nullable=False),
    Column("collected", String(16), nullable=False),
    Column("theta_deg", Float),  # none for diffuse light
    Column("phi_deg", Float, nullable=False),
    Column("bands", Text, nullable=False),  # JSON; empty for a spectrum
    Column("conditions", Text, nullable=False),
    Column("data", LargeBinary, nullable=False),  # columns: wavelengths if a spectrum, values, standard errors if known
    Column("errors", Integer, nullable=False),
    Index("ix_sphere_values_mark", "sample_id", "mark"),
    Index("ix_sphere_values_file_id", "file_id"),
)

models = Table(
    "models",
    metadata,
    _key(),
    _of("samples"),
    Column("name", Text, nullable=False),
    Column("file_name", Text, nullable=False),
    _of("blobs"),
    Column("command", Text, nullable=False),
    Column("settings", Text, nullable=False),  # JSON
    Column("version", Text, nullable=False),
    Column("made", Moment, nullable=False),
    Column("kind", String(16), nullable=False, server_default="model"),  # model; or scans, prepared ones
    Column("steps", Text, nullable=False, server_default="[]"),  # JSON: what was done, in order
    Column("files", Text, nullable=False, server_default="{}"),  # JSON: SHA-256 of the files written, by name
    UniqueConstraint("sample_id", "name"),
)
model_parents = Table(
    "model_parents",
    metadata,
    _of("models", cascade=True, primary=True),
    Column("parent_id", ForeignKey("models.id"), primary_key=True),  # the model or scans that it was made from
)
model_scans = _link("models", "scans")
model_sphere_values = _link("models", "sphere_values")
reports = Table(
    "reports",
    metadata,
    _key(),
    Column("name", Text, nullable=False, unique=True),
    Column("file_name", Text, nullable=False),
    _of("blobs"),
    Column("made", Moment, nullable=False),
    Column("kind", String(16), nullable=False, server_default="report"),  # report; or check, what a check found
)
report_models = _link("reports", "models")
report_samples = _link("reports", "samples")
report_scans = _link("reports", "scans")
report_sphere_values = _link("reports", "sphere_values")

notes = Table(
    "notes",
    metadata,
    _key(),
    Column("subject", String(16), nullable=False),  # sample, instrument, configuration, run, file, scan, model, report
    Column("subject_id", Integer, nullable=False),
    Column("kind", String(16), nullable=False),  # note, of a person; warning, of what was odd in a file
    Column("text", Text, nullable=False),
    Column("author", Text),
    Column("written", Moment, nullable=False),
    Index("ix_notes_subject", "subject", "subject_id"),
)
