"""From a detector's signal to a BSDF: the dark taken off, the beam as reference.

BSDF = P_s / (P_i Ω_d cos θ), with the power P_s that a detector of solid angle Ω_d takes in and the beam's power P_i.
A scan across the beam gives ∫ P dΩ = P_i Ω_d, so neither needs to be known by itself.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.counts import counted
from clerestory.measure.prepare.signature import Drift, drifts, in_time, signatures
from clerestory.measure.prepare.step import Step, light_in_words, time_of
from clerestory.words import percent

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from clerestory.measure.scan import Measurement, Scan

    Floats = NDArray[np.float64]

DRIFT = 0.01
"""Relative change of the beam's power that is worth a warning."""
_LEAST_COSINE = 1e-3


def without_dark(measurement: Measurement) -> tuple[Measurement, Step]:
    """Signals less what the detector gives in the dark: a line in time through its scans, where all times are known.

    Raises
    ------
    ClerestoryError
        A scan of the dark lacks a channel of a signal.
    """
    signals = [scan for scan in measurement.scans if scan.quantity == "signal" and scan.purpose != "dark"]
    darks = [scan for scan in measurement.of(purpose="dark") if len(scan)]
    if not signals:
        return measurement, Step("dark signal", "no detector signals: nothing to subtract")
    if not darks:
        text = "there is no scan of the dark, so its signal is still in all values"
        return measurement, Step("dark signal", "no dark scan: nothing subtracted", warnings=(text,))
    levels = _by_time(darks, {name: [float(d.channel(name).mean()) for d in darks] for name in darks[0].channels})
    made = []
    for scan in measurement.scans:
        if scan.quantity == "signal" and scan.purpose != "dark":
            level = np.array([levels(scan, name) for name in scan.channels])
            made.append(replace(scan, values=scan.values - level))
        else:
            made.append(scan)
    spread = {
        name: float(np.concatenate([d.channel(name) - d.channel(name).mean() for d in darks]).std())
        for name in darks[0].channels
    }
    figures = {
        "dark scans": len(darks),
        "mean": {name: float(np.mean([d.channel(name).mean() for d in darks])) for name in darks[0].channels},
        "standard deviation of a value": spread,
    }
    words = f"the mean of {counted(len(darks), 'dark scan')} taken off {counted(len(signals), 'scan')}"
    return replace(measurement, scans=tuple(made)), Step("dark signal", words, {}, figures)


def as_bsdf(measurement: Measurement, *, detector_cone_deg: float | None = None) -> tuple[Measurement, Step]:
    """All scans of the sample as BSDF [1/sr], by the beam's scans or, for DSF, by the cosine.

    Parameters
    ----------
    measurement
        With the dark signal taken off.
    detector_cone_deg
        Full angle that the detector takes in [°], for a beam that was measured in one place only; else the beam's
        profile is integrated.

    Raises
    ------
    ClerestoryError
        There are signals and no scan of the beam, or one of too few points without the detector's angle.
    """
    samples = measurement.of()
    signals = [scan for scan in samples if scan.quantity == "signal"]
    turned = sum(scan.quantity == "dsf" for scan in samples)
    if not signals:
        words = f"{counted(turned, 'scan')} of DSF divided by cos θ" if turned else "all scans are BSDF already"
        scans = tuple(scan.as_bsdf() if scan.purpose == "sample" else scan for scan in measurement.scans)
        return replace(measurement, scans=scans), Step("BSDF", words, {}, {"scans of DSF": turned})
    beams = in_time(measurement.of(purpose="beam"))
    if not beams:
        raise ClerestoryError(
            f"{counted(len(signals), 'scan')} of a detector's signal and none of the beam: no BSDF can be told"
            " (add a scan of the beam without the sample)"
        )
    references = [_reference(beam, detector_cone_deg) for beam in beams]
    names = [name for name in beams[0].channels if all(name in r for r in references)]
    level = _by_time(beams, {name: [r[name] for r in references] for name in names})
    made = []
    for scan in measurement.scans:
        if scan.purpose != "sample" or scan.quantity == "bsdf":
            made.append(scan)
        elif scan.quantity == "dsf":
            made.append(scan.as_bsdf())
        else:
            made.append(_divided(scan, np.array([level(scan, name) for name in scan.channels])))
    moved = drifts(measurement) if all(len(beam) >= 3 for beam in beams) else ()
    in_line = len(beams) > 1 and all(time_of(scan) is not None for scan in [*beams, *signals])
    figures = {
        "scans of signal": len(signals),
        "scans of DSF": turned,
        "scans of the beam": len(beams),
        "drift": {d.channel: {"power": d.power, "shift_deg": d.shift_deg, "seconds": d.seconds} for d in moved},
        "corrected in time": in_line,
    }
    words = (
        f"{counted(len(signals), 'scan')} of signal referred to {counted(len(beams), 'scan')} of the beam, "
        f"{'on a line in time between them' if in_line else 'their mean' if len(beams) > 1 else 'the only one'}"
    )
    warnings = [*_drift_warnings(moved, corrected=in_line), *_beam_warnings(beams)]
    settings = {"detector_cone_deg": detector_cone_deg}
    return replace(measurement, scans=tuple(made)), Step("BSDF", words, settings, figures, tuple(warnings))


