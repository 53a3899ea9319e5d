"""`clerestory measure export`: a sample's scans as files of other programs, and models as a library to publish."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from clerestory.cli.common import JsonOption, UsageError, note, one_of, print_json
from clerestory.cli.measure.options import (
    DatabaseOption,
    DateOption,
    IncidentOption,
    LaboratoryOption,
    incident_of,
    open_database,
)

if TYPE_CHECKING:
    from clerestory.measure.database import Database

_MODELS = "xml"


def export(
    sample: Annotated[
        str | None,
        typer.Argument(
            metavar="SAMPLE|model:N|report:N",
            help="A sample's name (all samples by default with --format xml); or a model or report, as it is kept.",
        ),
    ] = None,
    *,
    output: Annotated[
        Path,
        typer.Option("--output", "-o", metavar="OUT", help="A folder; or a file if there is one.", show_default=False),
    ],
    format_: Annotated[
        str,
        typer.Option(
            "--format",
            metavar="FORMAT",
            help="mountain, iea21, astm, zemax, lighttools or csv; xml for models, with a catalogue of them.",
        ),
    ] = "mountain",
    db: DatabaseOption = None,
    laboratory: LaboratoryOption = None,
    date: DateOption = None,
    incident: IncidentOption = None,
    as_json: JsonOption = False,
) -> None:
    """Write a sample's scans as files that other programs read, with the conditions in their headers.

    With --format xml, write its models, or those of all samples, as BSDF XML with catalogue.json and catalogue.html. A
    model, prepared scans or a report (model:3, report:1) come out as the very files that were kept.

    Example: clerestory measure export twill --format mountain -o twill/ --db lab.sqlite
    """
    from clerestory.measure.files import writable_formats

    known = {"csv" if name == "table" else name: name for name in writable_formats()}
    chosen = one_of(format_, "--format", (*known, _MODELS))
    if sample is None and chosen != _MODELS:
        raise UsageError(f"--format {chosen}: of which sample? (give its name; `clerestory measure list` has them)")
    if chosen == _MODELS and (laboratory, date, incident) != (None, None, None):
        raise UsageError("--format xml: models are not chosen by --laboratory, --date or --incident (leave them out)")
    direction = incident_of(incident)
    kind, _, number = (sample or "").partition(":")
    notes: list[str] = []
    with open_database(db) as database:
        if kind in ("model", "report") and number.isdigit():
            if (laboratory, date, incident) != (None, None, None):
                raise UsageError(f"{sample}: --laboratory, --date and --incident choose scans (leave them out)")
            paths = _kept(database, kind, int(number), output)
        elif chosen == _MODELS:
            if sample is not None:
                database.sample(sample)
            paths, notes = _publish(database, sample, output)
        else:
            paths, notes = _scans(database, str(sample), output, known[chosen], laboratory, date, direction)
    if as_json:
        print_json({"written": paths, "notes": notes})
        return
    for text in notes:
        note(f"note: {text}")
    note(f"wrote {paths[0]}" if len(paths) == 1 else f"wrote {len(paths)} files to {output}")


def _kept(database: Database, kind: str, number: int, output: Path) -> list[Path]:
    """The files of a model or a report, byte by byte; several come into a folder."""
    import io
    import zipfile

    from clerestory.whole import write_whole

    if kind == "report":
        report = database.report(number)
        files = {report.file_name: database.report_bytes(number)}
    else:
        model = database.model(number)
        content = database.model_bytes(number)
        if len(model.files) == 1:
            files = {model.file_name: content}
        else:
            with zipfile.ZipFile(io.BytesIO(content)) as archive:
                files = {name: archive.read(name) for name in model.files}
    if len(files) == 1 and not output.is_dir():
        was = Path(next(iter(files)))
        if output.suffix.lower() != was.suffix.lower():
            raise UsageError(
                f"{output}: {kind}:{number} is {was.name} (end the name with {was.suffix or 'nothing'}, or name a"
                " folder)"
            )
        write_whole(output, next(iter(files.values())))
        return [output]
    if output.exists() and not output.is_dir():
        raise UsageError(f"{output}: a file, and {kind}:{number} is {len(files)} files (give a folder)")
    output.mkdir(parents=True, exist_ok=True)
    paths = []
    for name, data in files.items():
        paths.append(output / Path(name).name)
        write_whole(paths[-1], data)
    return paths


def _publish(database: Database, sample: str | None, output: Path) -> tuple[list[Path], list[str]]:
    from clerestory.measure.database.library import publish

    if output.exists() and not output.is_dir():
        raise UsageError(f"{output}: a file, and a library is a folder (give a folder)")
    published, paths = publish(database, output, samples=None if sample is None else [sample])
    lacking = [f"{one.name} of {one.sample}: {', '.join(one.missing)} not known" for one in published if one.missing]
    return paths, lacking


def _scans(
    database: Database,
    sample: str,
    output: Path,
    form: str,
    laboratory: str | None,
    date: str | None,
    direction: tuple[float | None, float | None],
) -> tuple[list[Path], list[str]]:
    from clerestory.counts import counted
    from clerestory.measure.files import write

    theta, phi = direction
    found = database.measurement(sample, laboratory=laboratory, date=date, theta_deg=theta, phi_deg=phi)
    if not found.scans:
        raise UsageError(f"{sample}: no such scans (`clerestory measure list scans --sample '{sample}'` has them)")
    kept = found.of()
    if not kept:
        raise UsageError(f"{sample}: nothing but scans of the beam and in the dark (there is no BSDF to write)")
    left = len(found.scans) - len(kept)
    written = write(replace(found, scans=kept), output, form)
    notes = [f"{counted(left, 'scan')} of the beam and in the dark left out"] if left else []
    return list(written.paths), [*notes, *written.notes]
