"""Formulas fitted to synthetic scans: parameters come back within the errors that are stated."""

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2

from clerestory import Basis, Bsdf, ClerestoryError, _core, trace
from clerestory import read as read_bsdf
from clerestory.cli import main
from clerestory.directions import direction, outgoing_side
from clerestory.integrals import continued
from clerestory.measure import Measurement, Scan, read, write
from clerestory.measure.formula import FORMULAS, data_set, fit_formula
from clerestory.measure.formula.beam import Beam, apart_from
from clerestory.measure.formula.shapes import Geometry
from synthetic_lab import about, hemisphere

DIFFUSE = 0.1
CASES = {
    "lambertian": ("reflection", {}),
    "abg": ("reflection", {"peak": 20.0, "rolloff": 0.03, "g": 2.2}),
    "harvey-shack": ("transmission", {"peak": 20.0, "shoulder": 0.03, "slope": 2.2}),
    "k-correlation": ("reflection", {"level": 20.0, "length": 30.0, "exponent": 1.5}),
    "gaussian": ("transmission", {"peak": 5.0, "width": 0.1}),
    "cosine-power": ("transmission", {"share": 0.5, "n": 6.0}),
    "ward": ("reflection", {"share": 0.3, "alpha": 0.1}),
    "ward-bounded": ("reflection", {"share": 0.3, "alpha": 0.1}),
    "ward-anisotropic": ("reflection", {"share": 0.3, "alpha_x": 0.1, "alpha_y": 0.2}),
    "ggx": ("reflection", {"f0": 0.5, "alpha": 0.15}),
    "ggx-transmission": ("transmission", {"level": 0.95, "alpha": 0.15, "index": 1.5}),
}


def usual(name, held):
    """Parameters as the fit reports them."""
    arrays = {key: np.array(value) for key, value in held.items()}
    found = FORMULAS[name].reported(arrays) or held
    return {**{key: float(value) for key, value in found.items()}, "diffuse": DIFFUSE}


def scan(name, theta_deg, *, seed, points=None, held=None, noise=0.02, phi_deg=90.0):
    scatter, parameters = CASES[name]
    incident = direction(theta_deg, phi_deg, side="exterior")
    side = outgoing_side("exterior", scatter)
    if points is None:
        even = hemisphere(9.0, 80.0)
        near = about(continued(incident, scatter), side, 6.0, 1.5)
        points = tuple(np.concatenate(pair) for pair in zip(even, near, strict=True))
    theta, phi = (array[points[0] <= 84.0] for array in points)
    outgoing = direction(theta, phi, side=side)
    arrays = {key: np.array(value) for key, value in (held or parameters).items()}
    values = FORMULAS[name].value(Geometry.of(incident, outgoing), arrays) + DIFFUSE / np.pi
    values = values * (1.0 + noise * np.random.default_rng(seed).standard_normal(len(values)))
    return Scan("exterior", scatter, theta_deg, phi_deg, theta, phi, values[:, None])


def lab(name, thetas_deg=(10.0, 50.0), *, seed=0, **options):
    return Measurement(
        name, tuple(scan(name, theta, seed=1000 * seed + k, **options) for k, theta in enumerate(thetas_deg))
    )


@pytest.mark.parametrize("name", CASES)
def test_every_formula_comes_back(name):
    (found,) = fit_formula(lab(name), name)
    truth = usual(name, CASES[name][1])
    numbers = found.numbers(30.0)
    assert {n.name for n in numbers} == set(truth)
    for number in numbers:
        assert number.standard_error < 0.1 * abs(truth[number.name])
        assert abs(number.value - truth[number.name]) < 4.5 * number.standard_error, number
    assert found.residual.rms_log10 == pytest.approx(0.02 / np.log(10.0), rel=0.25)
    assert all(order == 0 for order in found.orders.values())  # nothing changes with the angle of incidence


def test_stated_errors_are_those_that_are_made():
    z = []
    for seed in range(24):
        (found,) = fit_formula(lab("gaussian", (40.0,), seed=seed), "gaussian", order=0)
        truth = usual("gaussian", CASES["gaussian"][1])
        z.append([(n.value - truth[n.name]) / n.standard_error for n in found.numbers(40.0)])
    squares = np.square(z).sum(axis=0)
    low, high = chi2.ppf([0.001, 0.999], len(z))  # three parameters, 99.4 % together
    assert ((squares > low) & (squares < high)).all(), squares / len(z)


