"""`clerestory photo-compare`: photographs beside renderings of the same views."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from clerestory.cli.common import (
    JsonOption,
    UsageError,
    note,
    print_json,
    progress,
    refuse_overwriting,
    say,
    table,
    warn,
)

if TYPE_CHECKING:
    from clerestory.photo.cases import Case

_DRAWN = (".png", ".pdf", ".svg")
_REPORTS = (".html", ".htm")


def photo_compare(
    inputs: Annotated[
        list[Path],
        typer.Argument(
            metavar="CASES.csv|PHOTO RENDERING",
            help="Table with the columns case,photo,rendering and, if measured, measured_illuminance; or two pictures.",
            show_default=False,
        ),
    ],
    *,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="OUT",
            help="Report (.html); or, as .png, .pdf or .svg, the scatter of a table's cases, or two pictures and "
            "their ratio.",
        ),
    ] = None,
    regions: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE.csv",
            help="Cones to compare luminance in: name,azimuth_deg,elevation_deg,radius_deg; five by default.",
        ),
    ] = None,
    limit: Annotated[
        float, typer.Option(metavar="PCT", help="Leave out photographs further off the measured illuminance.")
    ] = 25.0,
    title: Annotated[str, typer.Option(metavar="TEXT", help="Head of the report.")] = "Photographs and renderings",
    date: Annotated[str | None, typer.Option(metavar="TEXT", help="Date to print; none by default.")] = None,
    as_json: JsonOption = False,
) -> None:
    """Compare photographs with renderings: luminance by regions, E_v, DGP and DGI over many cases.

    Two values of R² are printed: that of a regression line, and that about the line of equality. A table may hold
    values instead of pictures: photo_dgp and rendering_dgp, photo_dgi and rendering_dgi, photo_illuminance and
    rendering_illuminance.

    Example: clerestory photo-compare cases.csv -o report.html
    """
    from clerestory.photo.agreement import compare_cases
    from clerestory.photo.cases import evaluate_cases, read_cases
    from clerestory.photo.comparison_figure import words_of
    from clerestory.photo.comparison_report import pair_of, summary, write_comparison
    from clerestory.photo.regions import DEFAULT, read_regions
    from clerestory.plot.style import figures

    if not limit > 0.0:
        raise UsageError(f"--limit {limit:g}: not a limit (give a percentage above 0)")
    _check_output(output, inputs)
    cases = read_cases(inputs[0]) if _is_table(inputs) else [_two(inputs)]
    if output is not None:
        refuse_overwriting(output, [p for c in cases for p in (c.photo, c.rendering) if p is not None])
    with progress("evaluating") as tell:
        found = evaluate_cases(cases, DEFAULT if regions is None else read_regions(regions), progress=tell)
    compared = compare_cases(found, limit_percent=limit)
    for text in compared.warnings:
        warn(inputs[0], text)
    if output is not None:
        if output.suffix.lower() in _REPORTS:
            with progress("writing the report") as tell:
                write_comparison(
                    compared, output, title=title, command=_command(inputs, regions, output), date=date, progress=tell
                )
        else:
            from clerestory.photo.comparison_figure import scatter
            from clerestory.plot import save

            save(scatter(compared.agreements) if _is_table(inputs) else pair_of(found[0]), output)
        note(f"wrote {output}")
    if as_json:
        print_json(
            {
                "output": output,
                "cases": [
                    {
                        "case": f.case.name,
                        "photo": f.case.photo,
                        "rendering": f.case.rendering,
                        "measured_illuminance": f.case.measured,
                        "difference_percent": f.difference_percent,
                        "values": {name: {"photo": a, "rendering": b} for name, (a, b) in f.values.items()},
                    }
                    for f in compared.found
                ],
                "agreement": list(compared.agreements),
                "check": compared.check,
                "warnings": list(compared.warnings),
            }
        )
        return
    if len(found) == 1:
        rows = [
            [words_of(name), figures(a, 4), figures(b, 4), f"{100.0 * (b / a - 1.0):+.1f} %" if a else ""]
            for name, (a, b) in found[0].values.items()
        ]
        say(table(["", "photograph", "rendering", "difference"], rows))
        return
    for line in summary(compared):
        say(line)


def _is_table(inputs: list[Path]) -> bool:
    return inputs[0].suffix.lower() == ".csv"


def _two(inputs: list[Path]) -> Case:
    from clerestory.photo.cases import Case

    if len(inputs) != 2:
        raise UsageError(f"{inputs[0]}: one table or two pictures are asked for (give CASES.csv, or PHOTO RENDERING)")
    photo, rendering = inputs
    return Case(f"{photo.stem} | {rendering.stem}", photo, rendering)


def _check_output(output: Path | None, inputs: list[Path]) -> None:
    if _is_table(inputs) and len(inputs) > 1:
        raise UsageError(f"{inputs[1]}: one table is compared at a time (put all cases into one)")
    if output is None:
        return
    if output.suffix.lower() not in (*_REPORTS, *_DRAWN):
        raise UsageError(f"{output}: the name does not tell the format (end it with .html, {', '.join(_DRAWN)})")
    if not output.parent.is_dir():
        raise UsageError(f"{output}: the folder {output.parent} does not exist (create it first)")
    refuse_overwriting(output, inputs)


def _command(inputs: list[Path], regions: Path | None, output: Path) -> str:
    from shlex import join

    words = ["clerestory", "photo-compare", *(p.name for p in inputs)]
    if regions is not None:
        words += ["--regions", regions.name]
    return join([*words, "-o", output.name])
