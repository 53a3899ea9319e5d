"""Surfaces in three dimensions: meshes of directions, matplotlib's axes, light and shade."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import numpy as np
from mpl_toolkits.mplot3d import Axes3D

from clerestory.plot import style

if TYPE_CHECKING:
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from clerestory.directions import Side

_SHADOW = 0.35
"""Part of a colour's lightness that the shading may take; more would no longer match the colour bar."""


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
    across = drawn[1:, 1:] - drawn[:-1, :-1]
    along = drawn[1:, :-1] - drawn[:-1, 1:]
    normals = np.cross(across, along)
    length = np.linalg.norm(normals, axis=-1, keepdims=True)
    normals = np.divide(normals, length, out=np.zeros_like(normals), where=length > 0.0)
    elevation, azimuth = np.radians(ax.elev + 25.0), np.radians(ax.azim - 35.0)
    lamp = np.array([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)])
    # Faces have no outside: what turns away from the lamp is lit as its back would be, so that no side is black.
    bright = 1.0 - _SHADOW * (1.0 - np.abs(normals @ lamp))
    colours = style.colours()(norm(values))
    colours[..., :3] *= bright[..., None]
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


def upright(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Our x to the right, y up, z into the room as matplotlib's axes (..., 3), whose third points up."""
    return np.stack([points[..., 0], -points[..., 2], points[..., 1]], axis=-1)


def line(points: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Points (n, 3) as the three arguments that matplotlib asks for, upright."""
    p = upright(points)
    return p[..., 0], p[..., 1], p[..., 2]
