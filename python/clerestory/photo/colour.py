"""From the primaries of a camera's pictures to Radiance's, with the luminance kept."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

PRIMARIES: dict[str, tuple[float, ...]] = {
    "srgb": (0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290),
    "adobe-rgb": (0.64, 0.33, 0.21, 0.71, 0.15, 0.06, 0.3127, 0.3290),
}
"""Chromaticities x and y of red, green, blue and white: IEC 61966-2-1, and Adobe RGB (1998)."""
RADIANCE = (0.640, 0.330, 0.290, 0.600, 0.150, 0.060, 0.3333, 0.3333)
"""Those of Radiance's pictures."""
EFFICACY = 179.0
"""Luminance over radiance in Radiance's pictures [lm/W]."""


def primaries_of(name: str | Sequence[float]) -> tuple[float, ...]:
    """Chromaticities by their name, or eight numbers as they are.

    Raises
    ------
    ClerestoryError
        They are none.
    """
    if isinstance(name, str):
        if name not in PRIMARIES:
            raise ClerestoryError(f"primaries {name!r} are not known (give {' or '.join(PRIMARIES)}, or 8 numbers)")
        return PRIMARIES[name]
    if len(name) != 8 or not np.isfinite(_xyz(name)).all() or (_xyz(name)[1] <= 0.0).any():
        raise ClerestoryError(
            f"primaries {list(name)} are no colours of a camera (give x, y of red, green, blue and white)"
        )
    return tuple(name)


def luminance_shares(primaries: Sequence[float]) -> NDArray[np.float64]:
    """Shares (3,) of red, green and blue in the luminance."""
    return np.asarray(_xyz(primaries)[1])


def to_radiance(pixels: ArrayLike, primaries: Sequence[float]) -> NDArray[np.float32]:
    """Radiances (..., 3) [W/(m² sr)] of Radiance's primaries.

    Parameters
    ----------
    pixels
        Red, green and blue (..., 3) [cd/m²], each of which counts with its share in the luminance.
    primaries
        Their chromaticities.

    Notes
    -----
    White stays white, and the luminance is kept: X and Z are scaled by the ratio of the whites, whose Y are both 1. A
    colour outside of what Radiance's primaries can mix loses its negative part, and is scaled to its luminance.
    """
    ours, theirs = _xyz(primaries), _xyz(RADIANCE)
    white = theirs.sum(axis=1) / ours.sum(axis=1)
    turn = np.linalg.inv(theirs) @ (white[:, None] * ours)
    p = np.asarray(pixels, dtype=np.float32)
    made = p @ turn.T.astype(np.float32)
    if (made < 0.0).any():
        luminance = p @ ours[1].astype(np.float32)
        np.maximum(made, 0.0, out=made)
        mixed = made @ theirs[1].astype(np.float32)
        made *= np.divide(luminance, mixed, out=np.ones_like(mixed), where=mixed > 0.0)[..., None]
    return np.asarray(made / np.float32(EFFICACY))


def _xyz(primaries: Sequence[float]) -> NDArray[np.float64]:
    """Columns X, Y, Z (3, 3) of red, green and blue that make white with Y = 1."""
    with np.errstate(all="ignore"):
        x, y = np.array(primaries, dtype=np.float64).reshape(4, 2).T
        columns = np.stack([x / y, np.ones(4), (1.0 - x - y) / y])
        try:
            return np.asarray(columns[:, :3] * np.linalg.solve(columns[:, :3], columns[:, 3]))
        except np.linalg.LinAlgError:
            return np.full((3, 3), np.nan)
