"""Height maps: rasters of a 3D microscope on the face of a film."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Literal

import numpy as np

from clerestory.counts import counted
from clerestory.trace.keys import Positive, RecipeError
from clerestory.trace.kinds.common import Kind
from clerestory.trace.reading import reading
from clerestory.trace.shapes import Mesh

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from clerestory.trace.workshop import Workshop

    Floats = NDArray[np.float64]

MOST = 4_000_000
"""More points than these are refused."""


class HeightMap(Kind):
    """A film whose one face has the heights of a raster, repeated in both directions, and whose other one is flat."""

    kind: Literal["height-map"]
    file: str
    """Heights [µm]: a .npy array (rows, columns), or CSV without column names; the first row is the uppermost."""
    step_um: Positive
    """Distance of neighbouring points [µm]."""
    mirrored: bool = False
    """Whether mirror images are joined at the borders, for maps whose borders do not fit together."""
    medium: str
    """What the film is made of."""
    base_um: Positive
    """Thickness of the film under the deepest point [µm]."""
    relief: Literal["interior", "exterior"] = "interior"
    """The side that the heights are on."""

    def shapes(self, shop: Workshop, key: str) -> list[Mesh]:
        """Its two faces; the flat one lies in the plane of the sample."""
        face = shop.body(key, self.medium)
        shop.files.append(shop.folder / self.file)
        heights = _read(shop.folder / self.file, f"{key}.file")[::-1]
        if self.mirrored:
            heights = np.concatenate([heights, heights[-2:0:-1]])
            heights = np.concatenate([heights, heights[:, -2:0:-1]], axis=1)
        rows, columns = heights.shape
        if rows * columns > MOST:
            raise RecipeError(f"{key}.file: {rows * columns:,} points are too many (give {MOST:,} at most)")
        step = self.step_um * 1e-6
        wide, high = columns * step, rows * step
        z = self.base_um * 1e-6 + 1e-6 * (heights - heights.min())
        # The last row and column are joined to the first of the next period.
        z = np.pad(z, ((0, 1), (0, 1)), mode="wrap")
        x, y = np.meshgrid(np.arange(columns + 1) * step, np.arange(rows + 1) * step)
        points = np.stack([x, y, z], axis=-1).reshape(-1, 3)
        a = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).ravel()
        b, c, d = a + 1, a + columns + 1, a + columns + 2
        relief = np.concatenate([np.stack(t, axis=-1) for t in ((a, b, d), (a, d, c))])
        flat = np.array([[0.0, 0.0, 0.0], [wide, 0.0, 0.0], [wide, high, 0.0], [0.0, high, 0.0]])
        back = np.array([[0, 2, 1], [0, 3, 2]])
        if self.relief == "exterior":
            points = points * [1.0, 1.0, -1.0]
            relief, back = relief[:, ::-1], back[:, ::-1]
        return [Mesh.joined([(points, relief, face), (flat, back, face)], (wide, high))]


def _read(path: Path, key: str) -> Floats:
    with reading(key):
        data = path.read_bytes()
    try:
        if path.suffix == ".npy":
            heights = np.lib.format.read_array(io.BytesIO(data), allow_pickle=False)
        else:
            text = data.decode("utf-8-sig")
            delimiter = next((d for d in ";\t," if d in text), None)
            heights = np.loadtxt(text.splitlines(), delimiter=delimiter, ndmin=2)
    except ValueError as error:
        raise RecipeError(f"{key}: {path} is no raster of heights ({' '.join(str(error).split())})") from None
    if heights.ndim != 2 or min(heights.shape) < 2 or not np.issubdtype(heights.dtype, np.number):
        shape = " × ".join(str(n) for n in heights.shape)
        raise RecipeError(f"{key}: {path} holds {shape} values (give rows and columns of heights in µm)")
    heights = np.asarray(heights, dtype=np.float64)
    if not np.isfinite(heights).all():
        raise RecipeError(
            f"{key}: {path} has holes: {counted(int((~np.isfinite(heights)).sum()), 'value')} not finite (fill them)"
        )
    return heights
