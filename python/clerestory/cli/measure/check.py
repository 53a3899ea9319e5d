"""`clerestory measure check`: what is wrong or odd in measurements, in words."""

from __future__ import annotations

from typing import Annotated

import typer

from clerestory.cli.common import JsonOption, note, print_json, say
from clerestory.cli.measure.keeping import KeepOption, keep_checks
from clerestory.cli.measure.options import (
    ColumnOption,
    ConventionOption,
    DatabaseOption,
    FileScatterOption,
    FileSideOption,
    choices_of,
)


def check(
    words: Annotated[
        list[str],
        typer.Argument(metavar="FILE|SAMPLE…", help="Files, folders, samples of the database.", show_default=False),
    ],
    *,
    db: DatabaseOption = None,
    side: FileSideOption = None,
    scatter: FileScatterOption = None,
    convention: ConventionOption = None,
    column: ColumnOption = None,
    keep: KeepOption = True,
    as_json: JsonOption = False,
) -> None:
    """Check measurements: mistakes of angles and of light, drift, symmetry, and a sphere beside the goniophotometer.

    Files that are named together are taken together: scans of one sample, its beam and its sphere values. The exit code
    is 1 if a sample has errors, 0 otherwise. What is found of samples of the database is kept there with them.

    Example: clerestory measure check twill/ sphere.csv
    """
    from clerestory.counts import counted
    from clerestory.finding import tally
    from clerestory.measure.check import check_contents
    from clerestory.measure.given import contents_given, from_database

    choices = choices_of(side, scatter, convention, column)
    contents = contents_given(words, database=db, **choices)  # type: ignore[arg-type]  # what files do not say
    results = check_contents(contents)
    kept = keep_checks(contents, results, db) if keep and from_database(words, db) else {}
    held = {m.sample: m for m in contents.measurements}
    if as_json:
        print_json(
            {
                "samples": [
                    {
                        "sample": name,
                        "scans": len(held.get(name, ())),
                        "findings": findings,
                        "kept": kept.get(name),
                    }
                    for name, findings in results.items()
                ],
                "warnings": contents.warnings,
            }
        )
    else:
        for text in contents.warnings:
            say(f"warning: {text}")
        for name, findings in results.items():
            scans = counted(len(held[name]), "scan") if name in held else "values of a sphere"
            say(f"{name} ({scans}): {tally(findings)}")
            for finding in findings:
                say(f"  {finding}")
        for one in kept.values():
            note(one.words)
    if any(finding.severity == "error" for findings in results.values() for finding in findings):
        raise typer.Exit(1)
