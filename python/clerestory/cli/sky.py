"""`clerestory sky`: a sky and its sun as a picture, a scene, a table or a column of a sky matrix."""

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
    refuse_overwriting,
    say,
    warn,
    write_whole,
)

if TYPE_CHECKING:
    from clerestory.sky import Place, Sky, SunPosition

_KINDS = ("perez", "cie", "overcast", "clear", "intermediate", "uniform", "preetham", "weather")
_PICTURES = (".png", ".pdf", ".svg")
_FORMATS = {".hdr": "rgbe", ".exr": "exr"}
_SUFFIXES = (*_FORMATS, ".rad", ".csv", ".mtx", *_PICTURES)
_PRESETS = ("clerestory", "radiance", "radiance-matrix")
_METHODS = ("spa", "radiance", "almanac")
_PLANES = {"south": 180.0, "east": 90.0, "west": 270.0, "north": 0.0}


def sky(
    kind: Annotated[str, typer.Argument(metavar="KIND", help=", ".join(_KINDS), show_default=False)],
    which: Annotated[
        str | None,
        typer.Argument(
            metavar="[TYPE|FILE]", help="Type 1 to 15 of cie; EPW or WEA file of weather.", show_default=False
        ),
    ] = None,
    *,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            metavar="OUT",
            help="Radiances (.hdr, .exr), falsecolour (.png, .pdf, .svg), Radiance scene (.rad), luminances (.csv), "
            "column of a sky matrix (.mtx).",
        ),
    ] = None,
    place: Annotated[
        str | None,
        typer.Option("--place", metavar="LAT,LON", help="Latitude north and longitude EAST [°]."),
    ] = None,
    timezone: Annotated[
        str | None,
        typer.Option("--timezone", metavar="ZONE", help="Europe/Vienna, or hours ahead of UTC; UTC by default."),
    ] = None,
    time: Annotated[
        str | None,
        typer.Option("--time", metavar="TIME", help="'2021-02-21 14:00'; for weather '02-21 14:00'."),
    ] = None,
    sun: Annotated[
        str | None, typer.Option("--sun", metavar="ALT,AZ", help="Altitude and compass azimuth of the sun [°] instead.")
    ] = None,
    method: Annotated[
        str | None,
        typer.Option("--method", help=f"How the sun is found: {', '.join(_METHODS)} (Radiance's two formulas last)."),
    ] = None,
    direct: Annotated[float | None, typer.Option("--direct", help="Direct normal irradiance [W/m²].")] = None,
    diffuse: Annotated[float | None, typer.Option("--diffuse", help="Diffuse horizontal irradiance [W/m²].")] = None,
    direct_illuminance: Annotated[
        float | None, typer.Option("--direct-illuminance", help="Direct normal illuminance [lx].")
    ] = None,
    diffuse_illuminance: Annotated[
        float | None, typer.Option("--diffuse-illuminance", help="Diffuse horizontal illuminance [lx].")
    ] = None,
    global_horizontal: Annotated[
        float | None, typer.Option("--global", help="Global horizontal irradiance [W/m²], divided by Erbs (rough).")
    ] = None,
    zenith: Annotated[float | None, typer.Option("--zenith", help="Luminance of the zenith [cd/m²].")] = None,
    turbidity: Annotated[
        float | None, typer.Option("--turbidity", help="Of clear, intermediate (2.45) and preetham (3).")
    ] = None,
    sunless: Annotated[bool, typer.Option("--sunless", help="Clear or intermediate without the sun.")] = False,
    grey: Annotated[bool, typer.Option("--grey", help="Preetham without colours.")] = False,
    colour: Annotated[
        str | None, typer.Option("--colour", metavar="R,G,B", help="Factors of the sky, or radiance: gendaymtx's.")
    ] = None,
    ground: Annotated[float, typer.Option("--ground", help="Reflectance of the ground.")] = 0.2,
    north: Annotated[float, typer.Option("--north", help="Compass azimuth of the world's y axis [°].")] = 0.0,
    dew_point: Annotated[float | None, typer.Option("--dew-point", help="For the luminous efficacy [°C].")] = None,
    preset: Annotated[str, typer.Option("--preset", help=f"Whose practice: {', '.join(_PRESETS)}.")] = "clerestory",
    solar: Annotated[bool, typer.Option("--solar", help="Solar instead of visible watts.")] = False,
    basis: Annotated[
        str, typer.Option("--basis", metavar="BASIS", help="Patches of .mtx: tregenza, reinhart:N.")
    ] = "tregenza",
    part: Annotated[str, typer.Option("--part", help="What .mtx holds: all, sky or sun.")] = "all",
    five_phase: Annotated[
        float | None,
        typer.Option("--five-phase", metavar="ANGLE", help="Sun of .mtx in the nearest patch, as a disc [°]."),
    ] = None,
    size: Annotated[int, typer.Option("--size", help="Pixels across .hdr and .exr.")] = 1024,
    as_json: JsonOption = False,
) -> None:
    """Make a sky: print what it gives, or write it as a picture, a Radiance scene, a table or a matrix.

    Azimuths are compass azimuths, clockwise from north. A .rad file may come with a .cal file of the same name.

    Example: clerestory sky perez --direct 700 --diffuse 120 --place 47.3,11.4 --timezone Europe/Vienna
    --time "2021-02-21 14:00" -o sky.png
    """
    chosen = one_of(kind, "KIND", _KINDS)
    suffix = _suffix(output)
    _refuse_useless(
        chosen,
        which,
        suffix,
        turbidity,
        zenith,
        sunless=sunless,
        grey=grey,
        basis=basis,
        part=part,
        five_phase=five_phase,
    )
    common: dict[str, Any] = {
        "preset": one_of(preset, "--preset", _PRESETS),
        "quantity": "solar" if solar else "visible",
        "ground_reflectance": ground,
        "north_deg": north,
        "dew_point": dew_point,
    }
    if common["dew_point"] is None:
        del common["dew_point"]
    if colour is not None:
        common["colour"] = colour if colour in ("grey", "radiance") else numbers(colour, "--colour", 3, "0.9,1,1.2")
    asked = {
        "direct": direct,
        "diffuse": diffuse,
        "direct_illuminance": direct_illuminance,
        "diffuse_illuminance": diffuse_illuminance,
        "global_horizontal": global_horizontal,
        "zenith_luminance": zenith,
        "turbidity": turbidity,
    }
    light = {name: value for name, value in asked.items() if value is not None}
    how = one_of(method, "--method", _METHODS) if method is not None else None
    where: Place | None
    if chosen == "weather":
        if light or sun is not None or place is not None or timezone is not None:
            raise UsageError("weather: light and place are in the file (leave irradiances, --sun and --place out)")
        made, where = _from_weather(Path(str(which)), time, how, common)
        if output is not None:
            refuse_overwriting(output, [Path(str(which))])
    else:
        position, where = _sun(chosen, light, sun, place, timezone, time, how)
        made = _make(chosen, which, position, light, common, sunless=sunless, grey=grey)
    written = [] if output is None else _write(made, where, output, suffix, basis, part, five_phase, size)
    if as_json:
        print_json({**summary(made), "written": written})
        return
    if output is None:
        _print(made)
    for name in written:
        note(f"wrote {name}")


