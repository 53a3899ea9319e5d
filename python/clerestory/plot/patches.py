"""The patches of an angle basis with their numbers, bare or coloured by a data set."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, get_args

import numpy as np
from matplotlib.collections import PatchCollection
from matplotlib.patches import Circle, Patch, Wedge

from clerestory._core import ClerestoryError
from clerestory.basis import Basis
from clerestory.bsdf import Region
from clerestory.counts import counted
from clerestory.plot import disk, style
from clerestory.plot.view import View

if TYPE_CHECKING:
    from collections.abc import Iterable

    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike, NDArray

    from clerestory.bsdf import Bsdf
    from clerestory.directions import Scatter, Side

Show = Literal["number", "value", "both", "none"]
_WIDTH = 8.4  # inches of a figure
_RADIUS_PT = 222.0  # points of the disk's radius in such a figure, near enough to choose the size of type
_LEAST_PT = 3.0  # type that one can still read on a screen that is zoomed


@style.styled
def patches(
    bsdf: Bsdf,
    incident: int | ArrayLike,
    *,
    basis: Basis | None = None,
    side: Side | None = None,
    scatter: Scatter = "transmission",
    band: str | None = None,
    label: str = "",
    show: Show = "both",
    scale: style.Scale = "log",
    quantity: style.Quantity = "bsdf",
    projection: disk.Projection = "polar",
    regions: Iterable[Region] = (),
    limits: tuple[float, float] | None = None,
    ax: Axes | None = None,
) -> Figure:
    """The outgoing patches of a basis, coloured by the light that leaves into them, as seen from the room.

    The colour is the mean BSDF of a patch, peaks included: flux into the patch over its projected solid angle.

    Parameters
    ----------
    basis
        Patches to draw; those of the data set if it is a matrix, or else Klems' full basis.
    show
        What is written into the patches: their numbers (from 1), their values, both or nothing. What would be too
        small to read is left out.
    bsdf, incident, side, scatter, band, label, scale, quantity, projection, regions, limits, ax
        As for `hemisphere`.

    Raises
    ------
    MissingDataError
        The data set does not hold this component.
    """
    if show not in get_args(Show):
        raise ClerestoryError(f"{show!r} cannot be shown (give number, value, both or none)")
    view = View.of(bsdf, incident, side=side, scatter=scatter, band=band, label=label)
    basis = basis or _own_basis(view) or Basis.named("klems-full")
    values = patch_values(view, basis, quantity)
    norm = style.norm(values, scale, limits)
    chosen = list(regions)
    if ax is None:
        lines = view.title.count("\n") + len(chosen)
        ax = style.new_figure(_WIDTH, _WIDTH - 0.3 + 0.18 * lines).add_subplot()
    figure = style.figure_of(ax)
    disk.prepare(ax)
    collection = PatchCollection(
        _shapes(basis, projection), cmap=style.colours(), norm=norm, edgecolor="white", linewidth=0.5, zorder=1
    )
    collection.set_array(values)
    ax.add_collection(collection)
    words: dict[Show, list[list[str]]] = {
        "number": [[f"{i + 1}"] for i in range(len(basis))],
        "value": [[_short(float(v))] for v in values],
        "both": [[f"{i + 1}", _short(float(v))] for i, v in enumerate(values)],
        "none": [[] for _ in values],
    }
    inks = ["black" if _luminance(colour) > 0.42 else "white" for colour in style.colours()(norm(values))]
    _write(ax, basis, projection, words[show], inks)
    disk.frame(ax, projection, circles=False)
    # A border, since a cross would hide the number.
    home = int(basis.index_of_outgoing(view.through))
    for colour, width in (("white", 3.0), (style.INK, 1.6)):
        border = _shapes(basis, projection)[home]
        border.set(fill=False, edgecolor=colour, linewidth=width, zorder=2)
        ax.add_patch(border)
    handles: list[Artist] = [Patch(fill=False, edgecolor=style.INK, linewidth=1.6, label=view.through_words)]
    handles += disk.outlines(ax, chosen, view, projection)
    ax.set_title(view.title)
    bar = figure.colorbar(collection, ax=ax, shrink=0.82, pad=0.02, extend=style.extend(values, norm))
    bar.set_label(f"mean {style.UNITS[quantity]} of a patch of {basis.name}")
    style.legend_below(
        ax,
        handles,
        f"light leaving to the {view.outgoing_side}, as seen from the room",
    )
    return figure


@style.styled
def basis_patches(
    basis: Basis,
    *,
    of: Literal["outgoing", "incident"] = "outgoing",
    marked: Iterable[int] = (),
    projection: disk.Projection = "polar",
    ax: Axes | None = None,
) -> Figure:
    """The patches of a basis with their numbers, as seen from the room.

    Parameters
    ----------
    of
        `outgoing`: a patch stands where its light goes to. `incident`: where its light comes from, which is the
        opposite place, since patches are found by the direction of travel.
    marked
        Numbers of patches (from 1) to set off.
    projection, ax
        As for `hemisphere`.
    """
    if of not in ("outgoing", "incident"):
        raise ClerestoryError(f"patches of {of!r} directions are not known (give outgoing or incident)")
    wanted = {int(n) for n in marked}
    strange = [n for n in sorted(wanted) if not 1 <= n <= len(basis)]
    if strange:
        raise ClerestoryError(f"{basis.name} has no patch {strange[0]} (give 1 to {len(basis)})")
    if ax is None:
        ax = style.new_figure(_WIDTH - 1.4, _WIDTH - 1.0).add_subplot()
    disk.prepare(ax)
    turn = 180.0 if of == "incident" else 0.0
    shapes = _shapes(basis, projection, turn)
    collection = PatchCollection(
        shapes,
        facecolor=["#cfe3f3" if i + 1 in wanted else "white" for i in range(len(shapes))],
        edgecolor=style.INK,
        linewidth=0.6,
        zorder=1,
    )
    ax.add_collection(collection)
    numbers = [[f"{i + 1}"] for i in range(len(basis))]
    _write(ax, basis, projection, numbers, [style.INK] * len(basis), turn_deg=turn)
    disk.frame(ax, projection, circles=False, words=disk.INCIDENT_WORDS if turn else disk.OUTGOING_WORDS)
    where = "light that comes from there" if turn else "light that goes there"
    ax.set_title(
        f"{basis.name}: {counted(len(basis), 'patch', 'patches')}\n{of} directions ({where}), as seen from the room"
    )
    return style.figure_of(ax)


def patch_values(view: View, basis: Basis, quantity: style.Quantity = "bsdf") -> NDArray[np.float64]:
    """Mean BSDF [1/sr] of the light that leaves into every patch (n,), peaks included; or flux over solid angle."""
    areas = {"bsdf": basis.projected_solid_angles, "dsf": basis.solid_angles}
    if quantity not in areas:
        raise ClerestoryError(f"quantity {quantity!r} is not known (give bsdf or dsf)")
    flux = np.array([view.total(Region.patches(basis, [i])) for i in range(len(basis))])
    return np.asarray(flux / areas[quantity])


def _own_basis(view: View) -> Basis | None:
    model, _ = view.bsdf.model(view.light.side, view.scatter, view.band)
    return model.outgoing_basis if model.kind == "matrix" else None


def _shapes(basis: Basis, projection: disk.Projection, turn_deg: float = 0.0) -> list[Patch]:
    shapes: list[Patch] = []
    for lower, upper, left, right in basis.limits_deg:
        inner, outer = disk.radius([lower, upper], projection)
        if right - left > 359.0:
            shapes.append(Circle((0.0, 0.0), outer))
        else:
            shapes.append(Wedge((0.0, 0.0), outer, left + turn_deg, right + turn_deg, width=outer - inner))
    return shapes


def _write(
    ax: Axes,
    basis: Basis,
    projection: disk.Projection,
    lines: list[list[str]],
    inks: list[str],
    *,
    turn_deg: float = 0.0,
) -> None:
    """Lines of text in the middle of every patch, in a type that fits; only the first where more would be too small."""
    points = _sizes(basis, projection, lines, turn_deg)
    if np.median(points) < _LEAST_PT:
        lines = [words[:1] for words in lines]
        points = _sizes(basis, projection, lines, turn_deg)
    points = np.minimum(points, 1.2 * np.median(points))
    for (lower, upper, left, right), words, ink, size in zip(basis.limits_deg, lines, inks, points, strict=True):
        if not words or size < _LEAST_PT:
            continue
        inner, outer = (float(r) for r in disk.radius([lower, upper], projection))
        middle = 0.0 if right - left > 359.0 else 0.5 * (inner + outer)
        azimuth = np.radians(0.5 * (left + right) + turn_deg)
        ax.text(
            middle * np.cos(azimuth),
            middle * np.sin(azimuth),
            "\n".join(words),
            fontsize=size,
            ha="center",
            va="center",
            color=ink,
            zorder=8,
            linespacing=1.0,
        )


def _sizes(basis: Basis, projection: disk.Projection, lines: list[list[str]], turn_deg: float) -> NDArray[np.float64]:
    """Largest size of type [pt] in which words fit into each patch."""
    sizes = np.empty(len(lines))
    for i, ((lower, upper, left, right), words) in enumerate(zip(basis.limits_deg, lines, strict=True)):
        inner, outer = (float(r) for r in disk.radius([lower, upper], projection))
        # Width and height of the words in units of their size: a digit is 0.64 wide, a line 1.15 high.
        width, height = 0.64 * max(map(len, words), default=1), 1.15 * max(len(words), 1)
        if right - left > 359.0:
            sizes[i] = 2.0 * outer / np.hypot(width, height)
            continue
        azimuth, middle = np.radians(0.5 * (left + right) + turn_deg), 0.5 * (inner + outer)
        # Sectors taper: what fits somewhat inward of the middle fits.
        radial = outer - inner
        along = 2.0 * (middle - 0.2 * radial) * np.tan(np.radians(0.5 * min(right - left, 90.0)))
        c, s = abs(np.cos(azimuth)), abs(np.sin(azimuth))
        # An upright box in a sector that is turned by the azimuth: its shadow on both of the sector's axes must fit.
        sizes[i] = min(radial / (width * c + height * s), along / (width * s + height * c))
    return np.minimum(0.92 * _RADIUS_PT * sizes, 9.0)


def _short(value: float) -> str:
    """A value in two figures and few characters."""
    return style.figures(value, 2).removeprefix("0") or "0"


def _luminance(colour: NDArray[np.float64]) -> float:
    """Relative luminance of an sRGB colour, near enough to choose black or white for what is written on it."""
    return float(np.asarray(colour[:3]) ** 2.2 @ [0.2126, 0.7152, 0.0722])
