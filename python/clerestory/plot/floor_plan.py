"""Values over the floor of a room, as falsecolour."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.patches import Polygon

from clerestory._core import ClerestoryError
from clerestory.plot import style

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from matplotlib.axes import Axes
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure
    from matplotlib.image import AxesImage
    from numpy.typing import ArrayLike, NDArray

_PIXELS = 400
_WINDOW = {"color": "#56b4e9", "linewidth": 4.0, "solid_capstyle": "butt"}
_LABELS_AT_MOST = 160


@dataclass(frozen=True)
class Plan:
    """A room seen from above: x to the right, y up."""

    outline: NDArray[np.float64] | None = None
    """Corners of the floor (m, 2) [m]; without it the picture ends at the points' cells."""
    windows: tuple[NDArray[np.float64], ...] = field(default=())
    """Ends (2, 2) of windows [m]."""


@style.styled
def floor_plan(
    points: ArrayLike,
    values: Mapping[str, ArrayLike] | ArrayLike,
    *,
    label: str,
    plan: Plan | None = None,
    limits: tuple[float, float] | None = None,
    scale: style.Scale = "linear",
    percent: bool = False,
    numbers: bool = False,
    title: str = "",
) -> Figure:
    """Falsecolour of values at points; several data sets stand side by side on one scale.

    As figures 65 and 73 of the report of IEA SHC Task 61 (2021, C.2.2) show daylight autonomy.

    Parameters
    ----------
    points
        On a grid along x and y, whose cells are coloured, or anywhere (n, 2 or 3) [m]: then the floor takes the colour
        of the nearest one.
    values
        (n,), or (n,) by data set; what is not finite stays grey.
    label
        What they are, with their unit.
    plan
        Outline and windows.
    limits, scale
        Of the colours; a share goes from 0 to 1, other values from 0 to the largest of all.
    percent
        Values are shares, and shown as percentages from 0 to 100.
    numbers
        Write each value at its point.
    title
        Of the picture.
    """
    sets = values if isinstance(values, dict) else {"": np.asarray(values)}
    at = np.asarray(points, dtype=np.float64)[:, :2]
    factor = 100.0 if percent else 1.0
    made = {name: factor * np.asarray(v, dtype=np.float64) for name, v in sets.items()}
    if not made:
        raise ClerestoryError("no data set was given (give at least one)")
    for name, v in made.items():
        if v.shape != (len(at),):
            raise ClerestoryError(f"{name or 'values'}: {v.shape} do not go with {len(at)} points (give one each)")
    if numbers and len(at) > _LABELS_AT_MOST:
        raise ClerestoryError(f"numbers of {len(at)} points are not legible (leave them out, or take fewer points)")
    every = np.concatenate(list(made.values()))
    norm = style.norm(every, scale, (0.0, 100.0) if percent and limits is None else limits)
    room = plan or Plan()
    frame = _frame(at, room)
    across = min(len(made), 4 if frame[1] - frame[0] < frame[3] - frame[2] else 3)
    down = -(-len(made) // across)
    wide = 5.6 if len(made) == 1 else 2.7
    tall = 0.86 * wide * (frame[3] - frame[2]) / (frame[1] - frame[0])
    figure = style.new_figure(across * wide + 1.1, down * (min(tall, 2.0 * wide) + 0.4) + 0.25 * bool(title) + 0.3)
    axes = figure.subplots(down, across, squeeze=False)
    shown = None
    for ax, (name, v) in zip(axes.ravel(), made.items(), strict=False):
        shown = _draw(ax, at, v, norm, room, frame)
        if numbers:
            _write(ax, at, v, norm)
        ax.set_title(", ".join(filter(None, (name, _mean(v, percent=percent)))), loc="left", fontsize=8.5)
    for k, ax in enumerate(axes.ravel()):
        if k >= len(made):
            ax.set_axis_off()
        elif k + across < len(made):
            ax.set_xticklabels([])
        else:
            ax.set_xlabel("x [m]")
        if k % across:
            ax.set_yticklabels([])
        else:
            ax.set_ylabel("y [m]")
    if shown is None:
        raise ClerestoryError("no data set was given (give at least one)")
    bar = figure.colorbar(shown, ax=axes, pad=0.02, shrink=0.9, extend=style.extend(every, norm))
    bar.set_label(f"{label} [%]" if percent else label)
    if title:
        figure.suptitle(title, x=0.01, ha="left", fontsize=10)
    return figure


def _mean(values: NDArray[np.float64], *, percent: bool) -> str:
    if not np.isfinite(values).any():
        return "no values"
    mean = float(np.nanmean(values))
    return f"mean {mean:.1f} %" if percent else f"mean {style.figures(mean)}"


def cell(points: NDArray[np.float64]) -> tuple[float, float] | None:
    """Width and depth [m] of the cells of a grid along x and y (n, 2), which may lack points; None without one."""
    sides = []
    for axis in (0, 1):
        lines = np.unique(np.round(points[:, axis], 4))
        apart = np.diff(lines)
        if len(apart) == 0 or np.ptp(apart) > 0.02 * apart.mean():
            return None
        sides.append(float(apart.mean()))
    return sides[0], sides[1]


def spacing(points: NDArray[np.float64]) -> float:
    """Middle distance of points (n, 2) to their nearest neighbour [m]."""
    from scipy.spatial import cKDTree

    if len(points) < 2:
        return 1.0
    distances, _ = cKDTree(points).query(points, k=2)
    return float(np.median(distances[:, 1])) or 1.0


def _frame(at: NDArray[np.float64], room: Plan) -> tuple[float, float, float, float]:
    """Left, right, lower and upper end [m]."""
    half = np.array(cell(at) or (spacing(at), spacing(at))) / 2.0
    corners = [at.min(axis=0) - half, at.max(axis=0) + half]
    if room.outline is not None:
        corners += [room.outline.min(axis=0), room.outline.max(axis=0)]
    corners += [end for window in room.windows for end in window]
    low, high = np.min(corners, axis=0), np.max(corners, axis=0)
    edge = 0.03 * float((high - low).max())
    return float(low[0] - edge), float(high[0] + edge), float(low[1] - edge), float(high[1] + edge)


def _draw(
    ax: Axes,
    at: NDArray[np.float64],
    values: NDArray[np.float64],
    norm: Normalize,
    room: Plan,
    frame: tuple[float, float, float, float],
) -> AxesImage:
    from scipy.spatial import cKDTree

    left, right, low, high = frame
    size = max(right - left, high - low) / _PIXELS
    x = np.arange(left + size / 2.0, right, size)
    y = np.arange(low + size / 2.0, high, size)
    pixels = np.stack(np.meshgrid(x, y), axis=-1)
    # Points of a grid have rectangular cells; others reach to the walls, or a little where there are none.
    grid = cell(at)
    if grid is not None:
        _, nearest = cKDTree(at / grid).query(pixels.reshape(-1, 2) / grid, p=np.inf, distance_upper_bound=0.5001)
    else:
        reach = np.inf if room.outline is not None else 1.5 * spacing(at)
        _, nearest = cKDTree(at).query(pixels.reshape(-1, 2), distance_upper_bound=reach)
    image = np.append(values, np.nan)[nearest].reshape(len(y), len(x))
    shown = ax.imshow(
        np.ma.masked_invalid(image),
        extent=(left, left + size * len(x), low, low + size * len(y)),
        origin="lower",
        norm=norm,
        cmap=style.colours(),
        interpolation="nearest",
        zorder=1,
    )
    if room.outline is not None:
        floor = Polygon(room.outline, closed=True, fill=False, edgecolor=style.INK, linewidth=1.4, zorder=3)
        ax.add_patch(Polygon(room.outline, closed=True, facecolor=style.MISSING["facecolor"], zorder=0))
        ax.add_patch(floor)
        shown.set_clip_path(floor)
    for window in room.windows:
        ax.plot(window[:, 0], window[:, 1], zorder=4, **_WINDOW)  # type: ignore[arg-type]
    ax.set_xlim(left, right)
    ax.set_ylim(low, high)
    ax.set_aspect("equal")
    for edge in ("top", "right"):
        ax.spines[edge].set_visible(False)
    return shown


def _write(ax: Axes, at: NDArray[np.float64], values: NDArray[np.float64], norm: Normalize) -> None:
    for (x, y), value in zip(at, values, strict=True):
        if np.isfinite(value):
            ink = "white" if float(norm(value)) < 0.6 else "black"
            text = f"{value:.0f}" if abs(value) >= 10.0 else style.figures(float(value), 2)
            ax.text(x, y, text, ha="center", va="center", color=ink, fontsize=6.0)


def rectangle(width: float, depth: float, corner: Sequence[float] = (0.0, 0.0)) -> NDArray[np.float64]:
    """Outline (4, 2) of a rectangular floor [m]."""
    x, y = corner
    return np.array([[x, y], [x + width, y], [x + width, y + depth], [x, y + depth]])
