"""Pictures of what was found: a camera's response."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory.photo.response import HIGHEST, LEVELS, LOWEST
from clerestory.plot.style import COLOURS, DASHES, new_figure, styled

if TYPE_CHECKING:
    from collections.abc import Mapping

    from matplotlib.figure import Figure

    from clerestory.photo.response import Response

# Red, green and blue that the colour-blind can tell, with dashes besides.
_CHANNELS = (("red", COLOURS[1]), ("green", COLOURS[2]), ("blue", COLOURS[0]))


@styled
def response_curves(responses: Mapping[str, Response]) -> Figure:
    """Light by level of one or more responses.

    Parameters
    ----------
    responses
        By their labels; that of a single one may be empty.
    """
    figure = new_figure(5.2, 3.8)
    ax = figure.add_subplot()
    levels = np.arange(LEVELS)
    for label, response in responses.items():
        for number, ((name, colour), curve) in enumerate(zip(_CHANNELS, response.curves, strict=True)):
            shown = curve > 0.0
            # Curves of one camera lie on each other: each is thinner than the one below it.
            ax.plot(
                levels[shown],
                curve[shown],
                color=colour,
                linestyle=DASHES[number],
                linewidth=2.6 - 0.7 * number,
                label=f"{label} {name}".strip(),
            )
    ax.axvspan(0, LOWEST, color="#e6e6e6", linewidth=0)
    ax.axvspan(HIGHEST, LEVELS - 1, color="#e6e6e6", linewidth=0, label="not used")
    ax.set_yscale("log")
    ax.set_ylim(max(ax.get_ylim()[0], 1e-5), 1.6)
    ax.set_xlim(0, LEVELS - 1)
    ax.set_xlabel("level")
    ax.set_ylabel("light, relative to green's highest")
    ax.grid(visible=True)
    ax.set_axisbelow(True)
    ax.legend(loc="lower right")
    return figure
