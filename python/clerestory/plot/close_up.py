"""A peak from near by, on a grid of arc-minutes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.directions import outgoing_in_words
from clerestory.plot import style
from clerestory.plot.hemisphere import missing_handle, peak_style
from clerestory.plot.view import View

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike, NDArray

    from clerestory.bsdf import Bsdf
    from clerestory.directions import Scatter, Side

MOST_CELLS = 2000
"""Of a close-up, across."""


@style.styled
def close_up(
    bsdf: Bsdf,
    incident: int | ArrayLike,
    *,
    centre: ArrayLike | None = None,
    half_width_deg: float = 2.0,
    step_arcmin: float = 5.0,
    side: Side | None = None,
    scatter: Scatter = "transmission",
    band: str | None = None,
    label: str = "",
    scale: style.Scale | Literal["both"] = "both",
    quantity: style.Quantity = "bsdf",
    limits: tuple[float, float] | None = None,
    ax: Axes | None = None,
) -> Figure:
    """Falsecolour of the surroundings of an outgoing direction, linear and logarithmic side by side.

    Distances in the picture are angles from its centre (azimuthal equidistant); up is up and right is right as seen
    from the room. What lies beyond the horizon of the sample is hatched.

    Parameters
    ----------
    centre
        Outgoing direction (3,) in the middle; by default that of the strongest peak, or of light that goes straight
        on or is mirrored.
    half_width_deg
        Half the width of the picture [°], up to 90.
    step_arcmin
        Width of a cell [arc-minutes]; the BSDF is looked up at its centre.
    scale
        `log`, `linear`, or both in two panels (without `ax`).
    bsdf, incident, side, scatter, band, label, quantity, limits, ax
        As for `hemisphere`.

    Raises
    ------
    MissingDataError
        The data set does not hold this component.
    """
    cells = 120.0 * half_width_deg / step_arcmin if step_arcmin > 0.0 else np.inf
    if not 0.0 < half_width_deg <= 90.0 or not 2.0 <= cells <= MOST_CELLS:
        raise ClerestoryError(
            f"a close-up of ±{half_width_deg:g}° in steps of {step_arcmin:g}' is not possible "
            f"(give a half width up to 90° and steps that make 2 to {MOST_CELLS} of it)"
        )
    view = View.of(bsdf, incident, side=side, scatter=scatter, band=band, label=label)
    peaks = sorted(view.peaks(), key=lambda p: -p.value)
    middle = _centre(view, centre, peaks[0].outgoing if peaks else view.through)
    # Even, so that no centre of a cell lies on the middle lines, which are borders of cells in many data sets.
    count = 2 * round(60.0 * half_width_deg / step_arcmin)
    offsets = (np.arange(count) + 0.5 - count // 2) * (step_arcmin / 60.0)
    right, up = axes_at(middle)
    values = view.evaluate(around(middle, right, up, offsets), quantity)
    edge = offsets[-1] + 0.5 * step_arcmin / 60.0

    scales: list[style.Scale] = ["linear", "log"] if scale == "both" and ax is None else [_single(scale)]
    if ax is None:
        height = 4.6 + 0.18 * (view.title.count("\n") + len(peaks))
        figure = style.new_figure(5.0 * len(scales) + 0.2, height)
        panels = list(figure.subplots(1, len(scales), squeeze=False).flat)
        figure.suptitle(view.title, fontsize=9.5)
    else:
        figure, panels = style.figure_of(ax), [ax]
        ax.set_title(view.title)
    place = f"around {outgoing_in_words(middle)}, leaving to the {view.outgoing_side}, as seen from the room"
    words = f"{place}\ncells of {step_arcmin:g}'{resolved(view)}"
    handles: list[Artist] = []
    for panel, kind in zip(panels, scales, strict=True):
        norm = style.norm(values, kind, limits)
        image = style.square_image(panel, values, edge, norm)
        handles = []
        at = offset(view.through, middle, right, up)
        if np.all(np.abs(at) <= edge):
            handles.append(style.cross(panel, at, view.through_words))
        for peak in peaks:
            at = offset(peak.outgoing, middle, right, up)
            if np.all(np.abs(at) <= edge):
                value = f"peak {style.figures(peak.value)}: {outgoing_in_words(peak.outgoing)}"
                handles += panel.plot(*at, label=value, **peak_style(11.0))
        if np.isnan(values).any():
            handles.append(missing_handle("beyond the horizon"))
        bar = figure.colorbar(image, ax=panel, shrink=0.85, pad=0.02, extend=style.extend(values, norm))
        bar.set_label(f"{style.UNITS[quantity]}, {'logarithmic' if kind == 'log' else 'linear'}")
        panel.set_xlabel("to the right [°]")
        panel.set_ylabel("upward [°]")
        if ax is not None:
            panel.legend(
                handles=handles, loc="upper center", bbox_to_anchor=(0.5, -0.14), title=words, alignment="left"
            )
    if ax is None:
        figure.legend(handles=handles, loc="outside lower center", title=words, alignment="left")
    return figure


def axes_at(direction: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Unit vectors to the right and upward at a direction (3,), as seen from the room."""
    up = np.array([0.0, 1.0, 0.0]) - direction[1] * direction
    if np.linalg.norm(up) < 1e-9:
        # Straight up or down in the surface: up turns into what points out of the room, or into it.
        up = np.array([0.0, 0.0, -np.sign(direction[1])])
    up /= np.linalg.norm(up)
    right = np.cross(up, direction)
    if direction[2] < 0.0:
        right = -right
    return np.asarray(right), np.asarray(up)


