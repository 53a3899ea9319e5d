"""`clerestory weather`: what a weather file holds, what is odd in it, and the year as a picture."""

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
    write_whole,
)

if TYPE_CHECKING:
    from clerestory.sky import Place
    from clerestory.weather import Weather

_PICTURES = (".png", ".pdf", ".svg")
_SUFFIXES = (*_PICTURES, ".wea")
_STAMPS = ("middle", "begin", "end")


def weather(
    file: Annotated[
        Path | None,
        typer.Argument(metavar="FILE", help="EPW, WEA, TMY3 or NSRDB CSV, CSV or Parquet.", show_default=False),
    ] = None,
    *,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="OUT", help="The year (.png, .pdf, .svg), or a WEA file (.wea)."),
    ] = None,
    place: Annotated[
        str | None,
        typer.Option("--place", metavar="LAT,LON", help="Of a table that does not say: north and EAST [°]."),
    ] = None,
    timezone: Annotated[
        float | None,
        typer.Option("--timezone", metavar="HOURS", help="Its clock, ahead of UTC, without daylight saving."),
    ] = None,
    elevation: Annotated[float | None, typer.Option("--elevation", help="Above the sea [m].")] = None,
    column: Annotated[
        list[str] | None,
        typer.Option("--column", metavar="WHAT=NAME", help="A column of a table: time, dni, dhi, ghi, dew_point, …"),
    ] = None,
    stamp: Annotated[
        str | None,
        typer.Option("--stamp", help=f"What the times of a table name: {', '.join(_STAMPS)} of the interval."),
    ] = None,
    fill_hours: Annotated[
        float, typer.Option("--fill-hours", metavar="N", help="Interpolate light where up to N daylight hours lack.")
    ] = 0.0,
    synthetic: Annotated[
        bool, typer.Option("--synthetic", help="No file: a made-up year of --place with passing clouds.")
    ] = False,
    cloudiness: Annotated[
        float | None, typer.Option("--cloudiness", help="Of it: 0, clear, to 1, overcast; 0.5 by default.")
    ] = None,
    seed: Annotated[int | None, typer.Option("--seed", help="Of it: another one gives another year.")] = None,
    as_json: JsonOption = False,
) -> None:
    """Say what a weather file holds: place, steps, sums, and what is missing, impossible or odd, with its hours.

    All times are standard time. The exit code is 1 if light is missing by day, so that the year has no skies.

    Example: clerestory weather innsbruck.epw -o year.png
    """
    suffix = _suffix(output)
    made = _synthetic(file, place, timezone, elevation, column, stamp, cloudiness, seed) if synthetic else None
    if made is None:
        if cloudiness is not None or seed is not None:
            raise UsageError("--cloudiness and --seed: have an effect on a synthetic year only (give --synthetic)")
        made = _read(file, place, timezone, elevation, column, stamp, fill_hours)
    elif fill_hours:
        raise UsageError("--fill-hours: a synthetic year has no gaps (leave it out)")
    if output is not None:
        refuse_overwriting(output, [file] if file is not None else [])
        write_whole(output, _content(made, file, suffix))
    if as_json:
        written = [] if output is None else [str(output)]
        print_json({**summary(made), "findings": made.findings, "written": written})
    else:
        _print(made)
    if output is not None:
        note(f"wrote {output}")
    if any(finding.severity == "error" for finding in made.findings):
        raise typer.Exit(1)


def _suffix(output: Path | None) -> str:
    if output is None:
        return ""
    suffix = output.suffix.lower()
    if suffix not in _SUFFIXES:
        what = f"ends in {suffix}, which is not known" if suffix else "has no suffix"
        raise UsageError(f"{output}: the name of the output {what} (give {', '.join(_SUFFIXES)})")
    return suffix


def _place(place: str | None, timezone: float | None, name: str) -> Place | None:
    from clerestory.sky import Place

    if place is None:
        if timezone is not None:
            raise UsageError("--timezone: is that of a place (give --place LAT,LON, too)")
        return None
    latitude, longitude = numbers(place, "--place", 2, "47.3,11.4")
    if timezone is None:
        raise UsageError("--place: the clock is not known (give --timezone HOURS, ahead of UTC, such as 1)")
    return Place(latitude, longitude, timezone, name)


