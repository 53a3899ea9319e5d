"""Direct-hemispherical transmittance or reflectance over all incident directions."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.colors import Normalize

from clerestory.plot import disk, style
from clerestory.plot.hemisphere import paint
from clerestory.plot.view import component_words
from clerestory.words import common_band

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from clerestory.bsdf import Bsdf
    from clerestory.directions import Scatter, Side


@style.styled
def transmittance_map(
    bsdf: Bsdf,
    *,
    minus: Bsdf | None = None,
    side: Side = "exterior",
    scatter: Scatter = "transmission",
    band: str | None = None,
    label: str = "",
    minus_label: str = "",
    projection: disk.Projection = "polar",
    limits: tuple[float, float] | None = None,
    pixels: int | None = None,
    ax: Axes | None = None,
) -> Figure:
    """Direct-hemispherical value in falsecolour, each incident direction where its light comes from.

    As figures 22 and 23 of the report of IEA SHC Task 61 (2021, C.2.2).

    Parameters
    ----------
    bsdf, minus
        Data set, and one to be taken from it: then the picture shows the difference.
    side
        The side that the light comes from. Above is above, and right is right, as seen from the room, for both.
    label, minus_label
        Names of the data sets for the title.
    limits
        Ends of the scale; 0 to the largest value by default, or even to both sides of 0 for a difference.
    pixels
        Width of the disk in pixels; by default 360 for a matrix and 180 for models that must be integrated anew for
        each direction.
    scatter, band, projection, ax
        As for `hemisphere`.

    Raises
    ------
    MissingDataError
        A data set does not hold this component.
    """
    members = [bsdf] if minus is None else [bsdf, minus]
    band = common_band(dict(zip((label, f"minus {minus_label}"), members, strict=False)), band)
    models = [b.model(side, scatter, band) for b in members]
    count = pixels or (360 if all(model.kind == "matrix" for model, _ in models) else 180)
    directions = disk.pixels(count, side, projection)
    values = direct_hemispherical_at(bsdf, directions, side, scatter, band)
    symbol = f"${'T' if scatter == 'transmission' else 'R'}_{{\\mathrm{{d‐h}}}}$"
    if minus is None:
        norm, title, quantity = style.norm(values, "linear", limits), label, symbol
        colours = style.colours()
    else:
        values = values - direct_hemispherical_at(minus, directions, side, scatter, band)
        most = float(np.nanmax(np.abs(values))) or 1.0
        low, high = limits if limits is not None else (-most, most)
        norm, colours = Normalize(low, high), style.difference_colours()
        title, quantity = f"{label or 'first'} − {minus_label or 'second'}", f"difference of {symbol}"
    if ax is None:
        ax = style.new_figure(6.0, 5.4 + 0.18 * (len(title) // 60)).add_subplot()
    figure = style.figure_of(ax)
    image = paint(ax, values, norm)
    image.set_cmap(colours)
    disk.frame(ax, projection, words=disk.INCIDENT_WORDS)
    words = component_words(band, side, scatter, by_reciprocity=any(r for _, r in models))
    title = "\n".join(textwrap.wrap(title, 60))
    ax.set_title("\n".join(t for t in (title, words, "incident directions, as seen from the room") if t))
    bar = figure.colorbar(image, ax=ax, shrink=0.82, pad=0.02, extend=style.extend(values, norm))
    bar.set_label(f"{quantity} [–]")
    return figure


def direct_hemispherical_at(
    bsdf: Bsdf, directions: NDArray[np.float64], side: Side, scatter: Scatter, band: str | None
) -> NDArray[np.float64]:
    """Direct-hemispherical values for incident directions (..., 3); NaN where a direction is NaN."""
    known = np.all(np.isfinite(directions), axis=-1)
    values = np.full(directions.shape[:-1], np.nan)
    model, _ = bsdf.model(side, scatter, band)
    if model.kind != "matrix":
        values[known] = bsdf.integrate(directions[known], scatter, band=band)
        return values
    # A matrix has one value a patch: as many integrals as there are patches in sight.
    basis = model.incident_basis
    patch = basis.index_of_incident(directions[known])
    seen, first, back = np.unique(patch, return_index=True, return_inverse=True)
    del seen
    values[known] = bsdf.integrate(directions[known][first], scatter, band=band)[back]
    return values
