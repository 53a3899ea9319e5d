"""`clerestory render`: pictures and illuminances of a room with daylight."""

from __future__ import annotations

from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from clerestory.cli.common import (
    CommandError,
    JsonOption,
    UsageError,
    kept,
    list_shipped,
    note,
    numbers,
    partial_of,
    print_json,
    progress,
    refuse_overwriting,
    say,
    table,
    write_whole,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from clerestory.glare import Evaluation
    from clerestory.room import Illuminance, Rendering, Room, State, View

PICTURES = (".hdr", ".pic", ".xyze", ".exr", ".png", ".pdf", ".svg")
"""Suffixes of pictures: of radiance, and in false colours."""


def render(
    scene: Annotated[
        str | None,
        typer.Argument(metavar="SCENE", help="Room recipe (.toml), or the name of one of --list.", show_default=False),
    ] = None,
    *,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="OUT",
            help="Picture: .hdr, .pic, .xyze or .exr; .png, .pdf or .svg in false colours. With --sensors: .csv.",
        ),
    ] = None,
    view: Annotated[str | None, typer.Option(metavar="NAME", help="View of the recipe; its first by default.")] = None,
    sensors: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="Illuminance at these sensors of the recipe, in place of a picture."),
    ] = None,
    size: Annotated[str | None, typer.Option(metavar="W,H", help="Pixels; the view's by default.")] = None,
    noise: Annotated[
        float, typer.Option(metavar="PCT", help="Mean noise of a pixel to reach, relative to the mean luminance.")
    ] = 10.0,
    error: Annotated[float, typer.Option(metavar="PCT", help="Standard error of illuminances to reach.")] = 1.0,
    samples: Annotated[int | None, typer.Option(metavar="N", help="Paths a pixel or sensor, instead.")] = None,
    seconds: Annotated[
        float | None, typer.Option(metavar="S", help="Begin no further pass over the picture after this time.")
    ] = None,
    glare: Annotated[
        bool, typer.Option("--glare", help="Rate the glare of the picture, as `clerestory glare` does.")
    ] = False,
    denoise: Annotated[
        bool,
        typer.Option("--denoise", help="Average neighbours that differ by noise; glare is rated before that."),
    ] = False,
    glare_denoised: Annotated[
        bool, typer.Option("--glare-denoised", help="With --denoise and --glare: rate the denoised picture.")
    ] = False,
    no_picture: Annotated[
        bool,
        typer.Option("--no-picture", help="With --glare: find sources in the windows themselves, without a picture."),
    ] = False,
    tone_mapped: Annotated[
        bool, typer.Option("--tone-mapped", help="A .png, .pdf or .svg as people see it, not in false colours.")
    ] = False,
    seed: Annotated[int, typer.Option(metavar="N", min=0, help="Another seed gives an independent result.")] = 1,
    resume: Annotated[bool, typer.Option("--resume", help="Go on with the picture that Ctrl-C left behind.")] = False,
    list_all: Annotated[bool, typer.Option("--list", help="List the rooms that come with Clerestory.")] = False,
    as_json: JsonOption = False,
) -> None:
    """Look into a room with daylight: one picture, or illuminance at sensors.

    A recipe describes the room, its windows with their systems, the sky, views and sensors. Light is followed path
    by path; windows and the sun are asked for light at every surface, and the sun that a window lets pass straight is
    an exact disc.

    Example: clerestory render office -o office.hdr --glare
    """
    from clerestory import room
    from clerestory.annual.cache import Cache
    from clerestory.annual.traced import kept

    if list_all:
        from clerestory.room.shipped import ROOMS

        list_shipped(ROOMS, as_json=as_json)
        return
    if scene is None:
        raise UsageError("SCENE is missing (give a recipe, or see --list)")
    if output is not None:
        if sensors is None and output.suffix.lower() not in PICTURES:
            raise UsageError(f"{output}: the name does not tell the format (end it with {', '.join(PICTURES)})")
        if sensors is not None and output.suffix.lower() != ".csv":
            raise UsageError(f"{output}: illuminances are written as a table (end the name with .csv)")
        refuse_overwriting(output, [Path(scene)])
    elif sensors is None and not glare:
        raise UsageError("no output is named (give -o OUT.hdr, --glare, or --sensors NAME)")
    made = room.load(scene, traced=kept(Cache(), note))
    for text in made.warnings:
        note(f"warning: {scene}: {text}")
    if glare_denoised and not (denoise and glare):
        raise UsageError("--glare-denoised: goes with --denoise and --glare (give them, too)")
    if denoise and (no_picture or sensors is not None):
        raise UsageError("--denoise: only a picture is denoised (leave out --sensors and --no-picture)")
    if no_picture and (output is not None or not glare):
        raise UsageError("--no-picture: it is for --glare alone (leave out -o, or this option)")
    if resume and (output is None or sensors is not None):
        raise UsageError("--resume: only a picture with an output is kept (give -o OUT.hdr as before)")
    if sensors is not None:
        if view is not None or glare:
            raise UsageError("--sensors goes without --view and --glare (run the command twice)")
        for text in made.doubts(sensors=sensors):
            note(f"warning: {scene}: {text}")
        with progress("tracing") as tell:
            found = made.illuminance(sensors, error=error / 100.0, samples=samples, seed=seed, progress=tell)
        _tell_illuminance(found, output, as_json=as_json)
        return
    chosen = _view(made, view, size)
    for text in _view_doubts(made, view, chosen, glare=glare):
        note(f"warning: {scene}: {text}")
    if no_picture:
        with progress("tracing") as tell:
            rating = made.glare(chosen, error=error / 100.0, samples=samples, seed=seed, progress=tell)
        _tell_glare(rating, as_json=as_json)
        return
    with _keeping(made, chosen, output, seed=seed, resume=resume) as state, progress("tracing") as tell:
        picture = made.picture(
            chosen, noise=noise / 100.0, samples=samples, seconds=seconds, seed=seed, state=state, progress=tell
        )
    shown = made.denoise(picture) if denoise else picture
    if output is not None:
        _write(shown, output, tone_mapped=tone_mapped)
    _tell_picture(picture, output, rated=(shown if glare_denoised else picture) if glare else None, as_json=as_json)


