"""Models of line scans: of a sample whose scattering depends on the distance from straight light alone."""

from dataclasses import replace

import numpy as np
import pytest

from clerestory import ClerestoryError, _core
from clerestory import read as read_bsdf
from clerestory.cli import main
from clerestory.directions import direction
from clerestory.measure import Measurement, Scan, write
from clerestory.measure.formula import fit_formula
from clerestory.measure.interpolant import fit, spread_lines
from synthetic_lab import diffuse_and_peak, series

CELLS = _core.square_directions(300)


def truth(incident, outgoing):
    """Harvey and Shack's, over an even floor."""
    u = np.linalg.norm(outgoing[..., :2] + incident[..., :2], axis=-1)
    return 8.0 / (1.0 + (u / 0.06) ** 2) ** 1.1 + 0.08 / np.pi


def line(theta_deg, *, across=False, of=truth, phi_deg=0.0):
    """A scan in the plane of incidence every degree, finer about the peak; or one across it."""
    alpha = np.concatenate([np.arange(-80.0, 80.1, 1.0), theta_deg + np.geomspace(0.1, 5.0, 20)])
    alpha = np.concatenate([alpha, theta_deg - np.geomspace(0.1, 5.0, 20)])
    alpha = alpha[np.abs(alpha) < 81.0]
    incident = direction(theta_deg, phi_deg, side="exterior")
    theta, phi = np.abs(alpha), np.where(alpha >= 0.0, phi_deg + 180.0, phi_deg)
    if across:
        y = np.sin(np.radians(np.linspace(-70.0, 70.0, 141)))
        x = np.full_like(y, np.sin(np.radians(theta_deg)))
        inside = np.hypot(x, y) < 0.99
        theta = np.degrees(np.arcsin(np.hypot(x, y)[inside]))
        phi = phi_deg + 180.0 + np.degrees(np.arctan2(y, x)[inside])
    values = of(incident, direction(theta, phi, side="interior"))
    values = values * (1.0 + 0.01 * np.random.default_rng(int(theta_deg)).standard_normal(len(values)))
    return Scan("exterior", "transmission", theta_deg, phi_deg, theta, phi, values[:, None])


def lines(thetas_deg=range(0, 71, 10), **options):
    return Measurement("film", tuple(line(float(theta), **options) for theta in thetas_deg))


def test_lines_become_a_model_of_all_directions():
    spread, step = spread_lines(lines())
    assert "assumed" in step.warnings[0]
    for scan in spread.scans:
        assert scan.conditions["made"]
        np.testing.assert_allclose(scan.values[:, 0], truth(scan.incident, scan.outgoing), rtol=0.05)
    made = fit(spread, hold_out=False)
    for theta in (5.0, 25.0, 45.0):
        incident = direction(theta, 33.0, side="exterior")
        total = float(truth(incident, CELLS).mean() * np.pi)
        assert float(made.bsdf.integrate(incident, "transmission")) == pytest.approx(total, rel=0.01)
        out = _core.square_directions(24)
        out = out[out[:, 2] > 0.2]
        found = made.bsdf.evaluate(np.tile(incident, (len(out), 1)), out)
        assert np.std(np.log(found / truth(incident, out))) < 0.08
    # The formula itself knows what lies beside the plane.
    (formula,) = fit_formula(lines(), "harvey-shack")
    incident = direction(65.0, 33.0, side="exterior")
    np.testing.assert_allclose(formula.evaluate(incident, CELLS), truth(incident, CELLS), rtol=0.02)


def test_a_second_line_across_tells_what_the_first_cannot():
    def oval(incident, outgoing):
        off = outgoing[..., :2] + incident[..., :2]
        return 0.03 + 3.0 * np.exp(-0.5 * ((off[..., 0] / 0.1) ** 2 + (off[..., 1] / 0.3) ** 2))

    thetas = (0.0, 30.0)
    one = lines(thetas, of=oval)
    both = Measurement("film", (*one.scans, *(line(theta, of=oval, across=True) for theta in thetas)))
    normal = direction(0.0, 0.0, side="exterior")
    for measurement, close in ((one, False), (both, True)):
        spread, _ = spread_lines(measurement)
        assert len(spread) == 2
        first = spread.scans[0]
        beside = (np.abs(first.outgoing[:, 0]) < 0.01) & (first.theta_deg < 69.0)
        found = first.values[beside, 0] / oval(normal, first.outgoing[beside])
        assert (np.abs(found - 1.0).max() < 0.1) == close


def test_lines_are_refused_where_nothing_is_assumed():
    with pytest.raises(ClerestoryError, match=r"along a line.*--lines"):
        fit(lines())
    with pytest.raises(ClerestoryError, match="no scan is a line"):
        spread_lines(series(diffuse_and_peak, thetas_deg=(0.0, 30.0), phis_deg=(0.0,)))
    short = replace(lines().scans[0], theta_deg=[1.0, 20.0], phi_deg=[0.0, 0.0], values=np.ones((2, 1)))
    with pytest.raises(ClerestoryError, match="5 are needed"):
        spread_lines(Measurement("film", (short,)))
    peak = lines().scans[1]
    near = (np.abs(peak.theta_deg - 10.0) < 1.0) & (peak.phi_deg == 180.0)
    close = replace(peak, theta_deg=peak.theta_deg[near], phi_deg=peak.phi_deg[near], values=peak.values[near])
    with pytest.raises(ClerestoryError, match="does not leave the peak"):
        spread_lines(Measurement("film", (close,)))


def test_on_the_command_line(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    write(lines((0.0, 30.0, 60.0)), "scans", "mountain")
    assert main(["measure", "fit", "scans", "-o", "film.bsdf.npz"]) == 1
    assert "--lines" in capsys.readouterr().err
    assert not tmp_path.joinpath("film.bsdf.npz").exists()
    assert main(["measure", "fit", "scans", "-o", "film.bsdf.npz", "--lines"]) == 0
    assert "assumed to depend" in capsys.readouterr().err
    assert read_bsdf("film.bsdf.npz").models["visible"]["exterior", "transmission"].kind == "interpolant"
