"""`clerestory measure fit`: a model of every pair of directions from measured scans."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal, cast

import typer

from clerestory.cli.common import (
    TREES,
    JsonOption,
    UsageError,
    about,
    check_bsdf_name,
    note,
    one_of,
    plain,
    print_json,
    progress,
    refuse_overwriting,
    say,
)
from clerestory.cli.measure.budgets import as_rows, budgets_of, say_budgets
from clerestory.cli.measure.inputs import measurement_of, words_of
from clerestory.cli.measure.keeping import KeepOption, Made, NoteOption, keep, tell_written
from clerestory.cli.measure.options import (
    ColumnOption,
    ConventionOption,
    DatabaseOption,
    DateOption,
    FileScatterOption,
    FileSideOption,
    LaboratoryOption,
    SampleOption,
    choices_of,
)
from clerestory.cli.measure.tables import as_table
from clerestory.endings import stem_of

if TYPE_CHECKING:
    from clerestory.directions import Scatter, Side
    from clerestory.measure import Measurement
    from clerestory.measure.interpolant import Fit, Method
    from clerestory.measure.prepare.symmetry import Symmetry
    from clerestory.measure.uncertainty import Uncertainty


def fit(
    context: typer.Context,
    inputs: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="FILE…|SAMPLE", help="Files or folders of scans, or a sample of the database.", show_default=False
        ),
    ] = None,
    *,
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="OUT", help=".bsdf.npz, .xml or .xml.gz.", show_default=False)
    ],
    method: Annotated[
        str, typer.Option(metavar="METHOD", help="Between incident directions: transport, linear or nearest.")
    ] = "transport",
    symmetry: Annotated[
        str,
        typer.Option(
            metavar="SYMMETRY",
            help="auto, isotropic, quadrilateral, left-right, up-down, rotational (by 180°) or none.",
        ),
    ] = "auto",
    lines: Annotated[
        bool,
        typer.Option(
            "--lines", help="Turn scans along lines about the mirrored or straight direction (an assumption)."
        ),
    ] = False,
    channel: Annotated[
        list[str] | None, typer.Option("--channel", metavar="NAME", help="Only this channel; repeatable.")
    ] = None,
    basis: Annotated[
        str | None,
        typer.Option(
            metavar="NAME", help="For .xml: klems-full (the default), klems-half, …, or tensor3 or tensor4 for trees."
        ),
    ] = None,
    resolution: Annotated[
        int, typer.Option(metavar="N", help="2^N cells an axis, for trees: 6 is 4,096 × 4,096, 7 is 16,384 × 16,384.")
    ] = 6,
    cull: Annotated[float, typer.Option(metavar="PCT", help="Percentage of a tree's finest blocks to merge.")] = 90.0,
    uncertainty: Annotated[
        bool, typer.Option("--uncertainty/--no-uncertainty", help="Say how far values are to be believed, by cause.")
    ] = True,
    level: Annotated[
        float,
        typer.Option(metavar="PCT", help="Standard uncertainty of the level of all values, of the beam or a sphere."),
    ] = 0.0,
    cone: Annotated[
        float | None,
        typer.Option(metavar="DEG", help="Full angle of source and detector together, where files do not say."),
    ] = None,
    report: Annotated[
        Path | None,
        typer.Option(
            "--report", metavar="OUT", help="How good it is, with measured points beside the model: .html or .pdf."
        ),
    ] = None,
    db: DatabaseOption = None,
    sample: SampleOption = None,
    laboratory: LaboratoryOption = None,
    date: DateOption = None,
    note_: NoteOption = None,
    keep_: KeepOption = True,
    side: FileSideOption = None,
    scatter: FileScatterOption = None,
    convention: ConventionOption = None,
    column: ColumnOption = None,
    as_json: JsonOption = False,
) -> None:
    """Make a model of every pair of directions from scans of a few incident ones, and say how good it is.

    Scattered points become lobes, which move from where one incident direction has them to where the next one does. The
    report has the error of each measured direction left out. Values beyond what was measured are extrapolated. A model
    of scans of the database is kept there, with the way back to its points. For formulas such as ABg see `clerestory
    measure formula`.

    Example: clerestory measure fit twill --db lab.sqlite -o twill.bsdf.npz --symmetry rotational --report twill.html
    """
    from clerestory.measure.interpolant import METHODS, spread_lines
    from clerestory.measure.interpolant import fit as fitted
    from clerestory.measure.prepare.symmetry import SYMMETRIES
    from clerestory.measure.uncertainty.tables import with_errors

    chosen_method = cast("Method", one_of(method, "--method", METHODS))
    chosen_symmetry = cast('Symmetry | Literal["auto"]', one_of(symmetry, "--symmetry", ("auto", *SYMMETRIES)))
    check_bsdf_name(output)
    npz = output.name.lower().endswith(".npz")
    if basis is None and not npz:
        basis = "klems-full"
    if not 1 <= resolution <= 7:
        raise UsageError(f"--resolution {resolution}: a whole number from 1 to 7")
    if not 0.0 <= level < 100.0:
        raise UsageError(f"--level {level:g}: a percentage from 0 to below 100")
    if cone is not None and not 0.0 <= cone < 90.0:
        raise UsageError(f"--cone {cone:g}: degrees from 0 to below 90")
    words = words_of(inputs, sample)
    if report is not None:
        if report.suffix.lower() not in (".html", ".pdf"):
            raise UsageError(f"--report {report}: not a kind of report (give .html or .pdf)")
        refuse_overwriting(report, [Path(text) for text in words])
    refuse_overwriting(output, [Path(text) for text in words])
    choices = choices_of(side, scatter, convention, column)
    measurement = measurement_of(words, db, sample, choices, laboratory=laboratory, date=date)
    raw = measurement.scans
    assumed: tuple[str, ...] = ()
    if lines:
        measurement, step = spread_lines(measurement)
        assumed = step.warnings
    with progress("fit") as done:
        made = fitted(measurement, method=chosen_method, symmetry=chosen_symmetry, channels=channel, progress=done)
    found = _uncertainties(measurement, made, basis, level, cone) if uncertainty else {}
    told = budgets_of(found)
    bsdf = made.bsdf.with_metadata(name=made.sample) if made.sample else made.bsdf
    if basis is not None:
        with progress("convert") as done:
            bsdf = as_table(bsdf, basis, resolution, done, cull=cull)
        if npz and basis not in TREES and found:
            with progress("uncertainty") as done:
                bsdf = with_errors(bsdf, found, progress=done)
    with about(output):
        notes = bsdf.write(output)
    if report is not None:
        from clerestory.measure.interpolant.report import write_report

        write_report(report, made, measurement)
    settings: dict[str, object] = {
        "method": made.method,
        "symmetry": symmetry,
        "channels": channel,
        "basis": basis,
        "lines": lines or None,
    }
    if basis in TREES:
        settings |= {"resolution": resolution, "cull": cull}
    settings |= {"laboratory": laboratory, "date": date, **choices}
    if uncertainty:
        settings |= {"level_percent": level, "cone_deg": cone}
    kept = None
    if keep_:
        result = Made(
            [output],
            stem_of(output),
            settings,
            _steps(made, basis, notes, assumed),
            scans=raw,
            report=report,
            note=note_,
        )
        kept = keep(context, result, words, db)
    if as_json:
        components = [
            asdict(component)
            | {
                "held_out_total_error": component.held_out.total_error,
                "held_out_misplaced": component.held_out.misplaced_mean,
                "held_out_peak_deg": component.held_out.peak_median_deg,
            }
            for component in made.components
        ]
        print_json(
            {
                "sample": made.sample,
                "method": made.method,
                "written": output,
                "components": components,
                "uncertainty": as_rows(told),
                "warnings": [*assumed, *made.warnings, *notes],
                "report": report,
                "kept": kept,
            }
        )
        return
    for text in (*assumed, *made.warnings, *notes):
        note(f"warning: {text}")
    for line in made.lines():
        say(line)
    say_budgets(told)
    tell_written(filter(None, (output, report)), kept)


def _steps(made: Fit, basis: str | None, notes: list[str], assumed: tuple[str, ...]) -> list[dict[str, object]]:
    """What was done, for the database."""
    figures = plain([asdict(component) for component in made.components])
    steps: list[dict[str, object]] = [{"step": "lines", "what": text, "warnings": [text]} for text in assumed]
    what = "; ".join(made.lines())
    steps.append({"step": "fit", "what": what, "figures": figures, "warnings": list(made.warnings)})
    if basis is not None:
        steps.append({"step": "conversion", "what": f"a table on {basis}", "warnings": notes})
    return steps


def _uncertainties(
    measurement: Measurement, made: Fit, basis: str | None, level: float, cone: float | None
) -> dict[tuple[str, Side, Scatter], Uncertainty]:
    from clerestory.basis import Basis
    from clerestory.measure.delaunay import NoSurfaceError
    from clerestory.measure.uncertainty import Settings, uncertainties

    patches = Basis.named("klems-full" if basis is None or basis in TREES else basis)
    try:
        with progress("uncertainty") as done:
            return uncertainties(measurement, made, Settings(cone, 0.01 * level), basis=patches, progress=done)
    except NoSurfaceError as error:
        note(f"warning: how far values are to be believed is not known: {error}")
        return {}
