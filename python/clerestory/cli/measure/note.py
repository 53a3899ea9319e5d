"""`clerestory measure note`: a note on something in the database."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, cast

import typer

from clerestory.cli.common import JsonOption, UsageError, print_json, say
from clerestory.cli.measure.options import DatabaseOption, open_database, thing

if TYPE_CHECKING:
    from clerestory.measure.database.records import Subject


def note(
    what: Annotated[
        str,
        typer.Argument(
            metavar="SAMPLE|KIND:NUMBER", help="A sample's name; scan:7, file:2, run:4, model:3, report:1, …"
        ),
    ],
    text: Annotated[str, typer.Argument(metavar="TEXT", help="What is to be remembered.")],
    *,
    author: Annotated[str | None, typer.Option("--author", metavar="NAME", help="Who says so.")] = None,
    db: DatabaseOption = None,
    as_json: JsonOption = False,
) -> None:
    """Write a note on a sample, a scan, a file, a run, a configuration, an instrument, a model or a report.

    Example: clerestory measure note twill "torn at the lower left corner" --author Jo --db lab.sqlite
    """
    from clerestory.measure.database.records import SUBJECTS

    if not text.strip():
        raise UsageError("TEXT: nothing is said (give a few words)")
    with open_database(db) as database:
        sample = next((one for one in database.samples() if one.name == what), None)
        kind, number = ("sample", sample.id) if sample is not None else thing(what, SUBJECTS, "write a note on")
        made = database.note(cast("Subject", kind), number, text, author=author)
        place = str(database.location)
    if as_json:
        print_json({"database": place, "note": made, "on": kind, "number": number})
    else:
        say(f"{place}: note {made} on {what}")
