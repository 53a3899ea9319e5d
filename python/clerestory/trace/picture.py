"""A picture of a sample, so that a person sees what was understood."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.colors import to_rgb
from matplotlib.patches import Patch

from clerestory.plot.style import COLOURS, new_figure, styled
from clerestory.trace.shapes import AIR, Section, Solids
from clerestory.trace.tessellate import mesh_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from clerestory.trace.sample import Sample
    from clerestory.trace.shapes import Piece

    Floats = NDArray[np.float64]

UNITS = ((1.0, "m"), (1e-3, "mm"), (1e-6, "µm"))
PERIODS = 3
PALE = 0.28
"""How much of its colour a body has."""


class _Colours:
    """Colours by name, in the order in which they are asked for."""

    def __init__(self) -> None:
        self.known: dict[tuple[bool, str], str] = {}

    def of(self, name: str, *, body: bool = False) -> str:
        return self.known.setdefault((body, name), COLOURS[len(self.known) % len(COLOURS)])

    def pale(self, name: str) -> tuple[float, float, float]:
        """The colour of a body."""
        r, g, b = (1.0 - PALE * (1.0 - c) for c in to_rgb(self.of(name, body=True)))
        return r, g, b

    def legend(self, axes: Axes) -> None:
        handles = [
            Patch(facecolor=self.pale(name), label=name)
            if body
            else Patch(facecolor=colour, label=name, linewidth=0.0, fill=True)
            for (body, name), colour in self.known.items()
        ]
        axes.legend(handles=handles, loc="upper left", bbox_to_anchor=(1.01, 1.0), handlelength=1.2, handleheight=0.7)


@styled
def geometry(sample: Sample) -> Figure:
    """What a sample looks like: its section, or its mesh from the room and from the side; colours are materials."""
    colours = _Colours()
    sections = [shape for shape in sample.shapes if isinstance(shape, Section)]
    meshes = [mesh_of(s) if isinstance(s, Solids) else s for s in sample.shapes if not isinstance(s, Section)]
    if meshes:
        from clerestory.trace.picture_mesh import meshes as draw

        return draw(sample, meshes, sections, colours)
    low = min(s.depth()[0] for s in sections)
    high = max(s.depth()[1] for s in sections)
    tall = PERIODS * max(s.period for s in sections)
    bottom = -0.5 * tall / PERIODS
    scale, unit = unit_of(max(high - low, tall))
    margin = max(0.12 * (high - low), 0.12 * tall)
    figure = new_figure(min(9.0, max(4.6, 4.4 * (high - low + 2.0 * margin) / tall + 2.0)), 5.2)
    axes = figure.add_subplot()
    frame = (low - margin, high + margin, bottom, bottom + tall)
    repeated = [piece for s in sections for piece in _repeated(s, bottom, bottom + tall)]
    _bodies(axes, repeated, frame, scale, colours)
    for points, piece in repeated:
        _stretch(axes, points / scale, piece, colours, 0.004 * tall / scale)
    axes.set_xlim(frame[0] / scale, frame[1] / scale)
    axes.set_ylim(frame[2] / scale, frame[3] / scale)
    axes.set_aspect("equal")
    axes.set_xlabel(f"z [{unit}]: exterior on the left, room on the right")
    axes.set_ylabel(f"y [{unit}]: up")
    axes.set_title(sample.name)
    colours.legend(axes)
    return figure


def unit_of(length: float) -> tuple[float, str]:
    """A unit in which a length is readable: metres in it, and its name."""
    return next(((s, u) for s, u in UNITS if length >= 2.0 * s), UNITS[-1])


def _repeated(section: Section, bottom: float, top: float) -> list[tuple[Floats, Piece]]:
    """Points (n, 2) of all pieces between two heights [m]."""
    found = []
    lines = [(piece.points(), piece) for piece in section.pieces]
    ys = np.concatenate([points[:, 1] for points, _ in lines])
    first = int(np.floor((bottom - ys.max()) / section.period))
    last = int(np.ceil((top - ys.min()) / section.period))
    for k in range(first, last + 1):
        for points, piece in lines:
            moved = points + np.array([0.0, k * section.period])
            if moved[:, 1].max() >= bottom and moved[:, 1].min() <= top:
                found.append((moved, piece))
    return found


def _bodies(
    axes: Axes,
    lines: list[tuple[Floats, Piece]],
    frame: tuple[float, float, float, float],
    scale: float,
    colours: _Colours,
) -> None:
    """Shade what is not air, row by row of a fine raster: every border says what begins behind it."""
    if all(p.face.before == AIR and p.face.behind == AIR for _, p in lines):
        return
    left, right, bottom, top = frame
    rows, columns = 600, 600
    image = np.ones((rows, columns, 3))
    starts = np.concatenate([points[:-1] for points, _ in lines])
    ends = np.concatenate([points[1:] for points, _ in lines])
    owners = [piece for points, piece in lines for _ in points[1:]]
    centres = left + (np.arange(columns) + 0.5) * (right - left) / columns
    for row in range(rows):
        y = bottom + (row + 0.5) * (top - bottom) / rows
        crossed = np.flatnonzero((starts[:, 1] <= y) != (ends[:, 1] <= y))
        rise = ends[crossed, 1] - starts[crossed, 1]
        z = starts[crossed, 0] + (y - starts[crossed, 1]) / rise * (ends[crossed, 0] - starts[crossed, 0])
        for k in np.argsort(z):
            # Going up, the front is towards the exterior: behind it lies what comes next.
            face = owners[crossed[k]].face
            medium = face.behind if rise[k] > 0.0 else face.before
            image[row, centres > z[k]] = (1.0, 1.0, 1.0) if medium == AIR else colours.pale(medium)
    axes.imshow(
        image,
        origin="lower",
        extent=(left / scale, right / scale, bottom / scale, top / scale),
        interpolation="nearest",
        zorder=0,
    )


def _stretch(axes: Axes, points: Floats, piece: Piece, colours: _Colours, off: float) -> None:
    face = piece.face
    if face.front == face.back:
        axes.plot(*points.T, color=colours.of(face.front), linewidth=1.6, solid_capstyle="round")
        return
    # Both sides of a thin thing, each a little off it.
    steps = np.diff(points, axis=0)
    normals = np.column_stack([-steps[:, 1], steps[:, 0]]) / np.maximum(np.hypot(*steps.T), 1e-300)[:, None]
    aside = off * np.vstack([normals, normals[-1:]])
    axes.plot(*(points + aside).T, color=colours.of(face.front), linewidth=1.2)
    axes.plot(*(points - aside).T, color=colours.of(face.back), linewidth=1.2)
