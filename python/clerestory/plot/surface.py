"""Surfaces in three dimensions: meshes of directions, matplotlib's axes, light and shade."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import numpy as np
from matplotlib.colors import LogNorm
from mpl_toolkits.mplot3d import Axes3D
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from clerestory.plot import style

if TYPE_CHECKING:
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from clerestory.directions import Side

_SHADOW = 0.35
"""Part of a colour's lightness that the shading may take; more would no longer match the colour bar."""


HEIGHT = 1.24
"""Height of a mountain's box where the disk's radius is 1."""


def add_axes(figure: Figure) -> Axes3D:
    """Axes in three dimensions that draw in the order that they are told."""
    return cast("Axes3D", figure.add_subplot(projection="3d", computed_zorder=False))


def grid(theta: NDArray[np.float64], steps: int, side: Side) -> NDArray[np.float64]:
    """Directions (n, steps + 1, 3) for polar angles [rad] and a whole turn.

    The last column is the first again. The turn begins half a step beside the right, and ends a hair above the
    surface: the axes and the horizon are borders between cells in many data sets, and would tear the mesh.
    """
    phi = (np.arange(steps) + 0.5) * (2.0 * np.pi / steps)
    t, p = np.meshgrid(np.minimum(theta, 0.5 * np.pi - 1e-7), np.append(phi, phi[0]), indexing="ij")
    z = np.cos(t) if side == "interior" else -np.cos(t)
    return np.stack([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), z], axis=-1)


def circles(ax: Axes3D, floor: float) -> None:
    """Circles at 30°, 60° and 90° about the foot of a mountain."""
    circle = np.linspace(0.0, 2.0 * np.pi, 181)
    for r in np.sin(np.radians([30.0, 60.0, 90.0])):
        ax.plot(r * np.cos(circle), r * np.sin(circle), floor, color="#607880", linewidth=0.6, zorder=1)


def dress(ax: Axes3D, norm: Normalize, floor: float, top: float, unit: str) -> None:
    """Words, axis and shape of a mountain over the disk, from `floor` to `top` in the units that it is drawn in."""
    for word, px, py in (("up", 0, 1.18), ("down", 0, -1.18), ("left", -1.18, 0), ("right", 1.18, 0)):
        ax.text(px, py, floor, word, fontsize=8, ha="center", va="center", zorder=1)
    ax.set(xlim=(-1, 1), ylim=(-1, 1), zlim=(floor, top), xticks=[], yticks=[])
    if isinstance(norm, LogNorm):
        decades = np.arange(np.ceil(floor - 1e-9), np.floor(top + 1e-9) + 1)
        ax.set_zticks(decades, [f"$10^{{{d:.0f}}}$" for d in decades])
    ax.set_zlabel(unit)
    for axis in (ax.xaxis, ax.yaxis):
        axis.line.set_visible(False)
    for pane in (ax.xaxis, ax.yaxis, ax.zaxis):
        pane.pane.set_visible(False)
    ax.grid(visible=False)
    ax.set_box_aspect((1, 1, 0.5 * HEIGHT), zoom=1.1)


def draw(
    ax: Axes3D,
    points: NDArray[np.float64],
    values: NDArray[np.float64],
    norm: Normalize,
    *,
    zorder: int,
    height: float = 1.0,
) -> None:
    """A mesh of points (n, m, 3) in matplotlib's axes, coloured by a value for each of its (n-1, m-1) faces.

    Light comes from the upper left behind the eye. `height` is the length of the third axis that is drawn as long as 1
    of the others.
    """
    drawn = points / [1.0, 1.0, height]
    normals = np.cross(drawn[1:, 1:] - drawn[:-1, :-1], drawn[1:, :-1] - drawn[:-1, 1:])
    colours = _lit(ax, values, normals, norm)
    ax.plot_surface(
        points[..., 0],
        points[..., 1],
        points[..., 2],
        facecolors=colours,
        rstride=1,
        cstride=1,
        shade=False,
        linewidth=0.0,
        antialiased=False,
        rasterized=True,
        zorder=zorder,
    )


def draw_triangles(
    ax: Axes3D,
    corners: NDArray[np.float64],
    values: NDArray[np.float64],
    norm: Normalize,
    *,
    zorder: int,
    height: float = 1.0,
) -> None:
    """Triangles (n, 3, 3) in matplotlib's axes, coloured by a value each (n,); light and height as for `draw`."""
    drawn = corners / [1.0, 1.0, height]
    normals = np.cross(drawn[:, 1] - drawn[:, 0], drawn[:, 2] - drawn[:, 0])
    colours = _lit(ax, values, normals, norm)
    # An edge in the face's colour hides the hair between neighbours.
    faces = Poly3DCollection(corners, facecolors=colours, edgecolors=colours, linewidths=0.2, antialiaseds=False)
    faces.set(rasterized=True, zorder=zorder)
    ax.add_collection3d(faces)


def _lit(ax: Axes3D, values: NDArray[np.float64], normals: NDArray[np.float64], norm: Normalize) -> NDArray[np.float64]:
    """Colours (..., 4) of faces with values (...) and normals (..., 3) as they are drawn."""
    length = np.linalg.norm(normals, axis=-1, keepdims=True)
    normals = np.divide(normals, length, out=np.zeros_like(normals), where=length > 0.0)
    elevation, azimuth = np.radians(ax.elev + 25.0), np.radians(ax.azim - 35.0)
    lamp = np.array([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)])
    # Faces have no outside: what turns away from the lamp is lit as its back would be, so that no side is black.
    bright = 1.0 - _SHADOW * (1.0 - np.abs(normals @ lamp))
    colours: NDArray[np.float64] = style.colours()(norm(values))
    colours[..., :3] *= bright[..., None]
    return colours


def upright(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Our x to the right, y up, z into the room as matplotlib's axes (..., 3), whose third points up."""
    return np.stack([points[..., 0], -points[..., 2], points[..., 1]], axis=-1)


def line(points: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Points (n, 3) as the three arguments that matplotlib asks for, upright."""
    p = upright(points)
    return p[..., 0], p[..., 1], p[..., 2]
