"""`clerestory photo`: bracketed photographs to a calibrated map of luminance."""

from __future__ import annotations

from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from clerestory.cli.common import (
    CommandError,
    JsonOption,
    UsageError,
    about,
    note,
    numbers,
    one_of,
    print_json,
    progress,
    refuse_overwriting,
    warn,
)

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from clerestory.photo import Developed

_MAPS = (".hdr", ".pic", ".xyze", ".exr")
_DRAWN = (".png", ".pdf", ".svg")
_PROJECTIONS = ("equisolid", "equidistant", "orthographic", "stereographic", "perspective", "none")

_OPTIONS = {
    "exposures": "--exposures",
    "f_number": "--f-number",
    "iso": "--iso",
    "camera.response": "--response",
    "lens.radius_px": "--radius",
    "lens.centre_px": "--centre",
    "lens.field_deg": "--field",
    "lens.table": "--projection",
    "vignetting": "--vignetting",
    "vignetting.points": "--vignetting",
    "calibration.factor": "--factor",
    "calibration.spots": "--spot, --factor, --calibrate-by-illuminance",
    "check.illuminance": "--illuminance",
    "check.limit_percent": "--limit",
    "check.fill_overflow": "--fill-overflow",
    "output.size_px": "--size",
}
"""What keys of a session are called on the command line."""


