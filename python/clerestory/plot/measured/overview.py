"""All incident directions of a measurement in one picture."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.counts import counted
from clerestory.plot import disk, style
from clerestory.plot.measured.points import scatter_points
from clerestory.plot.measured.subject import by_direction, chosen, scale_of, together
from clerestory.plot.view import component_words

if TYPE_CHECKING:
    from collections.abc import Iterable

    from matplotlib.figure import Figure

    from clerestory.directions import Scatter, Side
    from clerestory.measure.scan import Scan

_MOST = 400
_INCH = 1.35
"""Width of a panel."""


@style.styled
def overview_figure(
    scans: Iterable[Scan],
    *,
    side: Side | None = None,
    scatter: Scatter | None = None,
    channel: str | None = None,
    label: str = "",
    scale: style.Scale = "log",
    quantity: style.Quantity = "bsdf",
    projection: disk.Projection = "polar",
    limits: tuple[float, float] | None = None,
) -> Figure:
    """Points of every incident direction on one scale, a panel each; one more shows where the light came from.

    Parameters
    ----------
    side, scatter, channel, label, scale, quantity, projection, limits
        As for `points_figure`.

    Raises
    ------
    MissingDataError
        There is no such scan or channel.
    ClerestoryError
        There are more than 400 incident directions.
    """
    of = [together(group, channel=channel, label=label) for group in by_direction(chosen(scans, side, scatter))]
    if len(of) > _MOST:
        raise ClerestoryError(f"{len(of)} incident directions do not fit in one picture (choose up to {_MOST})")
    values = [one.values(quantity) for one in of]
    norm = scale_of(np.concatenate(values), scale, limits)
    count = len(of) + 1
    across = int(np.clip(np.ceil(np.sqrt(1.3 * count)), 3, 20))
    down = -(-count // across)
    figure = style.new_figure(_INCH * across + 0.9, (_INCH + 0.26) * down + 1.0)
    panels = list(figure.subplots(down, across, squeeze=False).flat)
    first = panels[0]
    disk.prepare(first)
    first.patches[0].set(facecolor="white", hatch=None)
    disk.frame(first, projection, labels=False)
    # As seen from the room, where the light comes from; the frame of both sides is one.
    places = disk.project(np.array([one.scan.incident for one in of]), projection)
    first.plot(*places.T, linestyle="none", marker=".", markersize=4, color="#d55e00")
    first.set_title("light comes from", fontsize=7)
    for panel, one, found in zip(panels[1:], of, values, strict=False):
        scatter_points(panel, one.scan.outgoing, found, norm, projection, inches=_INCH)
        disk.frame(panel, projection, labels=False)
        style.cross(panel, disk.project(one.through, projection), size=3.0)
        panel.set_title(f"θ {one.scan.incident_theta_deg:g}°, φ {one.scan.incident_phi_deg:g}°", fontsize=7)
    for panel in panels[count:]:
        panel.set_visible(False)
    component = component_words(of[0].scan.channels[0], of[0].scan.incident_side, of[0].scan.scatter)
    points = counted(sum(len(one.scan) for one in of), "point")
    head = [label] if label else []
    directions = counted(len(of), "incident direction")
    figure.suptitle("\n".join([*head, component, f"{directions}, {points}; as seen from the room"]), fontsize=9.5)
    bar = figure.colorbar(style.mappable(norm), ax=panels, shrink=0.7, aspect=30, pad=0.02)
    bar.set_label(style.UNITS[quantity])
    return figure
