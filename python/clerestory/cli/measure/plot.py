"""`clerestory measure plot`: pictures of measured points."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from clerestory.cli.common import (
    JsonOption,
    UsageError,
    about,
    angle_pair,
    note,
    one_of,
    print_json,
    read,
    refuse_overwriting,
    scatter_of,
    side_of,
    write_whole,
)
from clerestory.cli.measure.inputs import contents_of
from clerestory.cli.measure.options import ColumnOption, DatabaseOption, DateOption, LaboratoryOption, choices_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from clerestory.measure import Scan

_KINDS = ("points", "surface", "mountain", "cut", "close-up", "overview")
_CLIPPED = ("surface", "mountain", "cut", "model")
_ON_DISKS = ("points", "surface", "overview")


def plot(
    files: Annotated[
        list[str], typer.Argument(metavar="FILE|SAMPLE…", help="Files, or samples of the database.", show_default=False)
    ],
    *,
    output: Annotated[Path, typer.Option("--output", "-o", metavar="OUT", help="Picture: .png, .pdf or .svg.")],
    kind: Annotated[
        str | None,
        typer.Option(
            "--kind", help=f"{', '.join(_KINDS)}; points, or overview for several incident directions, by default."
        ),
    ] = None,
    incident: Annotated[
        str | None, typer.Option("--incident", metavar="T,P", help="Where light comes from [°].", show_default=False)
    ] = None,
    side: Annotated[
        str | None, typer.Option("--side", metavar="SIDE", help="Side that light comes from; the first measured.")
    ] = None,
    scatter: Annotated[
        str | None, typer.Option("--scatter", metavar="SCATTER", help="transmission or reflection; the first measured.")
    ] = None,
    channel: Annotated[
        str | None, typer.Option("--channel", metavar="NAME", help="Of the file; visible, Y or the first by default.")
    ] = None,
    quantity: Annotated[str, typer.Option("--quantity", help="bsdf, or dsf = BSDF·cos θ.")] = "bsdf",
    scale: Annotated[str, typer.Option("--scale", help="log or linear; a close-up shows both.")] = "log",
    centre: Annotated[
        str | None, typer.Option("--centre", metavar="T,P", help="Middle of a close-up [°]; its peak by default.")
    ] = None,
    half_width: Annotated[
        float | None, typer.Option("--half-width", metavar="M", help="Of a close-up [arc-minutes].")
    ] = None,
    azimuth: Annotated[
        float | None, typer.Option("--azimuth", metavar="P", help="Of a cut [°]; the plane of scattering by default.")
    ] = None,
    clip: Annotated[
        float | None,
        typer.Option("--clip", metavar="DEG", help="Leave out what is closer to the horizon; 5 by default."),
    ] = None,
    projection: Annotated[
        str | None,
        typer.Option("--projection", metavar="NAME", help="Disks: polar (by default), or orthographic: projected."),
    ] = None,
    model: Annotated[
        Path | None,
        typer.Option("--model", metavar="FILE", help="Draw points beside this data set, and both in a cut."),
    ] = None,
    column: ColumnOption = None,
    dpi: Annotated[float, typer.Option("--dpi", help="Pixels an inch.")] = 160.0,
    db: DatabaseOption = None,
    laboratory: LaboratoryOption = None,
    date: DateOption = None,
    as_json: JsonOption = False,
) -> None:
    """Draw measured points: as they are, the surface between them, a mountain, a cut, a peak from near by, all of them.

    Directions are as seen from the room. A cut has a line for each sample in the files. With --model, the points stand
    beside the model that was made of them.

    Example: clerestory measure plot twill_40_0.txt -o twill.png --kind mountain --quantity dsf
    """
    from clerestory.plot import measured
    from clerestory.plot.style import render, suffix_of

    suffix = suffix_of(output)
    refuse_overwriting(output, [Path(word) for word in files])
    if model is not None and kind is not None:
        raise UsageError("--model: is a picture of its own (leave --kind out)")
    if clip is not None and not 0.0 <= clip < 90.0:
        raise UsageError(f"--clip {clip:g}: an angle from 0 to 90° is asked for")
    asked = "model" if model is not None else None if kind is None else one_of(kind, "--kind", _KINDS)
    options: dict[str, Any] = {
        "side": None if side is None else side_of(side),
        "scatter": None if scatter is None else scatter_of(scatter),
        "channel": channel,
        "quantity": one_of(quantity, "--quantity", ("bsdf", "dsf")),
    }
    from_direction = None if incident is None else angle_pair(incident, "--incident")
    middle = None if centre is None else angle_pair(centre, "--centre")
    kept_scale: Any = one_of(scale, "--scale", ("log", "linear"))
    contents = contents_of(files, db, choices_of(None, None, None, column), laboratory=laboratory, date=date)
    samples: dict[str, Sequence[Scan]] = {m.sample: m.scans for m in contents.measurements if m.of()}
    if not samples:
        raise UsageError(f"{files[0]}: no points of a sample to draw (give scans of a goniophotometer)")
    chosen = asked or _fitting(samples, many=from_direction is None)
    _refuse_useless(
        chosen,
        {
            "--incident": (from_direction is not None, (*(k for k in _KINDS if k != "overview"), "model")),
            "--centre": (middle is not None, ("close-up",)),
            "--half-width": (half_width is not None, ("close-up",)),
            "--azimuth": (azimuth is not None, ("cut", "model")),
            "--clip": (clip is not None, _CLIPPED),
            "--projection": (projection is not None, _ON_DISKS),
        },
    )
    if chosen != "overview":
        options["incident"] = from_direction
    if clip is not None:
        options["clip_deg"] = clip
    if projection is not None:
        options["projection"] = one_of(projection, "--projection", ("polar", "orthographic"))
    if chosen == "cut":
        figure = measured.cut_figure(samples, scale=kept_scale, azimuth_deg=azimuth, **options)
    else:
        if len(samples) > 1:
            names = ", ".join(samples)
            what = "--model" if model is not None else f"--kind {chosen}"
            raise UsageError(f"{what}: shows one sample, not {names} (give files of one, or take --kind cut)")
        label, scans = next(iter(samples.items()))
        options["label"] = label
        if model is not None:
            bsdf = read(model)
            with about(model):
                figure = measured.beside_figure(scans, bsdf, scale=kept_scale, azimuth_deg=azimuth, **options)
        elif chosen == "close-up":
            figure = measured.close_up_figure(scans, centre=middle, half_width_arcmin=half_width, **options)
        else:
            draw = {
                "points": measured.points_figure,
                "surface": measured.surface_figure,
                "mountain": measured.mountain_figure,
                "overview": measured.overview_figure,
            }[chosen]
            figure = draw(scans, scale=kept_scale, **options)  # type: ignore[operator]
    write_whole(output, render(figure, suffix, dpi=dpi))
    if as_json:
        held = {name: {"scans": len(s), "points": sum(len(scan) for scan in s)} for name, s in samples.items()}
        print_json({"output": output, "kind": chosen, "samples": held})
    else:
        note(f"wrote {output}")


def _fitting(samples: dict[str, Sequence[Scan]], *, many: bool) -> str:
    if len(samples) > 1:
        return "cut"
    scans = next(iter(samples.values()))
    directions = {(s.incident_theta_deg, s.incident_phi_deg) for s in scans if s.purpose == "sample"}
    return "overview" if many and len(directions) > 1 else "points"


def _refuse_useless(kind: str, given: dict[str, tuple[bool, tuple[str, ...]]]) -> None:
    for option, (present, kinds) in given.items():
        if present and kind not in kinds:
            what = "--model" if kind == "model" else f"--kind {kind}"
            others = " or ".join(name for name in kinds if name != "model")
            raise UsageError(f"{option}: has no effect on {what} (leave it out, or take {others})")
