"""Illuminance on the plane of the lens, and what of it is lost where pictures are too bright."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from clerestory.photo.lens import Lens
    from clerestory.picture.view import View


@dataclass(frozen=True)
class Overflow:
    """Where a picture is a lower limit."""

    solid_angle: float
    """[sr]"""
    azimuth_deg: float
    """Of its middle, to the right of the line of sight [°]."""
    elevation_deg: float
    """Of its middle, upward from the line of sight [°]."""
    illuminance: float
    """Its part of the illuminance as the picture has it [lx]."""

    @property
    def words(self) -> str:
        """Such as 0.0006 sr at 8° to the right and 15° up."""
        side = "right" if self.azimuth_deg >= 0.0 else "left"
        height = "up" if self.elevation_deg >= 0.0 else "down"
        return (
            f"{self.solid_angle:.2g} sr at {abs(self.azimuth_deg):.0f}° to the {side} and "
            f"{abs(self.elevation_deg):.0f}° {height}"
        )


def projected(view: View, width: int, height: int) -> NDArray[np.float64]:
    """Solid angle times cosine (height, width) [sr] of pixels before the eye, as a glare evaluation takes them."""
    cosines = view.pixel_directions(width, height) @ view.frame[2]
    return np.asarray(view.solid_angles(width, height) * np.nan_to_num(np.maximum(cosines, 0.0)))


def illuminance(luminance: ArrayLike, view: View) -> float:
    """Illuminance [lx] on the plane across the line of sight, of luminances (height, width) [cd/m²]."""
    values = np.asarray(luminance, dtype=np.float64)
    height, width = values.shape
    return float((values * projected(view, width, height)).sum())


def coverage(lens: Lens, view: View, size: int, shape: tuple[int, int]) -> float:
    """Share of the hemisphere, by cosine, that a lens shows within photographs of a shape (height, width)."""
    weights = projected(view, size, size)
    directions = np.nan_to_num(view.pixel_directions(size, size) @ view.frame.T)
    at = lens.locate(directions)
    height, width = shape
    with np.errstate(invalid="ignore"):
        seen = (at[..., 0] >= 0.0) & (at[..., 0] <= width) & (at[..., 1] >= 0.0) & (at[..., 1] <= height)
    if lens.projection != "perspective":
        # What a fisheye draws ends at its circle.
        seen &= directions[..., 2] >= np.cos(np.radians(min(lens.edge_deg, 90.0))) - 1e-9
    return float(weights[seen].sum() / weights.sum())


def overflow(luminance: ArrayLike, brim: NDArray[np.float32], view: View) -> Overflow:
    """What the pixels of which a share (height, width) is too bright hold, by their luminances [cd/m²]."""
    values = np.asarray(luminance, dtype=np.float64)
    height, width = brim.shape
    omega = view.solid_angles(width, height) * brim
    total = float(omega.sum())
    if total <= 0.0:
        return Overflow(0.0, 0.0, 0.0, 0.0)
    x, y, z = (np.nan_to_num(view.pixel_directions(width, height) @ view.frame.T) * omega[..., None]).sum(axis=(0, 1))
    return Overflow(
        solid_angle=total,
        azimuth_deg=float(np.degrees(np.arctan2(x, z))),
        elevation_deg=float(np.degrees(np.arctan2(y, np.hypot(x, z)))),
        illuminance=float((values * brim * projected(view, width, height)).sum()),
    )


def fill(
    seen: NDArray[np.float32],
    brim: NDArray[np.float32],
    shares: ArrayLike,
    view: View,
    measured: float,
) -> tuple[NDArray[np.float32], str]:
    """Raise what is too bright in all exposures until the illuminance is the measured one.

    Parameters
    ----------
    seen
        Red, green and blue (height, width, 3) [cd/m²].
    brim
        Share of each pixel that is too bright (height, width).
    shares
        Of the channels in the luminance (3,).
    view
        Of the picture.
    measured
        Illuminance on the plane of the lens [lx].

    Returns
    -------
    The picture, with white light of one luminance added to these pixels, and what was done in words.
    """
    lacking = measured - illuminance(seen @ np.asarray(shares), view)
    height, width = brim.shape
    room = float((brim * projected(view, width, height)).sum())
    if room <= 0.0:
        return seen, "nothing is too bright in all exposures, so that no overflow was filled"
    if lacking <= 0.0:
        return seen, "the picture has the measured illuminance without more light, so that no overflow was filled"
    added = lacking / room
    return (
        seen + (added * brim[..., None]).astype(np.float32),
        f"{lacking:.0f} lx that the picture lacked were put where it is too bright in all exposures, as {added:.3g} "
        "cd/m² more",
    )
