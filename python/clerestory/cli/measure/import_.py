"""`clerestory measure import`: files of measurements into the laboratory's database."""

from __future__ import annotations

import hashlib
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from clerestory.cli.common import CommandError, JsonOption, UsageError, about, note, print_json, say, tasks
from clerestory.cli.measure.keeping import waiting
from clerestory.cli.measure.options import (
    ColumnOption,
    ConventionOption,
    DatabaseOption,
    FileScatterOption,
    FileSideOption,
    choices_of,
)
from clerestory.cli.measure.reports import DOCUMENTS, import_reports

if TYPE_CHECKING:
    from clerestory.measure.database import Added, Database


def import_(
    files: Annotated[
        list[str],
        typer.Argument(
            metavar="FILES…",
            help="Files and folders of measurements; records of samples (.toml); `roundrobin`, a record that ships.",
            show_default=False,
        ),
    ],
    *,
    db: DatabaseOption = None,
    sample: Annotated[
        str | None, typer.Option("--sample", metavar="NAME", help="Name of the sample, in place of the files'.")
    ] = None,
    laboratory: Annotated[str | None, typer.Option("--laboratory", metavar="NAME", help="Who measured.")] = None,
    operator: Annotated[str | None, typer.Option("--operator", metavar="NAME", help="The person.")] = None,
    date: Annotated[str | None, typer.Option("--date", metavar="DAY", help="When: 2020-06-24.")] = None,
    instrument: Annotated[str | None, typer.Option("--instrument", metavar="NAME", help="Make and model.")] = None,
    side: FileSideOption = None,
    scatter: FileScatterOption = None,
    convention: ConventionOption = None,
    column: ColumnOption = None,
    replace: Annotated[
        bool, typer.Option("--replace", help="Read known files again, with what is said now; their old scans go.")
    ] = False,
    report_on: Annotated[
        str | None,
        typer.Option(
            "--report-on",
            metavar="SAMPLE|model:N",
            help="The files are reports (PDF, HTML, text) on this sample or model, and are kept as they are.",
        ),
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Take over what instruments saw into the laboratory's database, which is made if there is none.

    An import is done whole or not at all: with Ctrl-C, or if a file is damaged, the database stays as it was. A file
    that is known by its bytes is not taken twice. Formats are told by content; in a folder, what is no measurement is
    left out. With --report-on, documents are taken over instead: `show`, `list reports`, `export report:1` and `remove
    report:1` know them then.

    Example: clerestory measure import pg2/ --sample twill --laboratory HSLU --db lab.sqlite
    """
    from clerestory.measure.database import Added, Database, catalogue

    choices = choices_of(side, scatter, convention, column)
    if report_on is not None:
        if choices or replace or (sample, laboratory, operator, date, instrument) != (None,) * 5:
            raise UsageError("--report-on: other options tell of scans, not of reports (leave them out, save --db)")
        import_reports([Path(word) for word in files], report_on, db, as_json=as_json)
        return
    if date is not None:
        _check_day(date)
    said = {"laboratory": laboratory, "operator": operator, "date": date, "instrument": instrument}
    conditions = {key: value for key, value in said.items() if value is not None}
    paths = [catalogue.record(word) or Path(word) for word in files]
    for path in paths:
        path.stat()  # before a database is made
    listed = [(inner, path.is_dir()) for path in paths for inner in (_below(path) if path.is_dir() else [path])]
    total = sum(path.stat().st_size for path, _ in listed) or 1
    records: list[str] = []
    added, done = Added(), 0

    with Database.open(db, create=True, waiting=waiting) as database, tasks() as progress:
        with database.transaction(waiting=waiting):
            for path, of_folder in listed:
                progress(done / total, path.name)
                if path.suffix.lower() == ".toml":
                    records += _record(database, path)
                else:
                    added += _file(database, path, sample, conditions, choices, of_folder=of_folder, replace=replace)
                done += path.stat().st_size
            if not (records or added.files or added.known):
                raise CommandError(f"{', '.join(files)}: no measurement in it (docs/measurements.md lists the formats)")
        place = str(database.location)
    if as_json:
        print_json({"database": place, "records": records, **vars(added)})
        return
    for text in added.warnings:
        note(f"warning: {text}")
    _tell(place, added, records)


def _check_day(text: str) -> None:
    try:
        datetime.fromisoformat(text)
    except ValueError:
        raise UsageError(f"--date {text}: not a day (give it as 2020-06-24)") from None


def _below(folder: Path) -> list[Path]:
    """Files of a folder and those below it, in the order of their names; hidden ones are no measurements."""
    found = [path for path in folder.rglob("*") if path.is_file()]
    return sorted(p for p in found if not any(part.startswith(".") for part in p.relative_to(folder).parts))


def _record(database: Database, path: Path) -> list[str]:
    from clerestory.measure.database.record import keep_record, read_record

    return keep_record(database, read_record(path))


def _file(
    database: Database,
    path: Path,
    sample: str | None,
    conditions: dict[str, str],
    choices: dict[str, object],
    *,
    of_folder: bool,
    replace: bool,
) -> Added:
    from clerestory.measure.database import Added
    from clerestory.measure.files import read
    from clerestory.measure.formats import UnknownFormatError

    with path.open("rb") as stream:
        mark = hashlib.file_digest(stream, "sha256").hexdigest()
    known = next((file for file in database.files() if file.sha256 == mark), None)
    if known is not None:
        if not replace:
            return Added(known=[path.name])
        with about(path):
            database.remove("file", known.id)
    try:
        contents = read([path], strict=False, **choices)
    except UnknownFormatError as error:
        if not of_folder and path.suffix.lower() in DOCUMENTS:
            raise CommandError(f"{path}: no measurement (--report-on SAMPLE keeps it as a report)") from error
        if not of_folder:
            raise
        what = str(error).removeprefix(f"{path}: ").partition(" (")[0]
        return Added(warnings=[f"{path}: {what}; left out"])
    with about(path):
        return database.add(contents, sample=sample, conditions=conditions, choices=choices, originals=[path])


def _tell(place: str, added: Added, records: list[str]) -> None:
    from clerestory.counts import counted

    parts = []
    if added.scans:
        parts.append(f"{counted(added.scans, 'scan')} of {counted(added.points, 'point')}")
    if added.sphere_values:
        parts.append(f"{counted(added.sphere_values, 'set')} of sphere values")
    if added.files or added.scans:
        say(f"{place}: took {' and '.join(parts) or 'nothing'} from {counted(len(added.files), 'file')}")
    if added.samples:
        say(f"  samples: {', '.join(added.samples)}")
    for text in records:
        say(f"{place}: wrote down {text}")
    if added.known:
        shown = added.known[:8] + ([f"and {len(added.known) - 8} more"] if len(added.known) > 8 else [])
        say(f"{place}: known already, not taken again: {', '.join(shown)}")
