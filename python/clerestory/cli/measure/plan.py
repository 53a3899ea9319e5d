"""`clerestory measure plan`: what to measure, in which directions, on which paths, and how long it takes."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from clerestory.cli.common import (
    JsonOption,
    UsageError,
    angle_pair,
    check_folder,
    list_shipped,
    note,
    numbers,
    one_of,
    print_json,
    refuse_overwriting,
    say,
    table,
    warn,
    write_whole,
)
from clerestory.counts import counted

if TYPE_CHECKING:
    from clerestory.measure import Scan
    from clerestory.measure.plan import Plan


def plan(
    job: Annotated[
        Path | None,
        typer.Argument(metavar="[PLAN]", help="TOML file with the job; or use options.", show_default=False),
    ] = None,
    *,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="OUT", help="Folder for the plan; with --from-scan a .csv file."),
    ] = None,
    size: Annotated[str | None, typer.Option("--size", metavar="W,H", help="Of the sample [mm].")] = None,
    period: Annotated[
        float | None, typer.Option("--period", metavar="MM", help="Of its structure [mm]; none by default.")
    ] = None,
    symmetry: Annotated[
        str | None,
        typer.Option("--symmetry", help="isotropic, quadrilateral, left-right, up-down, rotational, none or unknown."),
    ] = None,
    weave: Annotated[str | None, typer.Option("--weave", help="none, square or rectangular.")] = None,
    cut_off: Annotated[
        float | None, typer.Option("--cut-off", metavar="DEG", help="Estimated from the geometry [°].")
    ] = None,
    geometry_known: Annotated[
        bool, typer.Option("--geometry-known", help="It is known well enough to trace it.")
    ] = False,
    purpose: Annotated[
        str | None, typer.Option("--for", metavar="PURPOSE", help="klems, high-resolution, glare or cut-off.")
    ] = None,
    instrument: Annotated[
        str | None, typer.Option("--instrument", metavar="NAME", help="One of --list, or a TOML file; pg2 by default.")
    ] = None,
    directions: Annotated[
        str | None,
        typer.Option("--directions", help="steps, klems-full, klems-half, klems-quarter or tregenza."),
    ] = None,
    from_scan: Annotated[
        Path | None, typer.Option("--from-scan", metavar="FILE", help="Coarse scan whose peaks become fine paths.")
    ] = None,
    incident: Annotated[
        str | None, typer.Option("--incident", metavar="T,P", help="Which scan of --from-scan; all by default.")
    ] = None,
    pattern: Annotated[str, typer.Option("--pattern", help="Of paths over peaks: circle or square.")] = "circle",
    list_all: Annotated[bool, typer.Option("--list", help="List the instruments that come with Clerestory.")] = False,
    as_json: JsonOption = False,
) -> None:
    """Plan a measurement: whether to measure or to trace, incident directions, scan paths, time, and what to know.

    The plan is written into a folder: plan.json, incident.csv, paths.csv. With --from-scan, peaks are found in a coarse
    scan and become fine paths.

    Example: clerestory measure plan --size 210,297 --period 0.6 --weave square --symmetry quadrilateral -o twill-plan
    """
    from clerestory.measure.plan import INSTRUMENTS, find_instrument, make_plan, write_plan
    from clerestory.measure.plan.tables import as_json as for_machines

    if list_all:
        list_shipped(INSTRUMENTS, as_json=as_json)
        return
    options: dict[str, Any] = {
        "--size": size,
        "--period": period,
        "--symmetry": symmetry,
        "--weave": weave,
        "--cut-off": cut_off,
        "--geometry-known": geometry_known or None,
        "--for": purpose,
        "--directions": directions,
    }
    given = [name for name, value in options.items() if value is not None]
    if from_scan is not None:
        if job is not None or given:
            raise UsageError(f"--from-scan: does not go with {job or given[0]} (plan the rest by another call)")
        _from_scan(from_scan, output, incident, pattern, instrument or "pg2", as_json=as_json)
        return
    if incident is not None:
        raise UsageError("--incident: goes with --from-scan only (a plan has all its directions)")
    if job is not None and given:
        raise UsageError(f"{given[0]}: does not go with {job} (change it there)")
    wanted = _job(job, options)
    made = make_plan(wanted, find_instrument(instrument or wanted.instrument))
    if output is not None:
        check_folder(output)
        written = write_plan(made, output)
    if as_json:
        print_json(for_machines(made))
    else:
        _show(made)
    if output is not None:
        for path in written:
            note(f"wrote {path}")


def _job(path: Path | None, options: dict[str, Any]) -> Any:  # noqa: ANN401 (a Job, imported when it is needed)
    from clerestory.measure.plan import Job, read_job

    if path is not None:
        return read_job(path)
    if options["--size"] is None:
        raise UsageError("no sample is given (give a PLAN.toml, or --size and what is known of it)")
    width, height = numbers(options["--size"], "--size", 2, "210,297")
    sample: dict[str, Any] = {"width_mm": width, "height_mm": height}
    for key, option in (
        ("period_mm", "--period"),
        ("symmetry", "--symmetry"),
        ("weave", "--weave"),
        ("cut_off_deg", "--cut-off"),
        ("geometry_known", "--geometry-known"),
    ):
        if options[option] is not None:
            sample[key] = options[option]
    tables: dict[str, Any] = {"sample": sample}
    if options["--for"] is not None:
        tables["purpose"] = options["--for"]
    if options["--directions"] is not None:
        tables["directions"] = options["--directions"]
    return Job.of(tables)


def _show(made: Plan) -> None:
    extent = made.extent
    say(f"{made.instrument.name}: {made.job.sample.name}, {made.job.purpose}")
    say(f"  way      {made.route.why}")
    say(f"  holder   {extent.holder or 'none that fits'}")
    say(f"  spot     {extent.spot_mm:g} mm at normal incidence")
    at_least = "at least " if made.instrument.kind == "scanning" else ""
    directions = counted(len(made.incident), "incident direction")
    positions = f" at {made.route.positions} positions" if made.route.positions > 1 else ""
    say(f"  time     {at_least}{made.hours:.1f} h for {directions}{positions}")
    say(f"  largest  {extent.largest_theta_deg:.1f}° of incidence, by the {extent.limited_by}")
    rings: dict[tuple[str, float], list[float]] = {}
    for side, theta, phi in made.incident:
        rings.setdefault((side, theta), []).append(phi)
    rows = [
        [side, f"{theta:g}", f"{extent.lit_mm(theta):.0f}", " ".join(f"{phi:g}" for phi in azimuths)]
        for (side, theta), azimuths in rings.items()
    ]
    say(table(["from", "θ [°]", "lit [mm]", "φ [°]"], rows, left=4))
    kinds: dict[tuple[str, str], list[int]] = {}
    for planned in made.paths:
        kinds.setdefault((planned.scatter, planned.path.kind), []).append(len(planned.path))
    if kinds:
        rows = [[s, k, str(len(n)), f"{sum(n) / len(n):.0f}"] for (s, k), n in kinds.items()]
        say(table(["paths", "kind", "number", "points each"], rows, left=2))
    for text in made.advice:
        say(f"- {text}")


def _from_scan(
    path: Path, output: Path | None, incident: str | None, pattern: str, instrument: str, *, as_json: bool
) -> None:
    from clerestory.measure import read
    from clerestory.measure.plan import find_instrument, find_peaks, fine_paths
    from clerestory.measure.plan.make import PlannedPath
    from clerestory.measure.plan.tables import paths_csv

    shape = "circle" if one_of(pattern, "--pattern", ("circle", "square")) == "circle" else "square"
    resolution = find_instrument(instrument).resolution_deg
    if output is not None:
        if output.suffix.lower() != ".csv":
            raise UsageError(f"{output}: paths are written as .csv (end the name so)")
        refuse_overwriting(output, [path])
    contents = read([path])
    for text in contents.warnings:
        warn(path, text)
    scans = [scan for measurement in contents.measurements for scan in measurement.of()]
    if incident is not None:
        scans = _scans_from(scans, angle_pair(incident, "--incident"), path)
    if not scans:
        raise UsageError(f"{path}: holds no scan of a sample (give a goniophotometer's file)")
    found: list[dict[str, Any]] = []
    planned: list[PlannedPath] = []
    for n, scan in enumerate(scans, start=1):
        peaks = find_peaks(scan)
        paths = fine_paths(peaks, pattern=shape, resolution_deg=resolution)  # type: ignore[arg-type]
        planned += [PlannedPath(n, scan.scatter, made) for made in paths]
        found.append({"incidence": n, "theta_deg": scan.incident_theta_deg, "phi_deg": scan.incident_phi_deg,
                      "side": scan.incident_side, "scatter": scan.scatter, "peaks": peaks,
                      "path_points": [len(made) for made in paths]})  # fmt: skip
    if output is not None:
        write_whole(output, paths_csv(tuple(planned)))
    if as_json:
        print_json(found)
    else:
        rows = [
            [f"{scan.incident_theta_deg:g},{scan.incident_phi_deg:g}", scan.scatter,
             f"{peak.theta_deg:.1f},{peak.phi_deg:.1f}", f"{peak.bsdf:.3g}", f"{peak.width_deg:.2g}",
             "yes" if peak.resolved else "no"]
            for scan, entry in zip(scans, found, strict=True)
            for peak in entry["peaks"]
        ]  # fmt: skip
        if rows:
            say(table(["incident", "scatter", "peak at", "BSDF [1/sr]", "width [°]", "resolved"], rows, left=2))
        else:
            say("no peaks: nothing is higher than its surroundings by more than the noise")
    if output is not None:
        note(f"wrote {output}")


def _scans_from(scans: list[Scan], asked: tuple[float, float], path: Path) -> list[Scan]:
    import numpy as np

    from clerestory.directions import direction

    kept = [s for s in scans if float(s.incident @ direction(*asked, side=s.incident_side)) > np.cos(np.radians(0.5))]
    if not kept:
        there = ", ".join(f"{s.incident_theta_deg:g},{s.incident_phi_deg:g}" for s in scans[:8])
        raise UsageError(f"{path}: no scan of light from {asked[0]:g},{asked[1]:g} (there are {there})")
    return kept
