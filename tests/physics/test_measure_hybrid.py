"""Hybrid models of two known truths: measured where the instrument reached, simulated elsewhere."""

import json
from dataclasses import replace

import numpy as np
import pytest

import pg2
from clerestory import Basis, Bsdf, ClerestoryError, Model
from clerestory import read as read_bsdf
from clerestory.cli import main
from clerestory.directions import direction
from clerestory.measure import Measurement, write
from clerestory.measure.hybrid import Reach, joined, reaches_known, reaches_of
from clerestory.measure.interpolant import fit
from synthetic_lab import diffuse_and_peak, series

KEY = ("exterior", "transmission")
KLEMS = Basis.named("klems-quarter")
AREAS = KLEMS.projected_solid_angles


def sampled(of):
    """Matrix of a function of incident and outgoing directions at the middles of patches."""
    incident, outgoing = KLEMS.incident_centres("exterior"), KLEMS.outgoing_centres("interior")
    return np.array([of(i, outgoing) for i in incident]).T


def truth(incident, outgoing):
    """A diffuser with a wide lobe straight on."""
    return 0.1 + 0.5 * np.exp(-0.5 * np.sum((outgoing + incident) ** 2, axis=-1) / 0.3**2)


def other(incident, outgoing):
    """The same sample at a quarter of the level, with a slope of its own."""
    return 0.25 * truth(incident, outgoing) * (1.0 + 0.1 * outgoing[..., 2])


def data_set(of, band="visible"):
    return Bsdf.from_models({band: {KEY: Model.matrix(sampled(of), KLEMS)}})


def values(bsdf):
    return bsdf.models["visible"][KEY].values


def hybrid(incident_deg=65.0, outgoing_deg=75.0, **options):
    measured = data_set(truth)
    reaches = reaches_known(measured, incident_deg=incident_deg, outgoing_deg=outgoing_deg)
    return joined(measured, reaches, data_set(other), basis="klems-quarter", **options)


def test_each_is_where_it_belongs_and_shares_sum_to_one():
    made = hybrid(blend_deg=5.0)
    (part,) = made.parts
    found, measured, simulated = values(made.bsdf), sampled(truth), sampled(other)
    limits = KLEMS.limits_deg
    inside, outside = limits[:, 1] <= 60.0, limits[:, 0] >= 75.0
    deep = limits[:, 1] <= 70.0
    np.testing.assert_allclose(found[np.ix_(deep, inside)], measured[np.ix_(deep, inside)], rtol=1e-6)
    np.testing.assert_allclose(found[:, outside], part.factor * simulated[:, outside], rtol=1e-6)
    # Everywhere between the two, so that no patch stands out.
    low, high = np.minimum(measured, part.factor * simulated), np.maximum(measured, part.factor * simulated)
    assert (found >= low - 1e-6).all()
    assert (found <= high + 1e-6).all()
    assert part.factor == pytest.approx(4.0, rel=0.1)
    assert part.factor_overlap == pytest.approx(4.0, rel=0.1)
    assert 0.0 < part.apart < 0.05
    # Shares by hand: incident directions within 65° and 75° out, with half of the band lost.
    assert part.measured_incident == pytest.approx(np.sin(np.radians(65.0)) ** 2, abs=0.03)
    expected = np.sin(np.radians(62.5)) ** 2 * np.sin(np.radians(72.5)) ** 2
    assert part.measured_solid_angle == pytest.approx(expected, abs=0.03)
    assert 0.0 < part.measured_flux < 1.0
    assert "measured" in made.bsdf.metadata.comments[1]


def test_no_seam_shows_where_one_passes_into_the_other():
    measured = data_set(truth)
    reaches = reaches_known(measured, incident_deg=70.0, outgoing_deg=70.0)
    simulated = Bsdf.from_models({"visible": {KEY: Model.lambertian(0.5)}})
    made = joined(measured, reaches, simulated, basis="tensor3", resolution=6, reduce=None, blend_deg=15.0)
    theta = np.linspace(30.0, 85.0, 221)
    incident = np.tile(direction(20.0, 0.0, side="exterior"), (len(theta), 1))
    outgoing = direction(theta, np.full(len(theta), 90.0), side="interior")
    w = reaches["visible", *KEY].weights(incident[0], outgoing, 15.0)
    steps = np.abs(np.diff(w))
    assert w[0] == 1.0
    assert w[-1] == 0.0
    assert steps.max() < 2.0 * (1.0 / 15.0) * (theta[1] - theta[0])  # a smooth step is at most 1.5 times as steep
    along = made.bsdf.evaluate(incident, outgoing)
    assert along[-1] == pytest.approx(made.parts[0].factor * 0.5 / np.pi, rel=1e-5)


