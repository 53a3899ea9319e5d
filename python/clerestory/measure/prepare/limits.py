"""Points that an instrument cannot see, or cannot see well: too close to grazing, in its own shadow, out of reach."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.counts import counted
from clerestory.measure.prepare.step import Step, with_samples

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from clerestory.directions import Side
    from clerestory.measure.scan import Measurement, Scan

LEAST_GRAZING_DEG = 75.0
MOST_GRAZING_DEG = 85.0
"""An automatic limit lies between these outgoing angles [°]: data of steep incidence only must not lose what is sound,
and past the second the noise, which grows with 1/cos θ, is more than eleven times that at the normal."""


@dataclass(frozen=True)
class Sector:
    """Outgoing directions that an instrument does not reach."""

    side: Side
    theta_from_deg: float
    theta_to_deg: float
    phi_from_deg: float
    """Azimuths run from here counter-clockwise to `phi_to_deg` [°]."""
    phi_to_deg: float

    def holds(self, scan: Scan) -> NDArray[np.bool_]:
        """Which points of a scan lie in it."""
        if scan.side != self.side:
            return np.zeros(len(scan), dtype=bool)
        wide = (self.phi_to_deg - self.phi_from_deg) % 360.0 or 360.0
        return np.asarray(
            (scan.theta_deg >= self.theta_from_deg)
            & (scan.theta_deg <= self.theta_to_deg)
            & ((scan.phi_deg - self.phi_from_deg) % 360.0 <= wide)
        )


def within_reach(
    measurement: Measurement,
    *,
    grazing_deg: float | Literal["auto"] = "auto",
    shadow_deg: float = 0.0,
    unreachable: Sequence[Sector] = (),
) -> tuple[Measurement, Step]:
    """The scans without points that the instrument does not see.

    Parameters
    ----------
    measurement
        With scans of the sample.
    grazing_deg
        Outgoing angle [°] up to which points are kept; by default the most grazing incident angle of the measurement,
        as what was reached one way is reached the other way, but at least `LEAST_GRAZING_DEG` and at most
        `MOST_GRAZING_DEG`.
    shadow_deg
        Half angle [°] of the cone about the source in which the detector stands in the beam, for reflection.
    unreachable
        Sectors that the instrument's arm does not reach.

    Raises
    ------
    ClerestoryError
        An angle makes no sense, or nothing is left of a scan.
    """
    samples = measurement.of()
    automatic = grazing_deg == "auto"
    limit = _automatic(samples) if grazing_deg == "auto" else float(grazing_deg)
    if not 0.0 < limit <= 90.0:
        raise ClerestoryError(f"points cannot be kept up to {limit:g}° (give more than 0 and at most 90°, or auto)")
    if not 0.0 <= shadow_deg < 90.0:
        raise ClerestoryError(f"a shadow of {shadow_deg:g}° is not possible (give the cone's half angle, 0 to 90°)")
    lost = {"grazing": 0, "shadow": 0, "out of reach": 0}
    made = []
    for scan in samples:
        grazing = scan.theta_deg > limit + 1e-9
        shadow = np.zeros(len(scan), dtype=bool)
        if scan.scatter == "reflection" and shadow_deg > 0.0:
            shadow = ~grazing & (scan.outgoing @ scan.incident > np.cos(np.radians(shadow_deg)))
        out = np.zeros(len(scan), dtype=bool)
        for sector in unreachable:
            out |= sector.holds(scan)
        out &= ~grazing & ~shadow
        for name, which in (("grazing", grazing), ("shadow", shadow), ("out of reach", out)):
            lost[name] += int(which.sum())
        made.append(_kept(scan, ~(grazing | shadow | out)))
    words = (
        f"points up to {limit:g}° kept{' (by the most grazing incident angle)' if automatic else ''}: "
        f"{counted(lost['grazing'], 'point')} beyond, {lost['shadow']} in the detector's shadow and"
        f" {lost['out of reach']} out of reach left out"
    )
    settings = {
        "grazing_deg": limit,
        "automatic": automatic,
        "shadow_deg": shadow_deg,
        "unreachable": [sector.__dict__ for sector in unreachable],
    }
    return with_samples(measurement, made), Step("within reach", words, settings, dict(lost))


def _automatic(samples: Sequence[Scan]) -> float:
    largest = max((scan.incident_theta_deg for scan in samples), default=MOST_GRAZING_DEG)
    return float(min(max(largest, LEAST_GRAZING_DEG), MOST_GRAZING_DEG))


def _kept(scan: Scan, which: NDArray[np.bool_]) -> Scan:
    if which.all():
        return scan
    if not which.any():
        raise ClerestoryError(
            f"nothing is left of {scan.scatter} from the {scan.incident_side} at {scan.incident_theta_deg:g}°"
            " (check the limits, and whether its angles are degrees)"
        )
    return replace(
        scan,
        theta_deg=scan.theta_deg[which],
        phi_deg=scan.phi_deg[which],
        values=scan.values[which],
        standard_errors=None if scan.standard_errors is None else scan.standard_errors[which],
    )
