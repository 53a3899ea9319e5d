"""Fitted formulas as a data set: a tensor tree of the scattered light, the beam beside it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory import _core
from clerestory._core import ClerestoryError, __version__
from clerestory.bsdf import Bsdf
from clerestory.model import Model
from clerestory.words import percent

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from clerestory.directions import Scatter, Side
    from clerestory.measure.formula.found import Fitted

    Floats = NDArray[np.float64]

_ACROSS = 2
"""Directions along each side of a cell over which what is smooth there is averaged."""
_NEAR = 6.0
"""Cells within so many widths of the mirrored or straight direction are summed over rings about it."""
_RINGS, _SECTORS = 120, 96
_FINEST = 1e-6
"""Radius of the innermost ring, in direction cosines."""
_RADII = 3
"""Incident directions a cell."""
_BEAM_STEPS = 181
_TOTAL_CELLS = 128


@dataclass(frozen=True)
class _Cells:
    """Outgoing directions, the same for all incident ones."""

    n: int
    """Cells an axis."""
    middles: Floats
    """(n², 3)."""
    fine: Floats
    """Of the parts of cells over which what is smooth is averaged."""

    @classmethod
    def of(cls, n: int) -> _Cells:
        return cls(n, _core.square_directions(n), _core.square_directions(_ACROSS * n))


def data_set(
    fits: Sequence[Fitted],
    *,
    name: str = "",
    resolution: int = 6,
    progress: Callable[[float], object] | None = None,
) -> tuple[Bsdf, list[str]]:
    """A data set of fitted formulas, and what one should know of it.

    Parameters
    ----------
    fits
        A component each.
    name
        Of the sample.
    resolution
        2^resolution cells an axis: a tensor tree of rank 3, or 4 for a formula that is not alike all around.
    progress
        Called with the share that is done, 0 to 1.

    Raises
    ------
    ClerestoryError
        There is nothing to put together, or the resolution is not possible.
    """
    if not fits:
        raise ClerestoryError("no formula was fitted")
    if not 2 <= resolution <= 8:
        raise ClerestoryError(f"resolution {resolution} is not possible for a formula's tree (give 2 to 8)")
    bands: dict[str, dict[tuple[Side, Scatter], Model]] = {}
    warnings: list[str] = []
    comments = [f"clerestory {__version__} measure formula: parameters fitted to scans"]
    for number, one in enumerate(fits):
        values, most = _grid(one, resolution, _within(progress, number, len(fits)))
        if most > 1.0:
            warnings.append(
                f"{one.where}: up to {percent(most)} of the light would leave; such incident directions are scaled to 1"
            )
        tree = Model.tree_from_grid(values)
        angles = np.degrees(np.arccos(np.linspace(0.0, 1.0, _BEAM_STEPS)))
        beam = one.specular(angles)
        parts = [(1.0, tree), *([(1.0, Model.specular(beam, by="cosine"))] if beam.any() else [])]
        bands.setdefault(one.band, {})[one.side, one.scatter] = tree if len(parts) == 1 else Model.sum(parts)
        limit = max(one.thetas_deg)
        if limit < 89.0:
            warnings.append(f"{one.where}: parameters beyond {limit:g}° of incidence are those at {limit:g}°")
        comments.append(" ".join([*one.lines(), *_table(one)]))
    made = Bsdf.from_models(bands)
    element_type, material, geometry, _, other = made._core.metadata_parts()
    made = Bsdf(made._core.with_metadata_parts((element_type, material, geometry, comments, other)))
    return (made.with_metadata(name=name) if name else made), warnings


def scattered_total(one: Fitted, theta_deg: float, phi_deg: float) -> float:
    """Direct-hemispherical value of the scattered light for one incident angle [°]."""
    theta, phi = np.radians([theta_deg, phi_deg])
    travel = -np.array([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi)])
    return float(_column(one, travel, _Cells.of(_TOTAL_CELLS)).mean() * np.pi)


def _table(one: Fitted) -> list[str]:
    rows = []
    for theta in one.thetas_deg:
        numbers = ", ".join(f"{n.name} {n.value:.5g} ± {n.standard_error:.2g}" for n in one.numbers(theta))
        rows.append(f"{theta:g}°: {numbers};")
    return rows


def _within(progress: Callable[[float], object] | None, number: int, count: int) -> Callable[[float], object]:
    """Progress of one of several equal parts."""
    return lambda share: None if progress is None else progress((number + share) / count)


def _grid(one: Fitted, resolution: int, progress: Callable[[float], object]) -> tuple[NDArray[np.float32], float]:
    """BSDF of all cells, and the largest direct-hemispherical value before it was limited."""
    n = 1 << resolution
    cells = _Cells.of(n)
    if one.formula.isotropic:
        edges = 1.0 - 2.0 * np.arange(n // 2 + 1) / n
        share = (np.arange(_RADII) + 0.5) / _RADII
        radii = np.sqrt(edges[1:, None] ** 2 + share * (edges[:-1, None] ** 2 - edges[1:, None] ** 2))
        travels = np.stack([radii, np.zeros_like(radii)], axis=-1)
    else:
        travels = cells.middles[:, None, :2]
    values = np.empty((len(travels), n * n), dtype=np.float32)
    most = 0.0
    for k, inside in enumerate(travels):
        column = np.mean([_column(one, travel, cells) for travel in inside], axis=0)
        theta = np.degrees(np.arcsin(np.clip(np.hypot(*inside.mean(axis=0)), 0.0, 1.0)))
        scattered, beam = float(column.mean() * np.pi), float(one.specular(theta))
        most = max(most, scattered + beam)
        if scattered + beam > 1.0:
            column = column * max(1.0 - beam, 0.0) / scattered
        values[k] = column
        if k % 16 == 0:
            progress(k / len(travels))
    return values.reshape((n // 2, n, n) if one.formula.isotropic else (n, n, n, n)), most


def _column(one: Fitted, travel: Floats, cells: _Cells) -> Floats:
    """Mean BSDF of the outgoing cells (n², ) for light that travels toward a point of the disk.

    In direction cosines an area of the disk is a projected solid angle, so rings about the direction in which light
    goes on sum a peak of any width exactly into the cells that it falls into.
    """
    incident = np.array([-travel[0], -travel[1], np.sqrt(max(1.0 - float(travel @ travel), 0.0))])
    n, width = cells.n, 2.0 / cells.n
    smooth = one.evaluate(incident, cells.fine).reshape(n, _ACROSS, n, _ACROSS).mean(axis=(1, 3)).ravel()
    if one.formula.about == "normal":
        return np.asarray(smooth)
    near = np.hypot(cells.middles[:, 0] - travel[0], cells.middles[:, 1] - travel[1]) < _NEAR * width
    edges = np.concatenate([[0.0], np.geomspace(_FINEST, (_NEAR + 3.0) * width, _RINGS)])
    turn = 2.0 * np.pi * (np.arange(_SECTORS) + 0.5) / _SECTORS
    radius = np.sqrt(0.5 * (edges[:-1] ** 2 + edges[1:] ** 2))
    area = np.repeat(np.pi * (edges[1:] ** 2 - edges[:-1] ** 2) / _SECTORS, _SECTORS)
    # Every second ring is turned by half a sector, so that no cell is met by a row of nodes.
    turns = turn + np.where(np.arange(_RINGS) % 2, np.pi / _SECTORS, 0.0)[:, None]
    points = np.stack(
        [travel[0] + radius[:, None] * np.cos(turns), travel[1] + radius[:, None] * np.sin(turns)], axis=-1
    ).reshape(-1, 2)
    r2 = (points**2).sum(axis=1)
    inside = r2 < 1.0
    points, area, r2 = points[inside], area[inside], r2[inside]
    nodes = np.concatenate([points, np.sqrt(1.0 - r2)[:, None]], axis=1)
    light = one.evaluate(incident, nodes) * area
    index = _core.square_cells(np.ascontiguousarray(points), n)
    flux = np.bincount(index, light, minlength=n * n)
    covered = np.bincount(index, area, minlength=n * n)
    # By the area that the nodes stand for in a cell, so that a smooth value does not depend on how many fell into it.
    by_rings = np.divide(flux, covered, out=smooth.copy(), where=covered > 0.5 * np.pi / (n * n))
    return np.asarray(np.where(near, by_rings, smooth))
