"""Pictures for people: falsecolour with a scale and isolines, and tone mapping."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.plot.style import colours, extend, figures, new_figure, norm, styled

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from clerestory.picture.image import Picture
    from clerestory.plot.style import Scale

WIDTH = 6.4
"""Of a figure [inches]."""


@styled
def falsecolour(
    picture: Picture,
    *,
    scale: Scale = "log",
    limits: tuple[float, float] | None = None,
    isolines: Sequence[float] | None = None,
    title: str | None = None,
) -> Figure:
    """Luminance in colours with a scale beside it.

    Parameters
    ----------
    picture
        The picture.
    scale
        log or linear.
    limits
        Ends of the scale [cd/m²]; from the 99.9th percentile down by default.
    isolines
        Luminances at which lines are drawn [cd/m²]; none by default.
    title
        Over the picture.
    """
    luminance = picture.luminance.astype(np.float64)
    if not np.isfinite(luminance).all():
        raise ClerestoryError("the picture has luminances that are not finite (correct it)")
    if limits is None:
        # A sun of a few pixels would take all colours from the room.
        bulk = np.minimum(luminance, max(float(np.percentile(luminance, 99.9)), 1e-9))
        colour_scale = norm(bulk, scale)
    else:
        colour_scale = norm(luminance, scale, limits)
    figure = _figure(picture, extra=1.0)
    ax = figure.add_subplot()
    image = ax.imshow(
        luminance, norm=colour_scale, cmap=colours(), interpolation="nearest", aspect=picture.pixel_aspect
    )
    ax.axis("off")
    if title:
        ax.set_title(title)
    if isolines:
        lines = ax.contour(luminance, levels=sorted(isolines), colors="white", linewidths=0.8)
        ax.clabel(lines, fmt=lambda value: figures(float(value)), fontsize=7)
    figure.colorbar(image, ax=ax, label="luminance [cd/m²]", extend=extend(luminance, colour_scale), shrink=0.85)
    return figure


def tone_map(picture: Picture, *, key: float = 0.18, white: float | None = None) -> NDArray[np.float64]:
    """Colours (height, width, 3) from 0 to 1 for a screen, by the global operator of Reinhard et al. (2002).

    Parameters
    ----------
    picture
        The picture.
    key
        Grey that the mean (of logarithms) becomes.
    white
        Luminance [cd/m²] that just becomes white; the 99.9th percentile by default.
    """
    luminance = picture.luminance.astype(np.float64)
    lit = luminance[luminance > 0.0]
    if lit.size == 0:
        return np.zeros((*luminance.shape, 3))
    factor = key / float(np.exp(np.log(lit).mean()))
    top = factor * float(np.percentile(lit, 99.9) if white is None else white)
    scaled = factor * luminance
    shown = scaled * (1.0 + scaled / top**2) / (1.0 + scaled)
    gain = np.divide(shown, luminance, out=np.zeros_like(shown), where=luminance > 0.0)
    linear = np.clip(179.0 * picture.pixels.astype(np.float64) * gain[..., None], 0.0, 1.0)
    # The curve of sRGB (IEC 61966-2-1); Radiance's primaries are near enough to its own.
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1.0 / 2.4) - 0.055)


@styled
def tone_mapped(picture: Picture, *, key: float = 0.18, white: float | None = None, title: str | None = None) -> Figure:
    """The picture as an eye might see it; see `tone_map`."""
    figure = _figure(picture)
    ax = figure.add_subplot()
    ax.imshow(tone_map(picture, key=key, white=white), interpolation="nearest", aspect=picture.pixel_aspect)
    ax.axis("off")
    if title:
        ax.set_title(title)
    return figure


def _figure(picture: Picture, extra: float = 0.0) -> Figure:
    height, width = picture.shape
    tall = WIDTH * min(max(height * picture.pixel_aspect / width, 0.2), 3.0)
    return new_figure(WIDTH + extra, tall + 0.3)
