"""Measured points as a fit takes them: folded, thinned where they crowd, weighed so that no range of angles rules."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.measure.formula.beam import Beam, Spread, apart_from
from clerestory.measure.formula.shapes import Geometry
from clerestory.measure.prepare.limits import MOST_GRAZING_DEG
from clerestory.measure.prepare.noise import noise

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from clerestory.measure.scan import Scan

    Floats = NDArray[np.float64]

FLOOR = 1e-4
"""What an instrument can tell from dark at best [1/sr]."""
RELATIVE = 0.05
"""Error of a value beside noise that a formula is not asked to be better than."""
_PER_DECADE = 10
_SECTORS = 24
_ENOUGH = 2000
_MOST = 4
"""Of a light with more than `_ENOUGH` points, so many are kept of each tenth of a decade of u and 15° about the
mirrored or straight direction."""
_FINEST_DEG = 0.1
_AROUND_SOURCE_DEG = 3.0
"""Reflected light this close to the source is that of a detector in its own beam."""


@dataclass(frozen=True)
class Light:
    """Points of light from one direction."""

    theta_deg: float
    """Angle of incidence [°]."""
    phi_deg: float
    incident: Floats
    """To the source (3,), +z forward."""
    outgoing: Floats
    """Folded (n, 3)."""
    geometry: Geometry
    apart: Floats
    """Angles from the mirrored or straight direction [rad] (n,)."""
    values: Floats
    """BSDF [1/sr] (n,), negative ones included."""
    errors: Floats
    """Standard errors [1/sr] of noise (n,)."""
    weights: Floats
    """How much a point counts; 1 in the mean (n,)."""
    spread: Spread | None
    measured: int
    """Points before they were thinned and limited."""

    @classmethod
    def of(cls, group: Sequence[Scan], channel: str, beam: Beam | None, *, around_normal: bool) -> Light:
        """The scans of light from one direction.

        Raises
        ------
        ClerestoryError
            Fewer than three points are left.
        """
        first = group[0]
        outgoing = np.concatenate([scan.outgoing for scan in group])
        values = np.concatenate([scan.channel(channel) for scan in group])
        theta = np.concatenate([scan.theta_deg for scan in group])
        errors = np.concatenate([_errors(scan, channel) for scan in group])
        kept = np.isfinite(values) & np.isfinite(errors) & (theta <= MOST_GRAZING_DEG)
        if first.scatter == "reflection":
            kept &= outgoing @ first.incident < np.cos(np.radians(_AROUND_SOURCE_DEG))
            # At the normal the mirrored light goes back to the source: it is either blocked or measured on purpose.
            if first.incident_theta_deg < _AROUND_SOURCE_DEG:
                kept = np.isfinite(values) & np.isfinite(errors) & (theta <= MOST_GRAZING_DEG)
        folded = np.stack([outgoing[:, 0], outgoing[:, 1], np.abs(outgoing[:, 2])], axis=1)
        incident = np.array([*first.incident[:2], abs(first.incident[2])])
        finest = _finest(beam)
        u = Geometry.of(incident, folded).u
        if kept.sum() > _ENOUGH:
            kept &= _thinned(u, folded + incident, finest, kept)
        if kept.sum() < 3:
            raise ClerestoryError(
                f"{first.scatter} from the {first.incident_side} at {first.incident_theta_deg:g}°: fewer than three"
                f" points up to {MOST_GRAZING_DEG:g}°"
            )
        folded, values, errors = folded[kept], values[kept], errors[kept]
        geometry = Geometry.of(incident, folded)
        middle = incident * [-1.0, -1.0, 1.0]
        apart = apart_from(folded, middle)
        place = 30.0 * geometry.cos_out**2 if around_normal else _PER_DECADE * np.log10(np.maximum(geometry.u, finest))
        _, which, counts = np.unique(np.floor(place), return_inverse=True, return_counts=True)
        weights = 1.0 / counts[which]
        return cls(
            first.incident_theta_deg,
            first.incident_phi_deg,
            incident,
            folded,
            geometry,
            apart,
            values,
            errors,
            weights / weights.mean(),
            None if beam is None else Spread.of(beam, middle, folded),
            len(kept),
        )


def _finest(beam: Beam | None) -> float:
    """Distance in direction cosines below which points are not told apart."""
    return float(np.radians(_FINEST_DEG)) if beam is None else 0.25 * beam.width


def _thinned(u: Floats, off: Floats, finest: float, kept: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """At most a few points of each ring and sector, the first ones."""
    ring = np.floor(_PER_DECADE * np.log10(np.maximum(u, finest))).astype(np.int64)
    sector = np.floor((np.arctan2(off[:, 1], off[:, 0]) / (2.0 * np.pi) % 1.0) * _SECTORS).astype(np.int64)
    cell = np.where(kept, (ring - ring.min()) * _SECTORS + sector, -1)
    order = np.argsort(cell, kind="stable")
    place = np.arange(len(cell)) - np.searchsorted(cell[order], cell[order])
    found = np.zeros(len(cell), dtype=bool)
    found[order] = place < _MOST
    return found


def _errors(scan: Scan, channel: str) -> Floats:
    if scan.standard_errors is not None:
        return scan.standard_errors[:, scan.channels.index(channel)]
    return np.asarray(noise(scan, channel) / np.maximum(np.cos(np.radians(scan.theta_deg)), 0.02))
