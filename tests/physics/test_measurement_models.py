"""Models of a synthetic laboratory's scans, beside the truth at incident directions that were not measured."""

from dataclasses import replace

import numpy as np
import pytest

import pg2
from clerestory import ClerestoryError, read
from clerestory.directions import direction
from clerestory.measure import Measurement
from clerestory.measure.interpolant import fit

#: Between the measured rings and azimuths [°].
THETA = np.array([5.0, 15.0, 25.0, 35.0, 45.0, 55.0, 65.0, 74.0])
PHI = np.array([7.5, 22.0, 37.5, 50.0, 67.5, 80.0, 10.0, 33.0])


def between(name, method):
    """Relative errors of direct-hemispherical values, angles of the peaks [°], RMS errors over the mean."""
    isotropic = pg2.SYMMETRY[name] == "isotropic"
    made = fit(pg2.measured(name, isotropic=isotropic), symmetry=pg2.SYMMETRY[name], method=method, hold_out=False)
    incident = direction(THETA, PHI, side="exterior")
    totals = made.bsdf.integrate(incident, "transmission")
    brightest = made.bsdf.models["visible"]["exterior", "transmission"]._core.brightest(incident)
    off, angles, rms = [], [], []
    for k in range(len(THETA)):
        at = pg2.travel(THETA[k], PHI[k])
        off.append(totals[k] / pg2.total(name, at) - 1.0)
        found = np.array([*brightest[k], np.sqrt(max(0.0, 1.0 - brightest[k] @ brightest[k]))])
        axes = pg2.brightest(name, at)
        angles.append(np.degrees(np.arccos(np.clip((axes @ found).max(), -1.0, 1.0))))
        truth = pg2.bsdf(name, at, pg2.EVEN)
        values = made.bsdf.evaluate(np.tile(incident[k], (len(pg2.EVEN), 1)), pg2.EVEN)
        rms.append(np.sqrt(np.mean((values - truth) ** 2)) / truth.mean())
    return np.array(off), np.array(angles), np.array(rms)


#: Most that transport's RMS error may be of linear interpolation's, on average over the directions.
WORSE = {"peak": 0.1, "off-specular": 0.9, "ring": 0.3, "twill": 0.3, "prism": 0.1}


@pytest.mark.parametrize(
    "name",
    ["peak", "off-specular", "ring", *(pytest.param(name, marks=pytest.mark.slow) for name in ("twill", "prism"))],
)
def test_samples_come_back_between_measured_directions(name):
    off, angles, rms = between(name, "transport")
    assert np.abs(off).max() < 0.01
    assert angles.max() < (0.1 if name == "peak" else 0.5)
    _, _, linear = between(name, "linear")
    assert rms.mean() < WORSE[name] * linear.mean()


def test_lobes_do_not_sag_between_points_as_far_apart_as_the_light_is_wide():
    thetas = (20.0, 35.0, 50.0)
    scans = [pg2.scan("ring", theta, 0.0, spacing_deg=5.0, seed=2) for theta in thetas]
    made = fit(scans, symmetry="isotropic", hold_out=False)
    found = made.bsdf.integrate(direction(thetas, [0.0] * 3, side="exterior"), "transmission")
    truth = [pg2.total("ring", pg2.travel(theta, 0.0)) for theta in thetas]
    np.testing.assert_allclose(found, truth, rtol=0.01)


def test_a_model_says_how_good_it_is_and_survives_its_file(tmp_path):
    made = fit(pg2.measured("peak", isotropic=True))
    (component,) = made.components
    assert component.symmetry == "isotropic"
    assert any("not tested" in text for text in made.warnings)
    held = component.held_out
    assert len(held) == 8
    assert held.total_error < 0.02
    assert held.peak_median_deg < 0.5
    assert "extrapolated" in made.lines()[1]
    path = tmp_path / "model.bsdf.npz"
    made.bsdf.write(path)
    again = read(path)
    incident = direction([33.0], [70.0], side="exterior")
    outgoing = direction([33.0], [250.0], side="interior")
    assert again.evaluate(incident, outgoing) == made.bsdf.evaluate(incident, outgoing)
    model = again.models["visible"]["exterior", "transmission"]
    assert model.kind == "interpolant"
    assert list(model.extrapolated(incident, outgoing)) == [False]
    assert list(model.extrapolated(direction([85.0], [0.0], side="exterior"), outgoing)) == [True]


def test_colour_and_sides_become_bands_and_components():
    scans = pg2.measured("off-specular", isotropic=True, spacing_deg=6.0).scans
    both = [replace(s, values=np.tile(s.values, (1, 2)), channels=("visible", "solar")) for s in scans]
    back = [replace(s, incident_side="interior") for s in scans]
    made = fit(Measurement("twice", (*both, *back)), hold_out=False)
    assert {(c.band, c.side) for c in made.components} == {
        ("visible", "exterior"),
        ("solar", "exterior"),
        ("visible", "interior"),
    }


def test_negative_noise_does_not_add_light():
    scans = pg2.measured("off-specular", isotropic=True, noise=0.01).scans
    made = fit(scans, hold_out=False)
    incident = direction([10.0, 30.0, 50.0], [0.0, 0.0, 0.0], side="exterior")
    truth = [pg2.total("off-specular", pg2.travel(theta, 0.0)) for theta in (10.0, 30.0, 50.0)]
    np.testing.assert_allclose(made.bsdf.integrate(incident, "transmission"), truth, rtol=0.02)


def test_what_makes_no_model_is_refused():
    scans = pg2.measured("peak", isotropic=True, spacing_deg=8.0).scans
    with pytest.raises(ClerestoryError, match="two or more"):
        fit(scans[:1], symmetry="isotropic")
    with pytest.raises(ClerestoryError, match="line"):
        fit(scans, symmetry="none")
    with pytest.raises(ClerestoryError, match="too few"):
        fit([replace(s, theta_deg=s.theta_deg[:3], phi_deg=s.phi_deg[:3], values=s.values[:3]) for s in scans])
    with pytest.raises(ClerestoryError, match="signal"):
        fit([replace(s, quantity="signal") for s in scans])
    with pytest.raises(ClerestoryError, match="not known"):
        fit(scans, method="cubic")
