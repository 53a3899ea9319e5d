"""`clerestory measure hybrid`: measured where the instrument reached, simulated elsewhere."""

from __future__ import annotations

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
    read,
    refuse_overwriting,
    say,
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
from clerestory.endings import is_bsdf, stem_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from clerestory.bsdf import Bsdf
    from clerestory.cli.measure.keeping import Kept
    from clerestory.measure import Measurement, Scan
    from clerestory.measure.hybrid import Hybrid, Reach, Scale
    from clerestory.measure.hybrid.reach import Key
    from clerestory.measure.interpolant import Method
    from clerestory.measure.prepare.symmetry import Symmetry


def hybrid(
    context: typer.Context,
    inputs: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="FILE…|SAMPLE",
            help="Scans: files, folders or a sample of the database; or one measured BSDF file (.bsdf.npz, .xml).",
            show_default=False,
        ),
    ] = None,
    *,
    simulated: Annotated[
        Path,
        typer.Option("--with", metavar="FILE", help="Simulated BSDF file of the same sample.", show_default=False),
    ],
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="OUT", help=".xml, .xml.gz or .bsdf.npz.", show_default=False)
    ],
    basis: Annotated[
        str, typer.Option(metavar="NAME", help="klems-full, klems-half, …, or tensor3 or tensor4 for trees.")
    ] = "klems-full",
    resolution: Annotated[int, typer.Option(metavar="N", help="2^N cells an axis, for trees.")] = 6,
    cull: Annotated[float, typer.Option(metavar="PCT", help="Percentage of a tree's finest blocks to merge.")] = 90.0,
    blend: Annotated[
        float, typer.Option(metavar="DEG", help="Width of the band in which one passes into the other [°].")
    ] = 10.0,
    scale: Annotated[
        str,
        typer.Option(metavar="HOW", help="Simulated light as measured along the seam, over all the overlap, or none."),
    ] = "seam",
    incident_limit: Annotated[
        float | None,
        typer.Option("--incident-limit", metavar="DEG", help="Incident angle up to which measured light counts."),
    ] = None,
    outgoing_limit: Annotated[
        float | None,
        typer.Option("--outgoing-limit", metavar="DEG", help="Outgoing angle up to which measured light counts."),
    ] = None,
    symmetry: Annotated[
        str,
        typer.Option(
            metavar="SYMMETRY", help="Of scans: auto, isotropic, quadrilateral, left-right, up-down, rotational, none."
        ),
    ] = "auto",
    method: Annotated[
        str, typer.Option(metavar="METHOD", help="Between measured incident directions: transport, linear, nearest.")
    ] = "transport",
    channel: Annotated[
        list[str] | None, typer.Option("--channel", metavar="NAME", help="Of scans, only this one; repeatable.")
    ] = None,
    picture: Annotated[
        Path | None, typer.Option("--picture", metavar="OUT", help="Both and the result: .png, .pdf or .svg.")
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
    """Join measured and simulated data: measured where the instrument reached, simulated elsewhere, without a seam.

    Scans tell how far they reach. The simulated light is scaled so that both carry as much along the seam; the report
    and the file say by what factor, and which share of incident directions, of all pairs and of the light is measured.

    Example: clerestory measure hybrid scans/ --with traced.xml -o hybrid.xml --picture hybrid.png
    """
    from clerestory.measure.hybrid import SCALES, joined
    from clerestory.measure.hybrid.tables import table
    from clerestory.measure.interpolant import METHODS
    from clerestory.measure.prepare.symmetry import SYMMETRIES

    how = cast("Scale", one_of(scale, "--scale", SCALES))
    chosen_method = cast("Method", one_of(method, "--method", METHODS))
    chosen_symmetry = cast('Symmetry | Literal["auto"]', one_of(symmetry, "--symmetry", ("auto", *SYMMETRIES)))
    check_bsdf_name(output)
    check_picture(picture)
    if not 0.0 < blend <= 45.0:
        raise UsageError(f"--blend {blend:g}: not possible (give more than 0 and at most 45°)")
    table(basis, resolution, cull)  # what is no basis is refused before the long work
    words = words_of(inputs, sample)
    for out in filter(None, (output, picture)):
        refuse_overwriting(out, [simulated, *(Path(text) for text in words)])
    rays = read(simulated)
    limits = (incident_limit, outgoing_limit)
    scans: tuple[Scan, ...] = ()
    model = None
    choices: dict[str, object] = {}
    if len(words) == 1 and is_bsdf(words[0]):
        model = Path(words[0])
        measured = read(model)
        warnings: list[str] = []
        reaches = _of_file(model, measured, *limits)
        name = measured.metadata.name or ""
    else:
        choices = choices_of(side, scatter, convention, column)
        measurement = measurement_of(words, db, sample, choices, laboratory=laboratory, date=date)
        name, scans = measurement.sample, measurement.scans
        measured, reaches, warnings = _of_scans(measurement, channel, limits, chosen_method, chosen_symmetry)
    with about(simulated), progress("join") as done:
        made = joined(
            measured,
            reaches,
            rays,
            basis=basis,
            resolution=resolution,
            reduce=cull,
            blend_deg=blend,
            scale=how,
            name=name,
            simulation=f"simulated ({simulated.name})",
            progress=done,
        )
    with about(output):
        notes = made.bsdf.write(output)
    written = [output]
    if picture is not None:
        from clerestory.measure.hybrid.picture import picture as draw
        from clerestory.plot.style import save

        save(draw(made), picture)
        written.append(picture)
    warnings += [*made.warnings, *notes]
    kept = None
    if keep_:
        said = {
            "with": str(simulated),
            "basis": basis,
            "blend": blend,
            "scale": how,
            "incident-limit": incident_limit,
            "outgoing-limit": outgoing_limit,
            "symmetry": symmetry,
            "method": chosen_method,
            "channels": channel,
            "laboratory": laboratory,
            "date": date,
            **choices,
        }
        if basis in TREES:
            said |= {"resolution": resolution, "cull": cull}
        steps = [
            {
                "step": "hybrid",
                "what": "; ".join(part.words for part in made.parts),
                "figures": plain(list(made.parts)),
                "warnings": warnings,
            }
        ]
        result = Made([output], stem_of(output), said, steps, scans=scans, model=model, note=note_)
        kept = keep(context, result, words, db)
    _tell(made, warnings, name, written, kept, as_json=as_json)


def _of_file(path: Path, measured: Bsdf, incident: float | None, outgoing: float | None) -> Mapping[Key, Reach]:
    from clerestory.measure.hybrid import reaches_known

    if (incident is None) != (outgoing is None):
        raise UsageError(f"{path}: give --incident-limit and --outgoing-limit together")
    kinds = {model.kind for members in measured.models.values() for model in members.values()}
    if incident is None and kinds != {"interpolant"}:
        raise UsageError(
            f"{path}: a {', '.join(sorted(kinds))} does not know how far it was measured (give --incident-limit and"
            " --outgoing-limit, or the scans themselves)"
        )
    return reaches_known(measured, incident_deg=incident, outgoing_deg=outgoing)


def _of_scans(
    measurement: Measurement,
    channel: list[str] | None,
    limits: tuple[float | None, float | None],
    method: Method,
    symmetry: Symmetry | Literal["auto"],
) -> tuple[Bsdf, Mapping[Key, Reach], list[str]]:
    from clerestory.measure.hybrid import reaches_of
    from clerestory.measure.interpolant import fit

    with progress("fit") as done:
        fitted = fit(measurement, method=method, symmetry=symmetry, channels=channel, hold_out=False, progress=done)
    incident, outgoing = (90.0 if limit is None else limit for limit in limits)
    reaches = reaches_of(measurement, fitted, incident_deg=incident, outgoing_deg=outgoing)
    return fitted.bsdf, reaches, list(fitted.warnings)


def _tell(
    made: Hybrid, warnings: list[str], name: str, written: list[Path], kept: Kept | None, *, as_json: bool
) -> None:
    if as_json:
        rows = []
        for part in made.parts:
            row = cast("dict[str, object]", plain(part))
            for what in ("incident", "solid_angle", "flux"):
                row[f"simulated_{what}"] = 1.0 - getattr(part, f"measured_{what}")
            rows.append(row)
        print_json({"sample": name, "written": written, "components": rows, "warnings": warnings, "kept": kept})
        return
    for text in warnings:
        note(f"warning: {text}")
    for part in made.parts:
        say(part.words)
    tell_written(written, kept)