@contextmanager
def _keeping(made: Room, view: View, output: Path | None, *, seed: int, resume: bool) -> Iterator[State]:
    """The picture's paths so far, which are kept beside the output if Ctrl-C is pressed."""
    from clerestory.room import State

    if output is None:
        yield State.new(made, view, seed=seed)
        return
    partial = partial_of(output, must_exist=resume)
    state = State.load(partial, made, view, seed=seed) if resume else State.new(made, view, seed=seed)

    def keep(path: Path) -> str:
        if state.samples == 0:
            return ""
        state.save(path)
        return f"{state.samples} paths a pixel are"

    with kept(keep, output, resume=resume):
        yield state


def _view(made: Room, name: str | None, size: str | None) -> View:
    if name is None:
        if not made.recipe.views:
            raise UsageError("the recipe has no view (add [views.NAME], or ask for --sensors)")
        name = next(iter(made.recipe.views))
    chosen = made.view(name)
    if size is None:
        return chosen
    width, height = (int(v) for v in numbers(size, "--size", 2, "800,800"))
    if not (1 <= width <= 16384 and 1 <= height <= 16384):
        raise UsageError(f"--size {size}: not a size in pixels (give 1 to 16384 for both)")
    return chosen.model_copy(update={"size_px": [width, height]})