def test_levels_that_change_with_the_angle_are_followed():
    scans = [
        scan("gaussian", theta, seed=k, held={"peak": 5.0 * np.exp(1.0 - np.cos(np.radians(theta))), "width": 0.1})
        for k, theta in enumerate((0.0, 20.0, 40.0, 60.0, 70.0))
    ]
    (found,) = fit_formula(Measurement("x", tuple(scans)), "gaussian")
    assert found.orders["peak"] == 1
    assert found.orders["width"] == 0
    for theta in (0.0, 35.0, 70.0):
        peak = found.numbers(theta)[0]
        truth = 5.0 * np.exp(1.0 - np.cos(np.radians(theta)))
        assert abs(peak.value - truth) < 4.0 * peak.standard_error
    assert found.numbers(85.0) == found.numbers(70.0)  # beyond what was measured they stay


WIDTH_DEG = 1.5


def through_the_beam(theta_deg, specular, *, seed=0):
    """A Gaussian lobe and a beam that passes, seen through an instrument's beam 1.5° wide."""
    incident = direction(theta_deg, 90.0, side="exterior")
    straight = continued(incident, "transmission")
    theta, phi = (np.concatenate(p) for p in zip(hemisphere(6.0, 80.0), about(straight, "interior"), strict=True))
    outgoing = direction(theta, phi, side="interior")
    beam = Beam.gaussian(WIDTH_DEG)
    # At the normal direction cosines are angles, nearly, and the widths of Gaussians add as squares.
    lobe, own = 0.05, beam.deviation
    u = Geometry.of(incident, outgoing).u
    wide = np.hypot(lobe, own)
    values = 4.0 * (lobe / wide) ** 2 * np.exp(-0.5 * (u / wide) ** 2) + DIFFUSE / np.pi
    cosine = np.abs(outgoing[:, 2])
    values = values + specular * beam.density(apart_from(outgoing, straight)) / cosine
    values *= 1.0 + 0.01 * np.random.default_rng(seed).standard_normal(len(values))
    return Scan("exterior", "transmission", theta_deg, 90.0, theta, phi, values[:, None])


def beam_scan():
    theta, phi = about(direction(0.0, 0.0, side="interior"), "interior", 5.0, 0.25)
    outgoing = direction(theta, phi, side="interior")
    density = Beam.gaussian(WIDTH_DEG).density(apart_from(outgoing, np.array([0.0, 0.0, 1.0])))
    values = (7.0 * density)[:, None]
    return Scan("exterior", "transmission", 0.0, 0.0, theta, phi, values, quantity="signal", purpose="beam")


@pytest.mark.parametrize("specular", [0.2, 0.0])
def test_the_beam_is_told_apart_from_the_lobe(specular):
    measurement = Measurement("x", (through_the_beam(0.0, specular), beam_scan()))
    (found,) = fit_formula(measurement, "gaussian")
    held = {n.name: n for n in found.numbers(0.0)}
    assert held["width"].value == pytest.approx(0.05, rel=0.01)
    assert held["peak"].value == pytest.approx(4.0, rel=0.02)
    assert held["specular"].value == pytest.approx(specular, abs=0.003)
    assert found.beam.signature.widths_deg[0] == pytest.approx(WIDTH_DEG, rel=0.03)
    # Without the beam's scan the width holds the instrument's own, and nothing is said to be unscattered.
    (blind,) = fit_formula(Measurement("x", measurement.of()), "gaussian")
    assert "specular" not in {n.name for n in blind.numbers(0.0)}
    assert "not known" in blind.lines()[-1]
    bsdf, _ = data_set([found], resolution=5)
    straight = bsdf.integrate(direction(0.0, 0.0, side="exterior"), "transmission", part="direct")
    assert float(straight) == pytest.approx(held["specular"].value if specular else 0.0, abs=1e-6)


@pytest.mark.parametrize("name", ["abg", "ward-anisotropic"])
def test_a_data_set_is_the_formula(name):
    (found,) = fit_formula(lab(name), name)
    bsdf, warnings = data_set([found], name="slat", resolution=4 if name == "ward-anisotropic" else 6)
    assert any("beyond 50°" in text for text in warnings)
    assert bsdf.metadata.name == "slat"
    cells = _core.square_directions(400)
    for theta in (0.0, 25.0, 48.0):
        incident = direction(theta, 90.0, side="exterior")
        outgoing = cells * np.array([1.0, 1.0, -1.0])
        total = float(found.evaluate(incident, outgoing).mean() * np.pi)
        assert float(bsdf.integrate(incident, "reflection")) == pytest.approx(total, rel=0.015)
        far = direction([60.0, 70.0], [0.0, 180.0], side="exterior")
        np.testing.assert_allclose(
            bsdf.evaluate(np.tile(incident, (2, 1)), far), found.evaluate(incident, far), rtol=0.1
        )


