"""`clerestory check`: findings in words, and where the light goes; for a file from a stranger."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from clerestory.cli.common import (
    FilesArgument,
    JsonOption,
    about,
    in_one_line,
    is_expected,
    one_of,
    print_json,
    read,
    say,
)

if TYPE_CHECKING:
    from pathlib import Path

    from clerestory.bsdf import Bsdf
    from clerestory.check import Finding, Purpose
    from clerestory.words import Flow


def check(
    files: FilesArgument,
    *,
    purpose: Annotated[
        str | None,
        typer.Option(
            "--for",
            metavar="PURPOSE",
            help="Say whether the resolution serves illuminance, glare or ase (hours of direct sun).",
        ),
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Check files from strangers: findings in words, and where the light goes.

    Errors mean that data should not be used so; warnings, that one should find out first. The exit code is 1 if a file
    has errors or cannot be read, 0 otherwise.

    Example: clerestory check --for glare blind.xml fabric.xml
    """
    from clerestory.check.purpose import PURPOSES

    wanted: Purpose | None = None
    if purpose is not None:
        name = one_of(purpose, "--for", PURPOSES)
        wanted = next(p for p in PURPOSES if p == name)
    results, failed = [], False
    for file in files:
        try:
            findings, flows = _results(file, wanted)
        except Exception as error:
            if not is_expected(error):
                raise
            typer.echo(f"error: {in_one_line(error)}", err=True)
            results.append({"file": file, "error": in_one_line(error)})
            failed = True
            continue
        failed = failed or any(finding.severity == "error" for finding in findings)
        results.append({"file": file, "findings": findings, "light": flows})
        if not as_json:
            _say(file, findings, flows, last=file is files[-1])
    if as_json:
        print_json(results)
    if failed:
        raise typer.Exit(1)


def _results(file: Path, purpose: Purpose | None) -> tuple[list[Finding], list[Flow]]:
    from clerestory.check import check as findings_of
    from clerestory.words import where_light_goes

    bsdf: Bsdf = read(file, show_warnings=False)
    with about(file):
        return findings_of(bsdf, purpose=purpose), where_light_goes(bsdf)


def _say(file: Path, findings: list[Finding], flows: list[Flow], *, last: bool) -> None:
    from clerestory.finding import tally

    say(f"{file}: {tally(findings)}")
    for finding in findings:
        say(f"  {finding}")
    # Reflection speaks where there is nothing else: up and down are best told from what passes.
    passing = [flow for flow in flows if flow.scatter == "transmission"] or flows
    say(f"\nWhere the light goes ({flows[0].band}; left and right as seen from the room)")
    for flow in passing:
        say(f"  {flow.words}")
    if not last:
        say()
