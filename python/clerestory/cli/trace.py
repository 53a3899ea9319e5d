"""`clerestory trace`: the virtual goniophotometer."""

from __future__ import annotations

import sys
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from clerestory.cli.common import (
    TREES,
    JsonOption,
    UsageError,
    angle_pair,
    check_bsdf_name,
    kept,
    list_shipped,
    note,
    numbers,
    one_of,
    partial_of,
    print_json,
    refuse_overwriting,
    say,
    side_of,
    table,
    warn,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from clerestory.directions import Side
    from clerestory.trace import Balance, Measured, Sample, Seen, Settings, State

SCENES = (".rad", ".obj", ".stl", ".ply")
UNITS = ("m", "cm", "mm", "um", "inch", "foot")
RAYS = 100_000
"""Paths of a ray file by default."""


def trace(
    sample: Annotated[
        str | None,
        typer.Argument(
            metavar="SAMPLE",
            help="Recipe (.toml), the name of one of --list, or a scene (.rad, .obj, .stl, .ply).",
            show_default=False,
        ),
    ] = None,
    *,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", metavar="OUT", help="File to write: .xml, .xml.gz or .bsdf.npz; .csv for a scan."
        ),
    ] = None,
    basis: Annotated[
        str,
        typer.Option(
            metavar="NAME",
            help="klems-full, klems-half, klems-quarter, tregenza, reinhart:N, iea21; tensor4 or tensor3 for a tree.",
        ),
    ] = "klems-full",
    resolution: Annotated[int, typer.Option(metavar="N", help="2^N cells an axis of a tree, at the finest.")] = 6,
    cull: Annotated[
        float | None,
        typer.Option(metavar="PCT", help="Percentage of a tree's finest blocks to merge, the smoothest first."),
    ] = None,
    incident: Annotated[
        list[str] | None,
        typer.Option(metavar="T,P", help="Scan this direction only, into a .csv; above is azimuth 90. Repeatable."),
    ] = None,
    side: Annotated[
        str | None, typer.Option("--side", metavar="SIDE", help="Trace from one side only; from both by default.")
    ] = None,
    samples: Annotated[int | None, typer.Option(metavar="N", help="Paths an incident direction.")] = None,
    error: Annotated[
        str | None,
        typer.Option(
            metavar="PCT",
            help="Standard error of direct-hemispherical values to reach; by default 0.5% as far as seconds suffice.",
        ),
    ] = None,
    seed: Annotated[int, typer.Option(metavar="N", min=0, help="Another seed gives an independent result.")] = 1,
    threads: Annotated[
        int | None, typer.Option(metavar="N", min=1, help="Threads; all by default. Results do not depend on it.")
    ] = None,
    source_cone: Annotated[
        float, typer.Option(metavar="DEG", help="Full opening angle of the source of a real instrument.")
    ] = 0.0,
    detector_cone: Annotated[float, typer.Option(metavar="DEG", help="Full opening angle of its detector.")] = 0.0,
    reciprocity: Annotated[
        bool, typer.Option("--reciprocity", help="Average each component with its reverse, for reciprocal samples.")
    ] = False,
    rays: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="Write the rays that leave: .csv or .npz; from --incident, or diffuse light."
        ),
    ] = None,
    plot_geometry: Annotated[
        Path | None,
        typer.Option(metavar="PICTURE", help="Draw what was understood: .png, .pdf or .svg."),
    ] = None,
    unit: Annotated[
        str | None, typer.Option(metavar="UNIT", help="Unit of a scene: m, cm, mm, um, inch or foot.")
    ] = None,
    period: Annotated[str | None, typer.Option(metavar="X,Y", help="Period of a scene, in its unit.")] = None,
    region: Annotated[
        str | None,
        typer.Option(metavar="X,X,Y,Y", help="Part of a scene that is not repeated where rays start, in its unit."),
    ] = None,
    reflectance: Annotated[
        float | None, typer.Option(metavar="R", help="Lambertian reflectance of a scene without materials of its own.")
    ] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Go on with what Ctrl-C left behind.")] = False,
    list_all: Annotated[bool, typer.Option("--list", help="List the recipes that come with Clerestory.")] = False,
    as_json: JsonOption = False,
) -> None:
    """Trace rays through a sample and write its BSDF, with standard errors.

    A recipe is a TOML file that says what the sample looks like and what it is made of; docs/recipes.md has every key.
    Ctrl-C keeps what was finished. The same seed gives the same file, whatever the number of threads.

    Example: clerestory trace round-robin-blind -o blind.xml
    """
    if list_all:
        from clerestory.trace.shipped import RECIPES

        list_shipped(RECIPES, as_json=as_json)
        return
    if sample is None:
        raise UsageError("SAMPLE: none is given (give a recipe, or --list for those that come with Clerestory)")
    _check_names(output, rays, plot_geometry, scanned=bool(incident))
    for path in (output, rays, plot_geometry):
        if path is not None:
            refuse_overwriting(path, [Path(sample)])
    sides: tuple[Side, ...] = ("exterior", "interior") if side is None else (side_of(side),)
    listed = [angle_pair(text, "--incident") for text in incident or ()]
    share = None if error is None else _share(error)
    if cull is not None and (basis not in TREES or not 0.0 <= cull <= 100.0):
        raise UsageError(f"--cull {cull:g}: a percentage for trees (give --basis tensor4 and 0 to 100)")
    if listed and basis in TREES:
        raise UsageError(f"--basis {basis}: a scan is seen by patches (give a basis such as klems-full)")
    if samples is not None and share is not None:
        raise UsageError("--samples with --error: either the work or the error is given (choose one)")

    from clerestory.trace import Settings

    settings = Settings(
        basis=basis if basis in TREES else _basis(basis),
        resolution=resolution,
        sides=sides,
        samples=samples,
        error=share,
        seed=seed,
        threads=threads,
        source_cone_deg=source_cone,
        detector_cone_deg=detector_cone,
        reciprocity=reciprocity,
    )
    made = _load(sample, unit, period, region, reflectance)
    for text in made.warnings:
        warn(sample, text)
    written: list[Path] = []
    if plot_geometry is not None:
        from clerestory.plot.style import save
        from clerestory.trace.picture import geometry

        save(geometry(made), plot_geometry)
        written.append(plot_geometry)
    result: dict[str, object] = {"sample": made.name, "bands": made.bands, "warnings": made.warnings}
    if rays is not None:
        result["rays"] = _rays(made, settings, listed, sides, rays)
        written.append(rays)
    if output is not None:
        if listed:
            result |= _scan(made, settings, listed, sides, output, resume=resume, quiet=as_json)
        else:
            result |= _measure(made, settings, output, cull, resume=resume, quiet=as_json)
        written.append(output)
    if as_json:
        print_json({**result, "written": written})
        return
    say(f"wrote {', '.join(str(path) for path in written)}: {made.name}")


