"""Pictures of a comparison of photographs with renderings."""

from __future__ import annotations

from typing import TYPE_CHECKING

import matplotlib.ticker
import numpy as np
from matplotlib.colors import LogNorm

from clerestory._core import ClerestoryError
from clerestory.photo.resample import SeenBy, resample
from clerestory.plot.style import COLOURS, INK, colours, difference_colours, extend, figures, new_figure, norm, styled

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from clerestory.photo.agreement import Agreement
    from clerestory.picture.image import Picture

MOST_RATIO = 8.0
"""Ends of the scale of the ratio: this and its reciprocal."""
DARK = 1e-3
"""Share of the mean luminance below which a pixel is too dark for a ratio."""
_MARKS = ("o", "s", "^", "D", "v", "P", "X")
_NAMES = {"illuminance": "E_v [lx]", "dgp": "DGP", "dgi": "DGI"}
_SIZE = 3.3
_UNKNOWN = "#d0d0d0"


def words_of(quantity: str) -> str:
    """A quantity with its unit: E_v [lx], DGP, luminance up [cd/m²]."""
    return _NAMES.get(quantity, f"{quantity} [cd/m²]")


@styled
def scatter(agreements: Sequence[Agreement]) -> Figure:
    """Renderings over photographs: a panel for each index, and one for the luminances of all regions."""
    panels = [[a] for a in agreements if a.quantity in _NAMES]
    luminances = [a for a in agreements if a.quantity not in _NAMES]
    if luminances:
        panels.append(luminances)
    if not panels:
        raise ClerestoryError("there is nothing to draw (give cases)")
    across = min(2, len(panels))
    down = -(-len(panels) // across)
    figure = new_figure(_SIZE * across + 0.2, _SIZE * down + 0.1)
    axes = figure.subplots(down, across, squeeze=False)
    for ax, panel in zip(axes.flat, panels, strict=False):
        _panel(ax, panel)
    for ax in axes.flat[len(panels) :]:
        ax.set_visible(False)
    return figure


def _panel(ax: Axes, panel: Sequence[Agreement]) -> None:
    values = np.array([v for a in panel for v in (*a.photo, *a.rendering)])
    positive = bool((values > 0.0).all())
    wide = positive and panel[0].quantity not in ("dgp", "dgi") and values.max() > 5.0 * values.min()
    low, high = float(values.min()), float(values.max())
    if wide:
        low, high = low / 1.25, high * 1.25
        ax.set_xscale("log")
        ax.set_yscale("log")
    else:
        margin = 0.07 * (high - low) or 0.1 * abs(high) or 1.0
        low, high = low - margin, high + margin
    ax.plot([low, high], [low, high], color="#7a7a7a", linewidth=0.8, zorder=1)
    for number, a in enumerate(panel):
        ax.plot(
            a.photo,
            a.rendering,
            linestyle="none",
            marker=_MARKS[number % len(_MARKS)],
            markersize=4.2,
            markerfacecolor=COLOURS[number % len(COLOURS)],
            markeredgecolor="white",
            markeredgewidth=0.4,
            label=a.quantity.removeprefix("luminance "),
            zorder=3,
        )
        apart = {o.label for o in a.outliers}
        at = [k for k, name in enumerate(a.cases) if name in apart]
        ax.plot(
            [a.photo[k] for k in at],
            [a.rendering[k] for k in at],
            linestyle="none",
            marker="o",
            markersize=9.0,
            markerfacecolor="none",
            markeredgecolor=INK,
            markeredgewidth=0.9,
            zorder=4,
        )
    ax.set_xlim(low, high)
    ax.set_ylim(low, high)
    if wide and high / low < 50.0:
        for axis in (ax.xaxis, ax.yaxis):
            axis.set_major_locator(matplotlib.ticker.LogLocator(subs=(1.0, 2.0, 5.0)))
            axis.set_minor_locator(matplotlib.ticker.NullLocator())
    if wide:
        for axis in (ax.xaxis, ax.yaxis):
            axis.set_major_formatter(matplotlib.ticker.FuncFormatter(lambda value, _: figures(float(value))))
    ax.set_aspect("equal")
    ax.grid(visible=True)
    ax.set_axisbelow(True)
    if len(panel) == 1:
        name, a = words_of(panel[0].quantity), panel[0]
        line = f"n = {a.count}"
        if a.correlation is not None and a.determination is not None:
            line += f",  R² = {a.correlation:.3f},  about 1:1 {a.determination:.3f}"
    else:
        name, line = "luminance [cd/m²]", "means of regions"
        ax.legend(loc="upper left", handletextpad=0.1, borderaxespad=0.2)
    symbol = name.replace("E_v", "$E_\\mathrm{v}$")
    ax.set_title(line, fontsize=8.5)
    ax.set_xlabel(f"{symbol}, photograph")
    ax.set_ylabel(f"{symbol}, rendering")


@styled
def pair(photo: Picture, rendering: Picture, *, title: str | None = None) -> Figure:
    """A photograph and a rendering in false colours on one scale, and the ratio of their luminances.

    Parameters
    ----------
    photo, rendering
        Fisheyes. They are laid on each other along their lines of sight; a rendering of another size or projection is
        laid out as the photograph.
    title
        Over the picture.
    """
    a = photo.luminance.astype(np.float64)
    b = matched(rendering, photo).astype(np.float64)
    # A sun of a few pixels would take all colours from the room.
    both = np.stack([a, b])
    scale = norm(np.minimum(both, max(float(np.percentile(both, 99.9)), 1e-9)), "log")
    figure = new_figure(9.6, 3.7)
    left, middle, right = figure.subplots(1, 3)
    shown = [ax.imshow(v, norm=scale, cmap=colours(), interpolation="nearest") for ax, v in ((left, a), (middle, b))]
    ratio = luminance_ratio(a, b)
    third = right.imshow(
        ratio,
        norm=LogNorm(1.0 / MOST_RATIO, MOST_RATIO),
        cmap=difference_colours().with_extremes(bad=_UNKNOWN),
        interpolation="nearest",
    )
    for ax, name in ((left, "photograph"), (middle, "rendering"), (right, "rendering / photograph")):
        ax.set_title(name)
        ax.axis("off")
    figure.colorbar(
        shown[0],
        ax=[left, middle],
        label="luminance [cd/m²]",
        extend=extend(both, scale),
        orientation="horizontal",
        fraction=0.07,
        aspect=40,
    )
    bar = figure.colorbar(
        third, ax=right, label="ratio of luminances", extend="both", orientation="horizontal", fraction=0.07, aspect=20
    )
    bar.set_ticks([0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0], labels=["1/8", "1/4", "1/2", "1", "2", "4", "8"])
    bar.minorticks_off()
    if title:
        figure.suptitle(title, fontsize=10)
    return figure


def matched(rendering: Picture, photo: Picture) -> NDArray[np.float32]:
    """Luminance [cd/m²] of a rendering, pixel by pixel where the photograph has it in its own frame."""
    ours, theirs = rendering.view, photo.view
    if ours is None or theirs is None:
        raise ClerestoryError("a picture does not say what it shows (give both a view)")
    if ours.projection == theirs.projection and rendering.shape == photo.shape and ours.size_deg == theirs.size_deg:
        return rendering.luminance
    height, width = photo.shape
    return resample(rendering.luminance, SeenBy(ours, rendering.shape), theirs, (width, height))


def luminance_ratio(photo: NDArray[np.float64], rendering: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rendering over photograph (height, width); NaN where either is too dark."""
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = rendering / photo
    return np.where((photo > DARK * photo.mean()) & (rendering > DARK * rendering.mean()), ratio, np.nan)
