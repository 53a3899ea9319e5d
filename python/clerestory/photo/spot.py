"""Spots of which a luminance meter has said the luminance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from clerestory.photo.lens import Lens


@dataclass(frozen=True)
class Spot:
    """A part of the picture with a known luminance."""

    luminance: float
    """By the meter [cd/m²]."""
    pixels: tuple[float, ...] = ()
    """Column and row of a pixel of the upright picture, counted from 0 at the upper left; with a radius, of a circle;
    or those of two corners of a rectangle."""
    direction: tuple[float, ...] = ()
    """Angles to the right and upward from the line of sight [°], and the radius of a circle [°]: 0.5 by default."""

    def __post_init__(self) -> None:
        if not (np.isfinite(self.luminance) and self.luminance > 0.0):
            raise ClerestoryError(f"a spot's luminance of {self.luminance:g} cd/m² is not possible (give one above 0)")
        if bool(self.pixels) == bool(self.direction):
            raise ClerestoryError("a spot lies at pixels or in a direction (give one of them)")
        if self.pixels and len(self.pixels) not in (2, 3, 4):
            raise ClerestoryError(
                f"a spot of {len(self.pixels)} numbers is not known (give x,y; x,y,radius; or x1,y1,x2,y2)"
            )
        if self.direction and len(self.direction) not in (2, 3):
            raise ClerestoryError("a spot's direction is azimuth,elevation or azimuth,elevation,radius in degrees")

    @property
    def words(self) -> str:
        """Such as pixels 1010,1700,1050,1740."""
        if self.pixels:
            return f"pixel{'' if len(self.pixels) == 2 else 's'} {','.join(f'{v:g}' for v in self.pixels)}"
        return f"direction {','.join(f'{v:g}' for v in self.direction)}°"

    def mask(self, shape: tuple[int, int], lens: Lens | None) -> tuple[tuple[slice, slice], NDArray[np.bool_]]:
        """The part of a picture (height, width) that holds the spot, and which of its pixels are in it.

        Raises
        ------
        ClerestoryError
            None is, or a direction is asked for without a lens.
        """
        if self.direction:
            return self._about(shape, lens)
        if len(self.pixels) == 4:
            x1, y1, x2, y2 = self.pixels
            box = (min(x1, x2), min(y1, y2), max(x1, x2), max(y1, y2))
        else:
            x, y, radius = (*self.pixels, 0.0)[:3]
            box = (x - radius, y - radius, x + radius, y + radius)
        part, columns, rows = _box(box, shape, self.words)
        if len(self.pixels) == 3:
            return part, np.hypot(columns - self.pixels[0], rows - self.pixels[1]) <= self.pixels[2]
        return part, np.ones(columns.shape, dtype=bool)

    def _about(self, shape: tuple[int, int], lens: Lens | None) -> tuple[tuple[slice, slice], NDArray[np.bool_]]:
        if lens is None:
            raise ClerestoryError(f"the spot at {self.words} needs a lens (give pixels, or a projection)")
        azimuth, elevation, radius = (*np.radians(self.direction[:2]), (*self.direction, 0.5)[2])
        axis = np.array([np.cos(elevation) * np.sin(azimuth), np.sin(elevation), np.cos(elevation) * np.cos(azimuth)])
        x, y = lens.locate(axis)
        if not np.isfinite([x, y]).all():
            raise ClerestoryError(f"the spot at {self.words} is not seen by the lens (correct it)")
        # Twice the size that the radius has on the axis, for the stretch toward the rim.
        reach = 4.0 * float(lens.radius_at(np.radians(radius))) + 2.0
        part, columns, rows = _box((x - reach, y - reach, x + reach, y + reach), shape, self.words)
        seen = lens.directions(np.stack([columns + 0.5, rows + 0.5], axis=-1))
        inside = np.nan_to_num(seen @ axis, nan=-2.0) >= np.cos(np.radians(radius))
        if not inside.any():
            raise ClerestoryError(f"the spot at {self.words} holds no pixel (give it a greater radius)")
        return part, inside


def _box(
    box: Sequence[float], shape: tuple[int, int], words: str
) -> tuple[tuple[slice, slice], NDArray[np.float64], NDArray[np.float64]]:
    """Slices of rows and columns, and the columns and rows of their pixels."""
    height, width = shape
    x1, y1, x2, y2 = box
    if x1 < 0 or y1 < 0 or x2 > width - 1 or y2 > height - 1:
        raise ClerestoryError(
            f"the spot at {words} is not within the picture of {width} × {height} (count from 0 at the upper left)"
        )
    columns, rows = np.arange(int(np.ceil(x1)), int(x2) + 1), np.arange(int(np.ceil(y1)), int(y2) + 1)
    if columns.size == 0 or rows.size == 0:
        raise ClerestoryError(f"the spot at {words} holds no pixel (make it larger)")
    across, down = np.meshgrid(columns.astype(np.float64), rows.astype(np.float64))
    return (slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)), across, down


@dataclass(frozen=True)
class Reading:
    """What a picture shows of a spot."""

    spot: Spot
    mean: float
    """Luminance [cd/m²] before calibration."""
    pixels: int
    spread: float
    """Standard deviation of its pixels, relative to the mean."""

    @property
    def factor(self) -> float:
        """By the meter over by the picture."""
        return self.spot.luminance / self.mean


def read_spot(spot: Spot, luminance: NDArray[np.float32], doubtful: NDArray[np.bool_], lens: Lens | None) -> Reading:
    """Measure a spot in a map of luminance (height, width).

    Raises
    ------
    ClerestoryError
        It lies outside, or some of its pixels are too bright or too dark in all exposures.
    """
    part, inside = spot.mask(luminance.shape, lens)
    bad = int((doubtful[part] & inside).sum())
    if bad:
        raise ClerestoryError(
            f"{bad} of {int(inside.sum())} pixels of the spot at {spot.words} are too bright or too dark in all "
            "exposures (choose another spot, or extend the series)"
        )
    values = luminance[part][inside].astype(np.float64)
    mean = float(values.mean())
    if not mean > 0.0:
        raise ClerestoryError(f"the spot at {spot.words} is black in the picture (choose another)")
    return Reading(spot, mean, values.size, float(values.std() / mean))


def common_factor(readings: Sequence[Reading]) -> float:
    """The factor for a map from its spots: the mean of their logarithms."""
    return float(np.exp(np.mean([np.log(r.factor) for r in readings])))
