"""Marks of scans and sphere values: SHA-256 of all that they hold, save the file that they came from."""

from __future__ import annotations

import hashlib
import json
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from clerestory.measure.scan import Scan
    from clerestory.measure.sphere import SphereValues

    Floats = NDArray[np.float64]


def mark_of_scan(scan: Scan) -> str:
    """The same for scans of the same numbers, names and conditions."""
    words = [scan.purpose, scan.incident_side, scan.scatter, scan.quantity, list(scan.channels), dict(scan.conditions)]
    head = [*words, _exact(scan.incident_theta_deg), _exact(scan.incident_phi_deg)]
    return _mark(head, [scan.theta_deg, scan.phi_deg, scan.values, scan.standard_errors])


def mark_of_sphere(values: SphereValues) -> str:
    """The same for values of the same numbers, names and conditions."""
    words = [values.incident_side, values.scatter, values.collected, list(values.bands), dict(values.conditions)]
    head = [*words, _exact(values.theta_deg), _exact(values.phi_deg)]
    return _mark(head, [values.wavelength_nm, values.values, values.standard_errors])


def _exact(angle_deg: float) -> str:
    return (float(angle_deg) + 0.0).hex()  # a database may forget the sign of zero


def _mark(head: Sequence[object], arrays: Sequence[Floats | None]) -> str:
    digest = hashlib.sha256(json.dumps(head, sort_keys=True).encode())
    for array in arrays:
        digest.update(b"|")
        if array is not None:
            digest.update(np.ascontiguousarray(array).data)
    return digest.hexdigest()