def _check_names(output: Path | None, rays: Path | None, picture: Path | None, *, scanned: bool) -> None:
    """Refuse names before any work is done."""
    if output is None and rays is None and picture is None:
        raise UsageError("-o: no file to write is given (give one ending in .xml, .xml.gz or .bsdf.npz)")
    if output is not None and scanned and output.suffix.lower() != ".csv":
        raise UsageError(f"{output}: a scan of directions is a table (end the name with .csv)")
    if output is not None and not scanned:
        check_bsdf_name(output)
    if rays is not None and rays.suffix.lower() not in (".csv", ".npz"):
        raise UsageError(f"--rays {rays}: the name does not tell the format (end it with .csv or .npz)")


def _share(text: str) -> float:
    """A share from `0.5%` or `0.005`."""
    try:
        value = float(text.removesuffix("%").strip()) * (0.01 if text.endswith("%") else 1.0)
    except ValueError:
        value = 0.0
    if not 0.0 < value < 1.0:
        raise UsageError(f"--error {text}: not an error to aim at (such as 0.5%)")
    return value


def _basis(name: str) -> Any:  # noqa: ANN401 (a basis, not yet imported)
    from clerestory import ClerestoryError
    from clerestory.basis import Basis

    try:
        return Basis.named(name)
    except ClerestoryError as error:
        raise UsageError(f"--basis {name}: {error}") from None


