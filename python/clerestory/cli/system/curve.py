"""`clerestory system curve`: the tilt of a blind that keeps the sun out."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

import typer

from clerestory.cli.common import JsonOption, UsageError, about, note, numbers, print_json, say, write_whole

_SUFFIXES = (".csv", ".json", ".png", ".pdf", ".svg")


def curve(
    recipe: Annotated[
        str | None,
        typer.Argument(
            metavar="[RECIPE]",
            help="Recipe of a venetian blind: a file, or a name of trace --list.",
            show_default=False,
        ),
    ] = None,
    *,
    slats: Annotated[
        str | None,
        typer.Option("--slats", metavar="W,S,C", help="Width, distance and crown of the slats [mm], without a recipe."),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="OUT", help="Table (.csv), data (.json) or picture (.png, .pdf, .svg)."),
    ] = None,
    safety: Annotated[float, typer.Option("--safety", metavar="DEG", help="Added to the tilt.")] = 0.0,
    step: Annotated[float, typer.Option("--step", metavar="DEG", help="Of the drive; 0 for any tilt.")] = 0.0,
    tilts: Annotated[str, typer.Option("--range", metavar="OPEN,CLOSED", help="Tilts that are possible [°].")] = "0,90",
    as_json: JsonOption = False,
) -> None:
    """Say which tilt of a blind keeps the sun out, by the sun's profile angle; exact for curved slats.

    The profile angle is the height of the sun in the section across the slats: tan Ω = tan(altitude) / cos(azimuth from
    the window's normal).

    Example: clerestory system curve round-robin-blind --safety 3 --step 5 -o curve.csv
    """
    if (recipe is None) == (slats is None):
        raise UsageError("a recipe or --slats is asked for (give one of them)")
    if output is not None and output.suffix.lower() not in _SUFFIXES:
        raise UsageError(f"{output}: the name does not tell the format (end it with {', '.join(_SUFFIXES)})")
    low, high = numbers(tilts, "--range", 2, "0,90")
    from clerestory.annual.control.curve import control_curve, slats_of
    from clerestory.annual.control.slats import Slats

    if recipe is None:
        width, pitch, crown = numbers(slats or "", "--slats", 3, "80,72,8")
        shape, name = Slats(width, pitch, crown), f"slats of {width:g} mm at {pitch:g} mm"
    else:
        from clerestory.trace import load

        with about(Path(recipe)):
            sample = load(recipe)
            shape, name = slats_of(sample), sample.name
    made = control_curve(shape, name=name, safety_deg=safety, step_deg=step, range_deg=(low, high))
    written = []
    if output is not None:
        suffix = output.suffix.lower()
        if suffix in (".csv", ".json"):
            write_whole(output, made.csv() if suffix == ".csv" else made.json())
        else:
            from clerestory.plot.style import save

            save(made.figure(), output)
        written.append(output)
    if as_json:
        print_json({**made.as_dict(), "written": written})
        return
    say(f"{made.name}: width {shape.width:g}, distance {shape.pitch:g}, crown {shape.crown:g} mm")
    for k in range(0, len(made.profile_deg), 10):
        tilt = made.tilt_deg[k]
        words = "no tilt keeps it out" if math.isnan(tilt) else f"tilt {tilt:.1f}°"
        say(f"  sun at {made.profile_deg[k]:2.0f}°: {words}")
    for path in written:
        note(f"wrote {path}")
