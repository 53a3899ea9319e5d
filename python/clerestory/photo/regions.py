"""Parts of the field of view, and their mean luminance."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError, FileFormatError
from clerestory.photo.exposure import text_of

if TYPE_CHECKING:
    import os

    from numpy.typing import NDArray

    from clerestory.picture.image import Picture

COLUMNS = ("name", "azimuth_deg", "elevation_deg", "radius_deg")
INNER_DEG = 30.0
"""Half angle of the middle of the default regions [°]."""


@dataclass(frozen=True)
class Region:
    """A cone about a direction, or a quarter of what lies outside of the middle."""

    name: str
    azimuth_deg: float
    """To the right of the line of sight."""
    elevation_deg: float
    """Upward from it."""
    radius_deg: float | None
    """Half angle of a cone; None for the quarter of the field toward the direction and outside of `INNER_DEG`."""

    def contains(self, directions: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Which directions (..., 3) to the right, up and along the line of sight lie in it."""
        a, e = np.radians([self.azimuth_deg, self.elevation_deg])
        axis = np.array([np.cos(e) * np.sin(a), np.sin(e), np.cos(e) * np.cos(a)])
        if self.radius_deg is not None:
            return np.asarray(directions @ axis >= np.cos(np.radians(self.radius_deg)))
        x, y, z = np.moveaxis(directions, -1, 0)
        along, across = x * axis[0] + y * axis[1], np.abs(x * axis[1] - y * axis[0])
        return np.asarray((z < np.cos(np.radians(INNER_DEG))) & (along > across))


DEFAULT = (
    Region("middle", 0.0, 0.0, INNER_DEG),
    Region("up", 0.0, 90.0, None),
    Region("down", 0.0, -90.0, None),
    Region("left", -90.0, 0.0, None),
    Region("right", 90.0, 0.0, None),
)
"""The cone of 30° about the line of sight, and the four quarters around it."""


def read_regions(path: str | os.PathLike[str]) -> tuple[Region, ...]:
    """Cones from a table with the columns name, azimuth_deg, elevation_deg, radius_deg.

    Raises
    ------
    FileFormatError
        A column is missing, or a value is none; the line is named.
    """
    path = Path(path)
    rows = csv.DictReader(io.StringIO(text_of(path)), skipinitialspace=True)
    heads = [head.strip() for head in rows.fieldnames or []]
    rows.fieldnames = heads
    missing = [column for column in COLUMNS if column not in heads]
    if missing:
        raise FileFormatError(f"{path}: line 1 has no column {missing[0]} (give {','.join(COLUMNS)})")
    found: list[Region] = []
    for row in rows:
        name = (row.get("name") or "").strip()
        try:
            azimuth, elevation, radius = (float(row.get(column) or "") for column in COLUMNS[1:])
        except ValueError:
            azimuth = elevation = radius = np.nan
        if not name or not (abs(azimuth) <= 90.0 and abs(elevation) <= 90.0 and 0.0 < radius <= 90.0):
            raise FileFormatError(
                f"{path}: line {rows.line_num} is no name and three angles up to 90° (give {','.join(COLUMNS)})"
            )
        if any(region.name == name for region in found):
            raise FileFormatError(f"{path}: line {rows.line_num} names {name} again (name each region once)")
        found.append(Region(name, azimuth, elevation, radius))
    if not found:
        raise FileFormatError(f"{path}: there is no line under the head (give one a region)")
    return tuple(found)


def mean_luminance(picture: Picture, region: Region) -> float:
    """Mean luminance [cd/m²], by solid angle, of a region before the eye.

    Raises
    ------
    ClerestoryError
        No pixel lies in it, or the picture has no view.
    """
    view = picture.view
    if view is None:
        raise ClerestoryError("the picture does not say what it shows (give it a view)")
    height, width = picture.shape
    directions = np.nan_to_num(view.pixel_directions(width, height) @ view.frame.T)
    inside = region.contains(directions) & (directions[..., 2] > 0.0)
    weights = view.solid_angles(width, height)[inside]
    if not weights.sum() > 0.0:
        raise ClerestoryError(f"no pixel lies in the region {region.name} (widen it, or turn it)")
    return float(np.average(picture.luminance[inside], weights=weights))
