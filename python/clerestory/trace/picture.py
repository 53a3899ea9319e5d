"""A picture of a sample, so that a person sees what was understood."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from clerestory.plot.style import COLOURS, INK, new_figure, styled
from clerestory.trace.shapes import AIR, Section

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from clerestory.trace.sample import Sample
    from clerestory.trace.shapes import Face

UNITS = ((1.0, "m"), (1e-3, "mm"), (1e-6, "µm"))
PERIODS = 3


@styled
def geometry(sample: Sample) -> Figure:
    """The section of a sample, exterior on the left, a few periods of it; colours are materials, shading is bodies."""
    sections = [shape for shape in sample.shapes if isinstance(shape, Section)]
    low = min(s.depth()[0] for s in sections)
    high = max(s.depth()[1] for s in sections)
    tall = PERIODS * max(s.period for s in sections)
    bottom = -0.5 * tall / PERIODS
    scale, unit = _unit(max(high - low, tall))
    aspect = (high - low + 0.3 * tall) / tall
    figure = new_figure(min(9.0, max(4.6, 4.6 * aspect + 1.6)), 5.2)
    axes = figure.add_subplot()
    colours: dict[tuple[str, str], str] = {}
    for section in sections:
        _section(axes, section, (bottom, bottom + tall), scale, colours)
    margin = max(0.12 * (high - low), 0.12 * tall)
    axes.set_xlim((low - margin) / scale, (high + margin) / scale)
    axes.set_ylim(bottom / scale, (bottom + tall) / scale)
    axes.set_aspect("equal")
    axes.set_xlabel(f"z [{unit}]: exterior on the left, room on the right")
    axes.set_ylabel(f"y [{unit}]: up")
    axes.set_title(sample.name)
    for (what, name), colour in colours.items():
        style: dict[str, Any] = {"linewidth": 6.0, "alpha": 0.35} if what == "medium" else {}
        axes.plot([], [], color=colour, label=f"{name} (body)" if what == "medium" else name, **style)
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0))
    return figure


def _unit(length: float) -> tuple[float, str]:
    return next(((s, u) for s, u in UNITS if length >= 2.0 * s), UNITS[-1])


def _section(
    axes: Axes, section: Section, limits: tuple[float, float], scale: float, colours: dict[tuple[str, str], str]
) -> None:
    ys = np.concatenate([p.points()[:, 1] for p in section.pieces])
    low, high = limits
    first = int(np.floor((low - ys.max()) / section.period))
    last = int(np.ceil((high - ys.min()) / section.period))
    for k in range(first, last + 1):
        up = k * section.period
        for piece in section.pieces:
            points = (piece.points() + np.array([0.0, up])) / scale
            if points[:, 1].max() < low / scale or points[:, 1].min() > high / scale:
                continue
            _stretch(axes, points, piece.face, colours)


def _stretch(axes: Axes, points: NDArray[np.float64], face: Face, colours: dict[tuple[str, str], str]) -> None:
    steps = np.diff(points, axis=0)
    lengths = np.maximum(np.hypot(*steps.T), 1e-300)
    normals = np.column_stack([-steps[:, 1], steps[:, 0]]) / lengths[:, None]
    normals = np.vstack([normals, normals[-1:]])
    front = _colour(colours, "material", face.front)
    if face.front == face.back:
        axes.plot(*points.T, color=front, linewidth=1.6, solid_capstyle="round")
    else:
        # Both sides of a thin thing, each a little off it.
        off = 0.004 * np.diff(axes.get_ylim())[0] * normals
        axes.plot(*(points + off).T, color=front, linewidth=1.2)
        axes.plot(*(points - off).T, color=_colour(colours, "material", face.back), linewidth=1.2)
    for medium, sign in ((face.before, 1.0), (face.behind, -1.0)):
        if medium != AIR:
            _body(axes, points, sign * normals, _colour(colours, "medium", medium))


def _body(axes: Axes, points: NDArray[np.float64], towards: NDArray[np.float64], colour: str) -> None:
    """Ticks into the body."""
    for point, way in zip(points[:-1] + 0.5 * np.diff(points, axis=0), towards[:-1], strict=True):
        axes.annotate(
            "",
            xy=point + 1e-9 * way,
            xytext=tuple(9.0 * way),
            textcoords="offset points",
            arrowprops={
                "arrowstyle": "-",
                "color": colour,
                "linewidth": 4.0,
                "alpha": 0.35,
                "shrinkA": 0,
                "shrinkB": 0,
            },
        )


def _colour(colours: dict[tuple[str, str], str], what: str, name: str) -> str:
    return colours.setdefault((what, name), (*COLOURS, INK)[len(colours) % (len(COLOURS) + 1)])