def _load(sample: str, unit: str | None, period: str | None, region: str | None, reflectance: float | None) -> Sample:
    """A sample from a recipe, its name, or a scene with its unit and period or region."""
    from clerestory.trace import RecipeError, load
    from clerestory.trace.kinds.scene import UNITS as METRES

    given = {"--unit": unit, "--period": period, "--region": region, "--reflectance": reflectance}
    if not sample.lower().endswith(SCENES):
        for option, value in given.items():
            if value is not None:
                raise UsageError(f"{option}: goes with a scene (.rad, .obj, .stl or .ply), not with a recipe")
        return load(sample)
    if unit is None:
        raise UsageError(f"{sample}: the unit of its lengths is not known (give --unit mm, or another one)")
    name = one_of(unit, "--unit", UNITS)
    if (period is None) == (region is None):
        raise UsageError(f"{sample}: either --period or --region is asked for (give one of them)")
    Path(sample).stat()
    millimetres = 1000.0 * METRES[name]
    table: dict[str, Any] = {"kind": "scene", "file": sample, "unit": name, "name": Path(sample).stem}
    if period is not None:
        table["period_mm"] = [millimetres * x for x in numbers(period, "--period", 2, "0.1,0.072")]
    if region is not None:
        table["region_mm"] = [millimetres * x for x in numbers(region, "--region", 4, "-1,1,-1,1")]
    recipe: dict[str, Any] = {"sample": table}
    if reflectance is not None:
        table["surfaces"] = {"*": {"material": "surface"}}
        recipe["materials"] = {"surface": {"kind": "lambertian", "reflectance": reflectance}}
    try:
        return load(recipe)
    except RecipeError as error:
        # The person has written options, no recipe: the file's name is enough.
        text = str(error).removeprefix("sample.file: ").removeprefix(f"{sample}: ")
        if text.startswith("sample.surfaces: nothing is said"):
            text = (
                f"{text.partition(' (')[0].removeprefix('sample.surfaces: ')} (give --reflectance, or write a recipe)"
            )
        raise RecipeError(f"{sample}: {text}") from None