def _suffix(output: Path | None) -> str:
    if output is None:
        return ""
    suffix = output.suffix.lower()
    if suffix not in _SUFFIXES:
        what = f"ends in {suffix}, which is not known" if suffix else "has no suffix"
        raise UsageError(f"{output}: the name of the output {what} (give {', '.join(_SUFFIXES)})")
    return suffix


def _refuse_useless(
    kind: str,
    which: str | None,
    suffix: str,
    turbidity: float | None,
    zenith: float | None,
    *,
    sunless: bool,
    grey: bool,
    basis: str,
    part: str,
    five_phase: float | None,
) -> None:
    """Options that would have no effect."""
    if kind in ("cie", "weather") and which is None:
        raise UsageError(
            f"{kind}: its {'type, 1 to 15,' if kind == 'cie' else 'file'} is missing (give it after the kind)"
        )
    if kind not in ("cie", "weather") and which is not None:
        raise UsageError(f"{which}: {kind} takes no type or file (leave it out)")
    useless = {
        "--turbidity": turbidity is not None and kind not in ("clear", "intermediate", "preetham"),
        "--zenith": zenith is not None and kind in ("perez", "preetham", "weather"),
        "--sunless": sunless and kind not in ("clear", "intermediate"),
        "--grey": grey and kind != "preetham",
    }
    for option, wrong in useless.items():
        if wrong:
            raise UsageError(f"{option}: has no effect on {kind} (leave it out)")
    matrix = {"--basis": basis != "tregenza", "--part": part != "all", "--five-phase": five_phase is not None}
    for option, given in matrix.items():
        if given and suffix != ".mtx":
            raise UsageError(f"{option}: has an effect on matrices only (give -o sky.mtx, or leave it out)")


