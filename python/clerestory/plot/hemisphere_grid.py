"""Falsecolour hemispheres of several data sets and incident directions side by side, on one scale."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import MissingDataError
from clerestory.plot import disk, style
from clerestory.plot.hemisphere import mark_peaks, missing_handle, paint
from clerestory.plot.view import PATCHES, View, component_words, labelled, lights
from clerestory.words import common_band

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike

    from clerestory.bsdf import Bsdf
    from clerestory.directions import Scatter, Side
    from clerestory.plot.view import Light

_CELL, _NAME, _HEAD, _FOOT = 1.5, 0.42, 0.85, 0.95
_ROWS = 6


@style.styled
def hemisphere_grid(
    sets: Bsdf | Mapping[str, Bsdf],
    incident: int | ArrayLike | Iterable[int | ArrayLike] = PATCHES,
    *,
    side: Side | None = None,
    scatter: Scatter = "transmission",
    band: str | None = None,
    scale: style.Scale = "log",
    quantity: style.Quantity = "bsdf",
    projection: disk.Projection = "polar",
    limits: tuple[float, float] | None = None,
    pixels: int = 220,
    samples: int = 16,
) -> Figure:
    """Falsecolour hemispheres: a row for each data set, a column for each incident direction, one scale for all.

    More than six data sets stand in two blocks side by side. What a data set does not hold is hatched.

    Parameters
    ----------
    sets
        Data sets by label.
    incident
        Patches of Klems' full basis (from 1) or directions (3,) toward the source.
    side, scatter, band, scale, quantity, projection, limits, pixels
        As for `hemisphere`.
    samples
        Directions over which the value under a picture is averaged where a patch names the light; a square number.
    """
    data, sources = labelled(sets), lights(incident, side)
    band = common_band(data, band)
    views = {(name, k): _view(data[name], s, name, scatter, band) for name in data for k, s in enumerate(sources)}
    images = {
        key: view.evaluate(disk.pixels(pixels, view.outgoing_side, projection), quantity)
        for key, view in views.items()
        if view is not None
    }
    every = np.concatenate([np.zeros(0), *(v[np.isfinite(v)] for v in images.values())])
    norm = style.norm(every, scale, limits)

    names = list(data)
    blocks = 1 if len(names) <= _ROWS else 2
    rows = -(-len(names) // blocks)
    block_width = _NAME + _CELL * len(sources)
    width, height = max(blocks * block_width + 0.2, 5.0), _HEAD + _CELL * rows + _FOOT
    figure = style.new_figure(width, height, constrained=False)
    left = 0.5 * (width - blocks * block_width)
    for n, name in enumerate(names):
        block, row = divmod(n, rows)
        x0, y0 = left + block * block_width, height - _HEAD - (row + 1) * _CELL
        figure.text(
            (x0 + 0.26) / width,
            (y0 + 0.5 * _CELL) / height,
            _folded(name),
            rotation=90,
            ha="center",
            va="center",
            fontsize=9,
            fontweight="bold",
        )
        for k, source in enumerate(sources):
            box = ((x0 + _NAME + k * _CELL) / width, y0 / height, _CELL / width, _CELL / height)
            ax = figure.add_axes(box, label=f"{name}|{source.words}", xticks=[], yticks=[])
            view = views[name, k]
            if row == 0:
                ax.set_title("\n".join(textwrap.wrap(source.words, 20)), fontsize=8, pad=2)
            if view is None:
                disk.prepare(ax)
                ax.text(0, 0, "no data", ha="center", va="center", fontsize=9, path_effects=list(disk.HALO))
            else:
                paint(ax, images[name, k], norm)
                style.cross(ax, disk.project(view.through, projection), size=4)
                mark_peaks(ax, view.peaks(), projection, size=5)
                ax.text(
                    0,
                    -1.03,
                    f"{view.symbol} = {style.figures(view.total(samples=samples))} ({view.total_of})",
                    ha="center",
                    va="top",
                    fontsize=7,
                )
            disk.frame(ax, projection, labels=False)
    words = component_words(band, sources[0].side, scatter)
    leaving = next((v.outgoing_side for v in views.values() if v is not None), "interior")
    figure.text(0.5, 1 - 0.1 / height, words, ha="center", va="top", fontsize=10)
    bar_width = min(4.5, width - 1.0)
    bar_box = (0.5 - 0.5 * bar_width / width, 0.62 / height, bar_width / width, 0.13 / height)
    mappable = style.mappable(norm)
    bar = figure.colorbar(
        mappable, cax=figure.add_axes(bar_box), orientation="horizontal", extend=style.extend(every, norm)
    )
    bar.set_label(f"{style.UNITS[quantity]}\nlight leaving to the {leaving}, as seen from the room")
    if any(v is None for v in views.values()):
        figure.legend(handles=[missing_handle()], loc="upper right")
    return figure


def _view(bsdf: Bsdf, source: Light, label: str, scatter: Scatter, band: str | None) -> View | None:
    try:
        return View.lit(bsdf, source, scatter=scatter, band=band, label=label)
    except MissingDataError:
        return None


def _folded(name: str, width: int = 18) -> str:
    """A label in two lines at most, cut with an ellipsis."""
    if len(name) <= width:
        return name
    cut = max(name.rfind(" ", 0, width + 1), *(name.rfind(mark, 0, width) + 1 for mark in "-_/,")) or width
    rest = name[cut:].strip()
    return name[:cut].strip() + "\n" + (rest if len(rest) <= width else rest[: width - 1] + "…")
