"""`clerestory trace`: the virtual goniophotometer."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from clerestory.cli.common import (
    JsonOption,
    UsageError,
    note,
    print_json,
    progress,
    say,
    side_of,
    table,
    warn,
)

if TYPE_CHECKING:
    from clerestory.directions import Side
    from clerestory.trace import Measured, Sample

SUFFIXES = (".xml", ".xml.gz", ".npz")


def trace(
    sample: Annotated[
        str | None,
        typer.Argument(metavar="SAMPLE", help="Recipe (.toml), or the name of one of --list.", show_default=False),
    ] = None,
    *,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="OUT", help="File to write: .xml, .xml.gz or .bsdf.npz.")
    ] = None,
    basis: Annotated[
        str, typer.Option(metavar="NAME", help="Directions: klems-full, klems-half, klems-quarter, tregenza, …")
    ] = "klems-full",
    side: Annotated[
        str | None, typer.Option("--side", metavar="SIDE", help="Trace from one side only; from both by default.")
    ] = None,
    samples: Annotated[int, typer.Option(metavar="N", min=16, help="Paths an incident direction.")] = 1024,
    seed: Annotated[int, typer.Option(metavar="N", min=0, help="Another seed gives an independent result.")] = 1,
    threads: Annotated[
        int | None, typer.Option(metavar="N", min=1, help="Threads; all by default. Results do not depend on it.")
    ] = None,
    plot_geometry: Annotated[
        Path | None,
        typer.Option(metavar="PICTURE", help="Draw what was understood: .png, .pdf or .svg. No -o, no tracing."),
    ] = None,
    list_all: Annotated[bool, typer.Option("--list", help="List the recipes that come with Clerestory.")] = False,
    as_json: JsonOption = False,
) -> None:
    """Trace rays through a sample and write its BSDF, with standard errors.

    A recipe is a TOML file that says what the sample looks like and what it is made of; docs/recipes.md has every key.
    Lengths and angles are in the units that the keys end in. Slats with a positive tilt hang their outer edge down.

    Example: clerestory trace round-robin-blind -o blind.xml
    """
    if list_all:
        _list(as_json=as_json)
        return
    if sample is None:
        raise UsageError("SAMPLE: none is given (give a recipe, or --list for those that come with Clerestory)")
    if output is None and plot_geometry is None:
        raise UsageError("-o: no file to write is given (give one ending in .xml, .xml.gz or .bsdf.npz)")
    if output is not None and not output.name.lower().endswith(SUFFIXES):
        raise UsageError(f"{output}: the name does not tell the format (end it with .xml, .xml.gz or .bsdf.npz)")
    sides: tuple[Side, ...] = ("exterior", "interior") if side is None else (side_of(side),)

    from clerestory.trace import load, run

    made = load(sample)
    for text in made.warnings:
        warn(sample, text)
    if plot_geometry is not None:
        from clerestory.plot.style import save
        from clerestory.trace.picture import geometry

        save(geometry(made), plot_geometry)
    if output is None:
        if as_json:
            print_json(_described(made))
        else:
            say(f"wrote {plot_geometry}: {made.name}")
        return
    with progress("tracing") as done:
        measured = run(made, basis=basis, sides=sides, samples=samples, seed=seed, threads=threads, progress=done)
    notes = measured.bsdf.write(output)
    if as_json:
        print_json({**_described(made), **_results(measured), "output": output, "notes": notes})
        return
    for text in notes:
        note(f"note: {output}: {text}")
    say(_summary(measured))
    say(f"wrote {output}: {', '.join(measured.bsdf.bands)}")


def _list(*, as_json: bool) -> None:
    from clerestory.trace.shipped import about, names, path_of

    found = [{"name": name, "what": about(name), "file": path_of(name)} for name in names()]
    if as_json:
        print_json(found)
        return
    say(table(["recipe", ""], [[str(f["name"]), str(f["what"])] for f in found], left=2))


def _described(sample: Sample) -> dict[str, object]:
    return {"sample": sample.name, "bands": sample.bands, "warnings": sample.warnings}


def _results(measured: Measured) -> dict[str, object]:
    return {
        "values": measured.values(),
        "balance": measured.balance,
        "paths": measured.paths,
        "seconds": measured.seconds,
    }


def _summary(measured: Measured) -> str:
    rows = [
        [v.band, v.side, v.scatter, *(f"{x:.4f} ± {e:.4f}" for x, e in (v.normal, v.hemispherical))]
        for v in measured.values()
    ]
    text = table(["band", "side", "scatter", "normal incidence", "hemispherical"], rows, left=3)
    for band, balance in measured.balance.items():
        parts = [f"{name.replace('_', ' ')} {value:.3g}" for name, value in vars(balance).items()]
        text += f"\n  {band}: of all light {', '.join(parts)}"
    return f"{text}\n  {measured.paths:,} paths in {measured.seconds:.1f} s"
