"""`clerestory system rate`: figures, g and classes of a device or a window, and its data sheet."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from clerestory.cli.common import (
    JsonOption,
    UsageError,
    about,
    note,
    one_of,
    print_json,
    read,
    refuse_overwriting,
    say,
    table,
    warn,
    write_whole,
)
from clerestory.cli.system.product import solved, specified
from clerestory.endings import is_bsdf

if TYPE_CHECKING:
    from clerestory.bsdf import Bsdf
    from clerestory.rating.product import Rated
    from clerestory.system.heat import WindowHeat
    from clerestory.system.window import Built

_SHEETS = (".html", ".pdf")
_POSITIONS = ("interior", "exterior", "integrated")


def rate(
    product: Annotated[
        str,
        typer.Argument(
            metavar="SPEC|FILE",
            help="Specification of a window (.toml, or a name of system build --list), or a BSDF file of a device.",
            show_default=False,
        ),
    ],
    *,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="SHEET", help="Data sheet: .html or .pdf.")
    ] = None,
    edition: Annotated[
        str,
        typer.Option("--edition", metavar="NAME|FILE", help="Limits of EN 14501; a TOML file has those of your copy."),
    ] = "en-14501:2005",
    position: Annotated[
        str, typer.Option("--position", metavar="WHERE", help="Of a device: interior, exterior or integrated.")
    ] = "interior",
    glazing: Annotated[
        str, typer.Option("--glazing", metavar="LETTER", help="Reference glazing A to D that a device is rated with.")
    ] = "C",
    winter: Annotated[str, typer.Option("--winter", metavar="NAME", help="Climate for U of a window.")] = "nfrc-winter",
    summer: Annotated[str, typer.Option("--summer", metavar="NAME", help="Climate for g of a window.")] = "nfrc-summer",
    directions: Annotated[
        Path | None,
        typer.Option("--directions", metavar="CSV", help="Write the solar heat gain of a window by direction."),
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Rate a shading device or a whole window: light by EN 14500, U and g, classes of EN 14501.

    A device is a BSDF file, and has g with the reference glazings by EN ISO 52022-1. A window is a specification of
    layers, and has its own U and g by ISO 15099, for the sun from every direction.

    Example: clerestory system rate double-glazing-roller-blind -o sheet.pdf
    """
    if output is not None and output.suffix.lower() not in _SHEETS:
        raise UsageError(f"{output}: the name does not tell the format (end it with .html or .pdf)")
    where = one_of(position, "--position", _POSITIONS)
    letter = one_of(glazing, "--glazing", ("a", "b", "c", "d")).upper()
    from clerestory.rating.classes import edition as limits_of
    from clerestory.rating.product import rate_device, rate_window

    limits = limits_of(edition)
    heat: WindowHeat | None = None
    built: Built | None = None
    with about(Path(product)):
        if is_bsdf(product):
            if directions is not None:
                raise UsageError("--directions goes with a specification of a window (a device has no heat of its own)")
            bsdf, sources = read(Path(product)), [Path(product)]
            rated = rate_device(bsdf, limits, position=where, glazing=letter)  # type: ignore[arg-type]
        else:
            bsdf, built, heat, sources = _window(product, winter, summer, quiet=as_json)
            rated = rate_window(bsdf, limits, g=heat.g, secondary=float(heat.gain.secondary[0]))
    for path in (output, directions):
        if path is not None:
            refuse_overwriting(path, sources)
    from clerestory.rating.sheet import directions as by_direction
    from clerestory.rating.sheet import sheet

    written = []
    if output is not None:
        document = sheet(rated, bsdf, limits, heat=heat, built=built)
        from clerestory.report.html import html
        from clerestory.report.pdf import pdf

        write_whole(output, html(document) if output.suffix.lower() == ".html" else pdf(document))
        written.append(output)
    if directions is not None and heat is not None:
        rows = by_direction(heat)
        lines = [",".join(rows[0]), *(",".join(f"{v:.6g}" for v in row.values()) for row in rows)]
        write_whole(directions, "\n".join(lines) + "\n")
        written.append(directions)
    if as_json:
        print_json(_result(rated, heat, edition) | {"written": written})
        return
    _tell(rated, heat, product)
    for path in written:
        note(f"wrote {path}")


def _window(product: str, winter: str, summer: str, *, quiet: bool) -> tuple[Bsdf, Built, WindowHeat, list[Path]]:
    from clerestory.system.heat import heat

    made = specified(product, quiet=quiet)
    built = solved(product, made)
    keys = made.specification.system
    found = heat(
        made.window,
        built,
        winter=winter,
        summer=summer,
        width_m=keys.width_m or 1.0,
        height_m=keys.height_m or 1.0,
        tilt_deg=keys.tilt_deg,
    )
    return built.bsdf, built, found, made.sources


def _result(rated: Rated, heat: WindowHeat | None, edition: str) -> dict[str, Any]:
    found: dict[str, Any] = {
        "name": rated.name,
        "optics": [vars(o) for o in rated.optics],
        "cut_off": {"angle_deg": rated.cut_off.angle_deg, "words": rated.cut_off.words},
        "g_total": {where: {k: t.g for k, t in by.items()} for where, by in rated.g.items()},
        "quantities": rated.quantities,
        "edition": edition,
        "classes": {r.criterion: {"class": r.number, "words": r.words} for r in rated.ratings},
        "doubts": list(rated.doubts),
    }
    if heat is not None:
        found["heat"] = {
            "u_w_m2k": heat.u,
            "g": heat.g,
            "g_diffuse": heat.diffuse,
            "winter": heat.winter.name,
            "summer": heat.summer.name,
            "inward_fractions": heat.gain.inward,
            "temperatures_c": heat.gain.balance.temperatures_c,
            "by_patch": {"basis": heat.basis.name, "shgc": heat.gain.shgc, "transmittance": heat.gain.transmitted},
            "assumed": list(heat.assumed),
        }
    return found


def _tell(rated: Rated, heat: WindowHeat | None, product: str) -> None:
    say(rated.name)
    for text in (*rated.doubts, *(heat.assumed if heat is not None else ())):
        warn(product, text)
    rows = [
        [
            f"{o.band}, {o.scatter} from the {o.side}",
            *(f"{v:.3f}" for v in (o.normal_hemispherical, o.normal_normal, o.normal_diffuse, o.diffuse_hemispherical)),
        ]
        for o in rated.optics
    ]
    say(table(["", "n-h", "n-n", "n-dif", "dif-h"], rows))
    say(f"\n  {rated.cut_off_words}")
    if heat is not None:
        say(f"\n  U {heat.u:.2f} W/(m² K) ({heat.winter.name}), g {heat.g:.3f}, for diffuse light {heat.diffuse:.3f}")
    if rated.g:
        letters = list(next(iter(rated.g.values())))
        rows = [[where, *(f"{by[letter].g:.3f}" for letter in letters)] for where, by in rated.g.items()]
        say("\n" + table(["g with reference glazing", *letters], rows))
    say("")
    for r in rated.ratings:
        say(f"  {r.criterion}: {'–' if r.number is None else r.number}  {r.words}")
