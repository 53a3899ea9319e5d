"""One look for all pictures, and files that are the same byte for byte.

Matplotlib's settings are changed for the time of a call only, and start from its defaults, so that a picture depends
neither on a person's own style nor changes it.
"""

from __future__ import annotations

from functools import wraps
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, ParamSpec, TypeVar

import matplotlib.patheffects as effects
import matplotlib.style
import numpy as np
from matplotlib import colormaps
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure

from clerestory._core import ClerestoryError
from clerestory.whole import write_whole

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Iterable, Sequence
    from contextlib import AbstractContextManager

    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.colors import Colormap
    from matplotlib.image import AxesImage
    from matplotlib.lines import Line2D
    from numpy.typing import ArrayLike, NDArray

P = ParamSpec("P")
R = TypeVar("R")
Scale = Literal["log", "linear"]
Quantity = Literal["bsdf", "dsf"]

SUFFIXES = (".png", ".pdf", ".svg")
UNITS: dict[Quantity, str] = {"bsdf": "BSDF [1/sr]", "dsf": "DSF = BSDF·cos θ [1/sr]"}
DECADES = 4
"""A logarithmic colour scale reaches this far down from the largest value, or to the smallest that there is."""

MISSING: dict[str, Any] = {"facecolor": "#e6e6e6", "edgecolor": "#b0b0b0", "hatch": "////", "linewidth": 0.0}
INK = "#222222"
# Okabe and Ito's colours (2008, "Color universal design") in an order of falling contrast, without the yellow, which
# vanishes on white. Together with the dashes, 28 lines are distinct; dashes alone tell 4 neighbours apart in grey.
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#000000", "#cc79a7", "#56b4e9", "#e69f00")
DASHES = ("-", (0, (5, 1.5)), (0, (1.2, 1.2)), (0, (6, 1.5, 1.2, 1.5)))
HATCHES = ("", "////", "....", "xxxx", "\\\\\\\\", "----", "++++")

_SETTINGS: dict[str, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 9,
    "axes.titlesize": 9.5,
    "axes.labelsize": 9,
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
    "legend.fontsize": 8,
    "legend.frameon": False,
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "text.color": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "axes.linewidth": 0.7,
    "axes.grid": False,
    "grid.color": "#d0d0d0",
    "grid.linewidth": 0.5,
    "hatch.linewidth": 0.5,
    "lines.linewidth": 1.4,
    "figure.constrained_layout.h_pad": 0.06,
    "figure.constrained_layout.w_pad": 0.06,
    "svg.fonttype": "path",
    "svg.hashsalt": "clerestory",
    "pdf.fonttype": 42,
}
_METADATA: dict[str, dict[str, Any]] = {
    ".png": {"Software": "Clerestory"},
    ".pdf": {"Creator": "Clerestory", "Producer": "Clerestory", "CreationDate": None},
    ".svg": {"Creator": "Clerestory", "Date": None},
}


def settings() -> AbstractContextManager[None]:
    """Matplotlib's defaults with the settings of this file, until the context is left."""
    return matplotlib.style.context(["default", _SETTINGS])


def styled(function: Callable[P, R]) -> Callable[P, R]:
    """Makes a function draw with `settings`."""

    @wraps(function)
    def inside(*args: P.args, **kwargs: P.kwargs) -> R:
        with settings():
            return function(*args, **kwargs)

    return inside


def new_figure(width: float, height: float, *, constrained: bool = True) -> Figure:
    """An empty figure [inches] that no window knows of."""
    figure = Figure(figsize=(width, height), layout="constrained" if constrained else None)
    FigureCanvasAgg(figure)
    return figure


def figure_of(ax: Axes) -> Figure:
    """The figure that axes are in, however deep."""
    parent: Any = ax.figure
    while not isinstance(parent, Figure):
        parent = parent.figure
    return parent


def colours() -> Colormap:
    """Perceptually uniform colours that the colour-blind can order; what lies under a scale is nearly black."""
    return colormaps["viridis"].with_extremes(under="#1c0022", bad=(0.0, 0.0, 0.0, 0.0))


def difference_colours() -> Colormap:
    """Colours for values on both sides of 0."""
    return colormaps["PuOr_r"].with_extremes(bad=(0.0, 0.0, 0.0, 0.0))


class FlooredLogNorm(LogNorm):
    """A logarithmic scale on which zero lies below the lower end: it is known to be dark, not unknown."""

    def __call__(self, value: Any, clip: bool | None = None) -> Any:  # noqa: ANN401, FBT001 (matplotlib's signature)
        """Place on the scale, 0 to 1; NaN stays masked."""
        v = np.ma.masked_invalid(np.ma.asarray(value, dtype=np.float64))
        return super().__call__(np.ma.maximum(v, 1e-3 * float(self.vmin or 1.0)), clip)


