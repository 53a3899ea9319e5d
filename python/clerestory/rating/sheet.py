"""The data sheet of a product, as a document for HTML and PDF."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory import __version__
from clerestory.counts import counted
from clerestory.directions import angles
from clerestory.plot import disk, style
from clerestory.plot.hemisphere import paint
from clerestory.plot.hemisphere_grid import hemisphere_grid
from clerestory.plot.transmittance_map import transmittance_map
from clerestory.rating.classes import EFFECTS
from clerestory.report.document import Box, Cell, Document, Figure, Heading, Paragraph, Table
from clerestory.thermal.en_iso_52022 import REFERENCE_GLAZINGS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure as Drawing

    from clerestory.bsdf import Bsdf
    from clerestory.rating.classes import Edition
    from clerestory.rating.product import Rated
    from clerestory.report.document import Block
    from clerestory.system.heat import WindowHeat
    from clerestory.system.window import Built

_DPI = 130.0
_SYMBOLS = {"visible": "v", "solar": "e"}
_LETTERS = {"transmission": "τ", "reflection": "ρ"}


def sheet(
    rated: Rated, bsdf: Bsdf, limits: Edition, *, heat: WindowHeat | None = None, built: Built | None = None
) -> Document:
    """A sheet with what stands in `rated`, pictures of the data, and heat for a window.

    Parameters
    ----------
    rated
        The product.
    bsdf
        Its data, for the pictures.
    limits
        Edition that it was rated by.
    heat, built
        Of a window that was built of layers.
    """
    blocks: list[Block] = [Box("In short", tuple(_short(rated, heat)))]
    doubts = [*rated.doubts, *(heat.assumed if heat is not None else ())]
    if doubts:
        blocks.append(Box("Before the numbers are used", tuple(doubts), "note"))
    blocks += [Heading("Classes"), _classes(rated), Paragraph(f"Limits of the classes: {limits.source}.")]
    blocks += [Heading("Light"), _optics(rated), Paragraph(_found(rated))]
    if heat is not None and built is not None:
        blocks += [Heading("Heat"), *_heat(heat, built)]
    if rated.g:
        blocks += [Heading("Heat behind and before reference glazing"), _totals(rated)]
    blocks += [Heading("Pictures"), *_pictures(bsdf)]
    subtitle = " · ".join(text for text in (bsdf.metadata.manufacturer, f"Clerestory {__version__}") if text)
    return Document(rated.name, subtitle, __version__, tuple(blocks))


def _short(rated: Rated, heat: WindowHeat | None) -> list[str]:
    found = []
    through = rated.of("visible", "transmission")
    if through is not None:
        found.append(
            f"Of visible light along the normal {through.normal_hemispherical:.1%} passes: {through.normal_normal:.1%} "
            f"straight on, {through.normal_diffuse:.1%} scattered. Of evenly diffuse light "
            f"{through.diffuse_hemispherical:.1%} passes."
        )
    if heat is not None:
        found.append(f"U is {heat.u:.2f} W/(m² K) ({heat.winter.name}), g is {heat.g:.3f} ({heat.summer.name}).")
    elif "g_tot" in rated.quantities:
        found.append(f"g with the glazing that it is rated with is {rated.quantities['g_tot']:.3f}.")
    known = [r for r in rated.ratings if r.number is not None]
    found.append(f"{counted(len(known), 'class', 'classes')} of {len(rated.ratings)} could be given.")
    return found


def _classes(rated: Rated) -> Table:
    rows = tuple(
        (
            Cell(r.criterion),
            Cell(r.words),
            Cell("–" if r.number is None else str(r.number), r.number),
        )
        for r in rated.ratings
    )
    return Table(f"Classes from 0, {EFFECTS[0]}, to 4, {EFFECTS[-1]}", ("criterion", "effect", "class"), rows, 2)


def _optics(rated: Rated) -> Table:
    rows = []
    for o in rated.optics:
        name = f"{_LETTERS[o.scatter]}_{_SYMBOLS.get(o.band, o.band)}, from the {o.side}"
        values = (o.normal_hemispherical, o.normal_normal, o.normal_diffuse, o.diffuse_hemispherical)
        rows.append((Cell(name), *(Cell(f"{v:.3f}", v) for v in values)))
    heads = ("", "normal-hemispherical", "normal-normal", "normal-diffuse", "diffuse-hemispherical")
    return Table("Transmittance τ and reflectance ρ, visible (v) and solar (e)", heads, tuple(rows))


def _found(rated: Rated) -> str:
    by_side = {o.scatter: o.words for o in rated.optics}
    ways = "; ".join(f"{scatter}: {words}" for scatter, words in by_side.items())
    return f"{rated.cut_off_words}. Values by {ways}."


def _heat(heat: WindowHeat, built: Built) -> list[Block]:
    gain = heat.gain
    rows = tuple(
        (
            Cell(f"{k}. {name}"),
            Cell(f"{gain.absorbed[k - 1, 0]:.3f}", float(gain.absorbed[k - 1, 0])),
            Cell(f"{gain.inward[k - 1]:.3f}", float(gain.inward[k - 1])),
            *(Cell(f"{t:.1f}", float(t)) for t in gain.balance.temperatures_c[k - 1]),
        )
        for k, name in enumerate(built.layers, 1)
    )
    heads = ("layer", "absorbed along the normal", "flows inward", "exterior face [°C]", "interior face [°C]")
    return [
        Paragraph(
            f"Centre of glass, by ISO 15099. U = {heat.u:.2f} W/(m² K) between {heat.winter.outdoor_c:g} and "
            f"{heat.winter.indoor_c:g} °C. For the sun along the normal g = {heat.g:.3f}, of which "
            f"{gain.transmitted[0]:.3f} is light and {gain.secondary[0]:.3f} heat; for evenly diffuse light g = "
            f"{heat.diffuse:.3f}."
        ),
        Table(f"Layers in the sun of {heat.summer.irradiance:g} W/m² ({heat.summer.name})", heads, rows),
        _figure(
            gain_map(heat),
            "Solar heat gain coefficient by direction of the sun",
            "Falsecolour disk of the solar heat gain coefficient over all directions of incidence.",
        ),
    ]


def _totals(rated: Rated) -> Table:
    rows = tuple(
        (
            Cell(f"{letter}: {pane.name}"),
            Cell(f"{pane.u:.1f}", pane.u),
            Cell(f"{pane.g:.2f}", pane.g),
            *(Cell(f"{by[letter].g:.3f}", by[letter].g, "; ".join(by[letter].doubts)) for by in rated.g.values()),
        )
        for letter, pane in REFERENCE_GLAZINGS.items()
    )
    heads = ("glazing", "U [W/(m² K)]", "g", *rated.g)
    return Table("Total g with the device, by EN ISO 52022-1", heads, rows)


def _pictures(bsdf: Bsdf) -> list[Block]:
    return [
        _figure(
            hemisphere_grid(bsdf, band="visible"),
            "Where light from above goes that comes at 0, 30, 50 and 70° (BSDF, visible)",
            "Falsecolour hemispheres of transmitted light for four angles of incidence.",
        ),
        _figure(
            transmittance_map(bsdf, band="visible"),
            "Visible transmittance by the direction that light comes from",
            "Falsecolour disk of direct-hemispherical transmittance.",
        ),
    ]


def _figure(made: Drawing, caption: str, alt: str) -> Figure:
    return Figure(caption, alt, style.render(made, ".png", dpi=_DPI))


@style.styled
def gain_map(heat: WindowHeat) -> Drawing:
    """Solar heat gain coefficient in falsecolour, each direction where the sun stands, as seen from the room."""
    axes = style.new_figure(6.0, 5.4).add_subplot()
    seen = disk.pixels(360, "exterior", "polar")
    known = np.isfinite(seen).all(axis=-1)
    values = np.full(known.shape, np.nan)
    values[known] = heat.gain.shgc[heat.basis.index_of_incident(seen[known])]
    norm = style.norm(values, "linear")
    image = paint(axes, values, norm)
    disk.frame(axes, "polar", words=disk.INCIDENT_WORDS)
    axes.set_title(f"{heat.basis.name}\nincident directions, as seen from the room")
    figure = style.figure_of(axes)
    bar = figure.colorbar(image, ax=axes, shrink=0.82, pad=0.02, extend=style.extend(values, norm))
    bar.set_label("solar heat gain coefficient [–]")
    return figure


def directions(heat: WindowHeat) -> Sequence[dict[str, float]]:
    """Solar heat gain by patch, a row each: angles of its middle [°], SHGC, what passes, what each layer absorbs."""
    thetas, phis = angles(heat.basis.incident_centres("exterior"))
    return [
        {
            "patch": float(k + 1),
            "theta_deg": float(theta),
            "phi_deg": float(phi),
            "shgc": float(heat.gain.shgc[k]),
            "transmittance": float(heat.gain.transmitted[k]),
        }
        | {f"absorptance_{n + 1}": float(a) for n, a in enumerate(heat.gain.absorbed[:, k])}
        for k, (theta, phi) in enumerate(zip(thetas, phis, strict=True))
    ]
