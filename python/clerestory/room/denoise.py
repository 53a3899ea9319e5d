"""Denoising of pictures: neighbours that differ by no more than noise are averaged, on surfaces that are alike.

Non-local means (Buades, Coll and Morel 2005) with the noise of each pixel known (Rousselle, Knaus and Zwicker 2012),
held back where normal, distance or reflectance of what is seen first differ. Windows, lamps, the outside and pixels at
their edges stay as they are, and so does the sun's disc. It is for eyes: means of regions are kept within their noise,
single values are not.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from clerestory.photometry import EFFICACY

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from clerestory import _core
    from clerestory.room.picture import Rendering

RADIUS = 5
"""Neighbours up to this far along either axis [pixels]."""
SHARPNESS = 0.6
"""Differences in units of noise that count: less keeps more detail, and more noise."""
NORMAL, DISTANCE, REFLECTANCE = 0.2, 0.1, 0.05
"""Differences that hold back: of unit normals, relative to the distance, and of reflectances."""
TINY = 1e-9


def denoise(core: _core.Room, picture: Rendering) -> Rendering:
    """A picture of a room with less noise; `noise` stays what it was before."""
    height, width = picture.luminance.shape
    features = core.features(picture.view, width, height).reshape(height, width, 6)
    return replace(picture, radiance=filtered(picture.radiance, picture.noise, features), denoised=True)


def filtered(
    radiance: NDArray[np.float64], noise: NDArray[np.float64], features: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Radiance (height, width, 3) with less noise.

    Parameters
    ----------
    radiance
        (height, width, 3) [W/(m² sr)].
    noise
        (height, width) standard error of the luminance [cd/m²].
    features
        (height, width, 6): share of surfaces, and times it their normal (3), distance [m] and reflectance.
    """
    whole = features[..., 0] > 1.0 - 1e-6
    level = EFFICACY * radiance.mean(axis=-1)
    count = _box(whole.astype(float))
    # The spread of a few paths is itself rough.
    variance = _box(np.where(whole, noise**2, 0.0)) / np.maximum(count, 1.0)
    least = TINY + (1e-4 * level[whole].mean() if whole.any() else 0.0) ** 2
    total = np.zeros(whole.shape)
    sums = np.zeros(radiance.shape)
    for here, there in _shifts(*whole.shape):
        both = whole[here] & whole[there]
        v, w = variance[here], variance[there]
        apart = (level[here] - level[there]) ** 2 - (v + np.minimum(v, w))
        apart = np.where(both, apart / (least + SHARPNESS**2 * (v + w)), 0.0)
        apart = np.maximum(_box(apart) / np.maximum(_box(both.astype(float)), 1.0), 0.0)
        weight = np.where(both, np.exp(-apart - _unlike(features[here], features[there])), 0.0)
        total[here] += weight
        sums[here] += weight[..., None] * radiance[there]
    return np.where(whole[..., None], sums / np.maximum(total, TINY)[..., None], radiance)


def _unlike(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """How much surfaces differ: 1 for the difference that holds back."""
    normal = np.sum((a[..., 1:4] - b[..., 1:4]) ** 2, axis=-1) / NORMAL**2
    distance = (a[..., 4] - b[..., 4]) ** 2 / (DISTANCE * np.maximum(a[..., 4], TINY)) ** 2
    reflectance = (a[..., 5] - b[..., 5]) ** 2 / REFLECTANCE**2
    unlike: NDArray[np.float64] = np.maximum(np.maximum(normal, distance), reflectance)
    return unlike


Window = tuple[slice, slice]


def _shifts(height: int, width: int) -> Iterator[tuple[Window, Window]]:
    """All shifts within the radius, as the parts of a picture that lie on one another."""

    def parts(by: int, size: int) -> tuple[slice, slice]:
        return slice(max(-by, 0), size - max(by, 0)), slice(max(by, 0), size + min(by, 0))

    for down in range(-min(RADIUS, height - 1), min(RADIUS, height - 1) + 1):
        for right in range(-min(RADIUS, width - 1), min(RADIUS, width - 1) + 1):
            (y, y_there), (x, x_there) = parts(down, height), parts(right, width)
            yield (y, x), (y_there, x_there)


def _box(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Sum over the three by three pixels about each, as far as there are some."""
    for axis in (0, 1):
        padded = np.pad(values, [(1, 1) if k == axis else (0, 0) for k in (0, 1)])
        n = values.shape[axis]
        values = sum((padded.take(range(k, k + n), axis) for k in (1, 2)), padded.take(range(n), axis))
    return values
