"""`clerestory system build`: layers of glass and shade to one window."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, cast

import typer

from clerestory.cli.common import (
    JsonOption,
    UsageError,
    about,
    check_bsdf_name,
    list_shipped,
    note,
    print_json,
    refuse_overwriting,
    say,
    table,
    warn,
    write_whole,
)
from clerestory.cli.system.product import solved, specified

if TYPE_CHECKING:
    from clerestory.directions import Scatter, Side
    from clerestory.files import Target
    from clerestory.system.build import Specified
    from clerestory.system.window import Built

SIDES: tuple[Side, ...] = ("exterior", "interior")
SCATTERS: tuple[Scatter, ...] = ("transmission", "reflection")
PICTURES = (".png", ".pdf", ".svg")


def build(
    spec: Annotated[
        str | None,
        typer.Argument(
            metavar="SPEC",
            help="Specification (.toml), or the name of one of --list.",
            show_default=False,
        ),
    ] = None,
    *,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="OUT", help="File to write: .xml, .xml.gz or .bsdf.npz."),
    ] = None,
    target: Annotated[
        str,
        typer.Option("--for", metavar="PROGRAM", help="What an XML file is for: plain, radiance, window, energyplus."),
    ] = "plain",
    curves: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Write what panes do by angle: .csv, or a picture (.png, .pdf, .svg)."),
    ] = None,
    list_all: Annotated[
        bool, typer.Option("--list", help="List the specifications that come with Clerestory.")
    ] = False,
    as_json: JsonOption = False,
) -> None:
    """Put layers together to a window, and write its BSDF.

    A specification is a TOML file that lists layers from the exterior to the interior: glass, files, recipes of the
    virtual goniophotometer, and the gas between them; docs/systems.md has every key.

    Example: clerestory system build double-glazing-roller-blind -o window.xml
    """
    from clerestory.system.build import SYSTEMS

    if list_all:
        list_shipped(SYSTEMS, as_json=as_json)
        return
    if spec is None:
        raise UsageError("SPEC: none is given (give a specification, or --list for those that come with Clerestory)")
    _check_names(output, target, curves)
    made = specified(spec, quiet=as_json)
    for path in (output, curves):
        if path is not None:
            refuse_overwriting(path, made.sources)
    built = solved(spec, made)
    written: list[Path] = []
    if output is not None:
        _write(made, built, output, target)
        written.append(output)
    if curves is not None:
        _write_curves(made, curves)
        written.append(curves)
    if as_json:
        print_json({**_result(made, built), "written": written})
        return
    _tell(made, built)
    for path in written:
        note(f"wrote {path}")


def _check_names(output: Path | None, target: str, curves: Path | None) -> None:
    """Refuse names before any work is done."""
    from clerestory.cli.common import one_of

    if output is not None:
        check_bsdf_name(output)
    if curves is not None and curves.suffix.lower() not in (".csv", *PICTURES):
        raise UsageError(f"--curves {curves}: the name does not tell the format (end it with .csv, .png, .pdf or .svg)")
    one_of(target, "--for", ("plain", "radiance", "window", "energyplus"))


def _write(made: Specified, built: Built, output: Path, target: str) -> None:
    from clerestory.cli.common import one_of

    if output.name.lower().endswith(".npz"):
        (made.sharpened() if made.is_sharp else built.bsdf).save(output)
        return
    if made.is_sharp:
        raise UsageError(
            f"{output}: XML holds no beams beside tables (end the name with .bsdf.npz, or set system.resolution to "
            "patches)"
        )
    name = one_of(target, "--for", ("plain", "radiance", "window", "energyplus"))
    from clerestory.system.exchange import described

    bsdf, notes = described(made, built.matrices)
    with about(output):
        for text in (*notes, *bsdf.write(output, target=cast("Target", name))):
            warn(output, text)


def _write_curves(made: Specified, path: Path) -> None:
    from clerestory.system.glazing import Glazing

    panes = [layer.pane for layer in made.window.layers if layer.pane is not None]
    if not panes:
        raise UsageError(f"--curves {path}: the window has no pane of glass (leave it out)")
    glazing, norm = Glazing(panes), made.specification.system.standard
    if path.suffix.lower() == ".csv":
        write_whole(path, glazing.csv(norm=norm))
        return
    from clerestory.plot.style import save

    save(glazing.figure(norm), path)


def _result(made: Specified, built: Built) -> dict[str, object]:
    bands = {}
    for band in built.absorbed:
        bands[band] = {side: _values(built, band, side) for side in SIDES}
    layers = [
        {"number": k, "name": layer.name, "is_glass": layer.pane is not None, **vars(layer.thermal)}
        for k, layer in enumerate(made.window.layers, 1)
    ]
    gaps = [{"name": gap.name, "width_m": gap.width_m, "gas": gap.gas} for gap in made.window.gaps]
    return {
        "name": made.name,
        "standard": made.specification.system.standard,
        "basis": built.basis.name,
        "layers": layers,
        "gaps": gaps,
        "bands": bands,
        "broad_bands_differ_by": built.difference,
        "warnings": built.warnings,
    }


def _values(built: Built, band: str, side: Side) -> dict[str, Any]:
    """Direct-hemispherical values along the normal and under diffuse light, and by patch."""
    incident = built.basis.incident_centres(side)
    area = built.basis.projected_solid_angles
    weights = area / area.sum()
    found: dict[str, Any] = {}
    for scatter in SCATTERS:
        by_patch = built.bsdf.integrate(incident, scatter, band=band)
        direct = built.bsdf.integrate(incident, scatter, band=band, part="direct")
        found[scatter] = {
            "normal": by_patch[0],
            "normal_direct": direct[0],
            "hemispherical": weights @ by_patch,
            "by_patch": by_patch,
        }
    absorbed = built.absorptance(band, side)
    found["absorptance"] = {
        "normal": absorbed[:, 0],
        "hemispherical": absorbed @ weights,
        "by_patch": absorbed,
    }
    return found


def _tell(made: Specified, built: Built) -> None:
    say(f"{made.name}: {len(built.layers)} layers on {built.basis.name}, {made.specification.system.standard}")
    rows = []
    for band in built.absorbed:
        for side in SIDES:
            values = _values(built, band, side)
            row = [f"{band}, from the {side}"]
            for scatter in ("transmission", "reflection"):
                held = values[scatter]
                row += [f"{held[key]:.3f}" for key in ("normal", "hemispherical")]
            row += [f"{a:.3f}" for a in values["absorptance"]["normal"]]
            rows.append(row)
    heads = ["", "T normal", "T diffuse", "R normal", "R diffuse"]
    heads += [f"A{k} normal" for k in range(1, len(built.layers) + 1)]
    say(table(heads, rows))
    for k, name in enumerate(built.layers, 1):
        say(f"  layer {k}: {name}")
    if built.difference:
        worst = ", ".join(f"{band} {value:.4f}" for band, value in built.difference.items())
        say(f"  broad bands would differ in transmittance by up to: {worst}")
