"""Integrated quantities against closed forms."""

import numpy as np
import pytest

from clerestory import Basis, Bsdf, Model, direction
from clerestory.integrals import (
    continued,
    cut_off,
    direct_direct,
    direct_hemispherical,
    hemispherical,
    sky_radiance,
)

KLEMS = Basis.named("klems-full")


def one(model, side="exterior", scatter="transmission"):
    return Bsdf.from_models({(side, scatter): model})


@pytest.mark.parametrize("name", ["klems-full", "klems-quarter", "tregenza", "reinhart:2"])
@pytest.mark.parametrize("sky", ["uniform", "overcast"])
def test_a_diffuser_has_one_value_everywhere(name, sky):
    bsdf = one(Model.lambertian(0.4))
    basis = Basis.named(name)
    figures = direct_hemispherical(bsdf, basis=basis)
    assert len(figures.values) == len(basis)
    np.testing.assert_allclose(figures.values, 0.4, rtol=1e-12)
    assert hemispherical(bsdf, basis=basis, sky=sky).value == pytest.approx(0.4, rel=1e-12)


def test_a_matrix_is_summed_on_its_own_patches():
    values = np.random.default_rng(1).random((145, 145)) * 0.2
    bsdf = one(Model.matrix(values, KLEMS))
    areas = KLEMS.projected_solid_angles
    figures = direct_hemispherical(bsdf)
    np.testing.assert_allclose(figures.values, areas @ values, rtol=1e-12)
    assert "the data's own" in figures.words
    assert hemispherical(bsdf).value == pytest.approx(areas @ values @ areas / np.pi, rel=1e-12)
    assert figures.standard_errors is None


def test_standard_errors_add_in_quadrature():
    errors = np.full((145, 145), 0.01)
    bsdf = one(Model.matrix(np.full((145, 145), 0.1), KLEMS, standard_errors=errors))
    areas = KLEMS.projected_solid_angles
    expected = 0.01 * np.sqrt(np.sum(areas**2))
    np.testing.assert_allclose(direct_hemispherical(bsdf).standard_errors, expected, rtol=1e-9)
    assert hemispherical(bsdf).standard_error == pytest.approx(expected * np.sqrt(np.sum(areas**2)) / np.pi, rel=1e-9)


def test_a_beam_of_constant_value():
    bsdf = one(Model.specular(0.8))
    assert hemispherical(bsdf).value == pytest.approx(0.8, rel=1e-12)
    incident = direction(50, 90)
    assert direct_direct(bsdf, incident).value == pytest.approx(0.8)
    assert direct_direct(bsdf, incident, cone_deg=0.5).value == pytest.approx(0.8)


def test_a_clear_pane_like_curve():
    """T = cos²θ = 1 − sin²θ: the mean over projected solid angle is 1/2, and each patch has 1 − mean sin²θ."""
    bsdf = one(Model.specular(np.array([1.0, 0.0])))
    assert hemispherical(bsdf).value == pytest.approx(0.5, rel=1e-12)
    limits = np.radians(KLEMS.limits_deg[:, :2])
    mean = 1.0 - 0.5 * np.sum(np.sin(limits) ** 2, axis=1)
    np.testing.assert_allclose(direct_hemispherical(bsdf).values, mean, rtol=1e-12)


def test_overcast_sky_on_a_vertical_facade():
    """E_v/E_h of the CIE traditional overcast sky is 3/14 + 4/(7π) = 0.39618."""
    rng = np.random.default_rng(0)
    root = np.sqrt(rng.random(200_000))
    phi = rng.random(200_000) * 2 * np.pi
    toward = np.column_stack([root * np.cos(phi), root * np.sin(phi), -np.sqrt(1 - root**2)])
    ratio = np.pi * sky_radiance(toward, "overcast", 0.0).mean() / (7 * np.pi / 9)
    assert ratio == pytest.approx(3 / 14 + 4 / (7 * np.pi), rel=5e-3)
    assert pytest.approx(0.39618, abs=5e-6) == 3 / 14 + 4 / (7 * np.pi)


