"""Bars of hemispherical, direct-hemispherical and direct-direct values by data set."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.plot import style

if TYPE_CHECKING:
    from collections.abc import Mapping

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


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
        ax = style.new_figure(min(inches, 16.0), 3.6 + 0.17 * (-(-count // 4))).add_subplot()
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
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=min(count, 4))
    return style.figure_of(ax)


def _mathematical(name: str) -> str:
    """T_d-h with its subscript lowered."""
    head, *rest = name.split("\n")
    symbol, mark, subscript = head.partition("_")
    if mark and len(symbol) == 1:
        subscript, _, tail = subscript.partition(" ")
        head = f"${symbol}_{{\\mathrm{{{subscript.replace('-', '‐')}}}}}$" + (f" {tail}" if tail else "")
    return "\n".join([head, *rest])