@contextmanager
def _bar() -> Iterator[Callable[[float, float | None], None]]:
    """A bar that shows the present error, on standard error if that is a terminal."""
    if not sys.stderr.isatty():
        yield lambda _share, _error: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (
        TextColumn("tracing"),
        BarColumn(),
        TextColumn("{task.percentage:>3.0f} %"),
        TextColumn("{task.fields[error]}"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("tracing", total=1.0, error="")

        def tell(share: float, error: float | None) -> None:
            bar.update(task, completed=share, error="" if error is None else f"error {100.0 * error:.2g} %")

        yield tell


def _keeper(state: State) -> Callable[[Path], str]:
    """What keeps a measurement in a file, and tells how much of it."""

    def keep(path: Path) -> str:
        finished, count = state.done
        state.save(path)
        return f"{finished} of {count} parts are"

    return keep


def _state(made: Sample, settings: Settings, output: Path, incident: Any = None, *, resume: bool) -> State:  # noqa: ANN401
    from clerestory.trace import State

    if not resume:
        return State.new(made, settings, incident)
    partial = partial_of(output, must_exist=True)
    return State.load(partial, made, settings, incident)


def _measure(
    made: Sample, settings: Settings, output: Path, cull: float | None, *, resume: bool, quiet: bool
) -> dict[str, object]:
    from clerestory.trace import run
    from clerestory.trace.export import culled

    state = _state(made, settings, output, resume=resume)
    with kept(_keeper(state), output, resume=resume), _bar() as tell:
        measured = run(made, settings, state=state, progress=tell)
    bsdf = measured.bsdf if cull is None else culled(measured.bsdf, cull)
    notes = [text for text in bsdf.write(output) if "standard errors" not in text]
    if not quiet:
        for text in (*measured.bsdf.warnings, *notes):
            note(f"note: {output}: {text}")
        say(_summary(measured))
    return {
        "values": measured.values,
        "balance": measured.balance,
        "error": measured.error,
        "paths": measured.paths,
        "seconds": measured.seconds,
        "notes": [*measured.bsdf.warnings, *notes],
    }


def _summary(measured: Measured) -> str:
    from clerestory.words import percent

    rows = [[v.band, v.side, v.scatter, _with_error(v.normal), _with_error(v.hemispherical)] for v in measured.values]
    text = table(["band", "side", "scatter", "normal incidence", "hemispherical"], rows, left=3)
    speed = f"{measured.paths:,} paths in {measured.seconds:.1f} s, standard error {percent(measured.error)} at most"
    return "\n".join([text, *_balances(measured.balance), f"  {speed}"])


def _with_error(pair: tuple[float, float]) -> str:
    value, error = pair
    return f"{value:.4f} ± {error:.4f}" if error == error else f"{value:.4f}"  # not NaN


def _balances(balances: dict[str, Balance]) -> list[str]:
    lines = []
    for band, balance in balances.items():
        parts = [f"{name.replace('_', ' ')} {value:.3g}" for name, value in vars(balance).items()]
        lines.append(f"  {band}: of all light {', '.join(parts)}")
    return lines


def _directions(listed: Sequence[tuple[float, float]], sides: Sequence[Side]) -> Any:  # noqa: ANN401 (an array)
    import numpy as np

    from clerestory.directions import direction

    if len(sides) == 1:
        return np.array([direction(*angles, side=sides[0]) for angles in listed])
    return np.array([direction(*angles, side="exterior") for angles in listed])


def _scan(
    made: Sample,
    settings: Settings,
    listed: Sequence[tuple[float, float]],
    sides: Sequence[Side],
    output: Path,
    *,
    resume: bool,
    quiet: bool,
) -> dict[str, object]:
    from clerestory.trace import scan
    from clerestory.trace.export import scan_table
    from clerestory.whole import write_whole

    towards = _directions(listed, sides)
    state = _state(made, settings, output, towards, resume=resume)
    with kept(_keeper(state), output, resume=resume), _bar() as tell:
        seen, balance = scan(made, towards, settings, state=state, progress=tell)
    write_whole(output, scan_table(seen, settings.patches).encode())
    if not quiet:
        say(_seen(seen))
        for line in _balances(balance):
            say(line)
    values = [
        {"band": s.band, "incident": s.incident, "scatter": s.scatter, "total": s.total, "beam": s.beam} for s in seen
    ]
    return {"values": values, "balance": balance}


def _seen(seen: Sequence[Seen]) -> str:
    from clerestory.directions import incident_in_words

    rows = [[s.band, incident_in_words(s.incident), s.scatter, _with_error(s.total), _with_error(s.beam)] for s in seen]
    return table(["band", "light", "scatter", "all", "straight on"], rows, left=3)


def _rays(
    made: Sample, settings: Settings, listed: Sequence[tuple[float, float]], sides: Sequence[Side], path: Path
) -> dict[str, object]:
    from clerestory.trace.export import write_rays

    if len(listed) > 1:
        raise UsageError(
            "--rays with several --incident: a ray file is of one direction (give one, or none for diffuse)"
        )
    towards = _directions(listed, sides) if listed else None
    paths = settings.samples or RAYS
    with _bar() as tell:
        count = write_rays(made, path, towards, sides[0], paths, settings, progress=tell)
    return {"file": path, "rays": count, "paths": paths}