def photo(
    pictures: Annotated[
        list[Path],
        typer.Argument(
            metavar="IMAGE…|SESSION.toml",
            help="Photographs of one series (JPEG, PNG, TIFF of 8 or 16 bits), their folder, or a session file.",
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
            help="Map of luminance: .hdr, .pic, .xyze or .exr; .png, .pdf or .svg in false colours.",
        ),
    ] = None,
    exposures: Annotated[
        Path | None,
        typer.Option(metavar="FILE.csv", help="Where EXIF does not say them: columns file,time_s,f_number,iso."),
    ] = None,
    f_number: Annotated[float | None, typer.Option(metavar="N", help="Of all pictures, if EXIF lacks it.")] = None,
    iso: Annotated[float | None, typer.Option(metavar="S", help="Of all pictures, if EXIF lacks it.")] = None,
    times: Annotated[
        str | None,
        typer.Option(metavar="HOW", help="Exposure times as written, or as thirds of a stop that EXIF rounds."),
    ] = None,
    encoding: Annotated[
        str | None,
        typer.Option(metavar="WHAT", help="Levels: linear, camera, or auto: linear if of 16 bits. [auto]"),
    ] = None,
    response: Annotated[
        Path | None, typer.Option(metavar="FILE", help="The camera's response, .json or hdrgen's .rsp.")
    ] = None,
    method: Annotated[
        str | None, typer.Option(metavar="NAME", help="How it is recovered: debevec or mitsunaga. [debevec]")
    ] = None,
    save_response: Annotated[
        Path | None, typer.Option(metavar="OUT.json", help="Keep the recovered response for other series.")
    ] = None,
    plot_response: Annotated[Path | None, typer.Option(metavar="OUT.png", help="Draw it: .png, .pdf or .svg.")] = None,
    primaries: Annotated[str | None, typer.Option(metavar="NAME", help="srgb or adobe-rgb. [srgb]")] = None,
    projection: Annotated[
        str | None,
        typer.Option(metavar="NAME", help=f"Of the lens: {', '.join(_PROJECTIONS)}; or a table, FILE.csv. [equisolid]"),
    ] = None,
    centre: Annotated[
        str | None, typer.Option(metavar="X,Y", help="Of the lens's circle [pixels]; found by default.")
    ] = None,
    radius: Annotated[
        float | None, typer.Option(metavar="R", help="Of the lens's circle [pixels]; found by default.")
    ] = None,
    field: Annotated[
        float | None, typer.Option(metavar="DEG", help="Field of view over the circle's diameter [°]. [180]")
    ] = None,
    vignetting: Annotated[
        str | None,
        typer.Option(metavar="A,B,C|FILE.csv", help="V = 1 + Aθ² + Bθ⁴ + Cθ⁶ [rad], or measured theta_deg,value."),
    ] = None,
    spot: Annotated[
        list[str] | None,
        typer.Option(
            metavar="PLACE=L", help="Luminance [cd/m²] of a pixel X,Y, circle X,Y,R or rectangle X1,Y1,X2,Y2; again."
        ),
    ] = None,
    spot_direction: Annotated[
        list[str] | None,
        typer.Option(metavar="AZ,EL[,R]=L", help="The same at angles to the right and up, within a radius [°]."),
    ] = None,
    factor: Annotated[
        float | None, typer.Option(metavar="F", help="Calibration by a factor that other series have given.")
    ] = None,
    illuminance: Annotated[
        float | None, typer.Option(metavar="LX", help="Measured on the plane of the lens, to check the result.")
    ] = None,
    calibrate_by_illuminance: Annotated[
        bool, typer.Option("--calibrate-by-illuminance", help="Make the picture's illuminance the measured one.")
    ] = False,
    limit: Annotated[
        float | None, typer.Option(metavar="PCT", help="Warn if the illuminance is further off. [25]")
    ] = None,
    fill_overflow: Annotated[
        bool,
        typer.Option("--fill-overflow", help="Put the illuminance that lacks where the picture is too bright."),
    ] = False,
    view: Annotated[
        str | None,
        typer.Option(metavar="OPTIONS", help="'-vta' or '-vth', and where the camera stood: -vp, -vd, -vu. [-vta]"),
    ] = None,
    size: Annotated[int | None, typer.Option(metavar="N", help="Width and height [pixels]. [1000]")] = None,
    as_json: JsonOption = False,
) -> None:
    """Merge photographs of different exposure to a map of luminance that glare can be evaluated on.

    Exposures come from EXIF. The response of the camera is recovered from the series itself, the lens's circle is
    found, and the picture is laid out as a fisheye of 180°. A spot that a luminance meter has measured calibrates it,
    and the illuminance at the lens checks it. A session file holds the same; options win over it.

    Example: clerestory photo IMG_*.JPG --spot 2790,1860,2830,1900=512 --illuminance 2150 -o office.hdr
    """
    from clerestory.cli.photo_result import for_machines, for_people
    from clerestory.photo.develop import develop
    from clerestory.photo.session import Session
    from clerestory.trace.recipe import read_toml

    _check_inputs(pictures)
    described = pictures[0].suffix.lower() == ".toml"
    if described and len(pictures) > 1:
        raise UsageError(f"{pictures[1]}: a session names its pictures itself (give one session, or pictures)")
    _check_outputs(output, save_response, plot_response, pictures)
    folder = pictures[0].parent if described else Path()
    given = pictures[0] if described else None
    with _told(given, UsageError):
        tables: dict[str, Any] = read_toml(pictures[0]) if described else {"pictures": [str(p) for p in pictures]}
        _override(
            tables,
            {
                "exposures": exposures,
                "f_number": f_number,
                "iso": iso,
                "times": None if times is None else one_of(times, "--times", ("written", "thirds")),
                "camera.encoding": None
                if encoding is None
                else one_of(encoding, "--encoding", ("auto", "linear", "camera")),
                "camera.response": response,
                "camera.method": None if method is None else one_of(method, "--method", ("debevec", "mitsunaga")),
                "camera.primaries": None
                if primaries is None
                else one_of(primaries, "--primaries", ("srgb", "adobe-rgb")),
                **_projection(projection),
                "lens.centre_px": None if centre is None else list(numbers(centre, "--centre", 2, "2808,1872")),
                "lens.radius_px": radius,
                "lens.field_deg": field,
                "calibration.factor": factor,
                "calibration.by_illuminance": calibrate_by_illuminance or None,
                "check.illuminance": illuminance,
                "check.limit_percent": limit,
                "check.fill_overflow": fill_overflow or None,
                "output.view": view,
                "output.size_px": size,
            },
            folder,
        )
        if vignetting is not None:
            tables["vignetting"] = _vignetting(vignetting, folder)
        if spot or spot_direction:
            _table(tables, "calibration")["spots"] = [
                *(_spot(text, "--spot", "pixels", (2, 3, 4)) for text in spot or ()),
                *(_spot(text, "--spot-direction", "direction_deg", (2, 3)) for text in spot_direction or ()),
            ]
        session = Session.of(tables)
    with _told(given, CommandError), progress("developing") as tell:
        made = develop(session, folder, tell)
    inputs = [p.path for p in made.series.photographs]
    for text in made.warnings:
        warn(pictures[0] if described else inputs[0], text)
    for path in (output, save_response, plot_response):
        if path is not None:
            refuse_overwriting(path, inputs)
    _write(made, output, save_response, plot_response)
    if as_json:
        print_json(for_machines(made, output))
    else:
        for_people(made)


