"""Scaling that keeps reversed paths equal: rows and columns together, as Sinkhorn and Knopp (1967) do.

Plain factors of incident patches break f(i → o) = f(o → i). A factor for each incident patch times one for each
outgoing patch does not, if both sides get theirs from the same pair.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from clerestory.basis import Basis

    Floats = NDArray[np.float64]

_ROUNDS = 20000
SETTLED = 1e-9
"""Relative error of the sums at which the iteration has settled."""


@dataclass(frozen=True)
class Scaled:
    """A table whose rows and columns were scaled."""

    values: Floats
    """BSDF [1/sr] (outgoing, incident)."""
    outgoing: Floats
    """Factors of outgoing patches (n,)."""
    incident: Floats
    """Factors of incident patches (n,)."""
    residual: float
    """Largest difference between a direct-hemispherical value and what it should be."""
    uneven: float
    """Hemispherical-hemispherical value wanted of one side over that of the other; reciprocity makes it 1."""


def transmission(values: Floats, basis: Basis, front: Floats, back: Floats) -> Scaled:
    """Transmission with direct-hemispherical values for both sides and one table for both.

    Parameters
    ----------
    values
        BSDF of light from the front [1/sr] (outgoing, incident); the reversed table is the other side's.
    front, back
        Direct-hemispherical values wanted of light from either side, one a patch. Those of the back are scaled as a
        whole where the two do not agree in the hemispherical value.

    Raises
    ------
    ClerestoryError
        A patch that should have light has none.
    """
    area, turned = basis.projected_solid_angles, basis.reversed
    table = area[:, None] * np.maximum(values, 0.0) * area
    columns, rows = area * front, area * back[turned]
    uneven = float(columns.sum() / rows.sum()) if rows.sum() > 0.0 else 1.0
    rows = rows * uneven
    _check(table, columns, rows)
    d_in, d_out = np.ones(len(area)), np.ones(len(area))
    for _ in range(_ROUNDS):
        d_out = _over(rows, table @ d_in)
        d_in = _over(columns, d_out @ table)
        if np.max(np.abs(d_out * (table @ d_in) - rows) / area) < SETTLED:
            break
    made = d_out[:, None] * np.maximum(values, 0.0) * d_in
    residual = np.abs((area[:, None] * made * area).sum(axis=1) - rows) / area
    return Scaled(made, d_out, d_in, float(residual.max()), uneven)


def reflection(values: Floats, basis: Basis, wanted: Floats) -> Scaled:
    """Reflection with direct-hemispherical values, reversed paths equal.

    Parameters
    ----------
    values
        BSDF [1/sr] (outgoing, incident); the mean of it and its reverse is scaled.
    wanted
        Direct-hemispherical values, one a patch.

    Raises
    ------
    ClerestoryError
        A patch that should have light has none.
    """
    area, turned = basis.projected_solid_angles, basis.reversed
    table = (area[:, None] * np.maximum(values, 0.0) * area)[turned]
    table = 0.5 * (table + table.T)  # symmetric where reversed paths are equal
    sums = area * wanted
    _check(table, sums, sums)
    d = np.sqrt(_over(sums, table.sum(axis=1)))
    for _ in range(_ROUNDS):
        now = d * (table @ d)
        if np.max(np.abs(now - sums) / area) < SETTLED:
            break
        d = d * np.sqrt(_over(sums, now))
    made = d[:, None] * table * d
    residual = float(np.max(np.abs(made.sum(axis=1) - sums) / area))
    back = np.empty_like(made)
    back[turned] = made
    return Scaled(back / (area[:, None] * area), d[turned], d, residual, 1.0)


def _over(wanted: Floats, held: Floats) -> Floats:
    return np.divide(wanted, held, out=np.zeros_like(wanted), where=held > 0.0)


def _check(table: Floats, columns: Floats, rows: Floats) -> None:
    for axis, sums in ((0, columns), (1, rows)):
        dark = np.flatnonzero((table.sum(axis=axis) <= 0.0) & (sums > 0.0))
        if len(dark):
            raise ClerestoryError(
                f"patch {int(dark[0]) + 1} has no light that could be scaled (leave it at 0, or give data for it)"
            )
