"""How often illuminances occur: a histogram, and the share of hours with at least so much."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.annual.frequencies import cumulated, histogram
from clerestory.plot import style

if TYPE_CHECKING:
    from collections.abc import Mapping

    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike, NDArray


@style.styled
def occurrence(
    values: Mapping[str, ArrayLike],
    hours: ArrayLike,
    *,
    label: str = "vertical illuminance at the eye [lx]",
    edges: ArrayLike | None = None,
    title: str = "",
) -> Figure:
    """Hours in bins, and the share of the hours with at least each value, of several data sets.

    As figures 68 and 76 of the report of IEA SHC Task 61 (2021, C.2.2).

    Parameters
    ----------
    values
        By step (n,), by data set.
    hours
        Hours that each step counts for (n,) [h].
    label
        What they are, with their unit.
    edges
        Of the bins; a dozen and a half equal ones up to what 0.5 % of the hours exceed by default. The last bin holds
        what lies above it.
    title
        Of the picture.
    """
    if not values:
        raise ClerestoryError("no data set was given (give at least one)")
    table = np.stack([np.asarray(v, dtype=np.float64) for v in values.values()], axis=-1)
    limits = _edges(table[np.asarray(hours) > 0.0]) if edges is None else np.asarray(edges, dtype=np.float64)
    counts = histogram(table, hours, limits)
    levels = np.linspace(limits[0], limits[-1], 400)
    shares = 100.0 * cumulated(table, hours, levels)
    rows = style.columns(values, 7.6)[1]
    figure = style.new_figure(9.6, 3.9 + 0.2 * rows)
    left, right = figure.subplots(1, 2)
    for k, name in enumerate(values):
        look = style.line(k)
        left.stairs(counts[:, k], limits, label=name, **look, linewidth=1.4, baseline=None)
        right.plot(levels, shares[:, k], label=name, **look)
    for ax in (left, right):
        ax.set_xlim(limits[0], limits[-1])
        ax.set_xlabel(label)
        ax.grid()
        ax.set_axisbelow(True)
        for edge in ("top", "right"):
            ax.spines[edge].set_visible(False)
    left.set_ylim(bottom=0.0)
    right.set_ylim(0.0, 100.0)
    width = style.figures(float(limits[1] - limits[0]))
    even = np.ptp(np.diff(limits)) < 1e-9 * limits[-1]
    left.set_ylabel(f"hours in bins of {width}" if even else "hours in a bin")
    right.set_ylabel("share of the hours with at least so much [%]")
    beyond = float(counts[-1].sum()) > 0.0 and float(table.max()) > limits[-1]
    left.set_title(
        "occurrence" + (f" (last bin: all above {style.figures(float(limits[-2]))})" if beyond else ""), loc="left"
    )
    right.set_title("cumulated", loc="left")
    handles, labels = right.get_legend_handles_labels()
    if len(labels) > 1:
        figure.legend(handles, labels, loc="outside lower center", ncols=style.columns(labels, 9.0)[0])
    if title:
        figure.suptitle(title, x=0.01, ha="left", fontsize=10)
    return figure


def _edges(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Round edges from 0 to what 0.5 % of the values exceed."""
    top = float(np.quantile(values, 0.995)) if values.size else 1.0
    rough = max(top, 1e-9) / 18.0
    decade = 10.0 ** np.floor(np.log10(rough))
    width = next(m * decade for m in (1.0, 2.0, 2.5, 5.0, 10.0) if m * decade >= rough - 1e-12)
    edges: NDArray[np.float64] = np.arange(int(np.ceil(top / width)) + 1) * width
    return edges
