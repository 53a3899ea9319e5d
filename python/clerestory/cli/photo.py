"""`clerestory photo`: bracketed photographs to a calibrated map of luminance."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from clerestory.cli.common import (
    JsonOption,
    UsageError,
    about,
    note,
    numbers,
    one_of,
    print_json,
    progress,
    refuse_overwriting,
    say,
    table,
    warn,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from clerestory.photo import Developed

_MAPS = (".hdr", ".pic", ".xyze", ".exr")
_DRAWN = (".png", ".pdf", ".svg")
_PROJECTIONS = ("equisolid", "equidistant", "orthographic", "stereographic", "perspective", "none")


def photo(
    pictures: Annotated[
        list[Path],
        typer.Argument(
            metavar="IMAGE…|SESSION.toml",
            help="Photographs of one series (JPEG, PNG, TIFF of 8 or 16 bits), or a file that describes one.",
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
    from clerestory.photo.develop import develop
    from clerestory.photo.session import Session
    from clerestory.trace.recipe import read_toml

    _check_inputs(pictures)
    described = pictures[0].suffix.lower() == ".toml"
    if described and len(pictures) > 1:
        raise UsageError(f"{pictures[1]}: a session names its pictures itself (give one session, or pictures)")
    _check_outputs(output, save_response, plot_response, pictures)
    folder = pictures[0].parent if described else Path()
    with about(pictures[0]) if described else _as_it_is():
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
    with progress("developing") as tell:
        made = develop(session, folder, tell)
    inputs = [p.path for p in made.series.photographs]
    for text in made.warnings:
        warn(inputs[0].parent if described else inputs[0], text)
    for path in (output, save_response, plot_response):
        if path is not None:
            refuse_overwriting(path, inputs)
    _write(made, output, save_response, plot_response)
    if as_json:
        print_json(_plain(made, output))
    else:
        _say(made)


def _check_inputs(pictures: Sequence[Path]) -> None:
    first = pictures[0]
    if str(first) == "compare" and not first.exists():
        raise UsageError("compare: is a command of its own (run clerestory photo-compare)")


def _check_outputs(output: Path | None, response: Path | None, plot: Path | None, inputs: Sequence[Path]) -> None:
    for path, suffixes in ((output, (*_MAPS, *_DRAWN)), (response, (".json",)), (plot, _DRAWN)):
        if path is None:
            continue
        if path.suffix.lower() not in suffixes:
            raise UsageError(f"{path}: the name does not tell the format (end it with {', '.join(suffixes)})")
        if not path.parent.is_dir():
            raise UsageError(f"{path}: the folder {path.parent} does not exist (create it first)")
        refuse_overwriting(path, inputs)


def _as_it_is() -> Any:  # noqa: ANN401 (a context without effect)
    from contextlib import nullcontext

    return nullcontext()


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
        return {"coefficients": [float(part) for part in text.split(",")]}
    except ValueError:
        return {"points": _from(Path(text), folder)}


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


def _plain(made: Developed, output: Path | None) -> dict[str, object]:
    lens, vignetting, burnt = made.lens, made.vignetting, made.overflow
    return {
        "output": output,
        "size": list(made.picture.shape[::-1]),
        "view": None if made.picture.view is None else made.picture.view.options,
        "photographs": [
            {
                "file": p.path,
                "time_s": p.exposure.time,
                "f_number": p.exposure.f_number,
                "iso": p.exposure.iso,
                "camera": p.camera.model,
                "lens": p.camera.lens,
            }
            for p in made.series.photographs
        ],
        "steps": [
            {"shorter": s.shorter, "longer": s.longer, "given": s.given, "found": s.found, "spots": s.spots}
            for s in made.steps
        ],
        "response": {"method": made.response.method, "residual": made.response.residual},
        "lens": None
        if lens is None
        else {
            "projection": lens.projection or "table",
            "centre_px": list(lens.centre),
            "radius_px": lens.radius,
            "field_deg": 2.0 * lens.edge_deg,
            "found": None
            if made.circle is None
            else {"border_share": made.circle.share, "residual_px": made.circle.residual},
        },
        "vignetting": None
        if vignetting is None
        else {
            "coefficients": list(vignetting.coefficients),
            "table": [list(pair) for pair in vignetting.table],
            "residual": vignetting.residual,
            "reach_deg": vignetting.reach_deg,
        },
        "calibration": made.calibration,
        "factor": made.factor,
        "spots": [
            {
                "place": r.spot.words,
                "measured": r.spot.luminance,
                "picture": made.factor * r.mean,
                "pixels": r.pixels,
                "relative_spread": r.spread,
                "factor": r.factor,
            }
            for r in made.spots
        ],
        "illuminance": made.illuminance,
        "measured_illuminance": made.measured,
        "difference_percent": made.difference_percent,
        "acceptable": made.acceptable,
        "least_luminance": made.least,
        "greatest_luminance": made.most,
        "saturated_pixels": made.saturated_pixels,
        "overflow": None if burnt is None or burnt.solid_angle <= 0.0 else burnt,
        "dark_share": made.dark_share,
        "ghost_share": made.ghost_share,
        "assumptions": list(made.assumptions),
        "warnings": list(made.warnings),
    }


def _say(made: Developed) -> None:
    from clerestory.plot.style import figures

    series = made.series.photographs
    rows = [
        [p.path.name, p.exposure.words, *(("", "") if s is None else (f"{s.given:.3g} ×", f"{s.found:.3g} ×"))]
        for p, s in zip(series, (None, *made.steps), strict=True)
    ]
    say(table(["photograph", "exposure", "step", "in light"], rows, left=2))
    line: Callable[[str, str], None] = lambda name, text: say(f"  {name:<12}{text}")  # noqa: E731 (one look)
    misfit = "" if made.response.residual is None else f", misfit {100.0 * made.response.residual:.1f} %"
    line("response", f"{made.response.method}{misfit}")
    if made.lens is not None:
        line("lens", made.lens.words)
    if made.circle is not None:
        line("circle", made.circle.words)
    if made.vignetting is not None:
        v = made.vignetting
        fit = "" if v.residual is None else f", fitted within {100.0 * v.residual:.2g} % (RMS) up to {v.reach_deg:g}°"
        line("vignetting", f"{v.words}{fit}")
    for reading in made.spots:
        line(
            "spot",
            f"{reading.spot.words}: {figures(reading.spot.luminance, 4)} cd/m² by the meter, "
            f"{figures(made.factor * reading.mean, 4)} cd/m² in the picture ({reading.pixels} pixels, "
            f"± {100.0 * reading.spread:.1f} %)",
        )
    line("factor", f"{made.factor:.4g} ({'not calibrated' if made.calibration == 'none' else made.calibration})")
    line("range", f"{figures(made.least)} to {figures(made.most)} cd/m² on the axis")
    if made.illuminance is not None:
        text = f"{made.illuminance:.0f} lx"
        if made.difference_percent is not None and made.measured is not None:
            verdict = "accepted" if made.acceptable else "NOT ACCEPTABLE"
            text += f"; measured {made.measured:.0f} lx, {made.difference_percent:+.1f} %: {verdict}"
        line("E_v", text)
    line(
        "pixels",
        f"{made.saturated_pixels} too bright, {100.0 * made.dark_share:.2g} % too dark, "
        f"{100.0 * made.ghost_share:.2g} % contradicting",
    )
    for text in made.assumptions:
        line("assumed", text)
