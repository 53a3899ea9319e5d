"""`clerestory plot`: pictures of data sets."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from clerestory.cli.common import (
    BandOption,
    JsonOption,
    ScatterOption,
    SideOption,
    UsageError,
    about,
    angle_pair,
    note,
    numbers,
    one_of,
    print_json,
    read,
    refuse_overwriting,
    scatter_of,
    side_of,
    write_whole,
)
from clerestory.counts import counted

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure

    from clerestory.bsdf import Bsdf, Region
    from clerestory.directions import Scatter, Side

# Every kind of picture, and the options that make sense for it.
_KINDS: dict[str, frozenset[str]] = {
    "hemisphere": frozenset({"--log/--linear", "--dsf", "--region", "--orthographic"}),
    "grid": frozenset({"--log/--linear", "--dsf", "--orthographic"}),
    "patches": frozenset({"--log/--linear", "--dsf", "--region", "--orthographic", "--basis"}),
    "slices": frozenset({"--log/--linear", "--dsf"}),
    "close-up": frozenset({"--log/--linear", "--dsf", "--centre", "--half-width", "--step"}),
    "solid": frozenset(),
    "mountain": frozenset({"--log/--linear", "--dsf"}),
    "map": frozenset({"--orthographic"}),
    "bars": frozenset(),
}
_ONE_FILE = ("hemisphere", "patches", "close-up", "solid", "mountain")
_PROBES = (1, 41, 88, 130)


def plot(
    files: Annotated[
        list[Path] | None, typer.Argument(metavar="[FILE…]", help="BSDF files.", show_default=False)
    ] = None,
    *,
    output: Annotated[Path, typer.Option("--output", "-o", metavar="OUT", help="Picture: .png, .pdf or .svg.")],
    kind: Annotated[
        str | None,
        typer.Option(
            "--kind", help=f"{', '.join(_KINDS)}; hemisphere, or grid for several files or directions, by default."
        ),
    ] = None,
    incident: Annotated[
        list[str] | None,
        typer.Option(
            "--incident", metavar="T,P", help="Where light comes from [°]: 30,90 is a sun 30° above. Can be repeated."
        ),
    ] = None,
    patch: Annotated[
        list[int] | None,
        typer.Option(
            "--patch",
            metavar="N",
            help="The same as a patch of Klems' full basis; 41 by default, and 1, 41, 88, 130 for grid and bars.",
        ),
    ] = None,
    side: SideOption = "exterior",
    scatter: ScatterOption = "transmission",
    band: BandOption = None,
    log: Annotated[bool | None, typer.Option("--log/--linear", help="Scale of the values.")] = None,
    dsf: Annotated[bool, typer.Option("--dsf", help="Show BSDF·cos θ.")] = False,
    region: Annotated[
        list[str] | None,
        typer.Option(
            "--region",
            metavar="REGION",
            help="Outline and integrate cone:T,P,A, ring:T,P,A,B or patches:1,5-9[@BASIS]. Can be repeated.",
        ),
    ] = None,
    label: Annotated[
        list[str] | None, typer.Option("--label", metavar="NAME", help="Name of a data set, one a file.")
    ] = None,
    basis: Annotated[
        str | None,
        typer.Option("--basis", metavar="BASIS", help="For patches; without a file its bare numbers are drawn."),
    ] = None,
    centre: Annotated[
        str | None, typer.Option("--centre", metavar="T,P", help="Outgoing direction in the middle of a close-up [°].")
    ] = None,
    half_width: Annotated[
        float | None, typer.Option("--half-width", metavar="A", help="Of a close-up [°]; 2 by default.")
    ] = None,
    step: Annotated[
        float | None, typer.Option("--step", metavar="M", help="Of a close-up [arc-minutes]; 5 by default.")
    ] = None,
    orthographic: Annotated[
        bool, typer.Option("--orthographic", help="Equal areas for equal projected solid angles.")
    ] = False,
    dpi: Annotated[float, typer.Option("--dpi", help="Pixels an inch.")] = 160.0,
    as_json: JsonOption = False,
) -> None:
    """Draw a picture: falsecolour of a hemisphere, patches, slices, close-ups, solids, mountains, maps, bars.

    Directions are as seen from the room: right is right and up is up. A map of two files is the first minus the second.

    Example: clerestory plot blind.xml -o blind.png --patch 88 --region cone:50,270,10
    """
    from clerestory.plot.style import render, suffix_of
    from clerestory.words import common_band

    suffix = suffix_of(output)
    paths = files or []
    refuse_overwriting(output, paths)
    chosen = _kind(kind, paths, [*(incident or []), *(patch or [])])
    _refuse_useless(
        chosen,
        {
            "--log/--linear": log is not None,
            "--dsf": dsf,
            "--region": bool(region),
            "--basis": basis is not None,
            "--centre": centre is not None,
            "--half-width": half_width is not None,
            "--step": step is not None,
            "--orthographic": orthographic,
        },
    )
    sides, scatters = side_of(side), scatter_of(scatter)
    names = _labels(paths, label)
    sources = _sources(chosen, incident, patch, sides)
    regions = _regions(region, sides, scatters)
    sets = {name: read(path) for name, path in zip(names, paths, strict=True)}
    if len(paths) == 1:
        with about(paths[0]):
            band = common_band(sets, band)
    elif paths:
        band = common_band(sets, band)

    options: dict[str, Any] = {"side": sides, "scatter": scatters, "band": band}
    if log is not None:
        options["scale"] = "log" if log else "linear"
    if dsf:
        options["quantity"] = "dsf"
    if orthographic:
        options["projection"] = "orthographic"
    if region:
        options["regions"] = regions
    if basis is not None:
        from clerestory.basis import Basis

        options["basis"] = Basis.named(basis)
    if centre is not None:
        options["centre"] = _outgoing(centre, "--centre", sides, scatters)
    if half_width is not None:
        options["half_width_deg"] = half_width
    if step is not None:
        options["step_arcmin"] = step
    if len(paths) == 1:
        with about(paths[0]):
            figure = _draw(chosen, sets, sources, options)
    else:
        figure = _draw(chosen, sets, sources, options)
    write_whole(output, render(figure, suffix, dpi=dpi))
    if as_json:
        component = {"side": sides, "scatter": scatters, "band": band}
        values = _values(sets, sources, regions, component)
        print_json({"output": output, "kind": chosen, **component, "values": values})
    else:
        note(f"wrote {output}")


def _kind(kind: str | None, paths: Sequence[Path], directions: Sequence[object]) -> str:
    if kind is None:
        if not paths:
            return "patches"
        return "grid" if len(paths) > 1 or len(directions) > 1 else "hemisphere"
    name = one_of(kind, "--kind", tuple(_KINDS))
    if not paths and name != "patches":
        raise UsageError(f"--kind {name}: a file is needed (give one; only patches of a --basis go without)")
    if len(paths) > 1 and name in _ONE_FILE:
        raise UsageError(f"--kind {name}: {len(paths)} files do not fit in it (give one, or take grid or slices)")
    if len(directions) > 1 and name in _ONE_FILE:
        raise UsageError(f"--kind {name}: shows one incident direction (give one, or take grid or slices)")
    if len(paths) > 2 and name == "map":
        raise UsageError(f"--kind map: {len(paths)} files do not fit in it (give one, or two for their difference)")
    if directions and name == "map":
        raise UsageError("--kind map: shows all incident directions (leave --incident and --patch out)")
    return name


def _refuse_useless(kind: str, given: dict[str, bool]) -> None:
    for option, present in given.items():
        if present and option not in _KINDS[kind]:
            fit = ", ".join(name for name, options in _KINDS.items() if option in options)
            raise UsageError(f"{option}: has no effect on --kind {kind} (leave it out, or take {fit})")


def _labels(paths: Sequence[Path], labels: Sequence[str] | None) -> list[str]:
    from clerestory.files import default_labels

    names = default_labels(paths) if labels is None else list(labels)
    if len(names) != len(paths):
        raise UsageError(
            f"--label: {counted(len(names), 'name')} for {counted(len(paths), 'file')} (give one a file, in order)"
        )
    twice = [name for name in names if names.count(name) > 1]
    if twice:
        raise UsageError(f"--label {twice[0]}: given twice (give each data set a name of its own)")
    return names


def _sources(kind: str, incident: Sequence[str] | None, patch: Sequence[int] | None, side: Side) -> list[Any]:
    """Incident directions and Klems patches; those of the kind by default."""
    from clerestory.directions import direction

    if kind == "bars" and incident:
        raise UsageError("--incident: has no effect on --kind bars (name Klems patches by --patch)")
    made: list[Any] = [direction(*angle_pair(text, "--incident"), side=side) for text in incident or ()]
    made += patch or ()
    if kind == "map":
        return made
    return made or list(_PROBES if kind in ("grid", "bars") else (41,))


def _outgoing(text: str, option: str, side: Side, scatter: Scatter) -> Any:  # noqa: ANN401 (an array, not yet imported)
    from clerestory.directions import direction, outgoing_side

    return direction(*angle_pair(text, option), side=outgoing_side(side, scatter))


def _regions(texts: Sequence[str] | None, side: Side, scatter: Scatter) -> list[Region]:
    from clerestory.basis import Basis
    from clerestory.bsdf import Region

    made = []
    for text in texts or ():
        form, _, rest = text.partition(":")
        option = f"--region {form}"
        if form == "cone":
            theta, phi, angle = numbers(rest, option, 3, "cone:30,270,10")
            made.append(Region.cone(_outgoing(f"{theta},{phi}", option, side, scatter), angle))
        elif form == "ring":
            theta, phi, inner, outer = numbers(rest, option, 4, "ring:30,270,10,20")
            made.append(Region.ring(_outgoing(f"{theta},{phi}", option, side, scatter), inner, outer))
        elif form == "patches":
            numbered, _, name = rest.partition("@")
            basis = Basis.named(name or "klems-full")
            made.append(Region.patches(basis, [n - 1 for n in _patch_numbers(numbered, option, len(basis))]))
        else:
            raise UsageError(f"--region {text}: not known (give cone:T,P,A, ring:T,P,A,B or patches:1,5-9)")
    return made


def _patch_numbers(text: str, option: str, count: int) -> list[int]:
    """Numbers from 1 in a list with commas and ranges."""
    made: list[int] = []
    for part in text.split(","):
        first, dash, last = part.partition("-")
        try:
            low, high = int(first), int(last if dash else first)
        except ValueError:
            raise UsageError(f"{option} {text}: not patch numbers (such as patches:1,5-9)") from None
        if not 1 <= low <= high <= count:
            raise UsageError(f"{option} {text}: there is no patch {part} (the basis has 1 to {count})")
        made += [n for n in range(low, high + 1) if n not in made]
    return made


def _draw(kind: str, sets: dict[str, Bsdf], sources: list[Any], options: dict[str, Any]) -> Figure:
    from clerestory import plot as pictures
    from clerestory.plot.view import component_words

    names, data = list(sets), list(sets.values())
    projection = {k: v for k, v in options.items() if k == "projection"}
    component = {k: options[k] for k in ("side", "scatter", "band")}
    if not data:
        if "basis" not in options:
            raise UsageError("FILE: none is given (give a file, or a --basis to draw its patches)")
        return pictures.basis_patches(options["basis"], **projection)
    if kind == "grid":
        return pictures.hemisphere_grid(sets, sources, **options)
    if kind == "slices":
        return pictures.slices(sets, sources, **options)
    if kind == "bars":
        return pictures.transmittance_bars(
            pictures.transmittances(sets, sources, **component),
            title=component_words(options["band"], options["side"], options["scatter"]),
            ylabel="transmittance" if component["scatter"] == "transmission" else "reflectance",
        )
    if kind == "map":
        minus: dict[str, Any] = {"minus": data[1], "minus_label": names[1]} if len(data) == 2 else {}
        return pictures.transmittance_map(data[0], label=names[0], **minus, **options)
    single = {
        "hemisphere": pictures.hemisphere,
        "patches": pictures.patches,
        "close-up": pictures.close_up,
        "solid": pictures.photometric_solid,
        "mountain": pictures.mountain,
    }[kind]
    # A direction says its side by itself, and a patch needs to be told; both agree.
    figure: Figure = single(data[0], sources[0], label=names[0], **options)  # type: ignore[operator]
    return figure


def _values(
    sets: dict[str, Bsdf], sources: list[Any], regions: list[Region], component: dict[str, Any]
) -> list[dict[str, object]]:
    """What the pictures of hemispheres are labelled with, as numbers."""
    from clerestory._core import MissingDataError
    from clerestory.plot.view import View, region_words

    made: list[dict[str, object]] = []
    for name, bsdf in sets.items():
        for source in sources:
            try:
                view = View.of(bsdf, source, **component)
            except MissingDataError as error:
                made.append({"label": name, "missing": str(error)})
                continue
            made.append(
                {
                    "label": name,
                    "incident": view.light.words,
                    "band": view.band,
                    "direct_hemispherical": view.total(),
                    "values_of": view.total_of,
                    "by_reciprocity": view.by_reciprocity,
                    "peaks": view.peaks(),
                    "regions": [
                        {"region": region_words(r, view.outgoing_side), "value": view.total(r)} for r in regions
                    ],
                }
            )
    return made
