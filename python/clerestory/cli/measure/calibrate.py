"""`clerestory measure calibrate`: data sets and scans scaled to what an integrating sphere measured."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from clerestory.cli.common import (
    JsonOption,
    UsageError,
    check_bsdf_name,
    note,
    one_of,
    plain,
    print_json,
    read,
    refuse_overwriting,
    say,
    table,
)
from clerestory.cli.measure.inputs import contents_of, measurement_of, refuse_to_write_over
from clerestory.cli.measure.keeping import KeepOption, Kept, Made, NoteOption, keep, tell_written
from clerestory.cli.measure.options import (
    ColumnOption,
    DatabaseOption,
    DateOption,
    LaboratoryOption,
    SampleOption,
    check_picture,
    choices_of,
)
from clerestory.endings import is_bsdf, stem_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from clerestory.measure import Measurement
    from clerestory.measure.calibrate import Agreement, Factor
    from clerestory.measure.sphere import SphereValues

_SCALINGS = ("all", "scattered", "peak", "both")
_STANDARDS = ("en410", "iso9050", "nfrc300")


def calibrate(
    context: typer.Context,
    data: Annotated[
        str,
        typer.Argument(
            metavar="DATA", help="BSDF file (.xml, .bsdf.npz); or files or a sample of scans.", show_default=False
        ),
    ],
    *,
    sphere: Annotated[
        list[str],
        typer.Option("--sphere", metavar="FILE|SAMPLE", help="Values of an integrating sphere.", show_default=False),
    ],
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="OUT", help="Where to write; without it, values are compared only."),
    ] = None,
    scaling: Annotated[
        str, typer.Option("--scale", metavar="PART", help="all, scattered, peak, or both to their own values.")
    ] = "all",
    reciprocal: Annotated[
        bool, typer.Option("--reciprocal", help="Keep reversed paths equal (matrices, all light).")
    ] = False,
    standard: Annotated[
        str, typer.Option("--standard", metavar="NAME", help="Spectra that weigh: en410, iso9050 or nfrc300.")
    ] = "en410",
    picture: Annotated[
        Path | None, typer.Option("--picture", metavar="OUT", help="Curves or maps: .png, .pdf or .svg.")
    ] = None,
    format_: Annotated[
        str, typer.Option("--format", metavar="FORMAT", help="For scans: mountain, iea21, astm, zemax, csv, …")
    ] = "mountain",
    sample: SampleOption = None,
    column: ColumnOption = None,
    db: DatabaseOption = None,
    laboratory: LaboratoryOption = None,
    date: DateOption = None,
    note_: NoteOption = None,
    keep_: KeepOption = True,
    as_json: JsonOption = False,
) -> None:
    """Compare data with a sphere's direct-hemispherical values and scale them so that they agree.

    The integral becomes the measured value at every measured angle, and factors are interpolated between them. What was
    made of a model or of scans of the database is kept there too.

    Example: clerestory measure calibrate film.xml --sphere film-sphere.csv --scale scattered -o calibrated.xml
    """
    from clerestory.measure.files import writable_formats

    part = one_of(scaling, "--scale", _SCALINGS)
    weighed = one_of(standard, "--standard", _STANDARDS)
    check_picture(picture)
    if output is not None:
        refuse_overwriting(output, [Path(data), *map(Path, sphere)])
    choices = choices_of(None, None, None, column)
    values = _sphere_values(sphere, sample, db, choices)
    words = [data, *sphere]
    said = {
        "scale": part,
        "reciprocal": reciprocal or None,
        "standard": weighed,
        "laboratory": laboratory,
        "date": date,
    }

    def keeping(made: Made) -> Kept | None:
        told = replace(made, settings=said, spheres=values, note=note_)
        return keep(context, told, words, db) if keep_ else None

    if is_bsdf(data):
        if (laboratory, date) != (None, None):
            raise UsageError("--laboratory and --date choose scans of the database, not data sets (leave them out)")
        _model(Path(data), values, output, part, weighed, picture, keeping, reciprocal=reciprocal, as_json=as_json)
        return
    if reciprocal or part == "both":
        raise UsageError(
            f"{data}: scans are scaled by all, scattered or peak, without --reciprocal (fit a model first)"
        )
    form = one_of(format_, "--format", tuple(writable_formats()))
    if output is not None:
        refuse_to_write_over(output, [data])
    of_files = choices if Path(data).exists() else {}
    measurement = measurement_of([data], db, sample, of_files, laboratory=laboratory, date=date)
    _scans(measurement, values, output, part, weighed, picture, form, keeping, as_json=as_json)


def _sphere_values(
    words: list[str], sample: str | None, db: str | None, choices: dict[str, object]
) -> list[SphereValues]:
    found = contents_of(words, db, choices).sphere_values
    samples = list(dict.fromkeys(v.sample for v in found))
    if not samples:
        raise UsageError(f"--sphere {' '.join(words)}: no values of a sphere in it")
    if sample is not None and sample in samples:
        return [v for v in found if v.sample == sample]
    if len(samples) > 1:
        raise UsageError(f"--sphere: values of several samples: {', '.join(samples)} (name one by --sample)")
    return list(found)


def _model(
    path: Path,
    values: list[SphereValues],
    output: Path | None,
    part: str,
    standard: str,
    picture: Path | None,
    keeping: Callable[[Made], Kept | None],
    *,
    reciprocal: bool,
    as_json: bool,
) -> None:
    from clerestory.cli.common import about
    from clerestory.measure.calibrate import calibrated, of_model

    bsdf = read(path)
    with about(path):
        if output is None:
            _tell(of_model(bsdf, values, standard=standard), None, (), (), picture, [], as_json=as_json)
            return
        check_bsdf_name(output)
        done = calibrated(bsdf, values, scaling=part, reciprocal=reciprocal, standard=standard)  # type: ignore[arg-type]
    lost = done.bsdf.write(output)
    warnings = (*done.warnings, *lost)
    step = {
        "step": "calibration",
        "what": f"scaled to a sphere's values ({part} light): RMS difference {100.0 * done.before.rms:.2g} %, now"
        f" {100.0 * done.after.rms:.2g} %",
        "figures": plain({"factors": done.factors}),
        "warnings": list(warnings),
    }
    kept = keeping(Made([output], stem_of(output), {}, [step], model=path))
    _tell(done.before, done.after, done.factors, warnings, picture, [output], kept, as_json=as_json)


def _scans(
    measurement: Measurement,
    values: list[SphereValues],
    output: Path | None,
    part: str,
    standard: str,
    picture: Path | None,
    form: str,
    keeping: Callable[[Made], Kept | None],
    *,
    as_json: bool,
) -> None:
    from clerestory.measure.calibrate import calibrated_scans, of_scans
    from clerestory.measure.files import write
    from clerestory.measure.prepare.step import Prepared

    other = {v.sample for v in values} - {measurement.sample, ""}
    if other:
        note(f"warning: scans of {measurement.sample!r} beside a sphere's values of {', '.join(sorted(other))!r}")
    if output is None:
        _tell(of_scans(measurement, values, standard=standard), None, (), (), picture, [], as_json=as_json)
        return
    done = calibrated_scans(measurement, values, scaling=part, standard=standard)  # type: ignore[arg-type]
    written = write(replace(done.measurement, scans=done.measurement.of()), output, form)
    warnings = (*done.step.warnings, *written.notes)
    steps = cast("list[dict[str, object]]", plain(Prepared(done.measurement, (done.step,)).record()))
    name = f"{measurement.sample} calibrated"
    kept = keeping(Made(written.paths, name, {}, steps, kind="scans", scans=measurement.scans))
    _tell(done.before, done.after, (), warnings, picture, list(written.paths), kept, as_json=as_json)


def _tell(
    before: Agreement,
    after: Agreement | None,
    factors: tuple[Factor, ...],
    warnings: tuple[str, ...],
    picture: Path | None,
    written: list[Path],
    kept: Kept | None = None,
    *,
    as_json: bool,
) -> None:
    warnings = tuple(dict.fromkeys([*before.warnings, *warnings]))
    if picture is not None:
        from clerestory.measure.calibrate.picture import picture as draw
        from clerestory.plot.style import save

        save(draw(before, after), picture)
        written = [*written, picture]
    if as_json:
        print_json(
            {
                "before": _rows(before),
                "after": None if after is None else _rows(after),
                "factors": factors,
                "warnings": warnings,
                "written": written,
                "kept": kept,
            }
        )
        return
    later = {row.where: row.modelled for row in after.rows} if after is not None else {}
    rows = [
        [
            row.where,
            f"{row.measured:.4f}",
            f"{row.modelled:.4f}",
            f"{row.difference:+.4f}",
            f"{row.ratio:.3f}",
            *([f"{later[row.where]:.4f}"] if later else []),
        ]
        for row in before.rows
    ]
    say(table(["direct-hemispherical", "sphere", "data", "difference", "factor", *(["now"] if later else [])], rows))
    say(
        f"RMS difference {100.0 * before.rms:.2g} %" + (f", now {100.0 * after.rms:.2g} %" if after is not None else "")
    )
    for text in warnings:
        note(f"warning: {text}")
    folders = {path.parent for path in written if path != picture}
    if len(written) > 3 and len(folders) == 1:
        note(f"wrote {len(written) - (picture in written)} files to {next(iter(folders))}")
        written = [path for path in written if path == picture]
    tell_written(written, kept)


def _rows(agreement: Agreement) -> list[dict[str, object]]:
    """Values side by side as JSON shows them."""
    return [{**vars(row), "difference": row.difference, "ratio": row.ratio} for row in agreement.rows]
