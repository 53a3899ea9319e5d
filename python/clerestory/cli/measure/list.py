"""`clerestory measure list`: what is in the laboratory's database, and the catalogue of instruments and programs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from clerestory.cli.common import JsonOption, UsageError, one_of, print_json, say, table
from clerestory.cli.measure.options import (
    DatabaseOption,
    DateOption,
    IncidentOption,
    LaboratoryOption,
    SampleOption,
    incident_of,
    open_database,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from clerestory.measure.database import Database

_KINDS = (
    "samples",
    "runs",
    "scans",
    "spheres",
    "files",
    "models",
    "reports",
    "checks",
    "configurations",
    "notes",
    "instruments",
    "software",
)
_SHIPPED = ("instruments", "software")
# Which filters each kind knows.
_FILTERS = {
    "samples": ("sample",),
    "runs": ("laboratory", "date"),
    "scans": ("sample", "laboratory", "date", "incident"),
    "spheres": ("sample",),
    "files": ("sample",),
    "models": ("sample",),
    "reports": ("sample",),
    "checks": ("sample",),
}


def list(  # noqa: A001  # the command's name
    what: Annotated[str, typer.Argument(metavar="WHAT", help=f"{', '.join(_KINDS)}.")] = "samples",
    *,
    db: DatabaseOption = None,
    sample: SampleOption = None,
    laboratory: LaboratoryOption = None,
    date: DateOption = None,
    incident: IncidentOption = None,
    find: Annotated[
        str | None, typer.Option("--find", metavar="WORD", help="Only what has this word anywhere.")
    ] = None,
    upgrade: Annotated[
        bool, typer.Option("--upgrade", help="Bring a database of an older version up to date (keep a copy).")
    ] = False,
    as_json: JsonOption = False,
) -> None:
    """List what the laboratory's database holds, or the instruments and programs that Clerestory knows.

    Example: clerestory measure list scans --sample twill --incident 40,90 --db lab.sqlite
    """
    kind = one_of(what, "WHAT", _KINDS)
    given = {"sample": sample, "laboratory": laboratory, "date": date, "incident": incident}
    for name, value in given.items():
        if value is not None and name not in _FILTERS.get(kind, ()):
            having = " and ".join(k for k, names in _FILTERS.items() if name in names)
            raise UsageError(f"--{name}: does not choose among {kind} (it does among {having})")
    if kind in _SHIPPED:
        if upgrade:
            raise UsageError(f"--upgrade: {kind} come with Clerestory, not from a database (leave it out)")
        rows: Sequence[object] = _catalogue(kind)
    else:
        direction = incident_of(incident)
        with open_database(db, upgrade=upgrade) as database:
            rows = _rows(database, kind, sample, laboratory, date, direction)
    if find is not None:
        rows = [row for row in rows if find.lower() in str(row).lower()]
    if as_json:
        print_json(rows)
    elif kind in _SHIPPED:
        _print_catalogue(rows)
    elif not rows:
        say(f"no {kind}")
    else:
        _print(kind, rows)


def _rows(
    database: Database,
    kind: str,
    sample: str | None,
    laboratory: str | None,
    date: str | None,
    direction: tuple[float | None, float | None],
) -> Sequence[object]:
    if sample is not None:
        database.sample(sample)
    if kind == "scans":
        theta, phi = direction
        return database.stored_scans(sample=sample, laboratory=laboratory, date=date, theta_deg=theta, phi_deg=phi)
    if kind == "samples":
        return [one for one in database.samples() if sample in (None, one.name)]
    if kind == "runs":
        return database.runs(laboratory=laboratory, date=date)
    if kind == "files":
        return database.files(sample=sample)
    if kind == "spheres":
        return database.stored_sphere_values(sample=sample)
    if kind == "models":
        return database.models(sample=sample)
    if kind == "reports":
        return database.reports(sample=sample)
    if kind == "checks":
        return database.checks(sample=sample)
    return database.configurations() if kind == "configurations" else database.notes()


def _catalogue(kind: str) -> Sequence[dict[str, Any]]:
    from clerestory.measure.database import catalogue

    found = catalogue.instruments() if kind == "instruments" else catalogue.software()
    return [one.model_dump() for one in found]


def _print_catalogue(rows: Sequence[Any]) -> None:
    for row in rows:
        say(f"{row['name']}")
        for key, value in row.items():
            if key == "name" or value in (None, []):
                continue
            if key == "wavelength_nm":
                text = f"{value[0]:g} to {value[1]:g}"
            elif isinstance(value, bool):
                text = "yes" if value else "no"
            elif isinstance(value, float):
                text = f"{value:g}"
            else:
                text = value if isinstance(value, str) else "; ".join(value)
            say(f"  {key.replace('_', ' ')}: {text}")


# Columns of each table: heads, and what stands under them.
_COLUMNS: dict[str, tuple[tuple[str, str], ...]] = {
    "samples": (
        ("sample", "name"),
        ("manufacturer", "manufacturer"),
        ("scans", "scans"),
        ("points", "points"),
        ("sphere", "sphere_values"),
        ("models", "models"),
    ),
    "runs": (
        ("run", "id"),
        ("laboratory", "laboratory"),
        ("date", "date"),
        ("operator", "operator"),
        ("instrument", "instrument"),
        ("configuration", "configuration"),
        ("scans", "scans"),
        ("sphere", "sphere_values"),
    ),
    "scans": (
        ("scan", "id"),
        ("sample", "sample"),
        ("file", "file"),
        ("of", "purpose"),
        ("side", "side"),
        ("scatter", "scatter"),
        ("θ", "theta_deg"),
        ("φ", "phi_deg"),
        ("light", "incident_words"),
        ("values", "quantity"),
        ("points", "points"),
        ("lowest", "value_min"),
        ("highest", "value_max"),
    ),
    "spheres": (
        ("sphere", "id"),
        ("sample", "sample"),
        ("file", "file"),
        ("side", "side"),
        ("scatter", "scatter"),
        ("collected", "collected"),
        ("light", "light_words"),
        ("values", "what"),
    ),
    "files": (
        ("file", "id"),
        ("name", "name"),
        ("SHA-256", "sha256"),
        ("format", "format"),
        ("convention", "chosen"),
        ("imported", "imported"),
        ("scans", "scans"),
        ("sphere", "sphere_values"),
    ),
    "models": (
        ("model", "id"),
        ("name", "name"),
        ("of", "kind"),
        ("sample", "sample"),
        ("file", "file_name"),
        ("made", "made"),
        ("scans", "scans"),
        ("sphere", "sphere_values"),
    ),
    "reports": (
        ("report", "id"),
        ("name", "name"),
        ("of", "kind"),
        ("file", "file_name"),
        ("made", "made"),
        ("samples", "samples"),
        ("models", "models"),
    ),
    "checks": (("report", "report"), ("sample", "sample"), ("made", "made"), ("found", "tally")),
    "configurations": (
        ("configuration", "id"),
        ("instrument", "instrument"),
        ("name", "name"),
        ("lamp", "lamp"),
        ("detector", "detector"),
        ("filters", "filters"),
        ("spot [mm]", "spot_mm"),
        ("source [°]", "source_cone_deg"),
        ("detector [°]", "detector_cone_deg"),
    ),
    "notes": (
        ("note", "id"),
        ("on", "subject"),
        ("", "subject_id"),
        ("kind", "kind"),
        ("by", "author"),
        ("written", "written"),
        ("text", "text"),
    ),
}


def _print(kind: str, rows: Sequence[object]) -> None:
    columns = _COLUMNS[kind]
    say(table([head for head, _ in columns], [[_cell(row, name) for _, name in columns] for row in rows], left=9))


def _cell(row: object, name: str) -> str:
    value = getattr(row, name)
    if value is None:
        return "–"
    if name == "sha256":
        return f"{value[:12]}…"
    if isinstance(value, float):
        return f"{value:.4g}"
    if isinstance(value, tuple):
        return ", ".join(value)
    return f"{value:%Y-%m-%d %H:%M}" if hasattr(value, "strftime") else str(value)
