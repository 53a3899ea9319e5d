"""An integrating sphere beside the integrals of the scans."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.finding import Finding
from clerestory.measure.calibrate.agreement import of_scans
from clerestory.words import percent

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from clerestory.measure.scan import Measurement
    from clerestory.measure.sphere import SphereValues

DISAGREES = 0.05
"""Relative difference of a sphere's value and an integral; goniophotometers are good to about 5 %, spheres to 1 or 2
%."""
LEAST = 0.003
"""Difference that is always allowed: a sphere's own noise and stray light."""
ENERGY = 0.01


def sphere(measurement: Measurement, values: Iterable[SphereValues]) -> Iterator[Finding]:
    """Scans integrate to what a sphere gave."""
    given = list(values)
    if not given:
        return
    yield from sums(given)
    try:
        found = of_scans(measurement, given)
    except ClerestoryError as error:
        yield Finding("note", "sphere", "", str(error), "measure one angle with both instruments")
        return
    for row in found.rows:
        allowed = max(DISAGREES * row.measured, LEAST, 2.0 * (row.standard_error or 0.0))
        if abs(row.difference) > allowed:
            yield Finding(
                "warning",
                "sphere",
                row.where,
                f"the sphere gives {percent(row.measured)}, the scan's integral is {percent(row.modelled)}",
                "find out why (reference, sides, lateral loss), or calibrate (clerestory measure calibrate)",
            )
    for text in found.warnings:
        yield Finding("note", "sphere", "", text, "")


def sums(values: Iterable[SphereValues]) -> list[Finding]:
    """Transmittance and reflectance of a side and angle are at most 1 together, and none is negative."""
    found: list[Finding] = []
    held = [v for v in values if v.collected == "hemispherical"]
    for one in held:
        where = f"{one.scatter} from the {one.incident_side}, {one.theta_deg:g}°"
        if (one.values < -ENERGY).any() or (one.values > 1.0 + ENERGY).any():
            worst = float(one.values[np.argmax(np.abs(one.values - 0.5))])
            text = f"a sphere's value of {worst:.3g} is no share of light"
            found.append(Finding("error", "sphere", where, text, "check for per cent, and the reference"))
            continue
        for other in held:
            if other.scatter != "reflection" or one.scatter != "transmission" or other.bands != one.bands:
                continue
            near = (
                np.isnan([one.theta_deg, other.theta_deg]).sum() == 0 and abs(one.theta_deg - other.theta_deg) <= 10.0
            )
            if other.incident_side != one.incident_side or not near or other.values.shape != one.values.shape:
                continue
            same = one.wavelength_nm is None or np.array_equal(one.wavelength_nm, np.asarray(other.wavelength_nm))
            both = float((one.values + other.values).max())
            if same and both > 1.0 + ENERGY:
                text = f"transmittance and reflectance make {percent(both)} together"
                found.append(Finding("error", "sphere", where, text, "one of them is wrong: check the reference"))
    return found
