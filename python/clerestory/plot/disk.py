"""The disk that a hemisphere is drawn on: projections, circles of equal polar angle, words, regions.

Seen from the room, right is right and up is up, for light that leaves to either side.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Literal

import matplotlib.patheffects as effects
import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Circle

from clerestory._core import ClerestoryError
from clerestory.basis import Basis
from clerestory.plot.style import INK, MISSING, figures
from clerestory.plot.view import region_words

if TYPE_CHECKING:
    from collections.abc import Iterable

    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike, NDArray

    from clerestory.bsdf import Region
    from clerestory.directions import Side
    from clerestory.plot.view import View

Projection = Literal["polar", "orthographic"]
OUTGOING_WORDS = ("right", "up", "left", "down")
INCIDENT_WORDS = ("from the\nright", "from above", "from the\nleft", "from below")
_DASHES: tuple[Literal["-", "--", ":", "-."], ...] = ("-", "--", ":", "-.")
HALO = (effects.withStroke(linewidth=1.8, foreground="white"),)
_EDGE = 1.18


def radius(theta_deg: ArrayLike, projection: Projection) -> NDArray[np.float64]:
    """Distance from the centre of the disk, 1 at its edge: linear in the polar angle, or its sine."""
    theta = np.asarray(theta_deg, dtype=np.float64)
    if projection == "polar":
        return theta / 90.0
    if projection == "orthographic":
        return np.sin(np.radians(theta))
    raise ClerestoryError(f"projection {projection!r} is not known (give polar or orthographic)")


def project(directions: ArrayLike, projection: Projection) -> NDArray[np.float64]:
    """Points (..., 2) of the disk for directions (..., 3)."""
    d = np.asarray(directions, dtype=np.float64)
    sine = np.hypot(d[..., 0], d[..., 1])
    r = radius(np.degrees(np.arctan2(sine, np.abs(d[..., 2]))), projection)
    factor = np.divide(r, sine, out=np.ones_like(sine), where=sine > 0.0)
    return d[..., :2] * factor[..., None]


@lru_cache(maxsize=8)
def pixels(count: int, side: Side, projection: Projection) -> NDArray[np.float64]:
    """Directions (count, count, 3) at the centres of a picture's pixels, from the lower left; NaN off the disk."""
    at = (np.arange(count) + 0.5) * (2.0 / count) - 1.0
    x, y = np.meshgrid(at, at)
    r = np.hypot(x, y)
    if projection == "polar":
        sine = np.sin(0.5 * np.pi * np.minimum(r, 1.0))
    elif projection == "orthographic":
        sine = np.minimum(r, 1.0)
    else:
        raise ClerestoryError(f"projection {projection!r} is not known (give polar or orthographic)")
    factor = np.divide(sine, r, out=np.full_like(r, 0.5 * np.pi), where=r > 0.0)
    z = np.sqrt(1.0 - sine**2)
    made = np.stack([x * factor, y * factor, z if side == "interior" else -z], axis=-1)
    made[r >= 1.0] = np.nan
    made.setflags(write=False)
    return made


def prepare(ax: Axes) -> Circle:
    """Makes room for a disk and draws the ground that shows through where data is missing."""
    ax.set_aspect("equal")
    limit(ax)
    ax.axis("off")
    ground = Circle((0.0, 0.0), 1.0, zorder=0, **MISSING)
    ax.add_patch(ground)
    return ground


def limit(ax: Axes) -> None:
    """The part of the plane that a disk and its words need."""
    ax.set_xlim(-_EDGE, _EDGE)
    ax.set_ylim(-_EDGE, _EDGE)


def frame(
    ax: Axes,
    projection: Projection,
    *,
    words: tuple[str, ...] = OUTGOING_WORDS,
    labels: bool = True,
    circles: bool = True,
    small: bool = False,
) -> None:
    """Circles of equal polar angle (two of them on a small disk), the edge, and words for the azimuths."""
    thetas = (15, 30, 45, 60, 75) if labels and not small else (30, 60)
    for theta in thetas if circles else ():
        r = float(radius(theta, projection))
        ax.add_patch(Circle((0, 0), r, fill=False, edgecolor="white", linewidth=1.1, alpha=0.35, zorder=2))
        ax.add_patch(Circle((0, 0), r, fill=False, edgecolor=INK, linewidth=0.45, alpha=0.75, zorder=2))
        if labels:
            a = np.radians(22.5)
            ax.text(
                r * np.cos(a),
                r * np.sin(a),
                f"{theta}°",
                fontsize=7,
                ha="center",
                va="center",
                zorder=4,
                path_effects=list(HALO),
            )
    ax.add_patch(Circle((0, 0), 1.0, fill=False, edgecolor=INK, linewidth=0.8, zorder=3))
    if not labels:
        return
    places = [(1.03, 0.0, "left", "center"), (0.0, 1.03, "center", "bottom")]
    places += [(-1.03, 0.0, "right", "center"), (0.0, -1.03, "center", "top")]
    for word, (x, y, ha, va) in zip(words, places, strict=True):
        ax.text(x, y, word, ha=ha, va=va, fontsize=8)


def outline(
    ax: Axes, region: Region, side: Side, projection: Projection, *, style: int = 0, count: int = 720
) -> Line2D:
    """The border of a region, and a handle for the legend."""
    directions = pixels(count, side, projection)
    inside = region_level(region, directions)
    at = (np.arange(count) + 0.5) * (2.0 / count) - 1.0
    dashes = _DASHES[style % len(_DASHES)]
    # Beyond the horizon counts as outside, so that a region that reaches it is closed along the edge.
    level = np.where(np.isfinite(inside), inside, -1e-3)
    for colour, width in (("white", 2.6), (INK, 1.3)):
        ax.contour(
            at,
            at,
            level,
            levels=[0.0],
            colors=[colour],
            linewidths=width,
            linestyles=dashes if colour == INK else "-",
            zorder=5,
        )
    return Line2D([], [], color=INK, linewidth=1.3, linestyle=dashes)


def outlines(ax: Axes, regions: Iterable[Region], view: View, projection: Projection) -> list[Line2D]:
    """The borders of regions, and handles for the legend that say the share of the incident flux in each."""
    handles = []
    for k, region in enumerate(regions):
        handle = outline(ax, region, view.outgoing_side, projection, style=k)
        handle.set_label(f"{region_words(region, view.outgoing_side)}: {figures(view.total(region))}")
        handles.append(handle)
    return handles


def region_level(region: Region, directions: NDArray[np.float64]) -> NDArray[np.float64]:
    """A number that is above 0 inside of a region and below outside, for directions (..., 3)."""
    first = region.spec[0]
    if isinstance(first, tuple):
        (x, y), inner, outer = region.spec  # type: ignore[misc]
        axis = np.array([x, y, np.sqrt(max(0.0, 1.0 - x * x - y * y))])
        d = np.concatenate([directions[..., :2], np.abs(directions[..., 2:])], axis=-1)
        angle: NDArray[np.float64] = np.arccos(np.clip(d @ axis, -1.0, 1.0))
        return outer - angle if inner <= 0.0 else np.minimum(angle - inner, outer - angle)
    basis, chosen = Basis(first), region.spec[1]
    level = np.full(directions.shape[:-1], np.nan)
    known = np.all(np.isfinite(directions), axis=-1)
    level[known] = np.where(np.isin(basis.index_of_outgoing(directions[known]), chosen), 1.0, -1.0)
    return level
