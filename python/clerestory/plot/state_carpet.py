"""States of windows over the year: a carpet for each group of windows."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.patches import Patch

from clerestory._core import ClerestoryError
from clerestory.plot import style
from clerestory.plot.carpet import carpet

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from clerestory.plot.carpet import SunHours


@style.styled
def state_carpets(
    states: Mapping[str, NDArray[np.int64]],
    names: Sequence[str],
    times: NDArray[np.datetime64],
    step: float,
    *,
    sun: SunHours | None = None,
    title: str = "",
) -> Figure:
    """Which state windows are in, by day and hour: bright is open, dark is closed.

    Parameters
    ----------
    states
        Number of the state at each step (n,), by group of windows.
    names
        Of the states, the most open one first.
    times, step, sun
        As for `carpet`.
    title
        Of the picture.
    """
    if not states:
        raise ClerestoryError("no group of windows was given (give at least one)")
    count = len(names)
    # Light yellow to dark blue: ordered for the colour-blind, and in grey.
    shades = style.colours()(np.linspace(1.0, 0.0, count))
    cmap, norm = ListedColormap(list(shades)), BoundaryNorm(np.arange(count + 1) - 0.5, count)
    columns, rows = style.columns(names, 7.0)
    figure = style.new_figure(7.6, 0.55 + 2.3 * len(states) + 0.2 * rows)
    axes = figure.subplots(len(states), 1, squeeze=False)[:, 0]
    for ax, (group, numbers) in zip(axes, states.items(), strict=True):
        carpet(ax, times, numbers, step, norm, cmap=cmap, sun=sun)
        ax.set_title(group, loc="left")
    patches = [Patch(facecolor=shade, label=name) for shade, name in zip(shades, names, strict=True)]
    figure.legend(handles=patches, loc="outside lower left", ncols=columns)
    if title:
        figure.suptitle(title, x=0.01, ha="left", fontsize=10)
    return figure