@contextmanager
def _told(session: Path | None, kind: type[CommandError]) -> Iterator[None]:
    """Faults by the keys of a session's file, after its name; by options where there is no file."""
    from clerestory.trace.keys import RecipeError

    if session is not None:
        with about(session):
            yield
        return
    try:
        yield
    except RecipeError as error:
        key, _, text = str(error).partition(": ")
        if key == "pictures":
            raise kind(text) from None
        if key not in _OPTIONS:
            raise
        raise kind(f"{_OPTIONS[key]}: {text}") from None


def _check_inputs(pictures: Sequence[Path]) -> None:
    first = pictures[0]
    if str(first) == "compare" and not first.exists():
        raise UsageError("compare: is a command of its own (run clerestory photo-compare)")
    for path in pictures:
        if not any(mark in path.name for mark in "*?["):
            path.stat()  # A wrong name is told as it was typed.


def _check_outputs(output: Path | None, response: Path | None, plot: Path | None, inputs: Sequence[Path]) -> None:
    for path, suffixes in ((output, (*_MAPS, *_DRAWN)), (response, (".json",)), (plot, _DRAWN)):
        if path is None:
            continue
        if path.suffix.lower() not in suffixes:
            raise UsageError(f"{path}: the name does not tell the format (end it with {', '.join(suffixes)})")
        if not path.parent.is_dir():
            raise UsageError(f"{path}: the folder {path.parent} does not exist (create it first)")
        refuse_overwriting(path, inputs)


def _override(tables: dict[str, Any], options: dict[str, Any], folder: Path) -> None:
    """Put options over the keys of a session; files of options are named from where the command runs."""
    for key, value in options.items():
        if value is None:
            continue
        *path, last = key.split(".")
        target = _table(tables, path[0]) if path else tables
        target[last] = _from(value, folder) if isinstance(value, Path) else value


def _table(tables: dict[str, Any], name: str) -> dict[str, Any]:
    found: dict[str, Any] = tables.setdefault(name, {})
    if not isinstance(found, dict):
        raise UsageError(f"{name}: is a table (write [{name}])")
    return found


def _from(path: Path, folder: Path) -> str:
    return str(path if folder == Path() else path.resolve())


def _projection(text: str | None) -> dict[str, Any]:
    if text is None:
        return {}
    if text.lower().endswith(".csv"):
        return {"lens.projection": "table", "lens.table": Path(text)}
    return {"lens.projection": one_of(text, "--projection", _PROJECTIONS)}


def _vignetting(text: str, folder: Path) -> dict[str, Any]:
    try:
        values = [float(part) for part in text.split(",")]
    except ValueError:
        return {"points": _from(Path(text), folder)}
    if len(values) > 3:
        raise UsageError(f"--vignetting {text}: more than three coefficients (give those of θ², θ⁴ and θ⁶)")
    return {"coefficients": values}


def _spot(text: str, option: str, key: str, counts: tuple[int, ...]) -> dict[str, Any]:
    place, mark, luminance = text.rpartition("=")
    try:
        values, value = [float(part) for part in place.split(",")], float(luminance)
    except ValueError:
        values, value = [], 0.0
    if not mark or len(values) not in counts:
        example = "2790,1860,2830,1900=512" if key == "pixels" else "-20,-15,1=512"
        raise UsageError(f"{option} {text}: not a place and a luminance (such as {example})")
    return {key: values, "luminance": value}


def _write(made: Developed, output: Path | None, response: Path | None, plot: Path | None) -> None:
    if output is not None:
        if output.suffix.lower() in _DRAWN:
            from clerestory.picture import falsecolour
            from clerestory.plot import save

            save(falsecolour(made.picture), output)
        else:
            made.picture.write(output)
        note(f"wrote {output}")
    if response is not None:
        made.response.write(response)
        note(f"wrote {response}")
    if plot is not None:
        from clerestory.photo.figure import response_curves
        from clerestory.plot import save

        save(response_curves({"": made.response}), plot)
        note(f"wrote {plot}")