def resolved(view: View) -> str:
    """What the data resolve, in words."""
    angle = float(view.bsdf.resolution_deg(view.light.direction, view.scatter, view.band))
    return f"; the data resolve {style.figures(angle, 2)}°" if 0.0 < angle < 90.0 else ""


def _single(scale: style.Scale | Literal["both"]) -> style.Scale:
    return "log" if scale == "both" else scale


def _centre(view: View, centre: ArrayLike | None, default: NDArray[np.float64]) -> NDArray[np.float64]:
    middle = np.asarray(default if centre is None else centre, dtype=np.float64)
    if middle.shape != (3,) or not np.all(np.isfinite(middle)) or not np.any(middle):
        raise ClerestoryError(f"{centre!r} is not an outgoing direction (give x, y, z)")
    if (middle[2] > 0.0) != (view.outgoing_side == "interior"):
        raise ClerestoryError(
            f"the centre {outgoing_in_words(middle)} is not on the {view.outgoing_side}, where the light leaves to "
            "(turn its z round)"
        )
    return middle / np.linalg.norm(middle)


def around(
    middle: NDArray[np.float64],
    right: NDArray[np.float64],
    up: NDArray[np.float64],
    offsets_deg: ArrayLike,
) -> NDArray[np.float64]:
    """Directions (n, n, 3) at equal angles around one; NaN beyond the horizon."""
    u, v = np.meshgrid(np.radians(offsets_deg), np.radians(offsets_deg))
    angle = np.hypot(u, v)
    shrink = np.sinc(angle / np.pi)
    made: NDArray[np.float64] = (
        np.cos(angle)[..., None] * middle + (shrink * u)[..., None] * right + (shrink * v)[..., None] * up
    )
    made[(made[..., 2] * np.sign(middle[2]) <= 0.0) | (angle > np.pi)] = np.nan
    return made


def offset(
    direction: NDArray[np.float64],
    middle: NDArray[np.float64],
    right: NDArray[np.float64],
    up: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Place of a direction in the picture [°]."""
    x, y, z = direction @ right, direction @ up, direction @ middle
    sine = np.hypot(x, y)
    factor = np.degrees(np.arctan2(sine, z)) / sine if sine > 0.0 else 0.0
    return np.array([x * factor, y * factor])
