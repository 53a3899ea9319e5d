"""`clerestory system export`: a window as a luminaire for lighting design, and the daylight that it supplies."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from clerestory.cli.common import (
    JsonOption,
    UsageError,
    about,
    note,
    numbers,
    one_of,
    print_json,
    read,
    refuse_overwriting,
    say,
    write_whole,
)
from clerestory.cli.system.product import is_data_set, solved, specified

if TYPE_CHECKING:
    from clerestory.bsdf import Bsdf
    from clerestory.sky import Place, Sky

_SUFFIXES = (".ldt", ".ies", ".csv")
_SKIES = ("clear", "overcast", "uniform")


def export(
    product: Annotated[
        str,
        typer.Argument(
            metavar="SPEC|FILE",
            help="Specification of a window (.toml, or a name of system build --list), or a BSDF file.",
            show_default=False,
        ),
    ],
    *,
    output: Annotated[
        Path,
        typer.Option(
            "-o",
            "--output",
            metavar="OUT",
            help="Candle power: .ldt (EULUMDAT) or .ies (LM-63); daylight supply of two clear days: .csv.",
        ),
    ],
    sky: Annotated[str, typer.Option("--sky", metavar="KIND", help="clear, overcast or uniform.")] = "overcast",
    sun: Annotated[
        str | None,
        typer.Option("--sun", metavar="ALT,AZ", help="Altitude and compass azimuth of the sun [°], for a clear sky."),
    ] = None,
    azimuth: Annotated[
        float, typer.Option("--azimuth", metavar="DEG", help="Compass azimuth that the window looks to; 180 is south.")
    ] = 180.0,
    tilt: Annotated[float, typer.Option("--tilt", metavar="DEG", help="90 is upright, 0 a roof window.")] = 90.0,
    width: Annotated[float, typer.Option("--width", metavar="M", help="Width of the window.")] = 1.0,
    height: Annotated[float, typer.Option("--height", metavar="M", help="Height of the window.")] = 1.0,
    steps: Annotated[
        str, typer.Option("--steps", metavar="C,G", help="Steps of the azimuth and of the angle from the normal [°].")
    ] = "15,5",
    place: Annotated[
        str | None,
        typer.Option("--place", metavar="LAT,LON,ZONE", help="For daylight supply: degrees north and EAST, time zone."),
    ] = None,
    band: Annotated[str | None, typer.Option("--band", metavar="NAME", help="Visible by default.")] = None,
    as_json: JsonOption = False,
) -> None:
    """Write a window as a luminaire under a sky, or the daylight that it supplies on clear days.

    In the luminaire's file the inward normal of the window is the nadir, and C 90 is up. The sun's beams, which no such
    file can hold, are spread over a step and listed.

    Example: clerestory system export blind.xml -o blind.ldt --sky clear --sun 40,180
    """
    suffix = output.suffix.lower()
    if suffix not in _SUFFIXES:
        raise UsageError(f"{output}: the name does not tell the format (end it with {', '.join(_SUFFIXES)})")
    if (suffix == ".csv") != (place is not None):
        raise UsageError("--place goes with daylight supply, OUT.csv, which needs it (give both or neither)")
    kind = one_of(sky, "--sky", _SKIES)
    if (kind == "clear") != (sun is not None) and suffix != ".csv":
        raise UsageError("--sun goes with a clear sky, which needs it (give both or neither)")
    bsdf, name, sources = _product(product, quiet=as_json)
    refuse_overwriting(output, sources)
    with about(Path(product)):
        if suffix == ".csv":
            _supply(bsdf, _place(place or ""), output, band, as_json=as_json)
        else:
            grid = numbers(steps, "--steps", 2, "15,5")
            _luminaire(bsdf, name, _sky(kind, sun), output, (azimuth, tilt), (width, height), grid, band, as_json)


def _product(product: str, *, quiet: bool) -> tuple[Bsdf, str, list[Path]]:
    if is_data_set(product):
        bsdf = read(Path(product))
        return bsdf, bsdf.metadata.name or Path(product).name, [Path(product)]
    made = specified(product, quiet=quiet)
    return solved(product, made).bsdf, made.name, made.sources


def _place(text: str) -> Place:
    from clerestory.sky import Place

    latitude, longitude, zone = numbers(text, "--place", 3, "47.3,11.4,1")
    return Place(latitude, longitude, zone)


def _sky(kind: str, sun: str | None) -> Sky:
    from clerestory.sky import Sky

    if sun is None:
        return Sky.overcast() if kind == "overcast" else Sky.uniform()
    altitude, azimuth = numbers(sun, "--sun", 2, "40,180")
    return Sky.clear((altitude, azimuth))


def _luminaire(
    bsdf: Bsdf,
    name: str,
    sky: Sky,
    output: Path,
    looks: tuple[float, float],
    size: tuple[float, float],
    steps: tuple[float, ...],
    band: str | None,
    as_json: bool,  # noqa: FBT001
) -> None:
    from clerestory.luminaire import Facade, candle_power, eulumdat, lm63

    found = candle_power(
        bsdf,
        sky,
        Facade(*looks),
        area_m2=size[0] * size[1],
        c_step_deg=steps[0],
        gamma_step_deg=steps[1],
        band=band,
    )
    made = eulumdat if output.suffix.lower() == ".ldt" else lm63
    maker = bsdf.metadata.manufacturer or ""
    write_whole(output, made.write(found, name, width_m=size[0], height_m=size[1], maker=maker))
    if as_json:
        print_json(
            {
                "flux_lm": found.flux,
                "illuminance_lx": found.illuminance,
                "greatest_intensity_cd": found.intensity.max(),
                "scaled_by": found.scaled_by,
                "beams": [vars(beam) for beam in found.beams],
                "written": [output],
            }
        )
        return
    say(f"{name}: {found.flux:.4g} lm pass {found.area_m2:g} m² of {found.illuminance:.4g} lx outside")
    for beam in found.beams:
        say(f"  the sun's beam: {beam.flux:.4g} lm to C {beam.c_deg:.0f}°, {beam.gamma_deg:.1f}° from the normal")
    note(f"wrote {output}")


def _supply(bsdf: Bsdf, place: Place, output: Path, band: str | None, *, as_json: bool) -> None:
    from clerestory.luminaire import daylight_supply

    found = daylight_supply(bsdf, place, band=band)
    lines = ["day,orientation,supply_lm_h_per_m2,outside_lx_h"]
    lines += [f"{s.day},{s.orientation},{s.luminous_energy:.6g},{s.exposure:.6g}" for s in found]
    write_whole(output, "\n".join(lines) + "\n")
    if as_json:
        rows = [
            {"day": s.day, "orientation": s.orientation, "supply_lm_h_per_m2": s.luminous_energy, "outside": s.exposure}
            for s in found
        ]
        print_json({"supply": rows, "written": [output]})
        return
    for s in found:
        say(f"  {s.day} {s.orientation:5s} {s.luminous_energy:10.0f} lm h/m² of {s.exposure:10.0f} lx h")
    note(f"wrote {output}")
