"""Scans scaled to what an integrating sphere measured."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.counts import counted
from clerestory.directions import direction
from clerestory.integrals import continued
from clerestory.measure.calibrate.agreement import Agreement, of_scans
from clerestory.measure.calibrate.factors import Factors
from clerestory.measure.delaunay import surface
from clerestory.measure.prepare.step import Step, light_in_words, with_samples

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from clerestory.measure.calibrate.agreement import Row
    from clerestory.measure.scan import Measurement, Scan
    from clerestory.measure.sphere import SphereValues

    Floats = NDArray[np.float64]

ScanScaling = Literal["all", "scattered", "peak"]
PEAK_DEG = 5.0
"""Half angle [°] of the cone about straight or mirrored light that holds the peak."""


@dataclass(frozen=True)
class ScanCalibration:
    """Calibrated scans, and how their integrals agreed with the sphere before and agree now."""

    measurement: Measurement
    step: Step
    before: Agreement
    after: Agreement


def calibrated_scans(
    measurement: Measurement,
    values: Iterable[SphereValues],
    *,
    scaling: ScanScaling = "all",
    peak_deg: float = PEAK_DEG,
    standard: str = "en410",
) -> ScanCalibration:
    """Scans whose integrals over the hemisphere are those of a sphere.

    Factors are found where both were measured and interpolated for all other scans of that side and channel.

    Parameters
    ----------
    measurement
        With one scan of BSDF or DSF a light.
    values
        Spectra or values of bands; channels of the scans are found by their names.
    scaling
        All light; what is scattered outside of the peak and under it; or what stands out of its surroundings within
        `peak_deg` of straight or mirrored light.
    peak_deg
        Half angle of the peak's cone [°].
    standard
        By whose spectra wavelengths are weighed: en410, iso9050 or nfrc300.

    Raises
    ------
    ClerestoryError
        No value belongs to a scan, or the part that is kept has more light than was measured.
    """
    if scaling not in ("all", "scattered", "peak"):
        raise ClerestoryError(f"scaling {scaling!r} is not known for scans (give all, scattered or peak)")
    if not 0.0 < peak_deg < 45.0:
        raise ClerestoryError(f"a peak of {peak_deg:g}° about straight light is not one (give a half angle below 45°)")
    given = list(values)
    before = of_scans(measurement, given, standard=standard)
    made = [scan.as_bsdf() for scan in measurement.of()]
    warnings = list(before.warnings)
    figures: dict[str, object] = {}
    for key in sorted({(row.side, row.scatter, row.band) for row in before.rows}):
        rows = before.of(*key)
        side, scatter, band = key
        chosen = [
            k
            for k, scan in enumerate(made)
            if (scan.incident_side, scan.scatter) == (side, scatter) and band in scan.channels
        ]
        parts = {k: _parts(made[k], band, scaling, peak_deg) for k in chosen}
        found = _factors(rows, [made[k] for k in chosen], [parts[k] for k in chosen])
        where = f"{band}, {scatter} from the {side}"
        figures[where] = {"theta_deg": found.theta_deg.tolist(), "factor": found.values.tolist()}
        warnings.append(found.implausible(f"{where}, {scaling} light") or "")
        for k in chosen:
            scan = made[k]
            factor = found.at(np.array([scan.incident_theta_deg]), np.array([scan.incident_phi_deg]))[0]
            made[k] = _with(scan, band, parts[k], float(factor))
    result = with_samples(measurement, made)
    after = of_scans(result, given, standard=standard)
    words = f"{counted(len(made), 'scan')} scaled to a sphere's values ({scaling} light)"
    step = Step(
        "calibration",
        words,
        {"scaling": scaling, "peak_deg": peak_deg},
        {"factors": figures, "RMS difference before": before.rms, "after": after.rms},
        tuple(dict.fromkeys(filter(None, warnings))),
    )
    return ScanCalibration(result, step, before, after)


def _parts(scan: Scan, band: str, scaling: ScanScaling, peak_deg: float) -> Floats:
    """The part of each value that is scaled [1/sr]."""
    values = scan.channel(band)
    if scaling == "all":
        return values
    toward = continued(scan.incident, scan.scatter)
    apart = np.degrees(np.arccos(np.clip(scan.outgoing @ toward, -1.0, 1.0)))
    inside = apart <= peak_deg
    around = (apart > peak_deg) & (apart <= 2.0 * peak_deg + 5.0)
    if not around.any():
        raise ClerestoryError(f"{light_in_words(scan)}: no point about the peak tells what lies under it (scale all)")
    under = float(np.median(values[around]))
    peak = np.where(inside, np.maximum(values - under, 0.0), 0.0)
    return peak if scaling == "peak" else values - peak


def _factors(rows: Sequence[Row], scans: Sequence[Scan], parts: Sequence[Floats]) -> Factors:
    theta, phi, factors = [], [], []
    for row in rows:
        toward = direction(row.theta_deg, row.phi_deg, side=row.side)
        near = int(np.argmin([np.linalg.norm(scan.incident - toward) for scan in scans]))
        scan = scans[near]
        one = replace(scan, channels=("part",), values=parts[near][:, None], standard_errors=None)
        changed = float(surface(one).integrate().total[0])
        wanted = row.measured - (row.modelled - changed)
        if wanted < 0.0:
            raise ClerestoryError(f"{row.where}: the part that is kept has more light than was measured (scale all)")
        if changed <= 0.0:
            raise ClerestoryError(f"{row.where}: there is no such light in the scan that could be scaled (scale all)")
        theta.append(row.theta_deg)
        phi.append(row.phi_deg)
        factors.append(wanted / changed)
    return Factors.of(theta, phi, factors)


def _with(scan: Scan, band: str, part: Floats, factor: float) -> Scan:
    values = scan.values.copy()
    column = scan.channels.index(band)
    values[:, column] += (factor - 1.0) * part
    errors = scan.standard_errors
    if errors is not None:
        held = scan.values[:, column]
        errors = errors.copy()
        errors[:, column] *= np.divide(values[:, column], held, out=np.ones_like(held), where=held != 0.0)
    return replace(scan, values=values, standard_errors=None if errors is None else np.abs(errors))
