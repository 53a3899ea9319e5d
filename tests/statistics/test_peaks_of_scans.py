"""Peaks of a coarse scan are found where they were planted, and nowhere in noise."""

import numpy as np
import pytest

from clerestory import ClerestoryError
from clerestory.directions import direction
from clerestory.measure import Scan
from clerestory.measure.plan import find_peaks, fine_paths
from clerestory.measure.plan.paths import hemisphere_path

COARSE = hemisphere_path("interior", step_deg=2.5, largest_theta_deg=85.0)
OUTGOING = direction(COARSE.theta_deg, COARSE.phi_deg, side="interior")


def scan(bsdf, noise=0.0, dark=0.0, seed=1):
    """As an instrument sees it: noise in proportion, and of the detector, which grows toward the horizon."""
    rng = np.random.default_rng(seed)
    seen = bsdf * (1.0 + noise * rng.standard_normal(len(OUTGOING)))
    seen += dark * rng.standard_normal(len(OUTGOING)) / OUTGOING[:, 2]
    return Scan("exterior", "transmission", 40.0, 90.0, COARSE.theta_deg, COARSE.phi_deg, seen[:, None])


def away(theta, phi):
    return np.degrees(np.arccos(np.clip(OUTGOING @ direction(theta, phi, side="interior"), -1.0, 1.0)))


def lobe(theta, phi, height, width):
    return height * np.exp(-0.5 * (away(theta, phi) / width) ** 2)


PLANTED = [(40.0, 270.0, 30.0, 2.0), (25.0, 30.0, 3.0, 3.0), (72.0, 140.0, 8.0, 2.0), (0.0, 0.0, 1.0, 3.0)]


@pytest.mark.parametrize("seed", range(6))
def test_planted_peaks_are_found_and_nothing_else(seed):
    bsdf = 0.1 + sum(lobe(*planted) for planted in PLANTED)
    found = find_peaks(scan(bsdf, noise=0.03, dark=0.002, seed=seed))
    assert len(found) == len(PLANTED)
    for theta, phi, height, width in PLANTED:
        at = direction(theta, phi, side="interior")
        (near,) = [
            p for p in found if direction(p.theta_deg, p.phi_deg, side="interior") @ at > np.cos(np.radians(2.0))
        ]
        assert np.degrees(np.arccos(direction(near.theta_deg, near.phi_deg, side="interior") @ at)) < 0.75
        assert near.bsdf == pytest.approx(height, rel=0.5)
        assert near.width_deg == pytest.approx(2.355 * width, rel=0.2)
        assert near.resolved


@pytest.mark.parametrize(
    "bsdf",
    [
        np.full(len(OUTGOING), 0.2),
        0.3 * OUTGOING[:, 2] ** 2,
        0.1 + lobe(30.0, 270.0, 0.5, 25.0),  # wide: the coarse scan has it already
    ],
    ids=["lambertian", "cosine", "wide"],
)
def test_noise_has_no_peaks(bsdf):
    # 3,084 points a scan: at 7 sigmas none of 15 scans is expected to have one (p < 1e-6).
    assert [seed for seed in range(15) if find_peaks(scan(bsdf, noise=0.05, dark=0.005, seed=seed))] == []


def test_a_peak_between_the_points_of_the_scan_is_told_as_not_resolved():
    ring = int(np.argmin(away(40.0, 270.0)))
    at = COARSE.theta_deg[ring], COARSE.phi_deg[ring]
    (found,) = find_peaks(scan(0.1 + lobe(*at, 200.0, 0.3), noise=0.02))
    assert not found.resolved
    assert (found.theta_deg, found.phi_deg) == pytest.approx(at)
    assert found.width_deg == pytest.approx(2.5, abs=0.3)


@pytest.mark.parametrize("pattern", ["circle", "square"])
def test_fine_paths_recover_the_width_of_a_peak(pattern):
    width = 1.6  # standard deviation; half height is 2.355 of them apart
    (peak,) = find_peaks(scan(0.1 + lobe(41.0, 268.0, 20.0, width), noise=0.02, dark=0.002))
    (path,) = fine_paths([peak], pattern=pattern, resolution_deg=1.5)
    d = direction(path.theta_deg, path.phi_deg, side="interior")
    from_middle = np.degrees(np.arccos(np.clip(d @ direction(41.0, 268.0, side="interior"), -1.0, 1.0)))
    seen = 0.1 + 20.0 * np.exp(-0.5 * (from_middle / width) ** 2)
    # The area above half height is that of a circle of the width.
    cell = path.step_deg**2 if pattern == "square" else np.pi * (1.5 * peak.width_deg) ** 2 / len(path)
    across = 2.0 * np.sqrt(cell * (seen > 0.5 * seen.max()).sum() / np.pi)
    assert across == pytest.approx(2.355 * width, rel=0.05)


def test_what_makes_no_sense_is_refused():
    given = scan(np.full(len(OUTGOING), 0.2))
    with pytest.raises(ClerestoryError, match="make no sense"):
        find_peaks(given, contrast=1.0)
    with pytest.raises(ClerestoryError, match="no channel"):
        find_peaks(given, channel="solar")
    with pytest.raises(ClerestoryError, match="pattern"):
        fine_paths(find_peaks(scan(0.1 + lobe(40.0, 0.0, 9.0, 3.0))), pattern="star")
