"""What commands make of the database's scans is kept there, with the way back to the raw points."""

from __future__ import annotations

import shlex
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from clerestory.cli.common import CommandError, in_one_line, is_expected, note

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from clerestory.finding import Finding
    from clerestory.measure import Scan, SphereValues
    from clerestory.measure.contents import Contents
    from clerestory.measure.database import Database, Origin
    from clerestory.measure.database.records import Kind

KeepOption = Annotated[
    bool, typer.Option("--keep/--no-keep", help="Keep the result in the database that the scans come from.")
]
NoteOption = Annotated[str | None, typer.Option("--note", metavar="TEXT", help="Kept in the database with the result.")]

_UNTOLD = ("db", "as_json", "keep_", "note_")


@dataclass(frozen=True)
class Made:
    """What a command made."""

    written: Sequence[Path]
    """Its files."""
    name: str
    """What it is to be called in the database."""
    settings: Mapping[str, object]
    """As they were said; None for what was not."""
    steps: Sequence[Mapping[str, object]]
    kind: Kind = "model"
    scans: Sequence[Scan] = ()
    """What it was made of, raw."""
    spheres: Sequence[SphereValues] = ()
    model: Path | None = None
    """A data set that it was made from."""
    report: Path | None = None
    """A report on it."""
    note: str | None = None


@dataclass(frozen=True)
class Kept:
    """Where it is kept."""

    database: str
    model: int | None
    """Its number; None if the database does not have what it was made of."""
    new: bool
    """False if it was there already, byte by byte."""
    report: int | None
    words: str


def keep(context: typer.Context, made: Made, words: Sequence[str], db: str | None) -> Kept | None:
    """Keep what was made in the database that `words` were looked up in; nothing if none was.

    Raises
    ------
    CommandError
        It cannot be written to the database; the files are there.
    """
    from clerestory.cli.measure.options import open_database
    from clerestory.measure.given import from_database

    if not from_database(words, db):
        return None
    try:
        with open_database(db) as database:
            return _kept(database, made, _typed(context))
    except Exception as error:
        if not is_expected(error):
            raise
        files = ", ".join(map(str, made.written[:3])) + (", …" if len(made.written) > 3 else "")
        raise CommandError(f"{files}: written, but not kept in the database: {in_one_line(error)}") from error


def keep_checks(contents: Contents, results: Mapping[str, Sequence[Finding]], db: str | None) -> dict[str, Kept]:
    """Keep what a check found of each sample in the database that its scans and sphere values were looked up in.

    A database that cannot be written to is told of; the findings are there to be read.
    """
    from clerestory.cli.measure.options import open_database

    kept = {}
    try:
        with open_database(db) as database, database.transaction(waiting=waiting):
            for sample, findings in results.items():
                scans = [scan for m in contents.measurements if m.sample == sample for scan in m.scans]
                spheres = [v for v in contents.sphere_values if v.sample in ((sample, "") if scans else (sample,))]
                kept[sample] = _kept_check(database, sample, findings, scans, spheres)
    except Exception as error:
        if not is_expected(error):
            raise
        note(f"warning: not kept in the database: {in_one_line(error)}")
        return {}
    return kept


def waiting() -> None:
    """Say that another program is in the way."""
    note("note: another program writes to the database; waiting for it")


def tell_written(written: Iterable[Path], kept: Kept | None) -> None:
    """Say which files there are now, and where the result is kept."""
    for path in written:
        note(f"wrote {path}")
    if kept is not None:
        note(kept.words)


def _kept(database: Database, made: Made, command: str) -> Kept:
    from clerestory.measure.source import digest

    place = str(database.location)

    parents = []
    if made.model is not None:
        parent = database.made_as(digest(made.model.read_bytes()))
        if parent is None:
            return _without(place, made.model)
        parents = [parent]
    origin = database.origin(made.scans, made.spheres)
    if origin.unknown:
        return _without(place, origin.unknown[0])
    file_name, data = _content(made.written)
    files = {path.name: digest(path.read_bytes()) for path in made.written}
    with database.transaction(waiting=waiting):
        sample = _sample(database, origin, parents)
        before = {model.id for model in database.models(sample=sample)}
        number = database.add_model(
            sample,
            database.unused_name(sample, made.name),
            data,
            file_name=file_name,
            scans=made.scans,
            sphere_values=made.spheres,
            parents=parents,
            command=command,
            settings={key: value for key, value in made.settings.items() if value is not None},
            kind=made.kind,
            steps=made.steps,
            files=files,
        )
        new = number not in before
        if made.note and all(known.text != made.note for known in database.notes("model", number)):
            database.note("model", number, made.note)
        report = None
        if made.report is not None:
            name, data = database.unused_report_name(made.report.stem), made.report.read_bytes()
            report = database.add_report(name, data, file_name=made.report.name, models=[number])
    verb = "kept in {}" if new else "{} has it already, byte by byte,"
    words = f"{verb.format(place)} as {database.model(number).words} of {sample}"
    return Kept(place, number, new, report, words)


def _without(place: str, missing: object) -> Kept:
    words = f"note: not kept in {place}, which does not have {missing} (`clerestory measure import` takes scans in)"
    return Kept(place, None, new=False, report=None, words=words)


def _sample(database: Database, origin: Origin, parents: Sequence[int]) -> str:
    """Whose model it is: that of the data set that it was made from, or of the scans."""
    return database.model(parents[0]).sample if parents else origin.samples[0]


def _kept_check(
    database: Database,
    sample: str,
    findings: Sequence[Finding],
    scans: Sequence[Scan],
    spheres: Sequence[SphereValues],
) -> Kept:
    place = str(database.location)
    origin = database.origin(scans, spheres)
    if origin.unknown:
        return _without(place, origin.unknown[0])
    owner = sample if sample in origin.samples else origin.samples[0]
    before = {report.id for report in database.reports(sample=owner)}
    number = database.add_check(owner, findings, origin)
    new = number not in before
    words = f"{'kept in {}' if new else '{} has this check already,'} as report:{number} of {owner}".format(place)
    return Kept(place, None, new, number, words)


def _content(written: Sequence[Path]) -> tuple[str, bytes]:
    """The file, or all of them in an archive, which has the same bytes for the same files."""
    if len(written) == 1:
        return written[0].name, written[0].read_bytes()
    import io
    import zipfile

    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for path in sorted(written):
            archive.writestr(zipfile.ZipInfo(path.name), path.read_bytes(), zipfile.ZIP_DEFLATED)
    return f"{written[0].parent.name or 'scans'}.zip", packed.getvalue()


def _typed(context: typer.Context) -> str:
    """The command as a person would type it, without the database's address, which may hold a password."""
    words = [context.command_path]
    for parameter in context.command.params:
        name = parameter.name or ""
        source = context.get_parameter_source(name)
        if source is None or source.name != "COMMANDLINE" or name in _UNTOLD:
            continue
        value = context.params[name]
        option = parameter.opts[0] if parameter.opts[0].startswith("-") else None
        if isinstance(value, bool):
            words += [option or ""] if value else []
            continue
        for one in value if isinstance(value, (list, tuple)) else [value]:
            words += [option, str(one)] if option else [str(one)]
    return f"{words[0]} {shlex.join(words[1:])}"
