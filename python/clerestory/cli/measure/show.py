"""`clerestory measure show`: what the database knows of a sample, a scan, a file, a model and so on."""

from __future__ import annotations

import hashlib
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TypeVar

import typer

from clerestory.cli.common import JsonOption, UsageError, print_json, say
from clerestory.cli.measure.options import DatabaseOption, open_database

if TYPE_CHECKING:
    from clerestory.measure.database import Database

T = TypeVar("T")

_KINDS = ("sample", "scan", "sphere", "file", "model", "report", "run", "configuration")


def show(
    what: Annotated[
        str,
        typer.Argument(
            metavar="SAMPLE|FILE|KIND:NUMBER",
            help="A sample's name; a file's name, path or beginning of the SHA-256; scan:7 or 7, sphere:2, model:3, "
            "report:1, run:4, configuration:5.",
            show_default=False,
        ),
    ],
    *,
    db: DatabaseOption = None,
    as_json: JsonOption = False,
) -> None:
    """Say what the database knows of a sample, a scan, a file, a model, …: directions, values, notes, and where from.

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
    if colon and kind in _KINDS and number.isdigit():
        return _numbered(database, kind, int(number))
    sample = next((one for one in database.samples() if one.name == what), None)
    if sample is not None:
        found = {
            "sample": sample,
            "scans": database.stored_scans(sample=what),
            "sphere_values": database.stored_sphere_values(sample=what),
            "files": database.files(sample=what),
            "checks": database.checks(sample=what),
            "reports": database.reports(sample=what),
            "models": [database.provenance(model.id) for model in database.models(sample=what)],
            "notes": database.notes("sample", sample.id),
        }
        return found, about_sample(database, sample)
    if what.isdigit():
        return _numbered(database, "scan", int(what))
    files = [file for file in database.files() if file.name == what]
    if not files and len(what) >= 6:
        files = [file for file in database.files() if file.sha256.startswith(what.lower())]
    if not files and Path(what).is_file():
        with Path(what).open("rb") as stream:
            mark = hashlib.file_digest(stream, "sha256").hexdigest()
        files = [file for file in database.files() if file.sha256 == mark]
        made = database.made_as(mark)
        if not files and made is not None:
            return _numbered(database, "model", made)
        report = next((one for one in database.reports() if one.sha256 == mark), None)
        if not files and report is not None:
            return _numbered(database, "report", report.id)
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


def _numbered(database: Database, kind: str, number: int) -> tuple[object, list[str]]:
    from clerestory.measure.database import words

    if kind == "model":
        provenance = database.provenance(number)
        found = asdict(provenance) | {"notes": database.notes("model", number)}
        return found | {"reports": database.reports(model=number)}, words.about_model(database, number)
    if kind == "report":
        report = database.report(number)
        about: dict[str, object] = {"report": report, "notes": database.notes("report", number)}
        if report.kind == "check":
            about["check"] = database.check(number)
        return about, words.about_report(database, report)
    if kind == "scan":
        stored = _one(database, database.stored_scans(ids=[number]), "scan", number)
        found = {"scan": stored, "conditions": dict(database.scan(number).conditions)}
        return found | {"notes": database.notes("scan", number)}, words.about_scan(database, stored)
    if kind == "sphere":
        values = _one(database, database.stored_sphere_values(ids=[number]), "sphere value", number)
        return {"about": values, "values": database.sphere_value(number)}, words.about_sphere(database, values)
    if kind == "file":
        file = _one(database, [one for one in database.files() if one.id == number], "file", number)
        return file, words.about_file(database, file)
    if kind == "run":
        run = _one(database, [one for one in database.runs() if one.id == number], "run", number)
        scans = database.stored_scans(run=number)
        found = {
            "run": run,
            "scans": scans,
            "checks": database.checks(run=number),
            "notes": database.notes("run", number),
        }
        return found, words.about_run(database, run)
    if kind == "configuration":
        held = [one for one in database.configurations() if one.id == number]
        setup = _one(database, held, "configuration", number)
        spectrum = database.lamp_spectrum(number)
        found = {"configuration": setup, "lamp_spectrum": spectrum}
        return found | {"notes": database.notes("configuration", number)}, words.about_configuration(database, setup)
    sample = _one(database, [one for one in database.samples() if one.id == number], "sample", number)
    return _found(database, sample.name)


def _one(database: Database, found: list[T], kind: str, number: int) -> T:
    if not found:
        several = "spheres" if kind == "sphere value" else f"{kind}s"
        raise UsageError(f"{database.location}: no {kind} {number} (`clerestory measure list {several}` has them)")
    return found[0]