def _zone(text: str | None) -> str | float:
    if text is None:
        return 0.0
    try:
        return float(text)
    except ValueError:
        return text


def _sun(
    kind: str,
    light: dict[str, float],
    sun: str | None,
    place: str | None,
    timezone: str | None,
    time: str | None,
    method: str | None,
) -> tuple[SunPosition, Place | None]:
    from clerestory.sky import Place, SunPosition

    if sun is not None:
        if place is not None or time is not None or method is not None:
            raise UsageError("--sun: is given beside a place or a time (give one of them)")
        altitude, azimuth = numbers(sun, "--sun", 2, "30,180")
        if not -90.0 <= altitude <= 90.0:
            raise UsageError(f"--sun {sun}: the altitude goes from -90 to 90° (give ALTITUDE,AZIMUTH)")
        return SunPosition(altitude, azimuth % 360.0), None
    if place is None or time is None:
        if place is None and time is None and kind in ("overcast", "uniform") and light:
            return SunPosition(90.0, 180.0, source="not needed"), None
        missing = "--place" if place is None else "--time"
        raise UsageError(f"{missing}: the position of the sun is unknown (give --place and --time, or --sun ALT,AZ)")
    latitude, longitude = numbers(place, "--place", 2, "47.3,11.4")
    where = Place(latitude, longitude, _zone(timezone))
    return SunPosition.at(where, time, method=method or "spa"), where  # type: ignore[arg-type]


def _make(
    kind: str,
    which: str | None,
    sun: SunPosition,
    light: dict[str, float],
    common: dict[str, Any],
    *,
    sunless: bool,
    grey: bool,
) -> Sky:
    from clerestory.sky import Sky

    if kind == "perez":
        return Sky.perez(sun, **light, **common)
    if kind == "cie":
        try:
            number = int(str(which))
        except ValueError:
            raise UsageError(f"cie {which}: not a type (give 1, overcast, to 15)") from None
        return Sky.cie(number, sun, **light, **common)
    if kind == "preetham":
        return Sky.preetham(sun, coloured=not grey, **light, **common)
    make = {"overcast": Sky.overcast, "uniform": Sky.uniform, "clear": Sky.clear, "intermediate": Sky.intermediate}[
        kind
    ]
    return make(sun, **light, **common, **({"sunny": False} if sunless else {}))


def _from_weather(path: Path, time: str | None, method: str | None, common: dict[str, Any]) -> tuple[Sky, Place]:
    from clerestory.weather import read_weather

    with about(path):
        weather = read_weather(path)
    for finding in weather.findings:
        if finding.severity != "note":
            warn(path, str(finding).partition(": ")[2])
    if time is None:
        raise UsageError("--time: which step of the file is unknown (give --time '02-21 14:00')")
    with about(path):
        return weather.sky(time, method=method, **common), weather.place  # type: ignore[arg-type]


