"""`clerestory measure show`: a sample, a scan, a file or a model in words."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from clerestory.cli.common import JsonOption, UsageError, print_json, say
from clerestory.cli.measure.options import DatabaseOption, open_database

if TYPE_CHECKING:
    from clerestory.measure.database import Database


def show(
    what: Annotated[
        str,
        typer.Argument(
            metavar="SAMPLE|SCAN|FILE|MODEL",
            help="Name of a sample; scan:7 or 7; name, beginning of the SHA-256 or path of a file; model:3.",
            show_default=False,
        ),
    ],
    *,
    db: DatabaseOption = None,
    as_json: JsonOption = False,
) -> None:
    """Say what the database knows of a sample, a scan, a file or a model: directions, values, notes, and where from.

    Example: clerestory measure show twill --db lab.sqlite
    """
    with open_database(db) as database:
        found, lines = _found(database, what)
    if as_json:
        print_json(found)
        return
    for line in lines:
        say(line)


def _found(database: Database, what: str) -> tuple[object, list[str]]:
    from clerestory.measure.database.words import about_file, about_sample

    kind, colon, number = what.partition(":")
    if colon and kind in ("scan", "model") and number.isdigit():
        if kind == "model":
            provenance = database.provenance(int(number))
            return provenance, provenance.lines()
        return _scan(database, int(number))
    sample = next((one for one in database.samples() if one.name == what), None)
    if sample is not None:
        found = {
            "sample": sample,
            "scans": database.stored_scans(sample=what),
            "files": database.files(sample=what),
            "models": [database.provenance(model.id) for model in database.models(sample=what)],
            "notes": database.notes("sample", sample.id),
        }
        return found, about_sample(database, sample)
    if what.isdigit():
        return _scan(database, int(what))
    files = [file for file in database.files() if file.name == what]
    if not files and len(what) >= 6:
        files = [file for file in database.files() if file.sha256.startswith(what.lower())]
    if not files and Path(what).is_file():
        with Path(what).open("rb") as stream:
            mark = hashlib.file_digest(stream, "sha256").hexdigest()
        files = [file for file in database.files() if file.sha256 == mark]
        if not files:
            raise UsageError(f"{what}: not in {database.location} (take it over with `clerestory measure import`)")
    if not files:
        raise UsageError(
            f"{what}: neither a sample nor a file of {database.location} (`clerestory measure list` has them; "
            "scan:7 is a scan, model:3 a model)"
        )
    if len(files) > 1:
        marks = ", ".join(file.sha256[:12] for file in files)
        raise UsageError(f"{what}: {len(files)} files have this name (give the SHA-256 of one: {marks})")
    return files[0], about_file(database, files[0])


def _scan(database: Database, number: int) -> tuple[object, list[str]]:
    from clerestory.measure.database.words import about_scan

    stored = database.stored_scans(ids=[number])
    if not stored:
        raise UsageError(f"{database.location}: no scan {number} (`clerestory measure list scans` has them)")
    return {"scan": stored[0], "conditions": dict(database.scan(number).conditions)}, about_scan(database, stored[0])
