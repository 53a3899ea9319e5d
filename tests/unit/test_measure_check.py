"""Each mistake of a measurement is found where it was made, and not in sound data."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from clerestory.integrals import continued
from clerestory.measure import Measurement, SphereValues
from clerestory.measure.check import check
from clerestory.measure.delaunay import surface
from synthetic_lab import about, diffuse_and_peak, hemisphere, scan, series, venetian


@cache
def sound():
    """A fabric as a careful laboratory measures it: fine scans of the peak, 8°, all of both hemispheres."""
    scans = []
    for theta, phi in ((0.0, 0.0), (8.0, 90.0), (40.0, 90.0), (40.0, 0.0)):
        for scatter, level in (("transmission", 0.3), ("reflection", 0.2)):

            def sample(i, o, s, level=level):
                return diffuse_and_peak(i, o, s, diffuse=level, peak=5.0 * level, width_deg=3.0)

            coarse = scan(
                sample, theta, phi, scatter=scatter, noise_dsf=0.0005, seed=len(scans), points=hemisphere(6.0)
            )
            points = about(continued(coarse.incident, scatter), coarse.side, 8.0, 1.0)
            fine = scan(sample, theta, phi, scatter=scatter, noise_dsf=0.0005, seed=100 + len(scans), points=points)
            scans += [coarse, fine]
    conditions = {"spot_mm": "20", "period_mm": "1", "sample_mm": "100", "symmetry": "isotropic"}
    return Measurement("fabric", tuple(replace(s, conditions=conditions) for s in scans))


def faults(measurement, values=()):
    return {f.check: f for f in check(measurement, values) if f.severity != "note"}


def each(measurement, change):
    return replace(measurement, scans=tuple(change(s) for s in measurement.scans))


def beam(power=1.0, shift_deg=0.0):
    theta, phi = about(np.array([0.0, 0.0, 1.0]), "interior", 4.0, 0.25)
    x = np.radians(theta)[:, None] * np.column_stack([np.cos(np.radians(phi)), np.sin(np.radians(phi))])
    values = power * np.exp(-0.5 * ((x - [np.radians(shift_deg), 0.0]) ** 2).sum(axis=1) / np.radians(0.6) ** 2)
    base = scan(diffuse_and_peak, 0.0, 0.0, points=(theta, phi))
    return replace(base, values=values[:, None], quantity="signal", purpose="beam")


def with_beams(first, last):
    measurement = series(diffuse_and_peak, thetas_deg=(8.0,), phis_deg=(0.0,))
    return replace(measurement, scans=(first, *measurement.scans, last))


def test_sound_data_are_sound():
    assert faults(sound()) == {}
    assert faults(with_beams(beam(), beam(1.002))) == {}


def test_radians():
    def wrong(s):
        return replace(
            s,
            theta_deg=np.radians(s.theta_deg),
            phi_deg=np.radians(s.phi_deg),
            incident_theta_deg=np.radians(s.incident_theta_deg),
            incident_phi_deg=np.radians(s.incident_phi_deg),
        )

    found = faults(each(sound(), wrong))
    assert found["radians"].severity == "error"
    # A fine scan about the normal alone is no such thing: its azimuths go around in degrees.
    near = scan(diffuse_and_peak, 0.0, 0.0, points=about(np.array([0.0, 0.0, 1.0]), "interior", 1.0, 0.2))
    assert "radians" not in faults(Measurement("peak", (near,)))


def test_theta_and_phi_exchanged():
    # A quarter of the hemisphere, where angles that change places are still angles.
    theta, phi = (a.ravel() for a in np.meshgrid(np.arange(0.0, 90.0, 2.5), np.arange(0.0, 90.0, 2.5)))
    lights = ((50.0, 200.0), (20.0, 230.0), (35.0, 265.0))
    right = Measurement("corner", tuple(scan(diffuse_and_peak, t, p, points=(theta, phi)) for t, p in lights))
    assert "azimuths" not in faults(right)
    wrong = each(right, lambda s: replace(s, theta_deg=s.phi_deg, phi_deg=s.theta_deg))
    assert "exchanged" in faults(wrong)["azimuths"].what


@pytest.mark.parametrize("turn", ["source", "mirror"])
def test_azimuths_of_another_convention(turn):
    def wrong(s):
        return replace(s, phi_deg=s.phi_deg + 180.0 if turn == "source" else 180.0 - s.phi_deg)

    measurement = series(diffuse_and_peak, phis_deg=(20.0, 110.0))
    assert "azimuths" not in faults(measurement)
    assert ("180°" if turn == "source" else "mirrored") in faults(each(measurement, wrong))["azimuths"].what


@pytest.mark.parametrize(("power", "severity"), [(1.03, "warning"), (0.9, "error")])
def test_drift(power, severity):
    found = faults(with_beams(beam(), beam(power)))["drift"]
    assert found.severity == severity
    assert ("+3.0 %" if power > 1.0 else "-10") in found.what


def test_a_beam_that_moved():
    assert "0.3" in faults(with_beams(beam(), beam(shift_deg=0.3)))["drift"].what


def test_more_light_than_there_was():
    found = faults(each(sound(), lambda s: replace(s, values=2.0 * s.values)))["energy"]
    assert found.severity == "error"


def test_saturation():
    def wrong(s):
        return replace(s, values=np.minimum(s.values, 0.6 * s.values.max()))

    assert "saturation" in faults(each(sound(), wrong))


def test_dsf_called_bsdf_and_bsdf_called_dsf():
    def as_dsf(s):
        return replace(s, values=s.values * np.cos(np.radians(s.theta_deg))[:, None])

    assert "looks like DSF" in faults(each(sound(), as_dsf))["label"].what
    assert "label" not in faults(each(sound(), lambda s: replace(as_dsf(s), quantity="dsf")))
    assert "taken for DSF" in faults(each(sound(), lambda s: replace(s, quantity="dsf")))["label"].what


def test_a_peak_of_one_point():
    def narrow(i, o, s):
        return diffuse_and_peak(i, o, s, peak=30.0, width_deg=0.7)

    coarse = Measurement("film", (scan(narrow, 40.0, 90.0, points=hemisphere(5.0)),))
    assert "one point" in faults(coarse)["peak"].what
    fine = scan(
        narrow, 40.0, 90.0, points=about(continued(coarse.scans[0].incident, "transmission"), "interior", 4.0, 0.3)
    )
    assert "peak" not in faults(replace(coarse, scans=(*coarse.scans, fine)))


def test_half_a_hemisphere():
    def wrong(s):
        kept = np.sin(np.radians(s.phi_deg)) < 0.1
        return replace(s, theta_deg=s.theta_deg[kept], phi_deg=s.phi_deg[kept], values=s.values[kept])

    found = faults(each(series(diffuse_and_peak), wrong))["coverage"]
    assert "upward" in found.what


def test_a_symmetry_that_does_not_hold():
    measurement = series(venetian, phis_deg=(0.0, 90.0, 180.0, 270.0), thetas_deg=(0.0, 8.0, 50.0))
    stated = each(measurement, lambda s: replace(s, conditions={"symmetry": "quadrilateral"}))
    assert "quadrilateral" in faults(stated)["symmetry"].what
    right = each(measurement, lambda s: replace(s, conditions={"symmetry": "left-right"}))
    assert "symmetry" not in faults(right)


def test_the_detector_in_the_beam():
    def wrong(s):
        apart = np.degrees(np.arccos(np.clip(s.outgoing @ s.incident, -1.0, 1.0)))
        return replace(s, values=np.where((apart < 6.0)[:, None], 0.05 * s.values, s.values))

    reflecting = series(diffuse_and_peak, thetas_deg=(8.0, 40.0), scatter="reflection", points=hemisphere(2.5))
    assert "shadow" not in faults(reflecting)
    assert "shadow" in faults(each(reflecting, wrong))


def test_a_spot_too_small_or_too_large():
    small = each(sound(), lambda s: replace(s, conditions={"spot_mm": "20", "period_mm": "6"}))
    assert "3.3 periods" in faults(small)["spot"].what
    long = each(sound(), lambda s: replace(s, conditions={"spot_mm": "80", "sample_mm": "100"}))
    assert "40°" in faults(long)["spot"].what


def test_noise_and_a_dark_signal_too_large():
    found = faults(each(series(diffuse_and_peak), lambda s: replace(s, values=s.values - 0.2)))
    assert "negative" in found


def test_copies():
    measurement = series(diffuse_and_peak, thetas_deg=(8.0, 40.0), phis_deg=(0.0,))
    twice = replace(
        measurement, scans=(measurement.scans[0], replace(measurement.scans[1], values=measurement.scans[0].values))
    )
    assert faults(twice)["copy"].severity == "error"


def test_no_angle_near_8():
    notes = [f.check for f in check(series(diffuse_and_peak, thetas_deg=(0.0, 40.0)))]
    assert "near normal" in notes
    assert "near normal" not in [f.check for f in check(sound())]


def test_signals_without_a_beam():
    raw = each(series(diffuse_and_peak), lambda s: replace(s, quantity="signal"))
    assert faults(raw)["reference"].severity == "error"


def values_of(measurement, factor):
    found = []
    for s in measurement.scans:
        total = surface(s).integrate().total[0]
        found.append(
            SphereValues(
                "fabric",
                s.incident_side,
                s.scatter,
                s.incident_theta_deg,
                np.array([factor * total]),
                bands=("visible",),
                phi_deg=s.incident_phi_deg,
            )
        )
    return found


def test_a_sphere_that_disagrees():
    measurement = series(diffuse_and_peak, thetas_deg=(0.0, 8.0, 40.0))
    assert "sphere" not in faults(measurement, values_of(measurement, 1.01))
    assert "sphere" in faults(measurement, values_of(measurement, 1.2))


def test_a_sphere_in_per_cent():
    measurement = series(diffuse_and_peak, thetas_deg=(0.0, 8.0))
    found = check(measurement, values_of(measurement, 100.0))
    assert ("error", "sphere") in [(f.severity, f.check) for f in found]
