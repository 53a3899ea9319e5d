"""Check pictures: the sources coloured in a grey picture, and a table of them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.photometry import LUMINANCE
from clerestory.picture.display import tone_map
from clerestory.picture.image import Picture
from clerestory.plot.style import COLOURS, figures, new_figure, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from clerestory.glare.evaluate import Evaluation

LISTED = 8
"""Sources that the table holds."""


def _labels(found: Evaluation) -> NDArray[np.uint32]:
    if found.labels is None:
        raise ClerestoryError("known sources have no pixels to colour (evaluate a picture)")
    return found.labels


def _rgb(number: int) -> NDArray[np.float64]:
    """Colour of a source; the black of the set would look like no source."""
    from matplotlib.colors import to_rgb

    bright = [colour for colour in COLOURS if colour != "#000000"]
    return np.array(to_rgb(bright[(number - 1) % len(bright)]))


def check_hdr(picture: Picture, found: Evaluation) -> Picture:
    """A grey picture with coloured sources; every pixel keeps its luminance."""
    labels = _labels(found)
    pixels = np.repeat((picture.luminance / 179.0)[..., None], 3, axis=2).astype(np.float64)
    for number in range(1, len(found.sources) + 1):
        colour = _rgb(number) + 0.02
        pixels[labels == number] *= colour / (colour @ LUMINANCE)
    return Picture(pixels, picture.view, header=picture.header)


@styled
def check_picture(picture: Picture, found: Evaluation, *, title: str | None = None) -> Figure:
    """The picture in grey with its sources coloured and numbered, the indices, and a table of the worst sources."""
    labels = _labels(found)
    grey = tone_map(picture) @ np.array([0.2126, 0.7152, 0.0722])
    shown = np.repeat(0.85 * grey[..., None], 3, axis=2)
    for number in range(1, len(found.sources) + 1):
        inside = labels == number
        shown[inside] = 0.25 * shown[inside] + 0.75 * _rgb(number)
    height, width = picture.shape
    tall = 6.0 * min(max(height / width, 0.3), 2.0)
    rows = min(len(found.sources), LISTED)
    figure = new_figure(6.4, tall + 1.75 + 0.17 * rows, constrained=False)
    whole = float(figure.get_figheight())
    ax = figure.add_axes((0.03, 1.0 - (tall + 0.35) / whole, 0.94, tall / whole))
    ax.imshow(shown, interpolation="nearest")
    ax.axis("off")
    ax.set_title(title or "Glare sources")
    for number, source in enumerate(found.sources[:LISTED], 1):
        row, column = np.argwhere(labels == number).mean(axis=0)
        # A number on a small source would hide it.
        small = source.pixels < height * width / 500
        ax.annotate(
            str(number),
            (column, row),
            (16.0, 16.0) if small else (0.0, 0.0),
            textcoords="offset points",
            ha="center",
            va="center",
            fontsize=9,
            fontweight="bold",
            color="black",
            bbox={"boxstyle": "round,pad=0.15", "facecolor": "white", "edgecolor": "none", "alpha": 0.75},
            arrowprops={"arrowstyle": "-", "color": "white", "linewidth": 0.8} if small else None,
        )
    lines = [
        f"DGP {found.dgp:.3f} ({found.dgp_class})   DGI {found.dgi:.1f} ({found.dgi_class})   UGR {found.ugr:.1f}   "
        f"VCP {found.vcp:.0f} %   CGI {found.cgi:.1f}",
        f"E_v {figures(found.vertical_illuminance, 4)} lx   background {figures(found.background_luminance)} cd/m²   "
        f"{len(found.sources)} source{'' if len(found.sources) == 1 else 's'}",
    ]
    lines += _in_lines(found.settings.words(), 105)
    bottom = 1.0 - (tall + 0.5) / whole
    for k, line in enumerate(lines):
        figure.text(0.03, bottom - 0.19 * k / whole, line, fontsize=8 if k < 2 else 7, va="top")
    if rows:
        cells = [
            [
                str(number),
                figures(source.luminance, 4),
                f"{source.solid_angle:.2e}",
                f"{source.sigma_deg:.1f}°",
                f"{source.position_index:.2f}",
                figures(source.illuminance, 3),
                str(source.pixels),
                "peak" if source.peak else "",
            ]
            for number, source in enumerate(found.sources[:LISTED], 1)
        ]
        head = ["", "L [cd/m²]", "ω [sr]", "from sight", "P", "E [lx]", "pixels", ""]
        down = bottom - (0.19 * len(lines) + 0.1) / whole
        for c, name in enumerate(head):
            x = 0.05 + 0.125 * c
            figure.text(x, down, name, fontsize=7.5, va="top", fontweight="bold")
            for r, row in enumerate(cells):
                figure.text(
                    x,
                    down - 0.17 * (r + 1) / whole,
                    row[c],
                    fontsize=7.5,
                    va="top",
                    color=tuple(0.8 * _rgb(r + 1)) if c == 0 else "#222222",
                )
    return figure


def _in_lines(text: str, most: int) -> list[str]:
    import textwrap

    return textwrap.wrap(text, most)
