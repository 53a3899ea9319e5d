"""`clerestory glare`: sources and indices of pictures."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from clerestory.cli.common import (
    JsonOption,
    UsageError,
    about,
    in_one_line,
    is_expected,
    note,
    numbers,
    one_of,
    plain,
    print_json,
    refuse_overwriting,
    say,
    table,
    warn,
    write_whole,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from clerestory.glare import Evaluation, Settings
    from clerestory.picture import Picture, View

_HDR = (".hdr", ".pic", ".exr")
_LISTED = 12


def glare(
    pictures: Annotated[
        list[Path],
        typer.Argument(metavar="IMAGE…", help="Radiance pictures (.hdr, .pic) or OpenEXR.", show_default=False),
    ],
    *,
    preset: Annotated[
        str,
        typer.Option("--preset", metavar="NAME", help="Choices of evalglare-3.06, evalglare-2.10 or evalglare-1.x."),
    ] = "evalglare-3.06",
    threshold: Annotated[
        float | None,
        typer.Option(
            "--threshold",
            metavar="L",
            help="Source pixels: above 100 a luminance [cd/m²], else times the task's or the picture's mean. [2000]",
        ),
    ] = None,
    task: Annotated[
        str | None,
        typer.Option(
            "--task", metavar="X,Y,ANGLE", help="Task area: pixel from the left and the bottom, opening angle [rad]."
        ),
    ] = None,
    search_radius: Annotated[
        float | None, typer.Option("--search-radius", metavar="A", help="Of one source [rad]. [0.2]")
    ] = None,
    smooth: Annotated[bool, typer.Option("--smooth", help="Add pixels that a source surrounds.")] = False,
    peaks: Annotated[
        float | None, typer.Option("--peaks", metavar="L", help="Peaks above it are sources [cd/m²]. [50000]")
    ] = None,
    no_peaks: Annotated[bool, typer.Option("--no-peaks", help="Extract no peaks.")] = False,
    background: Annotated[
        str | None, typer.Option("--background", metavar="WHICH", help="without-sources, mean or illuminance.")
    ] = None,
    position_index: Annotated[
        str | None, typer.Option("--position-index", metavar="WHICH", help="guth-iwata or kim.")
    ] = None,
    low_light: Annotated[
        bool | None, typer.Option("--low-light/--no-low-light", help="Correct the DGP below 1000 lx.")
    ] = None,
    age: Annotated[float | None, typer.Option("--age", metavar="YEARS", help="Correct the DGP for age.")] = None,
    vertical_illuminance: Annotated[
        float | None,
        typer.Option("--vertical-illuminance", metavar="LX", help="Measured at the eye, for the DGP."),
    ] = None,
    view: Annotated[
        str | None,
        typer.Option("--view", metavar="OPTIONS", help="What the pictures show, such as '-vta -vh 180 -vv 180'."),
    ] = None,
    check_picture: Annotated[
        Path | None,
        typer.Option("--check-picture", metavar="OUT", help="Sources in colours: .png, .pdf, .svg, .hdr or .exr."),
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Find glare sources in pictures, and say what DGP, DGI, UGR and other indices make of them.

    Sources and indices are those of evalglare, whose choices of a release `--preset` names. Pictures should be fisheyes
    of 180°, angular or hemispherical. The exit code is 1 if a picture cannot be rated.

    Example: clerestory glare office.hdr --check-picture sources.png
    """
    from clerestory.picture import View

    settings = _settings(
        preset,
        threshold,
        task,
        {
            "search_radius": search_radius,
            "smoothing": smooth or None,
            "peaks": peaks,
            "background": background,
            "position_index": position_index,
            "low_light": low_light,
            "age": age,
            "vertical_illuminance": vertical_illuminance,
        },
        no_peaks=no_peaks,
    )
    if check_picture is not None:
        if len(pictures) > 1:
            raise UsageError("--check-picture: shows one picture (give one)")
        refuse_overwriting(check_picture, pictures)
        _check_suffix(check_picture)
    shown = None if view is None else View(view)
    results: list[dict[str, Any]] = []
    rated: list[tuple[Path, Evaluation]] = []
    for path in pictures:
        try:
            picture, found = _evaluate(path, settings, shown)
        except Exception as error:
            if not is_expected(error):
                raise
            typer.echo(f"error: {in_one_line(error)}", err=True)
            results.append({"file": path, "error": in_one_line(error)})
            continue
        for text in (*picture.warnings, *found.warnings):
            warn(path, text)
        if check_picture is not None:
            _write_check(check_picture, picture, found, path)
        rated.append((path, found))
        results.append(_plain(path, found))
    if as_json:
        print_json(results)
    elif rated:
        _say(rated, settings)
    if len(rated) < len(pictures):
        raise typer.Exit(1)


