"""Rows of tables that hold scans of several incident directions."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from clerestory.measure.scan import Scan

    Floats = NDArray[np.float64]


def repeated(scans: Sequence[Scan]) -> list[tuple[int, Scan]]:
    """Scans with how many before them are of the same light: a table can tell only the first of them from others."""
    seen: Counter[tuple[object, ...]] = Counter()
    found = []
    for scan in scans:
        light = (scan.incident_side, scan.scatter, scan.incident_theta_deg, scan.incident_phi_deg % 360.0)
        found.append((seen[light], scan))
        seen[light] += 1
    return found


def grouped(
    keys: Sequence[Floats], starts: Floats, rows: int
) -> list[tuple[tuple[float, ...], slice | NDArray[np.intp]]]:
    """Rows with the same keys, in the order in which keys first appear.

    Parameters
    ----------
    keys
        Values of each run of rows (runs,), as `_core.read_table` gives them; NaN is a value like others.
    starts
        First row of each run (runs,).
    rows
        How many there are.

    Returns
    -------
    Keys and their rows: a slice, which needs no copy, where they stand together.
    """
    begins = starts.astype(np.intp)
    lengths = np.diff(np.append(begins, rows))
    table = np.ascontiguousarray(np.column_stack(keys)) + 0.0  # no negative zeros
    _, first, inverse = np.unique(table.view(np.int64), axis=0, return_index=True, return_inverse=True)
    rank = np.argsort(np.argsort(first))[inverse.ravel()]
    order = np.sort(first)
    named = [tuple(table[k].tolist()) for k in order]
    if len(order) == len(begins):
        return [(key, slice(b, b + n)) for key, b, n in zip(named, begins.tolist(), lengths.tolist(), strict=True)]
    of_row = np.repeat(rank, lengths)
    sorted_rows = np.argsort(of_row, kind="stable")
    borders = np.cumsum(np.bincount(of_row, minlength=len(order)))[:-1]
    return list(zip(named, np.split(sorted_rows, borders), strict=True))
