"""Pictures of skies for people: luminance in falsecolour, with the sun and the points of the compass."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.patches import Circle

from clerestory.photometry import EFFICACY, LUMINANCE
from clerestory.plot import style
from clerestory.sky.picture import fisheye, place
from clerestory.sky.position import SunPosition

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from clerestory.sky.model import Sky

_PIXELS = 600


@style.styled
def falsecolour(sky: Sky, *, scale: style.Scale = "log", limits: tuple[float, float] | None = None) -> Figure:
    """Luminance of a sky, looking up: north at the top, east at the left.

    Parameters
    ----------
    sky
        The sky; one in solar watts shows radiance.
    scale
        Of the colours.
    limits
        Ends of the scale [cd/m², or W/(m² sr)].
    """
    visible = sky.settings.quantity == "visible"
    image = fisheye(sky, _PIXELS, with_sun=False) @ (EFFICACY * LUMINANCE if visible else LUMINANCE)
    y, x = np.meshgrid(np.arange(_PIXELS) + 0.5, np.arange(_PIXELS) + 0.5, indexing="ij")
    inside = np.hypot(2 * x / _PIXELS - 1, 2 * y / _PIXELS - 1) <= 1.0
    values = np.where(inside, image, np.nan)
    norm = style.norm(values, scale, limits)
    figure = style.new_figure(6.4, 5.6)
    ax = figure.add_subplot()
    shown = ax.imshow(values, norm=norm, cmap=style.colours(), extent=(0, 1, 1, 0), interpolation="bilinear")
    shown.set_clip_path(Circle((0.5, 0.5), 0.5, transform=ax.transData))
    _grid(ax, sky.settings.north_deg)
    _mark_sun(ax, sky)
    bar = figure.colorbar(shown, ax=ax, shrink=0.82, pad=0.02, extend=style.extend(values, norm))
    bar.set_label("luminance [cd/m²]" if visible else "radiance [W/(m² sr)]")
    ax.set_title("\n".join(_title(sky)), loc="left")
    return figure


def _title(sky: Sky) -> list[str]:
    settings = sky.settings
    lines = [f"{settings.kind} sky", f"sun {settings.sun.words}"]
    if settings.quantity == "visible":
        sun = sky.sun
        direct = "" if sun is None else f", sun {style.figures(179.0 * sky.direct_normal)} lx on a plane that faces it"
        lines.append(f"sky {style.figures(sky.diffuse_horizontal_illuminance)} lx horizontal{direct}")
    else:
        lines.append(f"sky {style.figures(sky.diffuse_horizontal)} W/m² horizontal")
    return lines


def _grid(ax: Axes, north_deg: float) -> None:
    for altitude in (30, 60):
        radius = (90 - altitude) / 180.0
        ax.add_patch(Circle((0.5, 0.5), radius, fill=False, color="white", linewidth=0.5, alpha=0.6))
        ax.text(
            0.5, 0.5 - radius - 0.006, f"{altitude}°", color="white", ha="center", va="bottom", fontsize=7, alpha=0.9
        )
    ax.add_patch(Circle((0.5, 0.5), 0.5, fill=False, color=style.INK, linewidth=0.8))
    for azimuth, name in enumerate(("N", "NE", "E", "SE", "S", "SW", "W", "NW")):
        angle = math.radians(45.0 * azimuth - north_deg)
        x, y = -math.sin(angle), -math.cos(angle)
        ax.plot([0.5 + 0.5 * x, 0.5 + 0.512 * x], [0.5 + 0.5 * y, 0.5 + 0.512 * y], color=style.INK, linewidth=0.8)
        weight = "bold" if len(name) == 1 else "normal"
        ax.text(0.5 + 0.54 * x, 0.5 + 0.54 * y, name, ha="center", va="center", fontsize=9, fontweight=weight)
    ax.set_xlim(-0.07, 1.07)
    ax.set_ylim(1.07, -0.07)
    ax.set_aspect("equal")
    ax.set_axis_off()


def _mark_sun(ax: Axes, sky: Sky) -> None:
    sun = sky.settings.sun
    if sun.altitude_deg < 0:
        return
    toward = SunPosition(sun.altitude_deg, sun.azimuth_deg - sky.settings.north_deg).direction
    x, y = place(np.array(toward), 1.0)
    name = "sun" if sky.sun is not None else "sun (not seen)"
    style.cross(ax, np.array([x, y]), name, size=7.0)
    ax.legend(loc="lower right", bbox_to_anchor=(1.06, -0.06), handletextpad=0.4)
