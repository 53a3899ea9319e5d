"""Directions to evaluate a file at that holds a function of two directions rather than scans."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.measure.formats.specular import from_specular

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from clerestory.directions import Scatter, Side

    Floats = NDArray[np.float64]

STEP_DEG = 5.0
"""Of polar angles and azimuths of the hemisphere."""
FINE_DEG = (0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0)
"""Radii of circles about the specular direction."""

_LAST_DEG = 85.0


def hemisphere(theta_deg: float, phi_deg: float, side: Side, scatter: Scatter) -> tuple[Floats, Floats]:
    """Polar angles and azimuths [°] of a hemisphere by steps, finer about the specular direction, each once."""
    polar, azimuth = np.meshgrid(np.arange(STEP_DEG, _LAST_DEG + 1.0, STEP_DEG), np.arange(0.0, 360.0, STEP_DEG))
    around = np.arange(0.0, 360.0, 30.0)
    radial, about = np.meshgrid(FINE_DEG[1:], around)
    near, along, above = from_specular(np.append(radial, 0.0), np.append(about, 0.0), theta_deg, phi_deg, side, scatter)
    above &= near <= _LAST_DEG
    theta = np.concatenate([[0.0], polar.ravel(), near[above]])
    phi = np.concatenate([[0.0], azimuth.ravel(), along[above]])
    flat = np.round(np.column_stack([theta, np.where(theta > 0.0, phi, 0.0)]), 6)
    _, first = np.unique(flat, axis=0, return_index=True)
    return theta[first], phi[first]


def incident_angles(choices: Mapping[str, object], key: str, default: Floats, low: float, high: float) -> Floats:
    """Angles [°] that a person asks for, or others.

    Raises
    ------
    ClerestoryError
        They are no angles within limits.
    """
    said = choices.get(key)
    if said is None:
        return default
    try:
        angles = np.atleast_1d(np.asarray(said, dtype=np.float64))
    except (TypeError, ValueError):
        angles = np.array([np.nan])
    if angles.ndim != 1 or not angles.size or not ((angles >= low) & (angles <= high)).all():
        raise ClerestoryError(f"{key} {said!r} is not a list of angles within {low:g} to {high:g}° (give degrees)")
    return angles