def _view_doubts(made: Room, name: str | None, chosen: View, *, glare: bool) -> list[str]:
    """What is doubtful about a view; a view that cannot be is an error before any path is followed."""
    from clerestory import ClerestoryError
    from clerestory.glare import Settings
    from clerestory.glare.evaluate import view_doubts
    from clerestory.picture import View as Shown
    from clerestory.room.picture import options

    name = next(iter(made.recipe.views)) if name is None else name
    try:
        shown = Shown(options(chosen))
        if glare:
            view_doubts(shown, Settings())
    except ClerestoryError as error:
        raise CommandError(f"view {name}: {str(error).removeprefix('view: ')}") from None
    return made.doubts(view=name)


def _write(picture: Rendering, output: Path, *, tone_mapped: bool) -> None:
    from clerestory.picture import falsecolour
    from clerestory.picture import tone_mapped as as_seen
    from clerestory.plot import save

    made = picture.picture()
    if output.suffix.lower() in (".png", ".pdf", ".svg"):
        save(as_seen(made) if tone_mapped else falsecolour(made), output)
    else:
        made.write(output)


def _tell_picture(picture: Rendering, output: Path | None, *, rated: Rendering | None, as_json: bool) -> None:
    luminance = picture.luminance
    result: dict[str, object] = {
        "output": output,
        "view": picture.view,
        "size": list(luminance.shape[::-1]),
        "paths_a_pixel": picture.samples,
        "relative_noise": picture.relative_noise,
        "mean_luminance": float(luminance.mean()),
        "greatest_luminance": float(luminance.max()),
        "seconds": picture.seconds,
    }
    lines = [
        f"{picture.samples} paths a pixel in {picture.seconds:.1f} s, mean noise of a pixel "
        f"{100.0 * picture.relative_noise:.2g} %",
        f"luminance {luminance.mean():.0f} cd/m² on average, {luminance.max():.3g} cd/m² at most",
    ]
    if rated is not None:
        from clerestory.glare import evaluate

        found = evaluate(rated.picture())
        result |= _rated(found)
        lines += [_glare_line(found), *(f"warning: {text}" for text in found.warnings)]
    if as_json:
        print_json(result)
        return
    for line in lines:
        say(line)


def _rated(found: Evaluation) -> dict[str, object]:
    return {
        "dgp": found.dgp,
        "dgi": found.dgi,
        "ugr": found.ugr,
        "vertical_illuminance": found.vertical_illuminance,
        "glare_sources": len(found.sources),
        "warnings": list(found.warnings),
    }


def _glare_line(found: Evaluation) -> str:
    return (
        f"E_v {found.vertical_illuminance:.0f} lx, DGP {found.dgp:.3f} ({found.dgp_class}), DGI {found.dgi:.1f} "
        f"({found.dgi_class}), UGR {found.ugr:.1f}, {len(found.sources)} sources"
    )


def _tell_glare(found: Evaluation, *, as_json: bool) -> None:
    if as_json:
        print_json(_rated(found))
    else:
        say(_glare_line(found))


def _tell_illuminance(found: Illuminance, output: Path | None, *, as_json: bool) -> None:
    if output is not None:
        head = "x_m,y_m,z_m,nx,ny,nz,illuminance_lx,standard_error_lx"
        rows = [
            ",".join(f"{v:.6g}" for v in (*p, *n, e, s))
            for p, n, e, s in zip(found.points, found.normals, found.values, found.standard_errors, strict=True)
        ]
        write_whole(output, "\n".join([head, *rows, ""]))
    if as_json:
        print_json(
            {
                "output": output,
                "points": found.points,
                "illuminance": found.values,
                "standard_errors": found.standard_errors,
                "paths_a_sensor": found.samples,
            }
        )
        return
    if output is None:
        lines = [
            [*(f"{v:.2f}" for v in p), f"{e:.0f} ± {s:.0f}"]
            for p, e, s in zip(found.points, found.values, found.standard_errors, strict=True)
        ]
        say(table(["x [m]", "y [m]", "z [m]", "illuminance [lx]"], lines, left=0))
    values = found.values
    say(
        f"{len(values)} points: mean {values.mean():.0f} lx, least {values.min():.0f}, greatest {values.max():.0f}; "
        f"{found.samples} paths each"
    )
