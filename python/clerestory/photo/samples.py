"""Even spots of a series, from which a camera's response can be recovered."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.photo.response import HIGHEST, LOWEST

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from clerestory.photo.photograph import Levels
    from clerestory.photo.series import Series

BLOCK = 8
"""Width of a spot [pixels]: a block of JPEG."""
EVEN = 3.0
"""Greatest standard deviation [levels of 255] in a spot that counts as even."""
CELLS = 6
"""The picture is divided into so many parts across and down, and into `STEPS` of brightness; spots come from all."""
STEPS = 24
MOST_BLOCKS = 60_000
"""Of a larger picture only so many are looked at, on a grid."""
A_PART = 2
"""Spots from each part of the picture and step of brightness."""


@dataclass(frozen=True)
class Samples:
    """Mean levels of even spots."""

    levels: NDArray[np.float64]
    """(spots, pictures, 3), of 255; from the shortest to the longest exposure."""
    exposures: NDArray[np.float64]
    """Exposure values of the pictures [s]."""


def sample(series: Series, progress: Callable[[float], object] | None = None) -> Samples:
    """Mean levels of spots that are even in all pictures and well exposed in two.

    They come from all parts of the picture and all brightnesses, as far as there are such.
    """
    means, deviations = [], []
    for count, photograph in enumerate(series.photographs):
        mean, deviation = _blocks(photograph.levels(), series.bits)
        means.append(mean)
        deviations.append(deviation)
        if progress is not None:
            progress((count + 1) / len(series.photographs))
    levels = np.stack(means, axis=2).astype(np.float64)  # rows, columns, pictures, channels
    useful = (levels >= LOWEST) & (levels <= HIGHEST)
    # A spot with a clipped part would look even; its mean is beyond the limits then, or its deviation great.
    even = np.all(np.stack(deviations, axis=2) <= EVEN, axis=(2, 3))
    seen = np.all(useful.sum(axis=2) >= 2, axis=2)
    rows, columns = np.nonzero(even & seen)
    chosen = _spread(levels[rows, columns], rows, columns, levels.shape[:2])
    return Samples(levels[rows, columns][chosen], np.array(series.values))


def _blocks(levels: Levels, bits: int) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Means and standard deviations (rows, columns, 3) of blocks, in levels of 255."""
    rows, columns = (n // BLOCK for n in levels.shape[:2])
    if not rows or not columns:
        raise ClerestoryError(f"the pictures are smaller than {BLOCK} pixels (give photographs)")
    every = max(1, int(np.ceil(np.sqrt(rows * columns / MOST_BLOCKS))))
    whole = levels[: rows * BLOCK, : columns * BLOCK].reshape(rows, BLOCK, columns, BLOCK, 3)
    parts = cast("Levels", np.ascontiguousarray(whole[::every, :, ::every]))
    scale = 255.0 / (2**bits - 1)
    # Exact integers: their sums of squares are below 2^44.
    total = parts.sum(axis=(1, 3), dtype=np.uint64).astype(np.float64)
    squares = np.einsum("ajbkc,ajbkc->abc", parts, parts, dtype=np.float64)
    mean = total / BLOCK**2
    deviation = np.sqrt(np.maximum(squares / BLOCK**2 - mean**2, 0.0))
    return (scale * mean).astype(np.float32), (scale * deviation).astype(np.float32)


def _spread(
    levels: NDArray[np.float64], rows: NDArray[np.intp], columns: NDArray[np.intp], shape: tuple[int, ...]
) -> NDArray[np.intp]:
    """Indices of spots, as evenly from all parts of the picture and all brightnesses as they allow."""
    if rows.size == 0:
        return np.zeros(0, dtype=np.intp)
    # The sum of a spot's levels over the pictures rises with its light over the whole range.
    light = levels[:, :, 1].sum(axis=1)
    span = float(np.ptp(light)) or 1.0
    step = np.minimum((STEPS * (light - light.min()) / span).astype(int), STEPS - 1)
    part = (rows * CELLS // shape[0]) * CELLS + columns * CELLS // shape[1]
    group = step * CELLS**2 + part
    order = np.argsort(_scattered(rows.size), kind="stable")
    order = order[np.argsort(group[order], kind="stable")]
    of = group[order]
    first = np.concatenate([[True], of[1:] != of[:-1]])
    rank = np.arange(of.size) - np.maximum.accumulate(np.where(first, np.arange(of.size), 0))
    chosen: NDArray[np.intp] = np.sort(order[rank < A_PART])
    return chosen


def _scattered(count: int) -> NDArray[np.float64]:
    """Numbers from 0 to 1 without order: the golden ratio's sequence."""
    return np.asarray((np.arange(1, count + 1) * 0.6180339887498949) % 1.0)
