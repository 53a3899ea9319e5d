"""`clerestory system export`: a window for other programs, as data, as a luminaire, or as the daylight it supplies."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from clerestory.cli.common import (
    JsonOption,
    UsageError,
    about,
    note,
    numbers,
    one_of,
    plain,
    print_json,
    read,
    refuse_overwriting,
    say,
    warn,
    write_whole,
)
from clerestory.cli.system.product import solved, specified
from clerestory.endings import is_bsdf

if TYPE_CHECKING:
    from clerestory.bsdf import Bsdf
    from clerestory.files import Target
    from clerestory.sky import Place, Sky
    from clerestory.system.build import Specified
    from clerestory.system.product import Curve
    from clerestory.system.window import Built

_LIGHT = (".ldt", ".ies", ".csv")
_DATA = (".xml", ".xml.gz", ".idf", ".epjson", ".json")
_TARGETS = ("plain", "radiance", "window", "energyplus")
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
            help="Data set .xml; EnergyPlus .idf or .epJSON; manifest .json; candle power .ldt (EULUMDAT) or .ies "
            "(LM-63); daylight supply of two clear days .csv.",
        ),
    ],
    to: Annotated[
        str | None,
        typer.Option(
            "--for",
            metavar="PROGRAM",
            help="What an XML file is for: plain (all bands, the default), radiance, window, energyplus.",
        ),
    ] = None,
    safety: Annotated[
        float, typer.Option("--safety", metavar="DEG", help="Added to the tilts of the control curve of slats.")
    ] = 0.0,
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
    """Write a window for other programs.

    XML holds all bands and sides, thermal properties and, in an element that other programs pass over, components, U
    and solar heat gain, control curve and orientation. For EnergyPlus it is a Construction:ComplexFenestrationState
    with all that it refers to. As a luminaire it stands under a sky: the inward normal of the window is the nadir, C 90
    is up; the sun's beams, which no such file can hold, are spread over a step and listed.

    Example: clerestory system export double-glazing-roller-blind -o window.idf
    """
    suffix = ".xml.gz" if output.name.lower().endswith(".xml.gz") else output.suffix.lower()
    if suffix not in (*_LIGHT, *_DATA):
        raise UsageError(f"{output}: the name does not tell the format (end it with {', '.join((*_DATA, *_LIGHT))})")
    if suffix in _DATA:
        if place is not None or sun is not None:
            raise UsageError("--place and --sun go with candle power and daylight supply (leave them out)")
        _data(product, output, suffix, to, safety, as_json=as_json)
        return
    if to is not None:
        raise UsageError(f"--for goes with data sets, not with {suffix} (leave it out)")
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
    if is_bsdf(product):
        bsdf = read(Path(product))
        return bsdf, bsdf.metadata.name or Path(product).name, [Path(product)]
    made = specified(product, quiet=quiet)
    return solved(product, made).bsdf, made.name, made.sources


def _data(product: str, output: Path, suffix: str, to: str | None, safety: float, *, as_json: bool) -> None:
    target = one_of(to or ("energyplus" if suffix in (".idf", ".epjson") else "plain"), "--for", _TARGETS)
    if suffix in (".idf", ".epjson") and target != "energyplus":
        raise UsageError(f"--for {target}: {suffix} files are for energyplus (end the name with .xml)")
    if is_bsdf(product):
        from clerestory.system.build import load

        path = Path(product)
        layer = {"kind": "file", "file": path.name}
        with about(path):
            made = load({"layers": [layer]}, folder=path.parent)
    else:
        made = specified(product, quiet=as_json)
    refuse_overwriting(output, made.sources)
    built = solved(product, made)
    with about(Path(product)):
        notes, result = _written(made, built, output, suffix, cast("Target", target), safety)
    for text in notes:
        warn(product, text)
    if as_json:
        print_json({**result, "notes": notes, "written": [output]})
        return
    for key, value in result.items():
        say(f"  {key.replace('_', ' ')}: {value}")
    note(f"wrote {output}")


def _written(
    made: Specified, built: Built, output: Path, suffix: str, target: Target, safety: float
) -> tuple[list[str], dict[str, object]]:
    """What was assumed or left out, and what the file holds, in a few words."""
    if suffix in (".idf", ".epjson"):
        from clerestory.system import energyplus

        objects, notes = energyplus.fenestration(made.window, built, made.name)
        write_whole(output, energyplus.idf(objects) if suffix == ".idf" else energyplus.epjson(objects))
        return notes, {"construction": objects[-1].name, "objects": len(objects)}
    from clerestory.system.exchange import data_set, manifest

    curve = _curve(made, safety)
    if suffix == ".json":
        import json

        found = manifest(made, built, curve=curve)
        write_whole(output, json.dumps(plain(found), indent=1, ensure_ascii=False) + "\n")
        return found.pop("notes"), {"components": len(made.specification.layers)}  # type: ignore[return-value]
    bsdf, notes = data_set(made, built, curve=curve)
    return [*notes, *bsdf.write(output, target=target)], {"bands": ", ".join(bsdf.bands)}


def _curve(made: Specified, safety: float) -> Curve | None:
    """The control curve of the outermost layer of slats."""
    from clerestory.annual.control.curve import control_curve, slats_of
    from clerestory.system.build import sample_of
    from clerestory.system.recipe import RecipeKeys
    from clerestory.trace.kinds.blind import VenetianBlind

    for keys in made.specification.layers:
        if isinstance(keys, RecipeKeys):
            sample = sample_of(keys, made.folder)
            if isinstance(sample.recipe.sample, VenetianBlind):
                return control_curve(slats_of(sample), safety_deg=safety).as_product()
    return None


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
