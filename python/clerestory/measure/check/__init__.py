"""Checks of a measurement: mistakes found before a simulation finds them.

Each check is a function that looks at the scans of a sample and yields findings. Thresholds are constants beside them,
after IEA SHC Task 61 report C.2.2 (2021), section 2, where it has any.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from clerestory._core import ClerestoryError
from clerestory.finding import SEVERITIES, Finding
from clerestory.measure.check import agreement, angles, conditions, light
from clerestory.measure.prepare.reference import as_bsdf, without_dark
from clerestory.measure.prepare.together import combined

if TYPE_CHECKING:
    from collections.abc import Iterable

    from clerestory.measure.contents import Contents
    from clerestory.measure.scan import Measurement
    from clerestory.measure.sphere import SphereValues

__all__ = ["Finding", "check", "check_contents"]

_OF_RAW = (angles.radians, angles.azimuths, angles.copies, light.saturation, conditions.drift, conditions.spot)
_OF_BSDF = (
    angles.coverage,
    angles.hemispheres,
    light.energy,
    light.label,
    light.negative,
    light.peak,
    light.shadow,
    light.symmetry,
    conditions.near_normal,
)


def check(measurement: Measurement, sphere_values: Iterable[SphereValues] = ()) -> list[Finding]:
    """Look for what is wrong or suspicious in the scans of a sample.

    Parameters
    ----------
    measurement
        As it was read; a detector's signals are referred to the beam first, and coarse and fine scans put together.
    sphere_values
        Values of an integrating sphere, which the integrals of the scans should agree with.

    Returns
    -------
    Findings, errors first.
    """
    found = [Finding("warning", "file", "", text, "") for text in measurement.warnings]
    for one in _OF_RAW:
        found += one(measurement)
    whole, why = _as_bsdf(measurement)
    if whole is None:
        found.append(Finding("error", "reference", "", why, "without it, light cannot be told in absolute terms"))
    elif not any(finding.check == "radians" for finding in found):
        for one in _OF_BSDF:
            found += one(whole)
        found += agreement.sphere(whole, sphere_values)
    return sorted(found, key=lambda finding: SEVERITIES.index(finding.severity))


def check_contents(contents: Contents) -> dict[str, list[Finding]]:
    """The findings of every sample that files hold, by its name."""
    checked = {
        m.sample: check(m, [v for v in contents.sphere_values if v.sample in (m.sample, "")])
        for m in contents.measurements
    }
    alone = {v.sample for v in contents.sphere_values} - set(checked) - {""}
    for name in sorted(alone):
        checked[name] = agreement.sums([v for v in contents.sphere_values if v.sample == name])
    return checked


def _as_bsdf(measurement: Measurement) -> tuple[Measurement | None, str]:
    """The scans of the sample as BSDF, one a light; or why there are none."""
    if not measurement.of():
        return None, "there is no scan of the sample"
    try:
        whole, _ = as_bsdf(without_dark(measurement)[0])
        samples = tuple(scan for scan in whole.of() if len(scan))
        return combined(replace(whole, scans=samples))[0], ""
    except ClerestoryError as error:
        return None, str(error)
