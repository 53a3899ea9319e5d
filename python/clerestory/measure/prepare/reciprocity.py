"""Light on reversed paths: f(i → o) = f(o → i), which fills incident directions that were not measured.

With directions that point away from the surface, the reversed path swaps them: light that comes from where it left to
leaves to where it came from (Helmholtz). So one point of every scan is a point of the reversed scan, which has as many
points as there are scans: few, and without a fine peak. It holds for samples without rotation of polarisation or
fluorescence.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.counts import counted
from clerestory.directions import angles, direction, outgoing_side
from clerestory.measure.delaunay import surface
from clerestory.measure.prepare.step import Step, light_in_words, with_samples
from clerestory.measure.scan import Scan

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from clerestory.directions import Scatter, Side
    from clerestory.measure.scan import Measurement

LEAST_POINTS = 12
"""A reversed scan of fewer points would say little about a hemisphere."""
_NEAR_DEG = 1.0


def filled(
    measurement: Measurement, incident_deg: Iterable[tuple[Side, Scatter, float, float]]
) -> tuple[Measurement, Step]:
    """The measurement with scans of light from directions that were not measured, by reversed paths.

    Parameters
    ----------
    measurement
        With scans of BSDF, one a light; images under the sample's symmetry add points to the new ones.
    incident_deg
        Side, scatter, angle to the normal and azimuth of the light wanted [°].

    Raises
    ------
    ClerestoryError
        The light was measured, or there are too few scans for its reversed paths.
    """
    samples = measurement.of()
    made: list[Scan] = []
    for side, scatter, theta, phi in incident_deg:
        wanted = direction(theta, phi, side=side)
        for scan in samples:
            same = (scan.incident_side, scan.scatter) == (side, scatter)
            if same and float(np.linalg.norm(scan.incident - wanted)) < np.radians(_NEAR_DEG):
                raise ClerestoryError(f"{light_in_words(scan)} was measured: reversed paths are not needed")
        made.append(_reversed(samples, side, scatter, theta, phi))
    words = f"{counted(len(made), 'incident direction')} filled by reversed paths"
    figures = {light_in_words(scan): len(scan) for scan in made}
    step = Step("reciprocity", words, {}, {"points": figures})
    return with_samples(measurement, [*samples, *made]), step


def missing_angles(measurement: Measurement, *, step_deg: float = 5.0) -> list[tuple[Side, Scatter, float, float]]:
    """Incident directions that reversed paths of the measurement can fill.

    For reflection, angles beyond the largest measured one in steps, up to 80°, at the azimuths measured; for
    transmission, the angles and azimuths of one side for the other side, if that has no scans.
    """
    samples = measurement.of()
    found: list[tuple[Side, Scatter, float, float]] = []
    for scatter in ("transmission", "reflection"):
        for side in ("exterior", "interior"):
            measured = [s for s in samples if (s.incident_side, s.scatter) == (side, scatter)]
            if not measured:
                continue
            if scatter == "transmission":
                other: Side = outgoing_side(side, "transmission")
                if not any((s.incident_side, s.scatter) == (other, scatter) for s in samples):
                    found += [(other, "transmission", s.incident_theta_deg, s.incident_phi_deg) for s in measured]
                continue
            top = max(s.incident_theta_deg for s in measured)
            azimuths = sorted({round(s.incident_phi_deg % 360.0, 3) for s in measured if s.incident_theta_deg > 1.0})
            found += [
                (measured[0].incident_side, "reflection", float(theta), azimuth)
                for theta in np.arange(top + step_deg, 80.0 + 1e-9, step_deg)
                for azimuth in azimuths
            ]
    return found


def _reversed(samples: Sequence[Scan], side: Side, scatter: Scatter, theta_deg: float, phi_deg: float) -> Scan:
    from_side = outgoing_side(side, scatter)
    wanted = direction(theta_deg, phi_deg, side=side)
    theta, phi, values, errors = [], [], [], []
    channels: tuple[str, ...] | None = None
    for scan in samples:
        if (scan.incident_side, scan.scatter) != (from_side, scatter) or len(scan) < 3:
            continue
        if channels is not None and scan.channels != channels:
            raise ClerestoryError(
                "scans of different channels have no common reversed paths (make bands of them first)"
            )
        channels = scan.channels
        through = surface(scan)
        if not through.measured(wanted):
            continue
        t, p = angles(scan.incident)
        theta.append(float(t))
        phi.append(float(p))
        values.append(through.evaluate(wanted))
        near = int(np.argmax(scan.outgoing @ wanted))
        errors.append(None if scan.standard_errors is None else scan.standard_errors[near])
    if channels is None or len(values) < LEAST_POINTS:
        raise ClerestoryError(
            f"{scatter} from the {side} at {theta_deg:g}°: {counted(len(values), 'scan')} hold reversed paths, and"
            f" {LEAST_POINTS} are needed (complete the symmetry first)"
        )
    known = [e for e in errors if e is not None]
    return Scan(
        side,
        scatter,
        theta_deg,
        phi_deg,
        np.array(theta),
        np.array(phi),
        np.array(values),
        channels=channels,
        standard_errors=np.array(known) if len(known) == len(errors) else None,
        conditions={"made": "reversed paths"},
    )
