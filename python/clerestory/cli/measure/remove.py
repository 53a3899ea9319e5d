"""`clerestory measure remove`: something out of the database."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, cast

import typer

from clerestory.cli.common import JsonOption, print_json, say
from clerestory.cli.measure.options import DatabaseOption, open_database, thing

if TYPE_CHECKING:
    from clerestory.measure.database.records import Subject

_KINDS = ("file", "scan", "model", "report")


def remove(
    what: Annotated[
        str,
        typer.Argument(
            metavar="SAMPLE|KIND:NUMBER",
            help="A sample's name, with all of its scans; file:2, with its scans; scan:7, model:3, report:1.",
        ),
    ],
    *,
    db: DatabaseOption = None,
    as_json: JsonOption = False,
) -> None:
    """Remove a sample, a file, a scan, a model or a report from the database, with the notes on it.

    Nothing is removed that a model or a report was made of: remove that first.

    Example: clerestory measure remove model:3 --db lab.sqlite
    """
    with open_database(db) as database:
        sample = next((one for one in database.samples() if one.name == what), None)
        kind, number = ("sample", sample.id) if sample is not None else thing(what, _KINDS, "remove")
        database.remove(cast("Subject", kind), number)
        place = str(database.location)
    if as_json:
        print_json({"database": place, "removed": kind, "number": number})
    else:
        say(f"{place}: removed {what}")