def _synthetic(
    file: Path | None,
    place: str | None,
    timezone: float | None,
    elevation: float | None,
    column: list[str] | None,
    stamp: str | None,
    cloudiness: float | None,
    seed: int | None,
) -> Weather:
    from clerestory.weather import synthetic_year

    if file is not None:
        raise UsageError(f"{file}: a synthetic year is made without a file (leave one of them out)")
    if column or stamp is not None:
        raise UsageError("--column and --stamp: are of tables, not of a synthetic year (leave them out)")
    where = _place(place, timezone, "")
    if where is None:
        raise UsageError("--synthetic: the place is not known (give --place LAT,LON and --timezone HOURS)")
    chosen: dict[str, Any] = {} if cloudiness is None else {"cloudiness": cloudiness}
    return synthetic_year(where, elevation=elevation or 0.0, seed=seed or 0, **chosen)


def _read(
    file: Path | None,
    place: str | None,
    timezone: float | None,
    elevation: float | None,
    column: list[str] | None,
    stamp: str | None,
    fill_hours: float,
) -> Weather:
    from clerestory.weather import read_weather

    if file is None:
        raise UsageError("the file is missing (give an EPW, WEA, CSV or Parquet file, or --synthetic)")
    columns = {}
    for word in column or []:
        what, mark, name = word.partition("=")
        if not (what and mark and name):
            raise UsageError(f"--column {word}: not a quantity and a column (write dni=NAME)")
        columns[what] = name
    chosen = None if stamp is None else one_of(stamp, "--stamp", _STAMPS)
    with about(file):
        return read_weather(
            file,
            place=_place(place, timezone, file.stem),
            elevation=elevation,
            columns=columns,
            stamp=chosen,  # type: ignore[arg-type]
            fill_hours=fill_hours,
        )


def _content(made: Weather, file: Path | None, suffix: str) -> bytes | str:
    if suffix == ".wea":
        from clerestory.weather.wea import to_wea

        with about(file or Path("synthetic year")):
            return to_wea(made)
    from clerestory.plot.style import render
    from clerestory.weather.figure import year

    return render(year(made), suffix)


def summary(made: Weather) -> dict[str, Any]:
    """Everything of weather that is one number."""
    import numpy as np

    sine = np.sin(np.radians(np.maximum(made.sun_positions()[0], 0.0)))
    direct, diffuse = np.nan_to_num(made.direct), np.nan_to_num(made.diffuse)
    kilo = {
        "direct_normal": float((direct * made.interval).sum()) / 1e3,
        "diffuse_horizontal": float((diffuse * made.interval).sum()) / 1e3,
        "global_horizontal": float(((diffuse + direct * sine) * made.interval).sum()) / 1e3,
    }
    order = np.argsort(made.times, kind="stable")
    return {
        "name": made.place.name,
        "latitude": made.place.latitude,
        "longitude": made.place.longitude,
        "elevation": made.elevation,
        "time_zone": made.time_zone,
        "source": made.source,
        "steps": len(made),
        "step_hours": made.step,
        "first": str(made.times[order[0]]),
        "last": str(made.times[order[-1]]),
        "is_year": made.is_year,
        "daylight_hours": float(made.interval[made.is_daylight].sum()),
        "sums_klxh" if made.illuminances else "sums_kwh_m2": kilo,
    }


def _print(made: Weather) -> None:
    found = summary(made)
    unit = "klx·h" if made.illuminances else "kWh/m²"
    sums = found["sums_klxh" if made.illuminances else "sums_kwh_m2"]
    north = f"{abs(made.place.latitude):g}° {'N' if made.place.latitude >= 0 else 'S'}"
    east = f"{abs(made.place.longitude):g}° {'E' if made.place.longitude >= 0 else 'W'}"
    say(
        f"{found['name'] or 'no name'}: {north}, {east}, {made.elevation:g} m, UTC{made.time_zone:+g} without daylight "
        "saving"
    )
    say(f"  source    {made.source}")
    minutes = 60.0 * made.step
    say(f"  steps     {len(made)} of {minutes:g} min, {made.words(0)} to {made.words(-1)} at their middle")
    say(f"  daylight  {found['daylight_hours']:.0f} h with the sun above the horizon")
    say(
        "  sums      " + ", ".join(f"{name.replace('_', ' ')} {value:.0f}" for name, value in sums.items()) + f" {unit}"
    )
    for finding in made.findings:
        say(f"  {finding}")
    if not made.findings:
        say("  nothing odd was found")