@pytest.mark.parametrize("name", ["klems-full", "klems-half", "reinhart:1"])
@pytest.mark.parametrize("rho", [0.0, 0.2])
def test_overcast_weights_split_patches_at_the_horizon(name, rho):
    """What passes light from above only, and all of it, shows the sky's share of the light on the façade."""
    halves = Basis.from_rings("halves", [(0.0, 90.0, 45.0, 2)])  # centred on azimuths 0 and 180
    passes_one = one(Model.matrix(np.array([[1.0, 0.0], [1.0, 0.0]]) / np.pi, halves))
    from_above = passes_one.rotated(-90.0)
    assert from_above.evaluate(direction(40, 90), direction(10, 0, side="interior")) > 0.0
    assert from_above.evaluate(direction(40, 270), direction(10, 0, side="interior")) == 0.0
    figure = hemispherical(from_above, basis=Basis.named(name), sky="overcast", ground_reflectance=rho)
    sky = 3 / 14 + 4 / (7 * np.pi)
    assert figure.value == pytest.approx(sky / (sky + rho / 2), abs=1e-3)
    assert "vertical façade" in figure.words


def test_overcast_sky_by_quadrature_of_a_smooth_model():
    """T = cos²θ under the overcast sky: closed form over the upper half, constant below."""
    bsdf = one(Model.specular(np.array([1.0, 0.0])))
    # ∫ cosθ · cos²θ over a quarter sphere is π/4; ∫ cos³θ sinγ is 4/15 with γ the elevation (y = sinγ).
    above = (np.pi / 4 + 2 * 4 / 15) / 3
    ground = 0.2 * 7 / 9
    expected = (above + ground * np.pi / 4) / ((np.pi / 2 + 2 * 2 / 3) / 3 + ground * np.pi / 2)
    assert hemispherical(bsdf, sky="overcast", samples=64).value == pytest.approx(expected, rel=2e-3)


def test_direct_direct_of_a_matrix_is_the_diagonal():
    values = np.random.default_rng(2).random((145, 145)) * 0.3
    areas = KLEMS.projected_solid_angles
    for scatter in ("transmission", "reflection"):
        bsdf = one(Model.matrix(values, KLEMS), scatter=scatter)
        for patch, (theta, phi) in {0: (0, 0), 40: (30, 90), 87: (50, 90), 129: (70, 90)}.items():
            figure = direct_direct(bsdf, direction(theta, phi), scatter)
            assert figure.value == pytest.approx(areas[patch] * values[patch, patch], rel=1e-12)
            assert f" {patch + 1}" in figure.words


def test_direct_direct_of_a_diffuser():
    bsdf = one(Model.lambertian(0.3))
    figure = direct_direct(bsdf, direction(0, 0))
    assert figure.value == pytest.approx(0.3 * np.sin(np.radians(5)) ** 2, rel=1e-3)
    assert "Klems Full 1" in figure.words
    figure = direct_direct(bsdf, direction(0, 0), cone_deg=10)
    assert figure.value == pytest.approx(0.3 * np.sin(np.radians(10)) ** 2, rel=1e-3)


def test_continued_directions():
    d = direction(40, 90)
    np.testing.assert_allclose(continued(d, "transmission"), direction(40, 270, side="interior"), atol=1e-15)
    np.testing.assert_allclose(continued(d, "reflection"), direction(40, 270), atol=1e-15)


def test_cut_off_of_a_beam_that_ends():
    """A beam of 1 − sin²θ/sin²45° ends at 45°; it falls to 1 % of its value at 0° at 44.7°."""
    bsdf = one(Model.specular(np.array([0.9, 0.0, 0.0])))
    found = cut_off(bsdf)
    assert found.angle_deg == 45.0
    assert found.threshold == pytest.approx(0.009)
    assert "1 % of that at 0°" in found.words
    assert "light from above" in found.words
    fine = cut_off(bsdf, 30.0, step_deg=0.1)
    assert fine.angle_deg == pytest.approx(np.degrees(np.arcsin(np.sqrt(0.99 * 0.5))), abs=0.1)
    assert cut_off(bsdf, threshold=0.4501).angle_deg == 30.0
    assert cut_off(one(Model.lambertian(0.5)), cone_deg=1.0).angle_deg is None


def test_cut_off_of_a_matrix_is_a_ring_limit():
    values = np.diag(np.where(KLEMS.limits_deg[:, 0] < 44.9, 0.5, 0.0) / KLEMS.projected_solid_angles)
    found = cut_off(one(Model.matrix(values, KLEMS)))
    assert found.angle_deg == 45.0
    assert "data resolve" in found.words