def _reference(beam: Scan, detector_cone_deg: float | None) -> dict[str, float]:
    """P_i Ω_d of each channel [signal·sr]."""
    weakened = _weakened(beam)
    if detector_cone_deg is not None:
        if not 0.0 < detector_cone_deg < 90.0:
            raise ClerestoryError(f"a detector does not take in {detector_cone_deg:g}° (give its full angle)")
        solid_angle = 2.0 * np.pi * (1.0 - np.cos(np.radians(0.5 * detector_cone_deg)))
        powers = {name: float(beam.channel(name).max()) * solid_angle * weakened for name in beam.channels}
        dark = next((name for name, power in powers.items() if not power > 0.0), None)
        if dark is not None:
            raise ClerestoryError(f"a scan of the beam has no light in {dark} (is it a scan of the dark?)")
        return powers
    if len(beam) < 10:
        raise ClerestoryError(
            f"{counted(len(beam), 'point')} of the beam do not give its profile (scan across it, or give the"
            " detector's full angle and a value at its centre)"
        )
    return {s.channel: s.integral * weakened for s in signatures(beam)}


def _weakened(scan: Scan) -> float:
    """Factor by which the light of a scan was weakened, by a filter in the beam or a lower gain."""
    text = scan.conditions.get("attenuation", "1")
    try:
        factor = float(text)
    except ValueError:
        factor = 0.0
    if not (np.isfinite(factor) and factor > 0.0):
        raise ClerestoryError(f"an attenuation of {text!r} is not a factor (give 1000 for a filter of density 3)")
    return factor


def _divided(scan: Scan, reference: Floats) -> Scan:
    cosine = np.cos(np.radians(scan.theta_deg))
    kept = cosine > _LEAST_COSINE
    per = reference / _weakened(scan) * cosine[kept, None]
    return replace(
        scan,
        theta_deg=scan.theta_deg[kept],
        phi_deg=scan.phi_deg[kept],
        values=scan.values[kept] / per,
        quantity="bsdf",
        standard_errors=None if scan.standard_errors is None else scan.standard_errors[kept] / per,
    )


def _by_time(scans: Sequence[Scan], levels: dict[str, list[float]]) -> Callable[[Scan, str], float]:
    """A level for a scan and channel: linear in time through all that have one, else their mean."""
    times = [time_of(scan) for scan in scans]

    def level(scan: Scan, channel: str) -> float:
        if channel not in levels:
            raise ClerestoryError(
                f"{light_in_words(scan)} has a channel {channel!r} that was not measured for the"
                f" {scans[0].purpose} (there are {', '.join(levels)})"
            )
        now = time_of(scan)
        known = [t for t in times if t is not None]
        if now is None or len(known) < len(times) or len(set(known)) < 2:
            return float(np.mean(levels[channel]))
        slope, at_zero = np.polyfit(np.array(known) - known[0], levels[channel], 1)
        return float(at_zero + slope * (now - known[0]))

    return level


def _drift_warnings(moved: Sequence[Drift], *, corrected: bool) -> list[str]:
    what = "corrected on a line in time" if corrected else "times are not known, so the mean is used"
    return [
        f"the beam's power in {d.channel} changed by {'+' if d.power > 0 else '-'}{percent(abs(d.power))} from its"
        f" first scan to its last ({what})"
        for d in moved
        if abs(d.power) > DRIFT
    ]


def _beam_warnings(beams: Sequence[Scan]) -> list[str]:
    return [
        f"a scan of the beam in {s.channel} stops where it still has {percent(s.border)} of its peak: its power is"
        " too low and the BSDF too high (scan farther out)"
        for beam in beams
        if len(beam) >= 10
        for s in signatures(beam)
        if not s.whole
    ][:1]
