"""Measured points beside the fitted curve."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.directions import direction
from clerestory.measure.formula.beam import Spread, apart_from, seen
from clerestory.measure.formula.shapes import Geometry
from clerestory.plot import style
from clerestory.plot.slices import in_plane

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from clerestory.measure.formula.found import Fitted
    from clerestory.measure.scan import Measurement, Scan

    Floats = NDArray[np.float64]

_MOST = 5
"""Incident angles that are drawn."""
_ASIDE = np.sin(np.radians(1.0))
"""Points this close to the plane of incidence, in direction cosines, are drawn in the cut."""
_DECADES = 6.0
_LEAST_U = 1e-3


@style.styled
def picture(fits: Sequence[Fitted], measurement: Measurement) -> Figure:
    """A row for each component: a cut in the plane of incidence, and all points over their distance u.

    Dots were measured, lines are what the instrument would see of the formula; where its beam is known, the sample's
    own scattering is dashed.

    Raises
    ------
    ClerestoryError
        Nothing was fitted.
    """
    if not fits:
        raise ClerestoryError("no formula was fitted")
    figure = style.new_figure(11.0, 4.0 * len(fits) + 0.3)
    panels = figure.subplots(len(fits), 2, squeeze=False)
    for one, (cut, over) in zip(fits, panels, strict=True):
        scans = [s.as_bsdf() for s in measurement.of(one.side, one.scatter) if one.band in s.channels]
        largest = max(float(s.channel(one.band).max()) for s in scans)
        for number, theta in enumerate(_chosen(one.thetas_deg)):
            here = [s for s in scans if abs(s.incident_theta_deg - theta) < 1e-6]
            _draw(cut, over, one, here, f"{theta:g}°", number)
        for axes in (cut, over):
            axes.set_yscale("log", nonpositive="mask")
            low = max(0.3 * _least(scans, one.band), largest * 10.0**-_DECADES)
            axes.set_ylim(low, 3.0 * largest)
            axes.grid(visible=True)
            axes.set_ylabel(style.UNITS["bsdf"])
        cut.set(xlim=(-90.0, 90.0), xlabel="angle to the normal in the plane of incidence [°]")
        cut.set_xticks(np.arange(-90, 91, 30))
        cut.set_title(f"{one.where}\n{one.formula.name}", loc="left")
        over.set_xscale("log")
        straight = "mirrored" if one.scatter == "reflection" else "straight"
        over.set(xlim=(_LEAST_U, 2.0), xlabel=f"distance u from the {straight} direction, in direction cosines")
        over.set_title(one.lines()[1].partition("; ")[2].replace("; ", "\n"), loc="left", fontsize=8)
        over.legend(title="incident", loc="lower left")
    return figure


def _least(scans: Sequence[Scan], band: str) -> float:
    values = np.concatenate([s.channel(band) for s in scans])
    return float(values[values > 0.0].min()) if (values > 0.0).any() else 1e-6


def _chosen(thetas: Sequence[float]) -> list[float]:
    picked = np.unique(np.round(np.linspace(0, len(thetas) - 1, min(_MOST, len(thetas)))).astype(int))
    return [thetas[k] for k in picked]


def _draw(cut: Axes, over: Axes, one: Fitted, scans: Sequence[Scan], label: str, number: int) -> None:
    look = style.line(number)
    first = scans[0]
    away = 270.0 if first.incident_theta_deg < 1e-6 else first.incident_phi_deg + 180.0
    side = np.radians(away)
    for scan in scans:
        values, out = scan.channel(one.band), scan.outgoing
        beside = np.abs(out @ [-np.sin(side), np.cos(side), 0.0]) < _ASIDE
        along = np.degrees(np.arctan2(out @ [np.cos(side), np.sin(side), 0.0], np.abs(out[:, 2])))
        dots = {"linestyle": "none", "marker": ".", "color": look["color"], "rasterized": len(scan) > 3000}
        cut.plot(along[beside], values[beside], markersize=4.0, **dots)
        u = Geometry.of(scan.incident, out).u
        over.plot(np.maximum(u, _LEAST_U), values, markersize=2.0, alpha=0.5, **dots)
    alpha = np.unique(np.concatenate([np.linspace(-89.0, 89.0, 357), _fine(first.incident_theta_deg)]))
    seen_here, own = _curves(one, first, in_plane(alpha, away, first.side))
    cut.plot(alpha, seen_here, color=look["color"], linewidth=1.2)
    # Over u, the curve of the plane's longer arm, from the mirrored or straight direction back over the normal.
    middle = np.sin(np.radians(first.incident_theta_deg))
    u = np.geomspace(_LEAST_U, middle + np.sin(np.radians(85.0)), 300)
    back = direction(
        np.degrees(np.arcsin(np.abs(middle - u))), np.where(u > middle, away + 180.0, away), side=first.side
    )
    along_u, own_u = _curves(one, first, back)
    over.plot(u, along_u, color=look["color"], linewidth=1.2, label=label)
    if one.beam is not None:
        cut.plot(alpha, own, color=look["color"], linewidth=1.0, linestyle=(0, (2, 2)))
        over.plot(u, own_u, color=look["color"], linewidth=1.0, linestyle=(0, (2, 2)))


def _fine(theta_deg: float) -> Floats:
    """Angles close to a peak."""
    off = np.concatenate([-np.geomspace(8.0, 0.02, 60), np.geomspace(0.02, 8.0, 60)])
    return np.clip(theta_deg + off, -89.0, 89.0)


def _curves(one: Fitted, scan: Scan, outgoing: Floats) -> tuple[Floats, Floats]:
    """What the instrument sees of a formula along directions, and the sample's own scattering."""
    geometry = Geometry.of(scan.incident, outgoing)
    middle = geometry.incident[0] * [-1.0, -1.0, 1.0]
    spread = None if one.beam is None else Spread.of(one.beam, middle, geometry.outgoing)
    held = one.values(scan.incident_theta_deg)
    along = seen(one.formula, held, one.beam, geometry, apart_from(geometry.outgoing, middle), spread)
    return along, one.evaluate(scan.incident, outgoing)
