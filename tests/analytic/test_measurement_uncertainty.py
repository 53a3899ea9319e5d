"""Uncertainties of models of measurements against cases whose answer is known."""

from dataclasses import replace

import numpy as np
import pytest

import pg2
from clerestory import Bsdf, ClerestoryError, Model, read
from clerestory.basis import Basis
from clerestory.compare import compare
from clerestory.directions import direction
from clerestory.integrals import direct_hemispherical
from clerestory.measure import Scan
from clerestory.measure.delaunay import surface
from clerestory.measure.interpolant import fit
from clerestory.measure.interpolant.residual import Residual, integral_errors, standard_errors
from clerestory.measure.uncertainty import Budget, Settings, uncertainties
from clerestory.measure.uncertainty.between import LeftOut, per_gap
from clerestory.measure.uncertainty.cone import blurred, cone_of
from clerestory.measure.uncertainty.neighbours import Neighbours, spread_out
from clerestory.measure.uncertainty.patches import Patches
from clerestory.measure.uncertainty.reach import LEAST, beyond_points

KLEMS = Basis.named("klems-full")
DIFFUSE = Bsdf.from_models({("exterior", "transmission"): Model.lambertian(0.5)})


def even(value=0.5 / np.pi, *, top_deg=80.0, step_deg=5.0, **changes):
    """A scan of an even BSDF."""
    theta, phi = [0.0], [0.0]
    for ring in np.arange(step_deg, top_deg + 1e-9, step_deg):
        count = round(360.0 * np.sin(np.radians(ring)) / step_deg)
        theta += [ring] * count
        phi += list(np.arange(count) * 360.0 / count)
    values = np.full((len(theta), 1), value)
    return Scan("exterior", "transmission", 0.0, 0.0, theta, phi, values, **changes)


def test_an_integral_is_the_sum_of_weights_times_values():
    scan = even(top_deg=85.0)
    rng = np.random.default_rng(2)
    through = surface(replace(scan, values=rng.uniform(0.0, 1.0, (len(scan), 1))))
    found = through.integrate()
    assert through.weights() @ through.values[:, 0] == pytest.approx(float((found.total - found.extrapolated)[0]))
    # The outermost points' chords leave out a little of the cap to 85°.
    assert through.weights().sum() == pytest.approx(np.pi * np.sin(np.radians(85.0)) ** 2, rel=2e-3)


def test_the_variance_of_a_sum_of_independent_points():
    weights, sigma = np.array([1.0, 2.0, 3.0]), np.array([0.1, 0.2, 0.3])
    left = np.array([0.5, -0.5, 0.1])
    found = integral_errors(weights, np.column_stack([left, sigma**2, left**2]))
    assert found.off[0] == pytest.approx(-0.2)
    assert found.noise[0] == pytest.approx(0.01 + 0.16 + 0.81)
    assert found.scatter[0] == pytest.approx(0.25 + 1.0 + 0.09)


def test_noise_of_totals_and_patches_is_that_of_repetitions():
    sigma = 0.02
    scan = even(step_deg=10.0)
    scan = replace(scan, standard_errors=np.full_like(scan.values, sigma))
    patches = Patches.of("interior")
    rng = np.random.default_rng(5)
    totals, fluxes = [], []
    for _ in range(50):
        noisy = replace(scan, values=scan.values + sigma * rng.standard_normal(scan.values.shape))
        one = Residual.of([noisy], DIFFUSE, "visible", mirrored=False)
        totals.append(one.total.off[0])
        fluxes.append(one.over(patches, np.eye(2)).off)
    told = one.over(patches, np.eye(2)).noise
    assert np.std(totals) == pytest.approx(np.sqrt(one.total.noise[0]), rel=0.3)
    seen = told > 0.0
    assert seen.mean() > 0.9
    ratio = np.std(fluxes, axis=0)[seen] / np.sqrt(told[seen])
    assert ratio.mean() == pytest.approx(1.0, abs=0.1)
    assert ratio.std() < 0.2


def test_noise_is_told_by_the_scan_itself():
    scan = pg2.scan("off-specular", 30.0, 0.0, noise=1e-3, relative=0.02, seed=4)
    left = scan.values[:, 0] - pg2.bsdf("off-specular", pg2.travel(30.0, 0.0), scan.outgoing)
    found = standard_errors(scan, "visible", left)
    true = np.hypot(1e-3 / np.cos(np.radians(scan.theta_deg)), 0.02 * scan.values[:, 0])
    bright = scan.values[:, 0] > 0.1
    assert np.median(found[bright] / true[bright]) == pytest.approx(1.0, abs=0.25)


