"""Fisheyes of skies: arrays for renderers, falsecolour for people."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from clerestory import _core
from clerestory._core import ClerestoryError
from clerestory.picture import Picture, View

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from clerestory.sky.model import Sky, SunDisc

_UPWARD = "-vta -vp 0 0 0 -vd 0 0 1 -vu 0 1 0 -vh 180 -vv 180"
_SPLIT = 8  # parts of a pixel, each way, that the sun's disc covers or not


def _directions(size: int, x: NDArray[np.float64], y: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
    """Directions (..., 3) of places on the picture [pixels from its top left corner], and the angle from the zenith."""
    right, up = 2.0 * x / size - 1.0, 1.0 - 2.0 * y / size
    radius = np.hypot(right, up)
    zenith = radius * (math.pi / 2.0)
    # Looking up with north at the top, east is at the left.
    with np.errstate(invalid="ignore", divide="ignore"):
        across = np.where(radius > 0, np.sin(zenith) / radius, math.pi / 2.0)
    return np.stack([-right * across, up * across, np.cos(zenith)], axis=-1), zenith


def fisheye(sky: Sky, size: int, *, with_sun: bool) -> NDArray[np.float64]:
    """See `Sky.picture`."""
    if not 1 <= size <= 16384:
        raise ClerestoryError(f"a picture of {size} pixels is not possible (give 1 to 16384)")
    y, x = np.meshgrid(np.arange(size) + 0.5, np.arange(size) + 0.5, indexing="ij")
    directions, zenith = _directions(size, x, y)
    inside = zenith <= math.pi / 2.0
    image = np.zeros((size, size, 3))
    image[inside] = sky.radiance(directions[inside])
    disc = sky.sun
    if with_sun and disc is not None:
        _add_sun(image, inside, disc)
    return image


def to_bytes(sky: Sky, size: int, form: str) -> bytes:
    """A file of the fisheye with the sun.

    Parameters
    ----------
    sky
        The sky.
    size
        Pixels across.
    form
        `rgbe`, Radiance's HDR, or `exr`.
    """
    settings = sky.settings
    header = [
        f"SOFTWARE= Clerestory {_core.__version__}",
        f"SKY= {settings.kind}, preset {settings.preset}, {settings.quantity} watts, sun {settings.sun.words}",
    ]
    picture = Picture(fisheye(sky, size, with_sun=True), View(_UPWARD), header=header)
    return picture._core.to_bytes(form)


def _add_sun(image: NDArray[np.float64], inside: NDArray[np.bool_], disc: SunDisc) -> None:
    """Add the disc by the share of each pixel that it covers, so that its irradiance is kept."""
    size = len(image)
    column, row = place(disc.direction, size)
    reach = math.ceil(disc.half_angle_deg / 180.0 * size) + 2
    rows = np.arange(max(0, int(row) - reach), min(size, int(row) + reach + 1))
    columns = np.arange(max(0, int(column) - reach), min(size, int(column) + reach + 1))
    parts = (np.arange(_SPLIT) + 0.5) / _SPLIT
    y = (rows[:, None] + parts).ravel()
    x = (columns[:, None] + parts).ravel()
    directions, zenith = _directions(size, *np.meshgrid(x, y))
    angle = np.linalg.norm(directions - disc.direction, axis=-1)
    covered = (angle <= 2.0 * math.sin(math.radians(disc.half_angle_deg) / 2.0)) & (zenith <= math.pi / 2.0)
    share = covered.reshape(len(rows), _SPLIT, len(columns), _SPLIT).mean(axis=(1, 3))
    if not share.any():  # it falls between the parts of large pixels
        share[int(row) - rows[0], int(column) - columns[0]] = 1.0
    weight = solid_angles(size)[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1] * share
    weight = np.where(inside[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1], weight, 0.0)
    whole = 2.0 * math.pi * (1.0 - math.cos(math.radians(disc.half_angle_deg)))
    if weight.sum() > 0:
        factor = share * (whole / weight.sum())
        image[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1] += factor[..., None] * disc.radiance


def solid_angles(size: int) -> NDArray[np.float64]:
    """Solid angle (size, size) of the pixels of an angular fisheye of 180° [sr]; 0 outside of the circle."""
    y, x = np.meshgrid(np.arange(size) + 0.5, np.arange(size) + 0.5, indexing="ij")
    _, zenith = _directions(size, x, y)
    step = math.pi / size
    with np.errstate(invalid="ignore", divide="ignore"):
        angle = np.where(zenith > 0, np.sin(zenith) / zenith, 1.0) * step**2
    return np.where(zenith <= math.pi / 2.0, angle, 0.0)


def place(direction: NDArray[np.float64], size: float) -> tuple[float, float]:
    """Place [pixels from the left and the top] of a direction above the horizon."""
    x, y, z = (float(c) for c in direction)
    flat = math.hypot(x, y)
    radius = math.atan2(flat, z) / (math.pi / 2.0)
    right, up = (-x / flat * radius, y / flat * radius) if flat > 0 else (0.0, 0.0)
    return (right + 1.0) / 2.0 * size, (1.0 - up) / 2.0 * size