def test_a_lobe_narrower_than_a_cell_keeps_its_light():
    (found,) = fit_formula(lab("abg"), "abg", order=0)
    narrow = replace(found, coefficients=np.array([np.log(2e6), np.log(1e-4), 2.2, np.log(DIFFUSE)]))
    bsdf, _ = data_set([narrow], resolution=5)
    u = np.geomspace(1e-8, 1.0, 20_001)
    values = 2e6 / (1.0 + (u / 1e-4) ** 2.2)
    lobe = 2.0 * np.pi * np.trapezoid(values * u, u)
    total = float(bsdf.integrate(direction(0.0, 0.0, side="exterior"), "reflection"))
    assert total == pytest.approx(lobe + DIFFUSE, rel=0.02)


def test_the_virtual_goniophotometer_sees_the_fitted_material():
    (found,) = fit_formula(lab("gaussian", (20.0,)), "gaussian")
    sheet = {"kind": "pane", "thickness_mm": 0, "exterior": "m"}
    incident = direction(20.0, 90.0, side="exterior")
    settings = trace.Settings(basis="klems-quarter", sides=("exterior",), samples=1 << 16)
    seen, _ = trace.scan({"sample": sheet, "materials": {"m": found.material()}}, incident, settings)
    (through,) = [one for one in seen if one.scatter == "transmission"]
    basis = Basis.named("klems-quarter")
    at = (np.arange(64) + 0.5) / 64
    u = np.stack(np.meshgrid(at, at), axis=-1).reshape(-1, 2)
    patches = [found.evaluate(incident, basis.sample_outgoing(k, u, "interior")).mean() for k in range(len(basis))]
    lit = np.array(patches) > 0.01
    z = (through.values - patches)[lit] / np.hypot(through.errors, 0.002 * np.array(patches))[lit]
    assert np.abs(z).max() < 4.5


def test_what_cannot_be_fitted_is_named():
    measurement = lab("abg")
    with pytest.raises(ClerestoryError, match="not known"):
        fit_formula(measurement, "phong")
    with pytest.raises(ClerestoryError, match="for transmission, and reflection was measured"):
        fit_formula(measurement, "ggx-transmission")
    with pytest.raises(ClerestoryError, match="3 incident angles"):
        fit_formula(measurement, "abg", order=2)
    with pytest.raises(ClerestoryError, match="signal"):
        fit_formula(Measurement("x", (replace(measurement.scans[0], quantity="signal"),)), "abg")
    with pytest.raises(ClerestoryError, match="no channel"):
        fit_formula(measurement, "abg", channels=["nir"])
    few = replace(measurement.scans[0], theta_deg=[10.0, 20.0], phi_deg=[0.0, 0.0], values=np.ones((2, 1)))
    with pytest.raises(ClerestoryError, match="fewer than three"):
        fit_formula(Measurement("x", (few,)), "abg")
    with pytest.raises(ClerestoryError, match="wide is not possible"):
        fit_formula(measurement, "abg", beam_deg=-1.0)


def test_on_the_command_line(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    write(replace(lab("abg"), sample="slat"), "scans", "mountain")
    assert len(read("scans").measurements[0]) == 2
    words = ["measure", "formula", "scans", "--model", "abg"]
    assert main([*words, "--csv", "slat.csv", "--picture", "slat.png", "-o", "slat.xml", "--basis", "tensor3"]) == 0
    shown = capsys.readouterr().out
    assert "±" in shown
    assert 'kind = "abg"' in shown
    rows = tmp_path.joinpath("slat.csv").read_text().splitlines()
    assert len(rows) == 1 + 2 * 4
    assert tmp_path.joinpath("slat.png").stat().st_size > 20_000
    assert isinstance(read_bsdf("slat.xml"), Bsdf)
    assert main([*words, "--json"]) == 0
    (component,) = json.loads(capsys.readouterr().out)["components"]
    g = next(p for p in component["angles"][0]["parameters"] if p["name"] == "g")
    assert g["value"] == pytest.approx(2.2, abs=5.0 * g["standard_error"])
    assert main([*words[:-1], "phong"]) == 2
    assert main([*words, "--order", "9"]) == 2
    assert main([*words, "-o", "slat.txt"]) == 2
