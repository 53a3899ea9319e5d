"""Measured, simulated and hybrid data side by side."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.directions import direction
from clerestory.plot import style
from clerestory.plot.slices import slices

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from clerestory.measure.hybrid.join import Hybrid

_AZIMUTH_DEG = 90.0
"""Of the incident light: a sun above."""
_USUAL_DEG = 40.0


@style.styled
def picture(made: Hybrid) -> Figure:
    """A row for each component that was joined: two cuts in the plane of incidence, and direct-hemispherical values.

    The cuts are of light from above at 40°, and from as far as the seam.

    Raises
    ------
    ClerestoryError
        Nothing was joined.
    """
    rows = [part for part in made.parts if part.measured_solid_angle > 0.0]
    if not rows:
        raise ClerestoryError("nothing was measured that could be drawn beside the simulation")
    sets = {"measured": made.measured, "simulated, scaled": made.simulated, "hybrid": made.bsdf}
    figure = style.new_figure(12.6, 3.5 * len(rows) + 0.3)
    panels = figure.subplots(len(rows), 3, squeeze=False)
    for part, row in zip(rows, panels, strict=True):
        steep = min(85.0, part.limit_deg)
        for axes, theta in zip(row[:2], (min(_USUAL_DEG, steep), steep), strict=True):
            slices(
                sets,
                direction(theta, _AZIMUTH_DEG, side=part.side),
                side=part.side,
                scatter=part.scatter,
                band=part.band,
                step_deg=0.5,
                ax=axes,
            )
            axes.get_legend().remove()
            axes.set_xlabel("angle to the normal [°]", labelpad=-8)
        axes = row[2]
        polar = np.linspace(0.0, 89.0, 179)
        incident = direction(polar, np.full(len(polar), _AZIMUTH_DEG), side=part.side)
        for n, (name, bsdf) in enumerate(sets.items()):
            axes.plot(polar, bsdf.integrate(incident, part.scatter, band=part.band), label=name, **style.line(n))
        axes.axvline(part.limit_deg, color="#909090", linewidth=0.8, linestyle=(0, (2, 2)), zorder=0)
        axes.set(xlim=(0.0, 90.0), xlabel="incident angle [°]", ylabel="direct-hemispherical")
        axes.set_ylim(bottom=0.0)
        axes.set_title(f"{part.where}\nup to the line measured")
        axes.grid(visible=True)
    handles, labels = panels[0][2].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3)
    return figure
