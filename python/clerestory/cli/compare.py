"""`clerestory compare`: data sets of one system side by side, as one HTML file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from clerestory.cli.common import (
    BandOption,
    JsonOption,
    ScatterOption,
    SideOption,
    UsageError,
    note,
    print_json,
    progress,
    refuse_overwriting,
    say,
    scatter_of,
    side_of,
    warn,
)
from clerestory.counts import counted

if TYPE_CHECKING:
    from collections.abc import Sequence


def compare(
    files: Annotated[
        list[str],
        typer.Argument(metavar="FILE…", help="Two to twenty BSDF files, or LABEL=FILE.", show_default=False),
    ],
    *,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", metavar="REPORT.html", help="The report, one HTML file.")
    ] = None,
    label: Annotated[
        list[str] | None,
        typer.Option(
            "--label", metavar="NAME", help="Name of a data set, usually the laboratory; one a file, in order."
        ),
    ] = None,
    band: BandOption = None,
    side: SideOption = "exterior",
    scatter: ScatterOption = "transmission",
    patches: Annotated[
        str,
        typer.Option("--patches", metavar="N,N…", help="Incident patches of Klems' full basis, counted from 1."),
    ] = "1,41,88,130",
    against_models: Annotated[
        bool,
        typer.Option("--against-models", help="Compare with simple models made of the first data set, too."),
    ] = False,
    title: Annotated[str, typer.Option("--title", metavar="TEXT", help="Head of the report.")] = (
        "Comparison of BSDF data sets"
    ),
    date: Annotated[
        str | None,
        typer.Option("--date", metavar="TEXT", help="Date to print; none by default, so that runs can be repeated."),
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Compare data sets of one system: values, spread, outliers, distances, pictures, findings.

    Labels are the files' names unless they are given by --label, one a file, or as LABEL=FILE. With --json every number
    of the report is printed; the report itself is written where -o names it.

    Example: clerestory compare HSLU=a.xml ISE=b.xml LBNL=c.xml -o report.html
    """
    from clerestory.compare import compare as compared
    from clerestory.compare import write_report

    if output is None and not as_json:
        raise UsageError("the report has no name (give -o report.html, or --json)")
    given, paths = zip(*(_parted(word) for word in files), strict=True)
    if output is not None:
        if output.suffix.lower() not in (".html", ".htm"):
            raise UsageError(f"{output}: the report is an HTML file (end the name with .html)")
        refuse_overwriting(output, paths)
        if not output.parent.is_dir():
            raise UsageError(f"{output}: the folder {output.parent} does not exist (create it first)")
    names = _names(given, [str(p) for p in paths], label)
    chosen_side, chosen_scatter, numbers = side_of(side), scatter_of(scatter), _patches(patches)
    with progress("comparing") as tell:
        result = compared(
            list(paths),
            labels=names,
            band=band,
            side=chosen_side,
            scatter=chosen_scatter,
            patches=numbers,
            against_models=against_models,
            progress=tell,
        )
    for path, data in zip(paths, result.sets, strict=True):
        for text in data.warnings:
            warn(path, text.removeprefix(f"{path}: "))
    if output is not None:
        options = ["" if band is None else f" --band {_quoted(band)}"]
        options += ["" if chosen_side == "exterior" else f" --side {chosen_side}"]
        options += ["" if chosen_scatter == "transmission" else f" --scatter {chosen_scatter}"]
        options += ["" if patches == "1,41,88,130" else f" --patches {_quoted(patches)}"]
        options += [" --against-models" if against_models else ""]
        words = " ".join(_quoted(f"{name}={path.name}") for name, path in zip(names, paths, strict=True))
        command = f"clerestory compare {words}{''.join(options)} -o {_quoted(output.name)}"
        with progress("writing the report") as tell:
            write_report(result, output, title=title, command=command, date=date, progress=tell)
        note(f"wrote {output}")
    if as_json:
        print_json(result.to_dict())
        return
    for sentence in result.summary:
        say(sentence)
    for text in result.notes:
        note(f"note: {text}")


def laboratories(words: Sequence[str]) -> list[tuple[str, Path]]:
    """Labels and files of words `LABEL=FILE` or `FILE`."""
    given, paths = zip(*(_parted(word) for word in words), strict=True)
    return list(zip(_names(given, [str(p) for p in paths], None), paths, strict=True))


def _quoted(word: str) -> str:
    from shlex import quote

    return quote(word)


def _parted(word: str) -> tuple[str | None, Path]:
    """Label and file; a name that is a file as it stands has no label."""
    label, mark, file = word.partition("=")
    if not mark or Path(word).exists():
        return None, Path(word)
    if not label or not file:
        raise UsageError(f"{word}: not a label and a file (write LABEL=FILE)")
    return label, Path(file)


def _names(given: Sequence[str | None], paths: Sequence[str], labels: Sequence[str] | None) -> list[str]:
    from clerestory.files import default_labels

    if labels:
        if any(given):
            raise UsageError("labels are there twice (give them by --label, or as LABEL=FILE)")
        if len(labels) != len(paths):
            raise UsageError(
                f"{counted(len(labels), 'label')} for {counted(len(paths), 'file')} (give --label for each, in order)"
            )
        return list(labels)
    return [label or made for label, made in zip(given, default_labels(paths), strict=True)]


def _patches(text: str) -> tuple[int, ...]:
    try:
        return tuple(int(part) for part in text.split(","))
    except ValueError:
        raise UsageError(f"--patches {text}: not numbers with commas (such as 1,41,88,130)") from None