def test_two_that_agree_are_one_and_keep_their_energy():
    measured = data_set(truth)
    reaches = reaches_known(measured, incident_deg=65.0, outgoing_deg=75.0)
    made = joined(measured, reaches, data_set(lambda i, o: 0.8 * truth(i, o)), basis="klems-quarter")
    assert made.parts[0].factor == pytest.approx(1.25, rel=1e-6)
    np.testing.assert_allclose(values(made.bsdf), sampled(truth), rtol=1e-5)
    np.testing.assert_allclose(AREAS @ values(made.bsdf), AREAS @ sampled(truth), rtol=1e-5)
    assert made.warnings == ()
    kept = joined(measured, reaches, data_set(other), basis="klems-quarter", scale="none")
    assert kept.parts[0].factor == 1.0
    assert any("times the simulated, outside" in text for text in kept.warnings)


def test_what_was_only_simulated_is_taken_as_it_is_and_too_much_light_is_said():
    bright = data_set(lambda i, o: 2.5 * truth(i, o))
    reaches = reaches_known(bright, incident_deg=65.0, outgoing_deg=75.0)
    back = ("exterior", "reflection")
    both = Bsdf.from_models({**data_set(other).models["visible"], back: Model.lambertian(0.3)})
    made = joined(bright, reaches, both, basis="klems-quarter")
    (alone,) = [part for part in made.parts if part.scatter == "reflection"]
    assert (alone.measured_incident, alone.measured_solid_angle, alone.measured_flux) == (0.0, 0.0, 0.0)
    assert "all of it simulated" in alone.words
    np.testing.assert_allclose(made.bsdf.models["visible"][back].values, 0.3 / np.pi, rtol=1e-6)
    assert any("more than arrives" in text for text in made.warnings)


def test_scans_tell_how_far_they_reach():
    thetas = (0.0, 20.0, 40.0, 60.0)
    measurement = series(diffuse_and_peak, thetas_deg=thetas, phis_deg=(0.0,))
    reach = Reach.of_scans(measurement.of(), "isotropic")
    toward = direction([0.0, 55.0, 60.0, 70.0], [200.0] * 4, side="exterior")
    np.testing.assert_allclose(np.degrees(reach.incident_depth(toward)), [60.0, 5.0, 0.0, -10.0], atol=1e-6)
    out = direction([0.0, 60.0, 85.0, 89.0], [30.0] * 4, side="interior")
    found = reach.weights(toward[0], out, 10.0)
    assert found[0] == 1.0
    assert found[1] == 1.0
    assert found[2:].max() < 0.05
    # A shadow of 12° about 40° is a hole, and one that no point lies in is not measured.
    hole = direction(40.0, 0.0, side="interior")
    cut = []
    for scan in measurement.of():
        kept = np.degrees(np.arccos(np.clip(scan.outgoing @ hole, -1.0, 1.0))) > 12.0
        kept &= np.degrees(np.arccos(np.clip(scan.outgoing @ (hole * [1, -1, 1]), -1.0, 1.0))) > 12.0
        cut.append((scan, kept))
    holed = [replace(s, theta_deg=s.theta_deg[k], phi_deg=s.phi_deg[k], values=s.values[k]) for s, k in cut]
    reach = Reach.of_scans(holed, "isotropic")
    normal = direction(0.0, 0.0, side="exterior")
    assert reach.weights(normal, hole[None], 5.0)[0] == 0.0
    assert reach.weights(normal, direction([40.0], [90.0], side="interior"), 5.0)[0] == 1.0


