"""Shares of hours in classes, as stacked bars of several data sets."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.plot import style

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike

COLOURS = ("#e8eef4", "#f2b84b", "#d1543b", "#5b1745")
"""From harmless to bad; each is darker than the one before, so that they are told apart in grey, too."""
_HATCHES = ("", "", "////", "")
_LEGIBLE = 4.0
"""Per cent of the hours from which on a part of a bar has its number."""


@style.styled
def class_bars(
    shares: Mapping[str, ArrayLike],
    names: Sequence[str],
    *,
    ranges: Sequence[str] = (),
    title: str = "",
    ylabel: str = "share of the hours [%]",
    focus: bool = False,
    ax: Axes | None = None,
) -> Figure:
    """One bar a data set, stacked by class from the worst at the foot to the harmless.

    As figures 69 to 72 and 77 to 80 of the report of IEA SHC Task 61 (2021, C.2.2) show glare.

    Parameters
    ----------
    shares
        Share of the hours in each class (classes,), 0 to 1, by data set; NaN for a data set that is not known.
    names, ranges
        Of the classes: words, and the values that they stand for.
    title
        Of the picture.
    ylabel
        What a bar's height is.
    focus
        End the axis a little above the tallest bar of all but the harmless class, whose part is then cut off; rare
        glare is seen so.
    ax
        Axes to draw on; a new figure by default.
    """
    if not shares:
        raise ClerestoryError("no data set was given (give at least one)")
    if not 2 <= len(names) <= len(COLOURS):
        raise ClerestoryError(f"{len(names)} classes cannot be shown (give 2 to {len(COLOURS)})")
    table = 100.0 * np.array([np.asarray(s, dtype=np.float64) for s in shares.values()])
    if table.shape != (len(shares), len(names)):
        raise ClerestoryError(f"shares {table.shape[1:]} do not go with {len(names)} classes (give one a class)")
    longest = max(len(name) for name in shares)
    slanted = longest > 9 and len(shares) > 3
    if ax is None:
        figure = style.new_figure(min(16.0, max(5.2, 1.2 + 0.72 * len(shares))), 4.3 + 0.05 * longest * slanted)
        ax = figure.add_subplot()
    known = np.isfinite(table).all(axis=1)
    at = np.arange(len(shares))
    foot = np.zeros(len(shares))
    top = 100.0
    if focus:
        most = float(np.nanmax(table[:, 1:].sum(axis=1), initial=0.0))
        top = min(100.0, max(5.0, 5.0 * np.ceil(1.15 * most / 5.0)))
    for k in reversed(range(len(names))):
        heights = np.where(known, table[:, k], 0.0)
        text = f"{names[k]} ({ranges[k]})" if ranges else names[k]
        ax.bar(
            at, heights, 0.72, foot, label=text, color=COLOURS[k], edgecolor=style.INK, linewidth=0.5, hatch=_HATCHES[k]
        )
        for x, low, height in zip(at.tolist(), foot.tolist(), heights.tolist(), strict=True):
            upper = min(low + height, top)
            if upper - low >= _LEGIBLE * top / 100.0:
                ax.text(
                    x,
                    (low + upper) / 2.0,
                    f"{height:.1f}" if height < 10.0 else f"{height:.0f}",
                    ha="center",
                    va="center",
                    fontsize=7,
                    color=style.INK if k < 2 else "white",
                    bbox={"facecolor": COLOURS[k], "edgecolor": "none", "pad": 0.8},
                )
        foot += heights
    if (~known).any():
        ax.bar(at[~known], np.full((~known).sum(), top), 0.72, **style.MISSING)
    # Few bars stay as slim as many are.
    margin = max(0.6, 0.5 * (6 - len(shares)))
    ax.set_xlim(-margin, len(shares) - 1 + margin)
    ax.set_ylim(0.0, top)
    ax.set_xticks(at, list(shares), rotation=30 if slanted else 0, ha="right" if slanted else "center")
    ax.tick_params(axis="x", length=0)
    ax.set_ylabel(ylabel if top == 100.0 else f"{ylabel}, cut off at {top:g} %")
    ax.set_title(title, loc="left")
    ax.grid(axis="y")
    ax.set_axisbelow(True)
    for edge in ("top", "right"):
        ax.spines[edge].set_visible(False)
    figure = style.figure_of(ax)
    handles, labels = ax.get_legend_handles_labels()
    # The order of the stack: what is on top stands first.
    across, _ = style.columns(labels, 0.9 * float(figure.get_figwidth()))
    figure.legend(handles, labels, loc="outside lower center", ncols=min(across, 4))
    return figure