def _write(
    sky: Sky,
    place: Place | None,
    output: Path,
    suffix: str,
    basis: str,
    part: str,
    five_phase: float | None,
    size: int,
) -> list[str]:
    if suffix in _PICTURES:
        from clerestory.plot.style import render
        from clerestory.sky.figure import falsecolour

        write_whole(output, render(falsecolour(sky), suffix))
    elif suffix in _FORMATS:
        from clerestory.sky.picture import to_bytes

        write_whole(output, to_bytes(sky, size, _FORMATS[suffix]))
    elif suffix == ".csv":
        write_whole(output, sky.table().to_csv())
    elif suffix == ".mtx":
        from clerestory.sky.matrix import text

        sun: dict[str, Any] = {} if five_phase is None else {"sun": "nearest", "disc_deg": five_phase}
        values = sky.patches(basis, part=one_of(part, "--part", ("all", "sky", "sun")), **sun)  # type: ignore[arg-type]
        write_whole(output, text(values[:, None], sky.settings, place))
    else:
        functions = output.with_suffix(".cal")
        content = sky.radiance_functions()
        if content is not None:
            write_whole(functions, content)
        write_whole(output, sky.radiance_description(functions.name))
        return [str(functions), str(output)] if content is not None else [str(output)]
    return [str(output)]


def summary(sky: Sky) -> dict[str, Any]:
    """Everything of a sky that is one number, and its settings."""
    visible = sky.settings.quantity == "visible"
    sun = sky.sun
    made: dict[str, Any] = {
        "settings": sky.settings,
        "sun_altitude_deg": sky.settings.sun.altitude_deg,
        "sun_azimuth_deg": sky.settings.sun.azimuth_deg,
        "sun_direction": sky.sun_direction,
        "sun_radiance": None if sun is None else sun.radiance,
        "sun_half_angle_deg": None if sun is None else sun.half_angle_deg,
        "clearness": sky.clearness,
        "brightness": sky.brightness,
        "diffuse_horizontal": sky.diffuse_horizontal,
        "direct_normal": sky.direct_normal,
        "global_horizontal": sky.global_horizontal,
        "ground_radiance": sky.ground,
    }
    if visible:
        made |= {
            "zenith_luminance": sky.zenith_luminance,
            "diffuse_horizontal_illuminance": sky.diffuse_horizontal_illuminance,
            "horizontal_illuminance": sky.horizontal_illuminance,
            "vertical_illuminance": {name: sky.illuminance(90.0, azimuth) for name, azimuth in _PLANES.items()},
        }
    else:
        made["vertical_irradiance"] = {
            name: float(sky.irradiance(90.0, azimuth).mean()) for name, azimuth in _PLANES.items()
        }
    return made


def _print(sky: Sky) -> None:
    from clerestory.plot.style import figures

    settings = sky.settings
    say(f"{settings.kind} sky, preset {settings.preset}, {settings.quantity} watts")
    say(f"  sun        {settings.sun.words}; {settings.sun.source}")
    if settings.light:
        given = ", ".join(f"{name.replace('_', ' ')} {value:g}" for name, value in settings.light.items())
        say(f"  given      {given}")
    if sky.clearness is not None and sky.brightness is not None:
        say(f"  Perez      clearness ε {sky.clearness:.3f}, brightness Δ {sky.brightness:.4f}")
    found = summary(sky)
    if settings.quantity == "visible":
        unit, factor = "lx", 179.0
        say(f"  zenith     {figures(sky.zenith_luminance, 4)} cd/m²")
        say(f"  ground     {figures(float(sky.luminance([0.0, 0.0, -1.0])), 4)} cd/m²")
        planes = found["vertical_illuminance"]
    else:
        unit, factor = "W/m²", 1.0
        planes = found["vertical_irradiance"]
    sun = sky.sun
    disc = "not seen" if sun is None else f"{figures(factor * sky.direct_normal, 4)} {unit} on a plane that faces it"
    say(f"  sun's disc {disc}")
    say(
        f"  horizontal {figures(factor * sky.global_horizontal, 4)} {unit}, of it the sky "
        f"{figures(factor * sky.diffuse_horizontal, 4)} {unit}"
    )
    say("  vertical   " + ", ".join(f"{name} {figures(value, 4)}" for name, value in planes.items()) + f" {unit}")
