"""Pictures of meshes: from the room, and a cut through the middle of the sample seen from the side."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgb

from clerestory.plot.style import INK, new_figure
from clerestory.trace.picture import unit_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from clerestory.trace.picture import _Colours
    from clerestory.trace.sample import Sample
    from clerestory.trace.shapes import Mesh, Section, Shape

    Floats = NDArray[np.float64]

LIGHT = np.array([-0.35, 0.55, 0.76])
"""Where the light of the picture comes from: above, from the left, out of the room."""
MOST = 60_000
"""More triangles than these are not drawn again for neighbouring periods."""


def meshes(sample: Sample, shapes: Sequence[Mesh], sections: Sequence[Section], colours: _Colours) -> Figure:
    """The view from the room, and a cut at the middle of x seen from the right."""
    wide = max(m.periods[0] for m in shapes)
    tall = max(m.periods[1] for m in shapes)
    everything: list[Shape] = [*shapes, *sections]
    low = min(s.depth()[0] for s in everything)
    high = max(s.depth()[1] for s in everything)
    depth = max(high - low, 1e-3 * tall)
    scale, unit = unit_of(max(wide, tall))
    figure = new_figure(9.5, 4.8)
    front, side = figure.subplots(1, 2, width_ratios=[3.0, 2.0])
    for mesh in shapes:
        corners, own = _copies(mesh, (0.0, wide), (0.0, tall))
        _view(front, corners, own, mesh, scale, colours)
        _cut(side, corners, own, mesh, 0.5 * wide, scale, colours)
    for section in sections:
        for piece in section.pieces:
            side.plot(*(piece.points() / scale).T, color=colours.of(piece.face.front), linewidth=1.4)
    front.set_xlim(0.0, wide / scale)
    front.set_ylim(0.0, tall / scale)
    front.set_xlabel(f"x [{unit}]: right, seen from the room")
    front.set_ylabel(f"y [{unit}]: up")
    front.set_title(sample.name)
    margin = max(0.3 * depth, 0.05 * tall)
    side.set_xlim((low - margin) / scale, (high + margin) / scale)
    side.set_ylim(0.0, tall / scale)
    side.set_xlabel(f"z [{unit}]: exterior on the left")
    side.set_title(f"cut at x = {0.5 * wide / scale:.4g} {unit}")
    for axes in (front, side):
        axes.set_aspect("equal")
    colours.legend(side)
    return figure


def _copies(mesh: Mesh, x: tuple[float, float], y: tuple[float, float]) -> tuple[Floats, NDArray[np.int64]]:
    """Corners of all triangles (n, 3, 3) that reach into a part of the plane when repeated, and their surfaces (n,)."""
    own = mesh.corners[mesh.triangles]
    ranges = []
    for axis, (low, high) in enumerate((x, y)):
        period = mesh.periods[axis]
        if not mesh.repeats or len(own) > MOST:
            ranges.append(range(1))
            continue
        least, most = own[..., axis].min(), own[..., axis].max()
        ranges.append(range(int(np.floor((low - most) / period)) + 1, int(np.ceil((high - least) / period))))
    moves = [
        np.array([i * mesh.periods[0] if i else 0.0, j * mesh.periods[1] if j else 0.0, 0.0])
        for i in ranges[0]
        for j in ranges[1]
    ]
    corners = np.concatenate([own + move for move in moves])
    inside = np.ones(len(corners), dtype=bool)
    for axis, (low, high) in enumerate((x, y)):
        along = corners[..., axis]
        inside &= (along.max(axis=1) >= low) & (along.min(axis=1) <= high)
    return corners[inside], np.tile(mesh.face, len(moves))[inside]


def _view(axes: Axes, corners: Floats, own: NDArray[np.int64], mesh: Mesh, scale: float, colours: _Colours) -> None:
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.maximum(np.linalg.norm(normals, axis=1), 1e-300)
    towards = np.sign(normals[:, 2])[:, None] * normals / lengths[:, None]
    bright = 0.35 + 0.65 * np.clip(towards @ LIGHT, 0.0, 1.0)
    # What faces the room shows its front, the rest its back.
    shades = np.array([[to_rgb(colours.of(name)) for name in (f.front, f.back)] for f in mesh.faces])
    colour = shades[own, (normals[:, 2] < 0.0).astype(int)] * bright[:, None]
    order = np.argsort(corners[..., 2].mean(axis=1), kind="stable")
    seen = order[lengths[order] > 0.0]
    axes.add_collection(
        PolyCollection(
            list(corners[seen][..., :2] / scale), facecolors=colour[seen], edgecolors=colour[seen], linewidths=0.2
        )
    )


def _cut(
    axes: Axes, corners: Floats, own: NDArray[np.int64], mesh: Mesh, x: float, scale: float, colours: _Colours
) -> None:
    """Where triangles meet the plane of an x, as lines in z and y."""
    # A plane through corners would cut in points: it is moved by next to nothing.
    off = corners[..., 0] - x - 1e-7 * mesh.periods[0]
    above = off > 0.0
    chosen = np.flatnonzero(above.any(axis=1) & ~above.all(axis=1))
    lines, shades = [], []
    for k in chosen:
        ends = []
        for a, b in ((0, 1), (1, 2), (2, 0)):
            if above[k, a] != above[k, b]:
                share = off[k, a] / (off[k, a] - off[k, b])
                ends.append((corners[k, a] + share * (corners[k, b] - corners[k, a]))[[2, 1]] / scale)
        lines.append(ends)
        shades.append(colours.of(mesh.faces[own[k]].front))
    axes.add_collection(LineCollection(lines, colors=shades or [INK], linewidths=1.4))