def test_anisotropic_scans_reach_as_far_as_the_circle_around_them():
    measurement = series(diffuse_and_peak, thetas_deg=(0.0, 30.0, 60.0), phis_deg=tuple(range(0, 181, 30)))
    reach = Reach.of_scans(measurement.of(), "up-down")
    toward = direction([0.0, 58.0, 58.0, 65.0], [0.0, 15.0, 250.0, 15.0], side="exterior")
    depth = np.degrees(reach.incident_depth(toward))
    assert depth[0] == pytest.approx(59.0, abs=1.5)
    assert 0.0 < depth[1] < 2.0
    assert 0.0 < depth[2] < 2.0
    assert depth[3] < 0.0


def test_wrong_input_is_named():
    measured = data_set(truth)
    reaches = reaches_known(measured, incident_deg=65.0, outgoing_deg=75.0)
    with pytest.raises(ClerestoryError, match=r"no band 'visible'.*solar"):
        joined(measured, reaches, data_set(other, "solar"), basis="klems-quarter")
    reflecting = Bsdf.from_models({("exterior", "reflection"): Model.lambertian(0.5)})
    with pytest.raises(ClerestoryError, match="no transmission from the exterior"):
        joined(measured, reaches, reflecting, basis="klems-quarter")
    dark = Bsdf.from_models({KEY: Model.lambertian(0.0)})
    with pytest.raises(ClerestoryError, match="dark where light was measured"):
        joined(measured, reaches, dark, basis="klems-quarter")
    with pytest.raises(ClerestoryError, match="does not know how far"):
        reaches_known(measured)
    with pytest.raises(ClerestoryError, match="blend"):
        joined(measured, reaches_known(measured, incident_deg=5.0, outgoing_deg=5.0), data_set(other), blend_deg=20.0)


def test_an_interpolant_remembers_how_far_it_was_measured():
    made = fit(pg2.measured("off-specular", isotropic=True, spacing_deg=6.0), hold_out=False)
    (reach,) = reaches_known(made.bsdf).values()
    normal = direction(0.0, 0.0, side="exterior")
    assert reach.limit_deg == pytest.approx(80.0, abs=0.1)
    found = reach.weights(normal, direction([10.0, 60.0, 85.0], [0.0] * 3, side="interior"), 5.0)
    np.testing.assert_allclose(found, [1.0, 1.0, 0.0])


def test_from_scans_and_a_traced_file_on_the_command_line(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    lab = series(diffuse_and_peak, thetas_deg=(0.0, 25.0, 50.0, 70.0), phis_deg=(0.0,))
    write(Measurement("film", lab.scans), "scans", "mountain")
    Bsdf.from_models({KEY: Model.lambertian(0.35)}).write("traced.bsdf.npz")
    words = ["measure", "hybrid", "scans", "--with", "traced.bsdf.npz", "-o", "film.xml", "--basis", "tensor3"]
    words += ["--resolution", "5", "--picture", "film.png"]
    assert main([*words, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    (part,) = found["components"]
    for what in ("incident", "solid_angle", "flux"):
        assert part[f"measured_{what}"] + part[f"simulated_{what}"] == pytest.approx(1.0)
    made = read_bsdf("film.xml")
    assert any("simulated light times" in text for text in made.metadata.comments)
    assert tmp_path.joinpath("film.png").stat().st_size > 10_000
    assert main([*words[:-1], "film.gif"]) == 2
    assert main([*words, "--blend", "0"]) == 2
    assert main([*words, "--resolution", "12"]) == 1
    assert main(["measure", "hybrid", "film.xml", "--with", "traced.bsdf.npz", "-o", "again.xml"]) == 2
    assert "--incident-limit" in capsys.readouterr().err
    assert not tmp_path.joinpath("again.xml").exists()


def test_reaches_go_with_the_components_of_a_fit():
    lab = series(diffuse_and_peak, thetas_deg=(0.0, 30.0, 60.0), phis_deg=(0.0,))
    made = fit(lab, hold_out=False)
    assert set(reaches_of(lab, made)) == {("visible", *KEY)}
    with pytest.raises(ClerestoryError, match="larger angles"):
        reaches_of(Measurement("x", lab.scans[1:]), made, incident_deg=10.0)
