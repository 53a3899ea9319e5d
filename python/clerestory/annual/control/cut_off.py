"""The control of blinds by cut-off: slats no more closed than keeps the direct sun out."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.annual.control.hysteresis import held

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from clerestory.annual.control.slats import Slats

    Doubles = NDArray[np.float64]


def needed_tilt_deg(
    slats: Slats, profile: ArrayLike, *, safety_deg: float = 0.0, step_deg: float = 0.0, least_deg: float = 0.0
) -> Doubles:
    """Tilt (n) [°] at which the slats keep the sun out; infinite where no tilt does.

    Parameters
    ----------
    slats
        Their geometry.
    profile
        Profile angle of the sun (n) [rad]; not a number behind the window, where the least tilt will do.
    safety_deg
        That is added.
    step_deg
        Of the drive: the tilt is a multiple of it, the next more closed one; any by default.
    least_deg
        The most open tilt.
    """
    angle = np.asarray(profile, dtype=np.float64)
    before = np.isfinite(angle)
    exact = np.degrees(slats.cut_off(np.where(before, angle, 0.0)))
    needed = np.where(np.isnan(exact), np.inf, np.maximum(exact + safety_deg, least_deg))
    if step_deg > 0.0:
        needed = step_deg * np.ceil(needed / step_deg - 1e-9)
    return np.asarray(np.where(before, needed, least_deg))


def nearest_closed(needed_deg: ArrayLike, tilts_deg: Sequence[float]) -> NDArray[np.int64]:
    """Number (n,) of the first of rising tilts [°] that is no more open than needed; the last where there is none."""
    tilts = np.asarray(tilts_deg, dtype=np.float64)
    if not len(tilts) or np.any(np.diff(tilts) <= 0.0):
        raise ClerestoryError("tilts rise from open to closed (give each once)")
    found = np.searchsorted(tilts, np.asarray(needed_deg, dtype=np.float64) - 1e-9, side="left")
    return np.minimum(found, len(tilts) - 1)


def nearest_state(tilt_deg: float, tilts_deg: Sequence[float | None]) -> int:
    """Number of the state whose slats are nearest to an angle [°]; of two alike the earlier one.

    Raises
    ------
    ClerestoryError
        No state has a tilt, or the angle is beyond ±90°.
    """
    apart = {k: abs(tilt - tilt_deg) for k, tilt in enumerate(tilts_deg) if tilt is not None}
    if not apart:
        raise ClerestoryError("no state has tilt_deg that it could be compared with (add it to states)")
    if not abs(tilt_deg) <= 90.0:
        raise ClerestoryError(f"{tilt_deg:g}° is no tilt of slats (give -90 to 90)")
    return min(apart, key=lambda k: apart[k])


def tilt_states(needed_deg: ArrayLike, tilts_deg: Sequence[float], *, hysteresis_deg: float = 0.0) -> NDArray[np.int64]:
    """The same with hysteresis: slats open to a tilt only if it would do with `hysteresis_deg` more."""
    needed = np.asarray(needed_deg, dtype=np.float64)
    return held(nearest_closed(needed, tilts_deg), nearest_closed(needed + hysteresis_deg, tilts_deg))
