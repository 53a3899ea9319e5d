"""Bars of hemispherical, direct-hemispherical and direct-direct values by data set."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError, MissingDataError
from clerestory.basis import Basis
from clerestory.bsdf import Bsdf, Region
from clerestory.integrals import hemispherical, patch_directions
from clerestory.plot import style
from clerestory.plot.view import PATCHES, labelled, light
from clerestory.words import common_band

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from clerestory.directions import Scatter, Side
    from clerestory.plot.view import Light


@style.styled
def transmittance_bars(
    values: Mapping[str, Mapping[str, float]],
    *,
    title: str = "",
    ylabel: str = "transmittance",
    ax: Axes | None = None,
) -> Figure:
    """Groups of bars: one group a quantity, one bar a data set.

    As figures 41 and 42 of the report of IEA SHC Task 61 (2021, C.2.2) show them.

    Parameters
    ----------
    values
        Value [0 to 1] by data set and quantity. The quantities' names stand below the groups in the order of their
        first appearance: "T_h-h", or "T_d-h" with "30°" in a second line. One that a data set lacks, or that is
        NaN, is marked as missing.
    title
        Title of the picture.
    ylabel
        What the values are.
    ax
        Axes to draw on; a new figure by default.
    """
    if not values:
        raise ClerestoryError("no data set was given (give at least one)")
    quantities = list(dict.fromkeys(q for row in values.values() for q in row))
    count = len(values)
    width = 0.82 / count
    if ax is None:
        inches = max(6.0, 0.9 + len(quantities) * max(0.62, 0.13 * count))
        _, rows = style.columns(values, 0.85 * min(inches, 16.0))
        ax = style.new_figure(min(inches, 16.0), 3.5 + 0.18 * rows).add_subplot()
    top = max((v for row in values.values() for v in row.values() if np.isfinite(v)), default=0.0) or 1.0
    for n, (name, row) in enumerate(values.items()):
        heights = np.array([row.get(q, np.nan) for q in quantities], dtype=np.float64)
        at = np.arange(len(quantities)) + (n - 0.5 * (count - 1)) * width
        known = np.isfinite(heights)
        colour = style.COLOURS[n % len(style.COLOURS)]
        ax.bar(
            at[known],
            heights[known],
            width * 0.92,
            label=name,
            color=colour,
            alpha=0.85,
            edgecolor="white",
            linewidth=0.3,
            hatch=style.HATCHES[(n // len(style.COLOURS) + n) % len(style.HATCHES)] if n else "",
        )
        if (~known).any():
            # Missing is not zero: a hatched stub, as in all pictures.
            ax.bar(at[~known], np.full((~known).sum(), 0.03 * top), width * 0.92, **style.MISSING)
        if count <= 4:
            for x, h in zip(at[known], heights[known], strict=True):
                ax.text(x, h + 0.01 * top, f"{h:.3f}", rotation=90, fontsize=6.5, ha="center", va="bottom")
    ax.set_xticks(np.arange(len(quantities)), [_mathematical(q) for q in quantities])
    ax.tick_params(axis="x", length=0)
    ax.set_xlim(-0.5, len(quantities) - 0.5)
    ax.set_ylim(0.0, top * (1.22 if count <= 4 else 1.05))
    ax.set_ylabel(ylabel)
    ax.grid(axis="y")
    ax.set_axisbelow(True)
    for edge in ("top", "right"):
        ax.spines[edge].set_visible(False)
    ax.set_title(title)
    across, _ = style.columns(values, 0.85 * float(style.figure_of(ax).get_figwidth()))
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=across)
    return style.figure_of(ax)


def transmittances(
    sets: Bsdf | Mapping[str, Bsdf],
    patches: Iterable[int] = PATCHES,
    *,
    side: Side = "exterior",
    scatter: Scatter = "transmission",
    band: str | None = None,
) -> dict[str, dict[str, float]]:
    """Values for `transmittance_bars`: hemispherical, direct-hemispherical and direct-direct, by data set.

    A matrix on Klems' full basis answers by its own values. Other data are averaged over 16 directions of the incident
    patch; direct-direct is what leaves through the outgoing patch of the same number.

    Parameters
    ----------
    sets
        Data sets by label; one that lacks the component has NaN.
    patches
        Incident patches of Klems' full basis, from 1.
    side, scatter, band
        As for `hemisphere`.
    """
    klems, letter = Basis.named("klems-full"), "T" if scatter == "transmission" else "R"
    chosen = [light(int(n), side) for n in patches]
    table = {}
    data = labelled(sets)
    band = common_band(data, band)
    for name, bsdf in data.items():
        row = {f"{letter}_h-h": np.nan}
        row |= {_key(letter, part, source): np.nan for part in ("d-h", "d-d") for source in chosen}
        with suppress(MissingDataError):
            row[f"{letter}_h-h"] = hemispherical(bsdf, scatter, side=side, band=band).value
            for source in chosen:
                index = int(klems.index_of_incident(source.direction))
                directions = patch_directions(bsdf, index + 1, scatter, side=side, band=band)
                for part, region in (("d-h", None), ("d-d", Region.patches(klems, [index]))):
                    values = bsdf.integrate(directions, scatter, region, band)
                    row[_key(letter, part, source)] = float(np.mean(values))
        table[name] = row
    return table


def _key(letter: str, part: str, source: Light) -> str:
    return f"{letter}_{part}\n{source.theta_deg:.3g}° ({source.patch})"


def _mathematical(name: str) -> str:
    """T_d-h with its subscript lowered."""
    head, *rest = name.split("\n")
    symbol, mark, subscript = head.partition("_")
    if mark and len(symbol) == 1:
        subscript, _, tail = subscript.partition(" ")
        head = f"${symbol}_{{\\mathrm{{{subscript.replace('-', '‐')}}}}}$" + (f" {tail}" if tail else "")
    return "\n".join([head, *rest])
