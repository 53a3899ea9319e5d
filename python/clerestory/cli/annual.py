"""`clerestory annual`: daylight and glare of a room over a year."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from clerestory.cli.common import JsonOption, UsageError, about, check_folder, note, print_json, progress, say, table

if TYPE_CHECKING:
    from clerestory.annual.study import Study


def annual(
    study: Annotated[Path, typer.Argument(metavar="STUDY.toml", help="Room, weather and data sets.")],
    *,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="FOLDER", help="For results.nc, tables and pictures."),
    ] = None,
    cache: Annotated[
        Path | None,
        typer.Option("--cache", metavar="FOLDER", help="Of matrices that are kept; $CLERESTORY_CACHE by default."),
    ] = None,
    picture: Annotated[
        list[str] | None,
        typer.Option(
            "--picture", metavar="TIME", help="Also pictures of this step (03-21 12:00), of every view; repeatable."
        ),
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option("--workers", metavar="N", min=1, help="Run with so many Dask workers on this machine."),
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option("--scheduler", metavar="ADDRESS", help="Run on a Dask cluster that sees the same folders."),
    ] = None,
    critical: Annotated[
        bool,
        typer.Option("--critical", help="Only find the critical moments: hours in which glare can occur, quickly."),
    ] = False,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Only say what would be computed.")] = False,
    as_json: JsonOption = False,
) -> None:
    """Daylight autonomy, vertical illuminance and glare of a room over a year, for one data set after another.

    Matrices of the room are kept, so that another data set in the same room takes seconds.

    Example: clerestory annual study.toml -o results --picture "03-21 12:00"
    """
    from clerestory.annual import results
    from clerestory.annual.study import load

    check_folder(output)
    if workers is not None and scheduler is not None:
        raise UsageError("--workers and --scheduler are two ways (give one)")
    if picture and (output is None or critical):
        raise UsageError("--picture: there are no results beside which to write (give --output FOLDER, no --critical)")
    made = load(study, cache=cache, tell=note)
    steps = [made.weather.at(when) for when in picture or ()]
    if steps and not made.views:
        raise UsageError("--picture: the study has no views (add one to the room, or to its key views)")
    for text in made.warnings:
        note(f"warning: {text}")
    if dry_run:
        _tell_plan(made, as_json=as_json)
        return
    if critical:
        with about(study):
            _tell_moments(made, output, as_json=as_json)
        return
    if workers is not None or scheduler is not None:
        from clerestory.annual.cluster import cluster, spread

        with cluster(scheduler=scheduler, workers=workers) as client, about(study), progress("workers") as tell:
            spread(made, study, client, tell)
    with about(study), progress("year") as tell:
        outcomes = made.run(tell)
    for text in made.cache.warnings:
        note(f"warning: {text}")
    found = results.summary(made, outcomes)
    written = [] if output is None else results.write(made, outcomes, output)
    if output is not None and steps:
        written += results.write_pictures(made, steps, output)
    if as_json:
        print_json(
            {
                "weather": made.weather.source,
                "hours": made.hours.words,
                "method": made.recipe.method,
                "warnings": [*made.warnings, *made.cache.warnings],
                "data_sets": found,
                "written": [str(path) for path in written],
            }
        )
        return
    say(f"{made.recipe.name or study.stem}: {made.weather.source}; {made.hours.words}; {made.recipe.method}")
    autonomy = f"DA {made.recipe.threshold_lx:g} lx"
    for head, rows in (
        (["data set", "sensors", autonomy, "mean E", "EN 17037 provision"], _of_sensors(found)),
        (["data set", "sensors", "sDA 300/50 %", "ASE 1000,250", "sDA is", "blinds"], _of_lm83(found)),
        (["data set", "view", "mean E_v", "DGP exceeded in 5 %", "EN 17037 glare"], _of_views(found)),
        (["data set", "windows", "states, share of the hours"], _of_states(found)),
    ):
        if rows:
            say(table(head, rows, left=2))
    for path in written:
        say(f"wrote {path}")


def _of_sensors(found: list[dict[str, Any]]) -> list[list[str]]:
    rows = []
    for record in found:
        for name, values in record["sensors"].items():
            autonomy, mean = 100.0 * values["daylight_autonomy"], values["mean_illuminance_lx"]
            level = "no daylight" if values["en17037_areas"] is None else values["en17037_provision"] or "below minimum"
            rows.append([str(record["data_set"]), name, f"{autonomy:.1f} %", f"{mean:.0f} lx", str(level)])
    return rows


def _of_lm83(found: list[dict[str, Any]]) -> list[list[str]]:
    rows = []
    for record in found:
        for name, values in record["sensors"].items():
            if values["sDA300_50"] is None:
                continue
            shares = [f"{100.0 * values[key]:.1f} %" for key in ("sDA300_50", "ASE1000_250")]
            rows.append([str(record["data_set"]), name, *shares, values["sDA_rating"], values["sDA_blinds"]])
    return rows


def _of_states(found: list[dict[str, Any]]) -> list[list[str]]:
    rows = []
    for record in found:
        for group, shares in record.get("states", {}).items():
            words = ", ".join(f"{name} {100.0 * share:.1f} %" for name, share in shares.items())
            rows.append([str(record["data_set"]), group, words])
    return rows


def _of_views(found: list[dict[str, Any]]) -> list[list[str]]:
    rows = []
    for record in found:
        for name, values in record["views"].items():
            at_eye = f"{values['mean_vertical_illuminance_lx']:.0f} lx"
            level = str(values["en17037_glare"] or "below minimum")
            rows.append([str(record["data_set"]), name, at_eye, f"{values['dgp_exceeded_5']:.3f}", level])
    return rows


def _tell_moments(study: Study, output: Path | None, *, as_json: bool) -> None:
    from clerestory.annual.critical import moments, to_csv
    from clerestory.whole import write_whole

    with progress("coarse year") as tell:
        found = moments(study, progress=tell)
    path = None if output is None else output / "moments.csv"
    if path is not None:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, to_csv(found).encode())
    if as_json:
        print_json({"moments": [asdict(moment) for moment in found], "written": [] if path is None else [str(path)]})
        return
    if not found:
        say(f"no hour with a DGP of 0.35 or more; {study.hours.words}")
    else:
        head = ["data set", "view", "time", "DGP", "cause", "sun (altitude, azimuth)", "stands for"]
        rows = [
            [
                m.data_set,
                m.view,
                m.time,
                f"{m.dgp:.2f}",
                m.cause,
                f"{m.sun_altitude_deg:.0f}°, {m.sun_azimuth_deg:.0f}°",
                f"{m.hours:.0f} h",
            ]
            for m in found
        ]
        say(table(head, rows, left=3))
    if path is not None:
        say(f"wrote {path}")


def _tell_plan(study: Study, *, as_json: bool) -> None:
    from clerestory.annual.plan import plan

    made = plan(study)
    control = {name: law.control.kind for name, law in study.recipe.data_sets.items() if law.control is not None}
    told: dict[str, Any] = {
        "room": study.room.name,
        "weather": study.weather.source,
        "steps": len(study.weather),
        "points": len(study.points),
        "views": study.views,
        "windows": study.groups,
        "data_sets": study.names,
        "control": control,
        "method": study.recipe.method,
        "memory_gb": study.recipe.memory_gb,
        "cache": str(study.cache.folder),
        "parts": made.parts,
        "parts_missing": made.missing,
        "seconds_about": round(made.seconds, 1),
        "disk_mb_about": round(made.disk_mb, 1),
    }
    if as_json:
        print_json(told)
        return
    for key, value in told.items():
        if isinstance(value, dict):
            value = [f"{name} by {law}" for name, law in value.items()] or ["none"]
        say(f"{key.replace('_', ' ')}: {'; '.join(value) if isinstance(value, list) else value}")
