"""Surfaces through points reproduce what is linear, integrate what is known, and say what was not measured."""

import numpy as np
import pytest

from clerestory import Basis, ClerestoryError
from clerestory.directions import direction
from clerestory.measure import Scan
from clerestory.measure.delaunay import regrid, surface


def irregular(count, up_to_deg=84.0, seed=1):
    """Directions spread evenly over the projected hemisphere, at random."""
    u = np.random.default_rng(seed).random((count, 2))
    return np.degrees(np.arcsin(np.sqrt(u[:, 0]) * np.sin(np.radians(up_to_deg)))), 360.0 * u[:, 1]


def scan(theta, phi, values, **changes):
    values = np.asarray(values, dtype=float)
    given = {"values": values if values.ndim == 2 else values[:, None], "theta_deg": theta, "phi_deg": phi}
    return Scan("exterior", "transmission", 30.0, 90.0, **(given | changes))


def plane(directions):
    return directions[..., :2] / (1.0 + np.abs(directions[..., 2:]))


@pytest.mark.parametrize("interpolated", ["bsdf", "log", "dsf"])
def test_what_is_linear_in_the_plane_comes_back(interpolated):
    theta, phi = irregular(500)

    def linear(d):
        return 2.0 + plane(d) @ [0.7, -0.4]

    def given(d):
        value = np.exp(linear(d)) if interpolated == "log" else linear(d)
        return value / np.abs(d[..., 2]) if interpolated == "dsf" else value

    made = surface(scan(theta, phi, given(direction(theta, phi, side="interior"))), interpolated=interpolated)
    asked = direction(*irregular(2000, 70.0, seed=2), side="interior")
    between = made.measured(asked)
    assert between.mean() > 0.98
    asked = asked[between]
    np.testing.assert_allclose(made.evaluate(asked)[:, 0], given(asked), rtol=1e-9)


@pytest.mark.parametrize("interpolated", ["bsdf", "log", "dsf"])
def test_a_lambertian_sample_has_its_integral_on_irregular_points(interpolated):
    theta, phi = irregular(800)
    integral = surface(scan(theta, phi, np.full(800, 0.6 / np.pi)), interpolated=interpolated).integrate()
    assert integral.total[0] == pytest.approx(0.6, rel=0.005)
    # sin² 84° of the hemisphere was reached at best.
    assert 0.6 * np.cos(np.radians(84.0)) ** 2 < integral.extrapolated[0] < 0.03


def test_a_lobe_integrates_as_its_formula_and_goes_onto_a_basis():
    n = 20.0  # f = cosⁿ about the normal: the integral is 2π/(n+2)
    theta, phi = irregular(9000)
    made = surface(scan(theta, phi, np.cos(np.radians(theta)) ** n))
    total = made.integrate().total[0]
    assert total == pytest.approx(2.0 * np.pi / (n + 2.0), rel=0.005)
    basis = Basis.named("iea21")
    values, share = made.onto(basis)
    assert float(basis.projected_solid_angles @ values[:, 0]) == pytest.approx(total, rel=0.003)
    assert share[0] == 1.0
    assert share[-1] == 0.0  # beyond 87.5°


def test_the_triangles_are_those_of_the_sphere():
    theta, phi = irregular(120)
    points = direction(theta, phi, side="interior")
    made = surface(scan(theta, phi, np.ones(120)))
    corners = made.plane.simplices[(made.plane.simplices < 120).all(axis=1)]
    order = plane(points)
    # Which of the given points each place is.
    which = np.array([np.argmin(((order - place) ** 2).sum(1)) for place in made.plane.points[:120]])
    for triangle in corners:
        a, b, c = points[which[triangle]]
        centre = np.cross(b - a, c - a)
        centre /= np.linalg.norm(centre)
        centre = centre if centre @ a > 0 else -centre
        inside = points @ centre > centre @ a + 1e-9
        assert not inside.any()


def test_regular_points_keep_the_integral_and_what_was_not_measured_is_left_out():
    theta, phi = irregular(3000)
    given = scan(theta, phi, np.cos(np.radians(theta)) + 0.2)
    steps = np.arange(0.0, 90.0, 4.0), np.arange(0.0, 360.0, 6.0)
    made = regrid(given, steps[0][:, None], steps[1][None, :])
    assert made.theta_deg.max() <= 84.0
    assert surface(made).integrate().total[0] == pytest.approx(surface(given).integrate().total[0], rel=0.005)
    assert len(regrid(given, 88.0, steps[1], extrapolate=True)) == 60
    assert len(regrid(given, 88.0, steps[1])) == 0


def test_a_missing_sector_is_not_measured():
    theta, phi = irregular(3000)
    kept = (phi < 90.0) | (phi > 180.0)
    made = surface(scan(theta[kept], phi[kept], np.ones(int(kept.sum()))))
    assert not made.measured(direction(60.0, 135.0, side="interior"))
    assert made.measured(direction(60.0, 300.0, side="interior"))
    assert np.isfinite(made.evaluate(direction(60.0, 135.0, side="interior"))).all()


def test_points_at_one_place_are_their_mean_and_channels_stay_apart():
    theta = np.concatenate([np.zeros(4), np.full(36, 40.0), np.full(36, 80.0)])
    phi = np.concatenate([[0, 90, 180, 270], np.arange(0, 360, 10), np.arange(0, 360, 10)]).astype(float)
    values = np.ones((76, 2))
    values[:4, 0] = [0.0, 1.0, 2.0, 5.0]
    values[:, 1] = 7.0
    made = surface(scan(theta, phi, values, channels=("X", "Y")))
    np.testing.assert_allclose(made.evaluate([0.0, 0.0, 1.0]), [2.0, 7.0])


def test_what_makes_no_surface_is_refused():
    line = np.linspace(0.0, 80.0, 40)
    with pytest.raises(ClerestoryError, match="one line"):
        surface(scan(line, np.full(40, 30.0), np.ones(40)))
    with pytest.raises(ClerestoryError, match="2 points"):
        surface(scan([1.0, 2.0], [0.0, 90.0], [1.0, 1.0]))
    with pytest.raises(ClerestoryError, match="logarithm"):
        surface(scan(*irregular(50), np.zeros(50)), interpolated="log")
    with pytest.raises(ClerestoryError, match="beam"):
        surface(scan(*irregular(50), np.ones(50), quantity="signal"))
