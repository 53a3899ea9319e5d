"""Cuts through the plane of scattering: several data sets on one axis, several incident directions side by side."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import MissingDataError
from clerestory.directions import angles, outgoing_in_words, outgoing_side
from clerestory.plot import style
from clerestory.plot.view import View, component_words, labelled, lights
from clerestory.words import common_band

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from numpy.typing import ArrayLike, NDArray

    from clerestory.bsdf import Bsdf
    from clerestory.directions import Scatter, Side
    from clerestory.plot.view import Light

_ASIDE_DEG = 1e-5
"""Half the distance of the two cuts whose mean is shown."""
_STEMS = 4
"""With more peaks than this in a panel their values are left to the axis."""
_OFF_PLANE_DEG = 1.0
"""A peak this close to the plane is drawn in it."""


@style.styled
def slices(
    sets: Bsdf | Mapping[str, Bsdf],
    incident: int | ArrayLike | Iterable[int | ArrayLike],
    *,
    side: Side | None = None,
    scatter: Scatter = "transmission",
    band: str | None = None,
    scale: style.Scale = "log",
    quantity: style.Quantity = "bsdf",
    azimuth_deg: float | None = None,
    limits: tuple[float, float] | None = None,
    step_deg: float = 0.1,
    ax: Axes | None = None,
) -> Figure:
    """BSDF along the plane that holds the incident direction and the normal.

    Angles are counted from the normal of the side that the light leaves to, and are positive on the side where light
    that goes straight on, or is mirrored, arrives. Peaks are stems that stand on the axis to the right.

    Parameters
    ----------
    sets
        Data sets by label. One that lacks the component is named in the legend as without data.
    incident
        Patches of Klems' full basis (from 1) or directions (3,) toward the source: one panel each.
    scale
        Logarithmic over four decades at most, or linear from 0.
    azimuth_deg
        Azimuth of the plane's positive end as seen from the room [°], for cuts outside of the plane of scattering.
        By default that of light that goes straight on; downward for light along the normal.
    limits
        Ends of the axis [1/sr].
    step_deg
        Distance of the points [°]. Nothing is interpolated between the data's own cells; where the plane runs along
        a border between cells, the mean of both is shown.
    side, scatter, band, quantity
        As for `hemisphere`.
    ax
        Axes to draw on, for one incident direction; a new figure by default.
    """
    data, sources = labelled(sets), lights(incident, side)
    band = common_band(data, band)
    alpha = np.linspace(-90.0, 90.0, round(180.0 / step_deg) + 1)
    if ax is None:
        across = min(len(sources), 2)
        down = -(-len(sources) // across)
        width = 6.6 if across == 1 else 9.6
        legend_columns, legend_rows = style.columns(data, width - 0.4)
        figure = style.new_figure(width, 0.9 + 3.0 * down + 0.19 * legend_rows)
        panels = list(figure.subplots(down, across, squeeze=False).flat)
    else:
        figure, panels = style.figure_of(ax), [ax]
        legend_columns, _ = style.columns(data, 0.8 * float(figure.get_figwidth()))
    curves = {
        (name, k): _curve(bsdf, source, scatter, band, alpha, azimuth_deg, quantity)
        for name, bsdf in data.items()
        for k, source in enumerate(sources)
    }
    every = np.concatenate([np.zeros(0), *(values for _, values in curves.values() if values is not None)])
    norm = style.norm(every, scale, limits)
    strongest = max((p.value for view, _ in curves.values() if view is not None for p in view.peaks()), default=0.0)
    for k, (panel, source) in enumerate(zip(panels, sources, strict=False)):
        members = {name: curves[name, k] for name in data}
        stems = _draw(panel, source, scatter, alpha, members, azimuth_deg, min(1.0, 1.5 * strongest))
        if scale == "log":
            panel.set_yscale("log", nonpositive="mask")
            panel.set_ylim(0.8 * float(norm.vmin or 1.0), 1.5 * float(norm.vmax or 1.0))
        else:
            panel.set_ylim(float(norm.vmin or 0.0), 1.05 * float(norm.vmax or 1.0))
        panel.set_ylabel(style.UNITS[quantity])
        if stems and len(stems) <= _STEMS:
            panel.legend(handles=stems, loc="best", fontsize=7, frameon=True, framealpha=0.85)
    for panel in panels[len(sources) :]:
        panel.set_visible(False)
    handles = panels[0].get_legend_handles_labels()[0]
    if handles and ax is None:
        figure.legend(handles=handles, loc="outside lower center", ncols=legend_columns)
    elif handles and ax is not None:
        # A second legend beside that of the stems; `panel.legend` would take its place.
        legend = ax.get_legend()
        ax.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, -0.18), ncols=legend_columns)
        if legend is not None:
            ax.add_artist(legend)
    if ax is None:
        where = "" if len(data) > 1 else next(iter(data))
        title = component_words(band, sources[0].side, scatter)
        figure.suptitle("\n".join(t for t in (where, title) if t), fontsize=10)
    return figure


def plane_azimuth_deg(source: Light) -> float:
    """Azimuth [°] of light that goes straight on; downward for light along the normal, as for a sun above."""
    if source.theta_deg < 1e-6:
        return 270.0
    return float(angles(-source.direction)[1])


def in_plane(alpha: NDArray[np.float64], azimuth_deg: float, side: Side) -> NDArray[np.float64]:
    """Directions (..., 3) at angles from the normal [°] in the plane whose positive end has an azimuth [°]."""
    a, phi = np.radians(alpha), np.radians(azimuth_deg)
    z = np.cos(a) if side == "interior" else -np.cos(a)
    return np.stack([np.sin(a) * np.cos(phi), np.sin(a) * np.sin(phi), z], axis=-1)


def _curve(
    bsdf: Bsdf,
    source: Light,
    scatter: Scatter,
    band: str | None,
    alpha: NDArray[np.float64],
    azimuth_deg: float | None,
    quantity: style.Quantity,
) -> tuple[View | None, NDArray[np.float64] | None]:
    try:
        view = View.lit(bsdf, source, scatter=scatter, band=band)
    except MissingDataError:
        return None, None
    azimuth = plane_azimuth_deg(source) if azimuth_deg is None else azimuth_deg
    # The plane's ends lie in the surface, where sides meet: a hair above it they belong to the side that is drawn.
    safe = np.clip(alpha, -90.0 + 1e-6, 90.0 - 1e-6)
    # The plane of a sun above is a border between cells in many data sets: both sides of it count.
    sides = [in_plane(safe, azimuth + aside, view.outgoing_side) for aside in (-_ASIDE_DEG, _ASIDE_DEG)]
    return view, 0.5 * (view.evaluate(sides[0], quantity) + view.evaluate(sides[1], quantity))


def _draw(
    panel: Axes,
    source: Light,
    scatter: Scatter,
    alpha: NDArray[np.float64],
    curves: Mapping[str, tuple[View | None, NDArray[np.float64] | None]],
    azimuth_deg: float | None,
    top: float,
) -> list[Line2D]:
    """Curves and stems of one panel; gives handles for the stems."""
    azimuth = plane_azimuth_deg(source) if azimuth_deg is None else azimuth_deg
    leaving = outgoing_side(source.side, scatter)
    stems, handles = None, []
    for n, (name, (view, values)) in enumerate(curves.items()):
        look = style.line(n)
        if view is None or values is None:
            panel.plot([], [], label=f"{name} (no data)", **look)
            continue
        for peak in view.peaks():
            along = peak.outgoing @ in_plane(np.array(90.0), azimuth, leaving)
            away = np.degrees(np.arcsin(np.clip(peak.outgoing @ _sideways(azimuth), -1.0, 1.0)))
            if abs(away) > _OFF_PLANE_DEG + 0.5 * peak.extent_deg:
                continue
            if stems is None:
                stems = panel.twinx()
                stems.set_ylim(0.0, top)
                stems.set_ylabel("transmittance of a peak" if scatter == "transmission" else "reflectance of a peak")
            at = round(float(np.degrees(np.arcsin(np.clip(along, -1.0, 1.0)))), 1) + 0.0
            stems.vlines(at, 0.0, peak.value, color=look["color"], linestyle=look["linestyle"], linewidth=1.2)
            words = f"{name}: " if name else ""
            handles += stems.plot(
                at,
                peak.value,
                marker="o",
                markersize=5,
                color=look["color"],
                markerfacecolor="white",
                linestyle="none",
                label=f"{words}peak {style.figures(peak.value)} at {at:g}°",
            )
        panel.plot(alpha, values, label=name or None, **look)
    through = source.theta_deg if azimuth_deg is None else None
    if through is not None:
        panel.axvline(through, color="#909090", linewidth=0.8, linestyle=(0, (2, 2)), zorder=0)
    ends = [outgoing_in_words(in_plane(np.array(a), azimuth, leaving)).split(",")[0] for a in (-45.0, 45.0)]
    panel.set_xlim(-90.0, 90.0)
    ticks = ["-90\n" + ends[0], "-60", "-30", "0", "30", "60", "90\n" + ends[1]]
    panel.set_xticks(np.arange(-90, 91, 30), [t.replace("-", "−") for t in ticks])
    panel.set_xlabel(f"angle to the normal [°], leaving to the {leaving}", labelpad=-8)
    panel.set_title(f"incident {source.words}")
    panel.grid(visible=True)
    return handles


def _sideways(azimuth_deg: float) -> NDArray[np.float64]:
    """Unit vector across the plane."""
    phi = np.radians(azimuth_deg)
    return np.array([-np.sin(phi), np.cos(phi), 0.0])
