"""Scanned sections: CSV files, and sections with few corners that stay close to them."""

from __future__ import annotations

import csv
from typing import TYPE_CHECKING

import numpy as np

from clerestory.counts import counted
from clerestory.trace.keys import RecipeError
from clerestory.trace.reading import reading

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

COLUMNS = ("x_um", "z_um")


def read_scan(path: Path, key: str) -> tuple[Floats, Floats]:
    """Positions and heights [µm] of a CSV file with the columns x_um and z_um, or with two columns of numbers.

    Raises
    ------
    RecipeError
        The columns are others, or hold no numbers; `key` and line are named.
    """
    with reading(key):
        data = path.read_bytes()
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise RecipeError(f"{key}: {path}, byte {error.start}: not text in UTF-8 (save it as CSV in UTF-8)") from None
    delimiter = next((d for d in ";\t" if d in text.partition("\n")[0]), ",")
    rows = [
        (n, [c.strip() for c in row])
        for n, row in enumerate(csv.reader(text.splitlines(), delimiter=delimiter), 1)
        if any(c.strip() for c in row) and not row[0].lstrip().startswith("#")
    ]
    if not rows:
        raise RecipeError(f"{key}: {path} holds no rows (give columns x_um and z_um)")
    places = [0, 1]
    head = [c.lower() for c in rows[0][1]]
    if not all(_is_number(c) for c in head):
        if not set(COLUMNS) <= set(head):
            raise RecipeError(f"{key}: {path} has the columns {', '.join(head)} (x_um and z_um are asked for, in µm)")
        places = [head.index(c) for c in COLUMNS]
        rows = rows[1:]
    elif len(head) != 2:
        raise RecipeError(f"{key}: {path} has {counted(len(head), 'column')} without names (give x_um and z_um, in µm)")
    values = []
    for number, row in rows:
        if len(row) <= max(places) or not all(_is_number(row[p]) for p in places):
            raise RecipeError(f"{key}: {path}, line {number}: not two numbers (give x_um and z_um, in µm)")
        values.append([float(row[p]) for p in places])
    if len(values) < 3:
        raise RecipeError(f"{key}: {path} holds {counted(len(values), 'point')} (a scan has three or more)")
    scan = np.array(values)
    if not np.isfinite(scan).all():
        raise RecipeError(f"{key}: {path} holds values that are not finite (cut them out)")
    scan = scan[np.argsort(scan[:, 0], kind="stable")]
    if (np.diff(scan[:, 0]) <= 0.0).any():
        raise RecipeError(f"{key}: {path} has two heights at one x_um (a section with overhangs needs kind profile)")
    return scan[:, 0] - scan[0, 0], scan[:, 1]


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def simplified(x: Floats, z: Floats, period: float, tolerance: float, key: str, *, closes: bool) -> Floats:
    """Corners (n, 2) of a line with few of them that stays within a tolerance of a scan.

    Corners are added where the distance is largest; their heights are those of least squares, so that noise below the
    tolerance is averaged out.

    Parameters
    ----------
    x, z
        The scan: positions from 0, and heights, in one unit.
    period
        Where the line ends.
    tolerance
        Largest vertical distance.
    key
        What a fault is reported about.
    closes
        Whether the last height has to be the first one.

    Raises
    ------
    RecipeError
        The ends do not fit together.
    """
    inside = x <= period * (1.0 + 1e-12)
    x, z = x[inside], z[inside]
    if x[-1] < period:
        raise_end = float(np.interp(period, x, z))
        x, z = np.append(x, period), np.append(z, raise_end)
    if closes and abs(z[-1] - z[0]) > 2.0 * tolerance:
        raise RecipeError(
            f"{key}.period_um: the ends of the scan differ by {abs(z[-1] - z[0]):.3g} µm in height "
            "(give the length of whole periods, or mirrored = true)"
        )
    corners = [0.0, 0.5 * period, period] if closes else [0.0, period]
    while True:
        heights = _heights(np.array(corners), x, z, closes=closes)
        off = np.abs(np.interp(x, corners, heights) - z)
        free = ~np.isin(x, corners)
        worst = int(np.argmax(np.where(free, off, -1.0)))
        if off.max() <= tolerance or not free.any():
            return np.column_stack([corners, heights])
        corners = sorted([*corners, float(x[worst])])


def _heights(corners: Floats, x: Floats, z: Floats, *, closes: bool) -> Floats:
    """Heights of least squares at the corners of a broken line."""
    cell = np.clip(np.searchsorted(corners, x, side="right") - 1, 0, len(corners) - 2)
    share = (x - corners[cell]) / (corners[cell + 1] - corners[cell])
    hats = np.zeros((len(x), len(corners)))
    hats[np.arange(len(x)), cell] = 1.0 - share
    hats[np.arange(len(x)), cell + 1] += share
    if closes:
        hats[:, 0] += hats[:, -1]
        hats = hats[:, :-1]
    heights = np.asarray(np.linalg.lstsq(hats, z, rcond=None)[0], dtype=np.float64)
    return np.asarray(np.append(heights, heights[0])) if closes else heights
