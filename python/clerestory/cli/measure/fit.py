"""`clerestory measure fit`: a model of every pair of directions from measured scans."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal, cast

import typer

from clerestory.cli.common import (
    JsonOption,
    UsageError,
    about,
    note,
    one_of,
    print_json,
    progress,
    refuse_overwriting,
    say,
)
from clerestory.cli.measure.budgets import as_rows, budgets_of, say_budgets
from clerestory.cli.measure.options import (
    ColumnOption,
    ConventionOption,
    DatabaseOption,
    FileScatterOption,
    FileSideOption,
    SampleOption,
    choices_of,
    open_database,
)

if TYPE_CHECKING:
    from clerestory.bsdf import Bsdf
    from clerestory.directions import Scatter, Side
    from clerestory.measure import Measurement
    from clerestory.measure.interpolant import Fit, Method
    from clerestory.measure.prepare.symmetry import Symmetry
    from clerestory.measure.uncertainty import Uncertainty

_TREES = ("tensor3", "tensor4")
_SUFFIXES = (".xml", ".xml.gz", ".bsdf.npz")


def fit(
    inputs: Annotated[
        list[str],
        typer.Argument(
            metavar="FILE…|SAMPLE", help="Files or folders of scans, or a sample of the database.", show_default=False
        ),
    ],
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
    db: DatabaseOption = None,
    sample: SampleOption = None,
    side: FileSideOption = None,
    scatter: FileScatterOption = None,
    convention: ConventionOption = None,
    column: ColumnOption = None,
    as_json: JsonOption = False,
) -> None:
    """Make a model of every pair of directions from scans of a few incident ones, and say how good it is.

    Scattered points become lobes, which move from where one incident direction has them to where the next one does. The
    report has the error of each measured direction left out. Values beyond what was measured are extrapolated.

    Example: clerestory measure fit scans/ -o twill.bsdf.npz --symmetry rotational
    """
    from clerestory.measure.interpolant import METHODS
    from clerestory.measure.interpolant import fit as fitted
    from clerestory.measure.prepare.symmetry import SYMMETRIES
    from clerestory.measure.uncertainty.tables import with_errors

    chosen_method = cast("Method", one_of(method, "--method", METHODS))
    chosen_symmetry = cast('Symmetry | Literal["auto"]', one_of(symmetry, "--symmetry", ("auto", *SYMMETRIES)))
    if not output.name.lower().endswith(_SUFFIXES):
        raise UsageError(f"{output}: the name does not tell the format (end it with {', '.join(_SUFFIXES)})")
    npz = output.name.lower().endswith(".npz")
    if basis is None and not npz:
        basis = "klems-full"
    if not 1 <= resolution <= 7:
        raise UsageError(f"--resolution {resolution}: a whole number from 1 to 7")
    if not 0.0 <= level < 100.0:
        raise UsageError(f"--level {level:g}: a percentage from 0 to below 100")
    if cone is not None and not 0.0 <= cone < 90.0:
        raise UsageError(f"--cone {cone:g}: degrees from 0 to below 90")
    files = [Path(text) for text in inputs]
    refuse_overwriting(output, [file for file in files if file.exists()])
    measurement = _measurement(inputs, db, sample, choices_of(side, scatter, convention, column))
    with progress("fit") as done:
        made = fitted(measurement, method=chosen_method, symmetry=chosen_symmetry, channels=channel, progress=done)
    found = _uncertainties(measurement, made, basis, level, cone) if uncertainty else {}
    told = budgets_of(found)
    bsdf = made.bsdf.with_metadata(name=made.sample) if made.sample else made.bsdf
    if basis is not None:
        with progress("convert") as done:
            bsdf = _converted(bsdf, basis, resolution, cull, done)
        if npz and basis not in _TREES and found:
            with progress("uncertainty") as done:
                bsdf = with_errors(bsdf, found, progress=done)
    with about(output):
        notes = bsdf.write(output)
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
                "warnings": [*made.warnings, *notes],
            }
        )
        return
    for text in (*made.warnings, *notes):
        note(f"warning: {text}")
    for line in made.lines():
        say(line)
    say_budgets(told)
    note(f"wrote {output}")


def _uncertainties(
    measurement: Measurement, made: Fit, basis: str | None, level: float, cone: float | None
) -> dict[tuple[str, Side, Scatter], Uncertainty]:
    from clerestory.basis import Basis
    from clerestory.measure.delaunay import NoSurfaceError
    from clerestory.measure.uncertainty import Settings, uncertainties

    patches = Basis.named("klems-full" if basis is None or basis in _TREES else basis)
    try:
        with progress("uncertainty") as done:
            return uncertainties(measurement, made, Settings(cone, 0.01 * level), basis=patches, progress=done)
    except NoSurfaceError as error:
        note(f"warning: how far values are to be believed is not known: {error}")
        return {}


def _converted(bsdf: Bsdf, basis: str, resolution: int, cull: float, done: object) -> Bsdf:
    from clerestory.basis import Basis

    call = cast("type", done)
    if basis in _TREES:
        rank = cast('Literal["tensor3", "tensor4"]', basis)
        return bsdf.to_tree(rank, resolution=resolution, reduce=cull, progress=call)
    return bsdf.to_matrix(Basis.named(basis), progress=call)


def _measurement(inputs: list[str], db: str | None, sample: str | None, choices: dict[str, object]) -> Measurement:
    """Scans of one sample, of files or of the database."""
    from clerestory.measure import read

    there = [text for text in inputs if Path(text).exists()]
    if len(there) < len(inputs):
        if there or len(inputs) > 1:
            missing = next(text for text in inputs if text not in there)
            raise UsageError(f"{missing}: no such file (give files and folders, or one sample of the database)")
        with open_database(db) as database:
            return database.measurement(inputs[0])
    contents = read(inputs, **choices)  # type: ignore[arg-type]  # what a person says is checked there
    for text in contents.warnings:
        note(f"warning: {text}")
    kept = [one for one in contents.measurements if sample in (None, one.sample)]
    if not kept:
        names = ", ".join(one.sample for one in contents.measurements) or "none"
        raise UsageError(f"no scans of {sample or 'a sample'} in these files (samples there: {names})")
    if len(kept) > 1:
        names = ", ".join(one.sample for one in kept)
        raise UsageError(f"scans of several samples: {names} (choose one with --sample)")
    return kept[0]
