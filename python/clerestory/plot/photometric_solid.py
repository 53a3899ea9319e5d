"""Photometric solids: a surface whose distance from the sample is the light that leaves there."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from clerestory.directions import outgoing_in_words
from clerestory.plot import style, surface
from clerestory.plot.view import View

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from mpl_toolkits.mplot3d import Axes3D
    from numpy.typing import ArrayLike, NDArray

    from clerestory.bsdf import Bsdf
    from clerestory.directions import Scatter, Side

_PLANE, _LIGHT, _PEAK = "#607880", "#e69f00", "#d00000"


@style.styled
def photometric_solid(
    bsdf: Bsdf,
    incident: int | ArrayLike,
    *,
    side: Side | None = None,
    scatter: Scatter = "transmission",
    band: str | None = None,
    label: str = "",
    limits: tuple[float, float] | None = None,
    step_deg: float = 1.5,
    ax: Axes3D | None = None,
) -> Figure:
    """Photometric solid: the radius is BSDF·cos θ, linear, with the sample and the incident light.

    The eye stands on the side that the light leaves to, above the sample and beside it. Peaks are red beams as long
    as the scale; their values are in the legend.

    Parameters
    ----------
    limits
        0 and the radius of the outer circle [1/sr].
    step_deg
        Step of the polar angle [°]; that of the azimuth is twice as wide.
    ax
        Axes made with `projection="3d"`; a new figure by default.
    bsdf, incident, side, scatter, band, label
        As for `hemisphere`.

    Raises
    ------
    MissingDataError
        The data set does not hold this component.
    """
    view = View.of(bsdf, incident, side=side, scatter=scatter, band=band, label=label)
    theta = np.radians(np.linspace(0.0, 90.0, round(90.0 / step_deg) + 1))
    directions = surface.grid(theta, round(180.0 / step_deg), view.outgoing_side)
    values = view.evaluate(directions, "dsf")
    norm = style.norm(values, "linear", limits)
    top = float(norm.vmax or 1.0)
    ax = ax or surface.add_axes(style.new_figure(7.0, 7.0 + 0.2 * (view.title.count("\n") + len(view.peaks()))))
    figure = style.figure_of(ax)
    exterior = view.outgoing_side == "exterior"
    ax.view_init(elev=18, azim=40 if exterior else -40)

    _sample(ax, top, exterior=exterior)
    faces = 0.25 * (values[:-1, :-1] + values[1:, :-1] + values[:-1, 1:] + values[1:, 1:])
    surface.draw(ax, surface.upright(directions * (values / top)[..., None]), faces, norm, zorder=3)
    source = view.light.direction
    # Light that comes through the sample from behind is hidden by what is in front of it.
    order = 1 if (source[2] < 0.0) != exterior else 5
    handles = ax.plot(*surface.line(np.outer([1.15, 0.0], source)), color=_LIGHT, linewidth=2.4, zorder=order)
    handles[0].set_label(f"incident {view.light.words}")
    _arrow_head(ax, source, order)
    handles += ax.plot(
        *surface.line(np.outer([0.0, 1.15], view.through)),
        color=style.INK,
        linewidth=0.9,
        linestyle=(0, (4, 3)),
        zorder=6,
        label=view.through_words,
    )
    for peak in view.peaks():
        handles += ax.plot(
            *surface.line(np.outer([0.0, 1.0], peak.outgoing)),
            color=_PEAK,
            linewidth=2.0,
            zorder=5,
            label=f"peak {style.figures(peak.value)}: {outgoing_in_words(peak.outgoing)}",
        )
    ax.set(xlim=(-1, 1), ylim=(-1, 1), zlim=(-1, 1))
    ax.set_box_aspect((1, 1, 1), zoom=1.35)
    ax.set_axis_off()
    ax.set_title(view.title)
    bar = figure.colorbar(style.mappable(norm), ax=ax, shrink=0.6, pad=0.02, extend=style.extend(values, norm))
    bar.set_label(f"radius and colour: {style.UNITS['dsf']}")
    style.legend_below(
        ax,
        handles,
        f"light leaving to the {view.outgoing_side}, seen from "
        + ("outdoors, where left and right swap" if exterior else "the room"),
    )
    return figure


def _sample(ax: Axes3D, top: float, *, exterior: bool) -> None:
    """The plane of the sample: circles at half and all of the scale, their values, words, the normal."""
    phi = np.linspace(0.0, 2.0 * np.pi, 181)
    circle = np.stack([np.cos(phi), np.sin(phi), np.zeros_like(phi)], axis=-1)
    plane = Poly3DCollection([surface.upright(circle)], facecolor="#9db4c0", alpha=0.3, linewidth=0.0, zorder=2)
    ax.add_collection3d(plane)
    lean = np.radians(240.0 if exterior else 300.0)
    for r in (0.5, 1.0):
        ax.plot(*surface.line(r * circle), color=_PLANE, linewidth=0.7, zorder=2)
        x, y, z = surface.upright(r * np.array([np.cos(lean), np.sin(lean), 0.0]))
        ax.text(x, y, z, f"{style.figures(r * top, 2)}/sr", fontsize=7, ha="center", va="center", zorder=2)
    for word, right, up in (("up", 0, 1.1), ("down", 0, -1.1), ("left", -1.15, 0), ("right", 1.15, 0)):
        x, y, z = surface.upright(np.array([right, up, 0.0]))
        ax.text(x, y, z, word, fontsize=8, ha="center", va="center", zorder=2)
    normal = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, -1.1 if exterior else 1.1]])
    ax.plot(*surface.line(normal), color=_PLANE, linewidth=0.7, zorder=2)


def _arrow_head(ax: Axes3D, source: NDArray[np.float64], zorder: int) -> None:
    """Strokes that say that the light arrives."""
    side = np.cross(source, [0.0, 1.0, 0.0])
    if np.linalg.norm(side) < 1e-6:
        side = np.array([1.0, 0.0, 0.0])
    side /= np.linalg.norm(side)
    for across in (side, np.cross(source, side)):
        for sign in (-1.0, 1.0):
            stroke = np.stack([source * 0.6, source * 0.72 + sign * 0.05 * across])
            ax.plot(*surface.line(stroke), color=_LIGHT, linewidth=2.0, zorder=zorder)
