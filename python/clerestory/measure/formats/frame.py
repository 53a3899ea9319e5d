"""How files count sides and azimuths, and the way from there to the sample's frame and back."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import numpy as np

from clerestory._core import FileFormatError
from clerestory.directions import SIDES
from clerestory.measure.formats.choices import angle_of, one_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike, NDArray

    from clerestory.directions import Scatter, Side

    Floats = NDArray[np.float64]

GRAZING_DEG = 1e-9
"""Angle [°] beyond the plane of the sample that is still in it."""


@dataclass(frozen=True)
class Frame:
    """One frame for both sides of a sample, as a file has it."""

    front: Side = "exterior"
    """What it calls front, or the side that θ = 0 is on."""
    up_deg: float = 90.0
    """Its azimuth of the sample's up [°]."""
    seen_from: Side = "exterior"
    """From where its azimuths run counter-clockwise."""

    @classmethod
    def chosen(cls, choices: Mapping[str, object], front: Side, up_deg: float) -> Frame:
        """A frame seen from its front, unless a person's `up_deg` and `seen_from` say otherwise."""
        up = angle_of(choices, "up_deg", up_deg)
        seen = one_of(choices, "seen_from", SIDES, front)
        return cls(front, up_deg if up is None else up, cast("Side", seen))

    def azimuth(self, phi_deg: ArrayLike) -> Floats:
        """An azimuth in the sample's frame [°], 0 to 360, from the file's."""
        return self.turn(np.array(phi_deg, dtype=np.float64))

    def turn(self, phi_deg: Floats) -> Floats:
        """The same in place, since millions of points would need their memory twice."""
        phi_deg -= self.up_deg
        if self.seen_from == "exterior":
            np.negative(phi_deg, out=phi_deg)
        phi_deg += 90.0
        phi_deg %= 360.0
        return phi_deg

    def written(self, phi_deg: ArrayLike) -> Floats:
        """The file's azimuth [°], 0 to 360, from one in the sample's frame."""
        turned = np.asarray(phi_deg, dtype=np.float64) - 90.0
        return np.asarray((self.up_deg + (turned if self.seen_from == "interior" else -turned)) % 360.0)

    @property
    def words(self) -> str:
        """What it means."""
        return (
            f"front is the {self.front}, up is azimuth {self.up_deg:g}°, "
            f"azimuths are counter-clockwise as seen from the {self.seen_from}, incident ones are the source's"
        )


def opposite(side: Side) -> Side:
    """The other side."""
    return "interior" if side == "exterior" else "exterior"


def wrapped(theta_deg: Floats, phi_deg: Floats) -> tuple[Floats, Floats]:
    """Polar angles brought to 0 to 180°: a negative one lies at the opposite azimuth."""
    if theta_deg.size == 0 or (theta_deg.min() >= 0.0 and theta_deg.max() <= 180.0):
        return theta_deg, phi_deg
    theta = (theta_deg + 180.0) % 360.0 - 180.0
    return np.abs(theta), np.where(theta < 0.0, phi_deg + 180.0, phi_deg)


def signed(theta_deg: Floats, phi_deg: Floats) -> tuple[Floats, Floats]:
    """The same for files whose polar angles have no business beyond 180°.

    Raises
    ------
    FileFormatError
        One has: angles may be exchanged, or in another unit.
    """
    beyond = theta_deg[~(np.abs(theta_deg) <= 180.0)]
    if beyond.size:
        raise FileFormatError(f"an angle to the normal is {beyond[0]:g}° (are θ and φ exchanged, or the units?)")
    return wrapped(theta_deg, phi_deg)


def halves(
    theta_deg: Floats, scatter: Scatter | None, unstated: Scatter | None = None
) -> list[tuple[Scatter, slice | NDArray[np.bool_], Floats]]:
    """Points told apart by the side that they lie on.

    Parameters
    ----------
    theta_deg
        Angles from the normal of the lit side [°], 0 to 180 (points,); where `scatter` says transmission and none is
        above 90°, from the normal of the side that the light leaves to.
    scatter
        What is said of all points.
    unstated
        What points are if nothing is said and none is beyond 90°.

    Returns
    -------
    Scatter, the points that it has, and their angles from the normal of their own side; one or two.

    Raises
    ------
    FileFormatError
        Points lie on the other side than was said, or it is not known on which.
    """
    beyond = theta_deg > 90.0 + GRAZING_DEG
    every = slice(None)
    if not beyond.any():
        which = scatter or unstated
        if which is None:
            raise FileFormatError(
                "no angle is above 90°, and nothing says whether light is transmitted or reflected "
                "(give scatter: transmission or reflection)"
            )
        return [(which, every, theta_deg if theta_deg.max() <= 90.0 else np.minimum(theta_deg, 90.0))]
    # What lies in the plane of the sample belongs to the only side that there is, or to the lit one.
    if (theta_deg[~beyond] >= 90.0 - GRAZING_DEG).all():
        if scatter == "reflection":
            raise FileFormatError(
                "all points lie behind the sample, where no light is reflected to (check the scatter)"
            )
        return [("transmission", every, np.clip(180.0 - theta_deg, 0.0, 90.0))]
    if scatter is not None:
        raise FileFormatError(
            f"points lie on both sides of the sample, not of {scatter} alone (leave the scatter out, or split the file)"
        )
    return [("reflection", ~beyond, theta_deg[~beyond]), ("transmission", beyond, 180.0 - theta_deg[beyond])]