def _settings(
    preset: str, threshold: float | None, task: str | None, given: dict[str, Any], *, no_peaks: bool
) -> Settings:
    from clerestory.glare import PRESETS, Settings

    settings = Settings.preset(one_of(preset, "--preset", PRESETS))
    if given["background"] is not None:
        given["background"] = one_of(given["background"], "--background", ("without-sources", "mean", "illuminance"))
    if given["position_index"] is not None:
        given["position_index"] = one_of(given["position_index"], "--position-index", ("guth-iwata", "kim"))
    if no_peaks and given["peaks"] is not None:
        raise UsageError("--no-peaks: does not go with --peaks (give one of them)")
    settings = replace(settings, **{key: value for key, value in given.items() if value is not None})
    if no_peaks:
        settings = replace(settings, peaks=None)
    if task is not None:
        x, y, angle = numbers(task, "--task", 3, "400,200,0.6")
        settings = replace(settings, task=(x, y, angle))
    if threshold is not None:
        settings = replace(settings, threshold=threshold, threshold_of="absolute")
    if settings.threshold <= 100.0:
        settings = replace(settings, threshold_of="mean" if settings.task is None else "task")
    return settings


def _evaluate(path: Path, settings: Settings, view: View | None) -> tuple[Picture, Evaluation]:
    from clerestory.glare import evaluate
    from clerestory.picture import Picture

    picture = Picture.read(path)
    with about(path):
        return picture, evaluate(picture, settings, view=view)


def _check_suffix(path: Path) -> None:
    from clerestory.plot.style import suffix_of

    if path.suffix.lower() not in _HDR:
        suffix_of(path)


def _write_check(target: Path, picture: Picture, found: Evaluation, path: Path) -> None:
    from clerestory.glare.check import check_hdr, check_picture

    if target.suffix.lower() in _HDR:
        check_hdr(picture, found).write(target)
    else:
        from clerestory.plot.style import render, suffix_of

        write_whole(target, render(check_picture(picture, found, title=path.name), suffix_of(target)))
    note(f"wrote {target}")


def _plain(path: Path, found: Evaluation) -> dict[str, Any]:
    """A result for machines; the labels of pixels would drown it."""
    values: dict[str, Any] = {"file": path, **plain(replace(found, labels=None))}  # type: ignore[dict-item]
    values.pop("labels")
    return {**values, "dgp_class": found.dgp_class, "dgi_class": found.dgi_class}


def _say(rated: Sequence[tuple[Path, Evaluation]], settings: Settings) -> None:
    head = ["picture", "class", "DGP", "DGI", "UGR", "VCP", "CGI", "E_v [lx]", "L_b [cd/m²]", "sources"]
    rows = [
        [
            path.name,
            found.dgp_class,
            f"{found.dgp:.3f}",
            f"{found.dgi:.1f}",
            f"{found.ugr:.1f}",
            f"{found.vcp:.1f}",
            f"{found.cgi:.1f}",
            f"{found.vertical_illuminance:.0f}",
            f"{found.background_luminance:.1f}",
            str(len(found.sources)),
        ]
        for path, found in rated
    ]
    say(table(head, rows, left=2))
    if len(rated) == 1 and rated[0][1].sources:
        say("\nSources, the most glaring first")
        say(_sources(rated[0][1]))
    say(f"\nSettings: {settings.words()}")


def _sources(found: Evaluation) -> str:
    head = ["", "L [cd/m²]", "ω [sr]", "E [lx]", "from sight", "P", "pixels"]
    rows = [
        [
            f"{number}{' (peak)' if source.peak else ''}",
            f"{source.luminance:.0f}",
            f"{source.solid_angle:.3e}",
            f"{source.illuminance:.1f}",
            f"{source.sigma_deg:.1f}°",
            f"{source.position_index:.2f}",
            str(source.pixels),
        ]
        for number, source in enumerate(found.sources[:_LISTED], 1)
    ]
    more = len(found.sources) - len(rows)
    return table(head, rows) + (f"\n  and {more} more" if more > 0 else "")
