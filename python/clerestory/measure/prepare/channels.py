"""Detectors and filters put together to bands: visible, solar."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.counts import counted
from clerestory.measure.delaunay import surface
from clerestory.measure.prepare.step import Step, light_in_words, same_light, with_samples

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from clerestory.measure.scan import Measurement, Scan

_SUM = 1e-6
_SAME_DEG = 1e-4


def side_by_side(measurement: Measurement) -> tuple[Measurement, Step]:
    """Scans of one light by several detectors as one scan of several channels.

    Where their points differ, those of the scan with the most points hold, and the others are read off their surfaces
    there (linear in BSDF).

    Raises
    ------
    ClerestoryError
        Two scans of one light have the same channel; they must be put together first.
    """
    made = []
    joined = between = 0
    for group in same_light(measurement.of()):
        if len(group) == 1:
            made.append(group[0])
            continue
        names = [name for scan in group for name in scan.channels]
        if len(set(names)) < len(names):
            raise ClerestoryError(
                f"{light_in_words(group[0])}: {counted(len(group), 'scan')} share a channel"
                " (combine coarse and fine scans, or average positions, first)"
            )
        joined += len(group)
        base = max(group, key=len)
        values, errors = [], []
        for scan in group:
            if _same_points(base, scan):
                values.append(scan.values)
                errors.append(scan.standard_errors)
            else:
                between += 1
                values.append(surface(scan, clip_deg=0.0).evaluate(base.outgoing))
                errors.append(None)
        known = [e for e in errors if e is not None]
        made.append(
            replace(
                base.as_bsdf() if base.quantity == "dsf" else base,
                channels=tuple(names),
                values=np.hstack(values),
                standard_errors=np.hstack(known) if len(known) == len(errors) else None,
            )
        )
    words = (
        f"{counted(joined, 'scan')} of several detectors put side by side, {between} read off between their points"
        if joined
        else "no light was measured by several detectors"
    )
    return with_samples(measurement, made), Step("detectors", words, {}, {"scans": joined, "interpolated": between})


def as_bands(measurement: Measurement, bands: Mapping[str, Mapping[str, float]]) -> tuple[Measurement, Step]:
    """Scans whose channels are weighted sums of the detectors'.

    Parameters
    ----------
    measurement
        With all channels of a light in one scan.
    bands
        Weights of channels by band; those of a band sum to 1. Scans that lack one of its channels do without the band.

    Raises
    ------
    ClerestoryError
        Weights do not sum to 1, or a scan has none of the bands.
    """
    for band, mixture in bands.items():
        total = sum(mixture.values())
        if not abs(total - 1.0) <= _SUM:
            raise ClerestoryError(f"the weights of {band} sum to {total:.6g}, not to 1")
    made, missing = [], 0
    for scan in measurement.of():
        held = {band: w for band, w in bands.items() if set(w) <= set(scan.channels)}
        if not held:
            wanted = sorted({name for w in bands.values() for name in w})
            raise ClerestoryError(
                f"{light_in_words(scan)} has {', '.join(scan.channels)} and none of the bands can be made of that"
                f" (they need {', '.join(wanted)})"
            )
        missing += len(bands) - len(held)
        mix = np.array([[w.get(name, 0.0) for w in held.values()] for name in scan.channels])
        errors = None
        if scan.standard_errors is not None:
            errors = np.sqrt(scan.standard_errors**2 @ mix**2)  # detectors' noise is independent
        made.append(replace(scan, channels=tuple(held), values=scan.values @ mix, standard_errors=errors))
    words = f"{', '.join(bands)} made of the detectors' channels in {counted(len(made), 'scan')}"
    warnings = () if missing == 0 else (f"{counted(missing, 'band')} could not be made for want of a channel",)
    settings = {"bands": {band: dict(w) for band, w in bands.items()}}
    return with_samples(measurement, made), Step("bands", words, settings, {"missing": missing}, warnings)


def _same_points(a: Scan, b: Scan) -> bool:
    return a.quantity == b.quantity and same_points([a, b])


def same_points(scans: Sequence[Scan]) -> bool:
    """Whether scans have the same outgoing directions in the same order."""
    first = scans[0]
    return all(
        len(scan) == len(first)
        and bool(np.all(np.linalg.norm(scan.outgoing - first.outgoing, axis=1) < np.radians(_SAME_DEG)))
        for scan in scans[1:]
    )
