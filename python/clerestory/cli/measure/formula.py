"""`clerestory measure formula`: a formula with a few parameters fitted to scans."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from clerestory.cli.common import (
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
    table,
)
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
    check_picture,
    choices_of,
)
from clerestory.cli.measure.tables import as_table
from clerestory.endings import stem_of

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from clerestory.bsdf import Bsdf
    from clerestory.cli.measure.keeping import Kept
    from clerestory.measure.formula import Fitted


def formula(
    context: typer.Context,
    inputs: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="FILE…|SAMPLE",
            help="Scans, lines among them: files, folders, or a sample of the database.",
            show_default=False,
        ),
    ] = None,
    *,
    model: Annotated[
        str,
        typer.Option(
            "--model",
            metavar="NAME",
            help="lambertian, abg, harvey-shack, k-correlation, gaussian, cosine-power, ward, ward-bounded, "
            "ward-anisotropic, ggx or ggx-transmission; even scattering is beside each.",
            show_default=False,
        ),
    ],
    output: Annotated[
        Path | None, typer.Option("--output", "-o", metavar="OUT", help="Data set: .bsdf.npz, .xml or .xml.gz.")
    ] = None,
    csv: Annotated[Path | None, typer.Option("--csv", metavar="OUT", help="The parameters as a table.")] = None,
    picture: Annotated[
        Path | None, typer.Option("--picture", metavar="OUT", help="Points and curves: .png, .pdf or .svg.")
    ] = None,
    order: Annotated[
        str, typer.Option(metavar="N", help="Degree of parameters in 1 − cos θ of incidence: 0 to 3, or auto.")
    ] = "auto",
    beam: Annotated[
        float | None,
        typer.Option("--beam", metavar="DEG", help="Full width at half maximum of the beam, if no scan tells it [°]."),
    ] = None,
    channel: Annotated[
        list[str] | None, typer.Option("--channel", metavar="NAME", help="Only this channel; repeatable.")
    ] = None,
    basis: Annotated[
        str | None, typer.Option(metavar="NAME", help="Of an .xml: klems-full (the default), …, tensor3 or tensor4.")
    ] = None,
    resolution: Annotated[int, typer.Option(metavar="N", help="2^N cells an axis of the data set's tree.")] = 6,
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
    """Fit a formula such as ABg to scans: parameters with standard errors, how well it fits, and a data set.

    Scans of the beam tell the instrument's signature, which is kept apart: what passes unscattered becomes a beam, and
    widths are the sample's own. Scans in the plane of incidence are enough for a sample that is alike all around.

    Example: clerestory measure formula scans/ --model abg -o slat.bsdf.npz --picture slat.png
    """
    from clerestory.measure.formula import FORMULAS, fit_formula

    name = model.lower() if model.lower() in FORMULAS else one_of(model, "--model", tuple(FORMULAS))
    degree = _order(order)
    if output is not None:
        check_bsdf_name(output)
    check_picture(picture)
    if not 2 <= resolution <= 8:
        raise UsageError(f"--resolution {resolution}: a whole number from 2 to 8")
    words = words_of(inputs, sample)
    for out in filter(None, (output, csv, picture)):
        refuse_overwriting(out, [Path(text) for text in words])
    choices = choices_of(side, scatter, convention, column)
    measurement = measurement_of(words, db, sample, choices, laboratory=laboratory, date=date)
    for text in measurement.warnings:
        note(f"warning: {text}")
    with progress("fit") as done:
        fits = fit_formula(measurement, name, order=degree, beam_deg=beam, channels=channel, progress=done)
    written: list[Path] = []
    warnings: list[str] = []
    if output is not None:
        with progress("convert") as done:
            bsdf, warnings = _data_set(fits, measurement.sample, output, basis, resolution, done)
        with about(output):
            warnings += bsdf.write(output)
        written.append(output)
    if csv is not None:
        from clerestory.whole import write_whole

        rows = [",".join(str(cell) for cell in row) for row in _rows(fits)]
        write_whole(csv, ("\n".join([",".join(_HEAD), *rows]) + "\n").encode())
        written.append(csv)
    if picture is not None:
        from clerestory.measure.formula.picture import picture as draw
        from clerestory.plot.style import save

        save(draw(fits, measurement), picture)
        written.append(picture)
    kept = None
    if keep_ and output is not None:
        said = {
            "model": name,
            "order": order,
            "beam": beam,
            "channels": channel,
            "basis": basis,
            "resolution": resolution,
            "laboratory": laboratory,
            "date": date,
            **choices,
        }
        figures = plain([_as_json(one) for one in fits])
        what = "; ".join(line for one in fits for line in one.lines())
        steps = [{"step": "formula", "what": what, "figures": figures, "warnings": warnings}]
        result = Made([output], stem_of(output), said, steps, scans=measurement.scans, note=note_)
        kept = keep(context, result, words, db)
    _tell(fits, measurement.sample, warnings, written, kept, as_json=as_json)


def _order(text: str) -> int | Literal["auto"]:
    if text == "auto":
        return "auto"
    if text in ("0", "1", "2", "3"):
        return int(text)
    raise UsageError(f"--order {text}: not known (give 0 to 3, or auto)")


def _data_set(
    fits: Sequence[Fitted],
    name: str,
    output: Path,
    basis: str | None,
    resolution: int,
    done: Callable[[float], object],
) -> tuple[Bsdf, list[str]]:
    from clerestory.measure.formula import data_set

    bsdf, warnings = data_set(fits, name=name, resolution=resolution, progress=done)
    if basis is None and output.name.lower().endswith(".npz"):
        return bsdf, warnings
    return as_table(bsdf, basis or "klems-full", resolution, done), warnings


_HEAD = ("band", "side", "scatter", "model", "theta_i_deg", "parameter", "value", "standard_error")


def _rows(fits: Sequence[Fitted]) -> list[list[object]]:
    return [
        [one.band, one.side, one.scatter, one.formula.name, theta, n.name, n.value, n.standard_error]
        for one in fits
        for theta in one.thetas_deg
        for n in one.numbers(theta)
    ]


def _tell(
    fits: Sequence[Fitted], name: str, warnings: list[str], written: list[Path], kept: Kept | None, *, as_json: bool
) -> None:
    if as_json:
        print_json(
            {
                "sample": name,
                "components": [_as_json(one) for one in fits],
                "warnings": warnings,
                "written": written,
                "kept": kept,
            }
        )
        return
    for one in fits:
        first, *rest = one.lines()
        say(first)
        head = [n.name for n in one.numbers(one.thetas_deg[0])]
        totals = {round(theta, 6): (made, seen) for theta, made, seen in one.totals}
        rows = []
        for theta in one.thetas_deg:
            cells = [_number(n.value, n.standard_error) for n in one.numbers(theta)]
            made, seen = totals[round(theta, 6)]
            rows.append([f"{theta:g}°", *cells, f"{made:.4f}", "" if seen is None else f"{seen:.4f}"])
        say(table(["incident", *head, "integral", "of points"], rows))
        for line in rest:
            say(f"  {line}")
        material = one.material()
        if material is not None:
            words = ", ".join(f"{k} = {_toml(v)}" for k, v in material.items())
            say(f"  as a material of a recipe: {{ {words} }}")
    for text in warnings:
        note(f"warning: {text}")
    tell_written(written, kept)


def _number(value: float, error: float) -> str:
    if math.isfinite(error):
        return f"{value:.4g} ± {error:.1g}"
    return "0" if value == 0.0 else f"{value:.4g} (limit)"


def _toml(value: object) -> str:
    return f'"{value}"' if isinstance(value, str) else f"{value:.6g}"


def _as_json(one: Fitted) -> dict[str, object]:
    signature = None if one.beam is None else one.beam.signature
    return {
        "band": one.band,
        "side": one.side,
        "scatter": one.scatter,
        "model": one.formula.name,
        "formula": one.formula.words,
        "points": one.points,
        "used": one.used,
        "residual": one.residual,
        "angles": [{"theta_deg": theta, "parameters": one.numbers(theta)} for theta in one.thetas_deg],
        "integrals": [{"theta_deg": t, "formula": made, "points": seen} for t, made, seen in one.totals],
        "orders": one.orders,
        "signature": signature,
        "beam": None if one.beam is None else one.beam.words,
        "material": one.material(),
    }