def norm(values: ArrayLike, scale: Scale, limits: tuple[float, float] | None = None) -> Normalize:
    """A scale for values; not finite ones do not count.

    Parameters
    ----------
    values
        All values that the scale is for.
    scale
        Linear from 0 to the largest value, or logarithmic over `DECADES` at most.
    limits
        Ends of the scale; found from the values by default.
    """
    if scale not in ("log", "linear"):
        raise ClerestoryError(f"scale {scale!r} is not known (give log or linear)")
    v = np.asarray(values, dtype=np.float64)
    v = v[np.isfinite(v)]
    top = float(v.max()) if v.size and v.max() > 0.0 else 1.0
    if scale == "linear":
        low, high = limits if limits is not None else (0.0, top)
    else:
        positive = v[v > 0.0]
        least = float(positive.min()) if positive.size else top / 10.0
        floor = max(least, top * 10.0**-DECADES)
        # A constant has a scale of one decade, and stands at its upper end.
        low, high = limits if limits is not None else (min(floor, top / 10.0), top)
        if low <= 0.0:
            raise ClerestoryError(f"a logarithmic scale cannot begin at {low:g} (give limits above 0)")
    if not low < high:
        raise ClerestoryError(f"a scale cannot reach from {low:g} to {high:g} (give the lower limit first)")
    return FlooredLogNorm(low, high) if scale == "log" else Normalize(low, high)


def mappable(scale: Normalize) -> ScalarMappable:
    """What a colour bar needs when no single picture stands for the scale."""
    return ScalarMappable(scale, colours())


def extend(values: ArrayLike, scale: Normalize) -> Literal["neither", "min", "max", "both"]:
    """Which ends of a colour bar have values beyond them."""
    v = np.asarray(values, dtype=np.float64)
    v = v[np.isfinite(v)]
    low, high = float(scale.vmin or 0.0), float(scale.vmax or 0.0)
    slack = 1e-9 * (high - low)
    below, above = bool(np.any(v < low - slack)), bool(np.any(v > high + slack))
    if below:
        return "both" if above else "min"
    return "max" if above else "neither"


def cross(ax: Axes, point: NDArray[np.float64], label: str = "", *, size: float = 8.0) -> Line2D:
    """A small cross about a point of a picture, on any colour; open in the middle, so that a beam there is seen."""
    from matplotlib.path import Path

    arms = [((0.5 * x, 0.5 * y), (x, y)) for x, y in ((1, 0), (0, 1), (-1, 0), (0, -1))]
    reticle = Path([end for arm in arms for end in arm], [Path.MOVETO, Path.LINETO] * len(arms))
    (mark,) = ax.plot(
        *point,
        marker=reticle,
        markersize=2.0 * size,
        markeredgewidth=1.2,
        color=INK,
        linestyle="none",
        label=label,
        zorder=6,
        path_effects=[effects.withStroke(linewidth=2.4, foreground="white")],
    )
    return mark


def legend_below(ax: Axes, handles: Sequence[Artist], title: str, *, low: float = 0.02) -> None:
    """A legend under a plot, at a height of its axes."""
    ax.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, low), title=title, title_fontsize=8)


def square_image(ax: Axes, values: NDArray[np.float64], half: float, scale: Normalize) -> AxesImage:
    """Values as a square of false colours that reaches `half` to each side; hatched where there are none."""
    ax.set_facecolor(MISSING["facecolor"])
    ax.patch.set(hatch=MISSING["hatch"], edgecolor=MISSING["edgecolor"], linewidth=0.0)
    return ax.imshow(
        values,
        origin="lower",
        extent=(-half, half, -half, half),
        interpolation="nearest",
        cmap=colours(),
        norm=scale,
    )


def line(index: int) -> dict[str, Any]:
    """Colour and dashes of the n-th line of a picture."""
    return {"color": COLOURS[index % len(COLOURS)], "linestyle": DASHES[index % len(DASHES)]}


def columns(labels: Iterable[str], inches: float) -> tuple[int, int]:
    """Columns and rows of a legend that is no wider than so many inches."""
    names = list(labels)
    widest = 0.55 + 0.068 * max((len(name) for name in names), default=1)
    across = max(1, min(len(names), int(inches / widest)))
    return across, -(-len(names) // across)


def figures(value: float, digits: int = 3) -> str:
    """A number with so many significant figures and no exponent where it can be read without."""
    if value == 0.0:
        return "0"
    text = f"{value:.{digits}g}"
    if "e" in text and abs(value) >= 1.0:
        return f"{float(text):.0f}"
    return text


def suffix_of(path: str | os.PathLike[str]) -> str:
    """The format that the name of a picture asks for.

    Raises
    ------
    ClerestoryError
        It is not .png, .pdf or .svg.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in SUFFIXES:
        what = f"ends in {suffix}, which is not known" if suffix else "has no suffix"
        raise ClerestoryError(f"{path}: the name of a picture {what} (give .png, .pdf or .svg)")
    return suffix


def render(figure: Figure, suffix: str, *, dpi: float = 160) -> bytes:
    """A picture as the bytes of a file; the same picture gives the same bytes.

    Parameters
    ----------
    suffix
        .png, .pdf or .svg.
    dpi
        Resolution of a PNG file, and of falsecolour in the others [pixels an inch].
    """
    if not 10 <= dpi <= 2400:
        raise ClerestoryError(f"{dpi:g} pixels an inch are not possible (give 10 to 2400)")
    buffer = BytesIO()
    with settings():
        figure.savefig(buffer, format=suffix[1:], dpi=dpi, metadata=_METADATA[suffix])
    return buffer.getvalue()


def save(figure: Figure, path: str | os.PathLike[str], *, dpi: float = 160) -> None:
    """Writes a picture whole or not at all; the same picture gives the same bytes.

    Parameters
    ----------
    figure
        What a function of this package returned.
    path
        Name ending in .png, .pdf or .svg.
    dpi
        Resolution of a PNG file, and of falsecolour in the others [pixels an inch].

    Raises
    ------
    ClerestoryError
        The name ends otherwise.
    """
    write_whole(path, render(figure, suffix_of(path), dpi=dpi))
