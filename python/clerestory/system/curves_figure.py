"""A picture of what glazing does with light by angle of incidence."""

from __future__ import annotations

from typing import TYPE_CHECKING

from clerestory.plot import style

if TYPE_CHECKING:
    from collections.abc import Mapping

    from matplotlib.figure import Figure

    from clerestory.system.glazing import Curves


@style.styled
def figure(curves: Mapping[str, Curves], norm: str) -> Figure:
    """A panel a band: transmittance, reflectances, and what each pane absorbs of light from outside."""
    made = style.new_figure(3.3 * len(curves) + 0.4, 3.1)
    panels = made.subplots(1, len(curves), sharey=True, squeeze=False)[0]
    for panel, (band, held) in zip(panels, curves.items(), strict=True):
        lines = {
            "transmittance": held.transmittance,
            "reflectance, exterior": held.reflectance["exterior"],
            "reflectance, interior": held.reflectance["interior"],
        }
        several = len(held.absorptance["exterior"]) > 1
        for k, absorbed in enumerate(held.absorptance["exterior"], 1):
            lines[f"absorbed by pane {k}" if several else "absorbed"] = absorbed
        for k, (label, values) in enumerate(lines.items()):
            colour = style.COLOURS[k % len(style.COLOURS)]
            panel.plot(held.theta_deg, values, label=label, color=colour, linestyle=style.DASHES[k % len(style.DASHES)])
        panel.set(title=f"{band}, {norm}", xlabel="angle of incidence [°]", xlim=(0.0, 90.0), ylim=(0.0, 1.0))
        panel.set_xticks(range(0, 91, 15))
        panel.grid(visible=True)
    panels[0].set_ylabel("share of the light")
    panels[0].legend(loc="center left", fontsize=7)
    return made