def test_a_model_that_lacks_light_is_found_out():
    one = Residual.of([even(0.6 / np.pi)], DIFFUSE, "visible", mirrored=False)
    lacks = 0.1 * np.sin(np.radians(80.0)) ** 2
    assert one.total.off[0] == pytest.approx(lacks, rel=5e-3)
    assert one.by_triangles == pytest.approx(0.6, rel=5e-3)
    patches = one.over(Patches.of("interior"), np.eye(2))
    inner = KLEMS.limits_deg[:, 1] < 75.0
    np.testing.assert_allclose(patches.off[inner], 0.1 / np.pi * KLEMS.projected_solid_angles[inner], rtol=1e-9)
    assert one.total.lobes(0.0)[0] > 0.98 * one.total.off[0] ** 2


def test_directions_between_measured_ones():
    chain = Neighbours(np.column_stack([np.sin(np.radians([0.0, 10.0, 30.0])), np.zeros(3)]), "isotropic")
    around = chain.around(np.array([0.0, np.sin(np.radians(15.0))]))
    assert list(around.scans) == [1, 2]
    np.testing.assert_allclose(around.shares, [0.75, 0.25])
    assert around.spread_deg2 == pytest.approx(5.0 * 15.0)
    # The neighbour at azimuth 0° is turned by 90°.
    np.testing.assert_allclose(around.images[0] @ [1.0, 0.0], [0.0, 1.0], atol=1e-12)
    assert chain.around(np.array([0.9, 0.0])).beyond
    corner = [[0.0, 0.0], [0.5, 0.0], [0.0, 0.5], [0.5, 0.5]]
    mesh = Neighbours(np.array(corner), "quadrilateral")
    around = mesh.around(np.array([-0.4, -0.3]))
    places = np.einsum("nij,nj->ni", around.images, np.array(corner)[around.scans])
    np.testing.assert_allclose(around.shares @ places, [-0.4, -0.3], atol=1e-12)
    assert not around.beyond
    assert mesh.around(np.array([0.5, 0.0])).spread_deg2 == pytest.approx(0.0, abs=1e-9)
    with pytest.raises(ClerestoryError, match="line"):
        Neighbours(np.array([[0.0, 0.0], [0.2, 0.0], [0.4, 0.0]]), "none")


def test_half_of_the_directions_are_spread_out():
    places = np.column_stack([np.sin(np.radians(np.arange(0.0, 81.0, 10.0))), np.zeros(9)])
    assert list(spread_out(places, "isotropic")) == [0, 2, 4, 6, 8]
    # What is the same under the symmetry, but for a slight turn of the sample, counts once.
    turned = np.concatenate([places, -places, 1.0001 * places])
    assert len(spread_out(turned, "rotational")) == 5
    assert len(spread_out(turned, "none")) == 9


def test_errors_of_interpolation_grow_with_the_square_of_the_gap():
    found = [LeftOut(1.01, 1.0, 100.0), LeftOut(0.99, 1.0, 100.0)]
    assert per_gap(found) == pytest.approx(1e-4)
    assert per_gap([LeftOut(0.5, 0.0, 100.0)]) is None


def test_a_cone_takes_nothing_from_an_even_distribution_but_at_the_horizon():
    patches = Patches.of("interior")
    incident = direction(0.0, 0.0, side="exterior")
    values = patches.values(DIFFUSE, incident)
    seen, lost = blurred(DIFFUSE, incident, patches, 1.5, values)
    inner = KLEMS.limits_deg[:, 1] < 80.0
    np.testing.assert_allclose(seen[inner], patches.fluxes(values)[inner], rtol=1e-9)
    assert 0.0 <= lost < 1e-3


def test_a_cone_carries_light_across_a_border():
    # A lobe of 1° at the border of the middle patch, seen through a second cone of the same kind.
    axis = np.array([np.sin(np.radians(5.5)), 0.0, np.cos(np.radians(5.5))])

    class Lobe:
        def __init__(self, width):
            self.lobe = pg2.Lobe(axis, width, 0.5)

        def evaluate(self, _, outgoing):
            return self.lobe(outgoing)

    patches, incident = Patches.of("interior", across=24), direction(0.0, 0.0, side="exterior")
    first, second = (
        patches.fluxes(Lobe(np.sqrt(np.radians(1.0) ** 2 + k * pg2.CONE**2)).evaluate(None, patches.directions))
        for k in range(2)
    )
    seen, _ = blurred(Lobe(np.radians(1.0)), incident, patches, 1.5, patches.directions[..., 0])
    # The lobe has the instrument's cone in it already: one and two of them differ by one.
    wide = patches.fluxes(Lobe(np.hypot(np.radians(1.0), pg2.CONE)).evaluate(None, patches.directions))
    np.testing.assert_allclose(seen - first, wide - first, atol=0.15 * np.abs(second - first).max() + 1e-6)


def test_light_beyond_the_points_is_uncertain():
    patches = Patches.of("interior")
    incident = direction(0.0, 0.0, side="exterior")
    values = patches.values(DIFFUSE, incident)
    beyond = patches.directions[..., 2] < np.cos(np.radians(80.0))
    by_patch, total = beyond_points(DIFFUSE, incident, patches, values, beyond, 80.0)
    # An even BSDF has no trend: a tenth of the light there, as the half width of a rectangle.
    assert total == pytest.approx(LEAST * 0.5 * np.cos(np.radians(80.0)) ** 2 / np.sqrt(3.0), rel=0.15)
    assert by_patch[KLEMS.limits_deg[:, 1] < 79.0].max() == 0.0


