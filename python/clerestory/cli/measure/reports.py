"""Reports that `clerestory measure import` takes over: documents on a sample or a model, kept as they are."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Literal

from clerestory.cli.common import CommandError, UsageError, about, print_json, say
from clerestory.cli.measure.keeping import waiting
from clerestory.cli.measure.options import open_database

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

DOCUMENTS = (".pdf", ".html", ".htm")
"""Endings of what is no measurement, but may be a report."""

_HEAD = 1024  # bytes within which a PDF or HTML says what it is
_CONTROL = re.compile(rb"[\x00-\x08\x0b\x0e-\x1f]")
_WIDE = (b"\xff\xfe", b"\xfe\xff")
_ENDINGS = {".pdf": ("PDF",), ".html": ("HTML",), ".htm": ("HTML",), ".txt": ("text", "HTML")}


def import_reports(paths: Sequence[Path], on: str, db: str | None, *, as_json: bool) -> None:
    """Keep documents as reports on what `on` names, all of them or none."""
    for path in paths:
        if path.is_dir():
            raise UsageError(f"{path}: a folder, and reports are files (name each)")
    documents = [(path, _document(path)) for path in paths]
    kind, _, number = on.partition(":")
    told, lines = [], []
    with open_database(db) as database, database.transaction(waiting=waiting):
        place = str(database.location)
        if kind == "model" and number.isdigit():
            what, models, samples = database.model(int(number)).words, [int(number)], []
        else:
            what, models, samples = f"sample {database.sample(on).name!r}", [], [on]
        for path, data in documents:
            before = {report.id for report in database.reports()}
            name = database.unused_report_name(path.stem)
            report = database.report(
                database.add_report(name, data, file_name=path.name, models=models, samples=samples)
            )
            new = report.id not in before
            told.append({"file": path, "report": report.id, "new": new})
            lines.append(f"{place}: {'took' if new else 'has it already:'} {report.words} on {what}")
    if as_json:
        print_json({"database": place, "reports": told})
        return
    for line in lines:
        say(line)


def _document(path: Path) -> bytes:
    """The bytes of a PDF, an HTML page or a text."""
    data = path.read_bytes()
    with about(path):
        kind = _kind(data)
        endings = _ENDINGS.get(path.suffix.lower(), (kind,))
        if kind not in endings:
            found = "something else" if kind is None else kind
            raise CommandError(f"{endings[0]} by its name, {found} by its content (export it again, or name it so)")
        if kind is None:
            raise CommandError("neither PDF, HTML nor text (export the report as one of them)")
    return data


def _kind(data: bytes) -> Literal["PDF", "HTML", "text"] | None:
    """What a document is by its content."""
    if not data.strip():
        raise CommandError("the file is empty (export it again)")
    head = data[:_HEAD]
    if b"%PDF-" in head:
        return "PDF"
    if _CONTROL.search(data) and not data.startswith(_WIDE):
        return None
    return "HTML" if re.search(rb"<(!doctype html|html)\b", head.replace(b"\0", b"").lower()) else "text"
