"""A picture laid out anew in another projection."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.picture.view import View

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

MOST_PARTS = 16
"""A new pixel is divided into so many parts at most, across and down."""
_POINTS = 1 << 20
"""Points that are looked up at a time."""


class Source(Protocol):
    """Whatever says where a direction is seen."""

    def locate(self, directions: ArrayLike, /) -> NDArray[np.float64]:
        """Columns and rows (..., 2) [pixels] of directions (..., 3) to the right, up and along the line of sight."""


class SeenBy:
    """A view as a source of pixels, in its own frame."""

    def __init__(self, view: View, shape: tuple[int, int]) -> None:
        self._view, self._shape = view, shape

    def locate(self, directions: ArrayLike, /) -> NDArray[np.float64]:
        """Columns and rows (..., 2) [pixels] of directions (..., 3) to the right, up and along the line of sight."""
        height, width = self._shape
        at = self._view.locate(np.asarray(directions, dtype=np.float64) @ self._view.frame)
        return np.stack([at[..., 0] * width, (1.0 - at[..., 1]) * height], axis=-1)


def resample(
    pixels: ArrayLike,
    source: Source,
    view: View,
    size: int | tuple[int, int],
    progress: Callable[[float], object] | None = None,
) -> NDArray[np.float32]:
    """What a view shows of a picture: each new pixel is the mean, by solid angle, of what it covers.

    Parameters
    ----------
    pixels
        Values (height, width) or (height, width, n), row by row from the top.
    source
        Where directions are seen in them.
    view
        The new view, a fisheye; black behind the eye and where the source shows nothing.
    size
        Width and height of the new picture, or both in one.
    progress
        Called with the share that is done, 0 to 1.

    Notes
    -----
    A pixel is divided into parts no wider than the old pixels, between whose centres values are interpolated, so that
    flux is kept: 0.5 % of the illuminance at the eye, with a sun of a few pixels, is tested.
    """
    old = np.asarray(pixels, dtype=np.float32)
    layers = old[..., None] if old.ndim == 2 else old
    width, height = (size, size) if isinstance(size, int) else size
    if not (1 <= width <= 16384 and 1 <= height <= 16384):
        raise ClerestoryError(f"a picture of {width} × {height} pixels is not possible (give 1 to 16384)")
    parts = _parts(source, layers.shape[:2], view, width, height)
    made = np.zeros((height, width, layers.shape[2]), dtype=np.float32)
    frame = view.frame
    offsets = (np.arange(parts) + 0.5) / parts
    x = (np.arange(width)[:, None] + offsets).ravel() / width
    rows_at_once = max(1, _POINTS // (width * parts**2))
    for start in range(0, height, rows_at_once):
        rows = np.arange(start, min(start + rows_at_once, height))
        y = 1.0 - (rows[:, None] + offsets).ravel() / height
        directions = view.rays(np.stack(np.meshgrid(x, y), axis=-1))[1] @ frame.T
        weights = _densities(view, directions)
        values, seen = _looked_up(layers, source.locate(directions))
        weights = np.where(seen & (directions[..., 2] >= 0.0), weights, 0.0).astype(np.float32)
        blocks = (rows.size, parts, width, parts)
        whole = weights.reshape(blocks).sum(axis=(1, 3))
        total = (values * weights[..., None]).reshape(*blocks, -1).sum(axis=(1, 3))
        centres = view.rays(
            np.stack(np.meshgrid((np.arange(width) + 0.5) / width, 1.0 - (rows + 0.5) / height), axis=-1)
        )[1]
        shown = (whole > 0.0) & (centres @ frame[2] >= 0.0)
        made[rows[0] : rows[-1] + 1] = np.divide(
            total, whole[..., None], out=np.zeros_like(total), where=shown[..., None]
        )
        if progress is not None:
            progress((int(rows[-1]) + 1) / height)
    return made[..., 0] if old.ndim == 2 else made


def _densities(view: View, directions: NDArray[np.float64]) -> NDArray[np.float64]:
    """Solid angle per area of the picture, up to a factor, at directions (..., 3) of the view's frame."""
    cosine = np.clip(directions[..., 2], -1.0, 1.0)
    if view.projection == "a":
        theta = np.arccos(cosine)
        return np.where(np.isnan(theta), 0.0, np.sinc(theta / np.pi))
    if view.projection == "h":
        return np.nan_to_num(1.0 / np.maximum(cosine, 1e-3))
    raise ClerestoryError(
        f"a {view.projection_name} view cannot be laid out (give an angular, -vta, or a hemispherical one, -vth)"
    )


def _parts(source: Source, shape: tuple[int, ...], view: View, width: int, height: int) -> int:
    """Into how many parts a new pixel is divided so that none is wider than an old pixel almost everywhere."""
    x = (np.arange(24) + 0.5) / 24.0
    points = np.stack(np.meshgrid(x, x), axis=-1)
    shifts = np.array([[0.0, 0.0], [0.5 / width, 0.0], [0.0, 0.5 / height]])
    at = source.locate(view.rays(points[:, :, None] + shifts)[1] @ view.frame.T)
    distance = 2.0 * np.hypot(*np.moveaxis(at[:, :, 1:] - at[:, :, :1], -1, 0))
    with np.errstate(invalid="ignore"):
        inside = np.all((at[:, :, :1] >= 0.0) & (at[:, :, :1] <= shape[::-1]), axis=-1)
    distance = distance[inside & np.isfinite(distance)]
    if distance.size == 0:
        raise ClerestoryError("the picture shows nothing of the view (correct the lens or the view)")
    return int(np.clip(np.ceil(np.quantile(distance, 0.95)), 2, MOST_PARTS))


def _looked_up(layers: NDArray[np.float32], at: NDArray[np.float64]) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
    """Values (..., n) between the pixels' centres, and whether there is a picture."""
    height, width, _ = layers.shape
    x, y = at[..., 0], at[..., 1]
    with np.errstate(invalid="ignore"):
        seen = (x >= 0.0) & (x <= width) & (y >= 0.0) & (y <= height)
    x, y = (np.where(seen, v - 0.5, 0.0) for v in (x, y))
    column, row = np.floor(x).astype(np.intp), np.floor(y).astype(np.intp)
    a, b = (x - column).astype(np.float32), (y - row).astype(np.float32)
    left, right = np.clip(column, 0, width - 1), np.clip(column + 1, 0, width - 1)
    upper, lower = np.clip(row, 0, height - 1), np.clip(row + 1, 0, height - 1)
    value = layers[upper, left] * ((1 - a) * (1 - b))[..., None]
    value += layers[upper, right] * (a * (1 - b))[..., None]
    value += layers[lower, left] * ((1 - a) * b)[..., None]
    value += layers[lower, right] * (a * b)[..., None]
    return value, seen