def test_causes_add_as_squares():
    budget = Budget(0.0, 0.0, True, False, 0.5, np.ones(2), {"noise": 0.03, "level": 0.04}, {"noise": np.array([3, 4])})
    assert budget.total_error == pytest.approx(0.05)
    np.testing.assert_allclose(budget.flux_errors, [3.0, 4.0])
    assert budget.interval == pytest.approx((0.402, 0.598))
    assert replace(budget, total=0.99).interval[1] == 1.0


def test_standard_errors_travel_to_the_comparison(tmp_path):
    plain = DIFFUSE.to_matrix(KLEMS)
    model = plain.models["visible"]["exterior", "transmission"]
    errors, totals = np.full((145, 145), 0.004), np.linspace(0.01, 0.03, 145)
    made = plain.with_models({"visible": {("exterior", "transmission"): model.with_standard_errors(errors, totals)}})
    made.write(tmp_path / "a.bsdf.npz")
    again = read(tmp_path / "a.bsdf.npz")
    held = again.models["visible"]["exterior", "transmission"]
    np.testing.assert_allclose(held.standard_errors, errors)
    np.testing.assert_allclose(held.total_standard_errors, totals)
    np.testing.assert_allclose(direct_hemispherical(again).standard_errors, totals)
    quantities = compare({"fit": again, "other": plain}).quantities
    shown = next(q for q in quantities if q.symbol == "T_d-h" and q.patch == 1)
    assert shown.standard_errors[0] == pytest.approx(totals[0], rel=1e-6)
    assert shown.standard_errors[1] is None


def test_what_makes_no_sense_is_refused():
    with pytest.raises(ClerestoryError, match="level"):
        Settings(level=-0.01)
    with pytest.raises(ClerestoryError, match="cone"):
        Settings(cone_deg=120.0)
    with pytest.raises(ClerestoryError, match="source_cone_deg 'wide'"):
        cone_of([even(conditions={"source_cone_deg": "wide"})])
    assert cone_of([even(conditions={"source_cone_deg": "0.3", "detector_cone_deg": "0.4"})]) == pytest.approx(0.5)
    wrong = even(standard_errors=np.full((len(even()), 1), -0.01))
    with pytest.raises(ClerestoryError, match="negative"):
        Residual.of([wrong], DIFFUSE, "visible", mirrored=False)
    few = replace(even(), theta_deg=[0.0, 10.0], phi_deg=[0.0, 0.0], values=[[1.0], [1.0]])
    with pytest.raises(ClerestoryError, match="three are needed"):
        Residual.of([few], DIFFUSE, "visible", mirrored=False)
    with pytest.raises(ClerestoryError, match="matrix"):
        Model.lambertian(0.5).with_standard_errors([[0.1]])
    square = Model.matrix(np.ones((145, 145)), KLEMS)
    with pytest.raises(ClerestoryError, match="shape"):
        square.with_standard_errors([[0.1]])
    with pytest.raises(ClerestoryError, match="standard errors"):
        square.with_standard_errors(np.full((145, 145), -1.0))


def test_budgets_of_a_fit_name_every_cause():
    scans = [pg2.scan("off-specular", theta, 0.0, spacing_deg=6.0, seed=1) for theta in (0.0, 10.0, 20.0, 30.0)]
    made = fit(scans, symmetry="isotropic", hold_out=False)
    ((key, one),) = uncertainties(scans, made, Settings(1.5, 0.01)).items()
    assert key == ("visible", "exterior", "transmission")
    on, between, outside = (one.at(direction(theta, 40.0, side="exterior")) for theta in (20.0, 15.0, 50.0))
    assert set(on.of_total) == {"noise", "lobes", "cone", "coverage", "level"}
    assert on.measured
    assert set(between.of_total) == set(on.of_total) | {"interpolation"}
    assert not between.measured
    assert between.of_total["level"] == pytest.approx(0.01 * between.total)
    assert outside.beyond
    assert outside.of_total["coverage"] > on.of_total["coverage"]
    assert (between.flux_errors > 0.0).all()


def test_what_symmetry_repeats_says_nothing_of_the_gaps():
    """A model of half of the directions foretells their images exactly."""
    at = [(0.0, 0.0)] + [(theta, phi) for theta in (25.0, 50.0) for phi in (0.0, 90.0, 180.0, 270.0)]
    scans = [pg2.scan("twill", theta, phi, spacing_deg=10.0, seed=1) for theta, phi in at]
    made = fit(scans, symmetry="rotational", hold_out=False)
    (one,) = uncertainties(scans, made).values()
    for theta in (12.0, 37.0):
        between = one.at(direction(theta, 0.0, side="exterior"))
        assert 0.0 < between.of_total["interpolation"] < 0.1 * between.total
