"""Tensor trees from Python."""

import numpy as np
import pytest

from clerestory import Bsdf, ClerestoryError, Model, UnsupportedError


def lobe(size, axes):
    """Forward scattering on a grid; the incident coordinate of three axes is the radius."""
    at = (np.arange(size) + 0.5) / size
    grid = np.meshgrid(*[at] * axes, indexing="ij")
    if axes == 4:
        distance = (grid[0] - grid[2]) ** 2 + (grid[1] - grid[3]) ** 2
    else:
        distance = (1 - grid[0] - grid[1]) ** 2 + (0.5 - grid[2]) ** 2
    values = 0.02 + 5 * np.exp(-30 * distance)
    if axes == 3:
        values[size // 2 :] = 0
    return values


@pytest.mark.parametrize("axes", [3, 4])
def test_an_array_becomes_a_tree_of_its_values(axes):
    values = lobe(8, axes)
    model = Model.tree_from_grid(values)
    assert (model.kind, model.tree_rank, model.tree_depth) == ("tensor tree", axes, 3)
    assert model.tree_leaves <= values.size
    bsdf = Bsdf.from_models({("exterior", "transmission"): model})
    # Straight through: near the middle of the lobe.
    normal = bsdf.evaluate([0.0, 0.0, -1.0], [0.0, 0.0, 1.0])
    assert normal == pytest.approx(values[(3, 4, 4) if axes == 3 else (4, 4, 4, 4)], rel=1e-6)


def test_the_unused_half_of_an_isotropic_array_may_be_left_out():
    values = lobe(8, 3)
    whole, half = Model.tree_from_grid(values), Model.tree_from_grid(values[:4])
    assert whole.tree_leaves == half.tree_leaves
    directions = np.random.default_rng(1).normal(size=(2, 50, 3))
    evaluate = [
        Bsdf.from_models({("exterior", "transmission"): m}).evaluate(
            directions[0] * [1, 1, 0] - [0, 0, 1], directions[1] * [1, 1, 0] + [0, 0, 1]
        )
        for m in (whole, half)
    ]
    np.testing.assert_array_equal(evaluate[0], evaluate[1])


@pytest.mark.parametrize("shape", [(), (8,), (4, 4), (3, 3, 3), (4, 4, 8), (2, 2, 2, 4), (2, 2, 2, 2, 2), (0, 0, 0)])
def test_arrays_of_other_shapes_are_refused(shape):
    with pytest.raises(ClerestoryError, match=r"tensor tree"):
        Model.tree_from_grid(np.ones(shape))


@pytest.mark.parametrize("value", [-1.0, np.nan, np.inf])
def test_values_that_are_no_bsdf_are_refused(value):
    with pytest.raises(ClerestoryError, match="tensor tree"):
        Model.tree_from_grid(np.full((2, 2, 2), value))


@pytest.mark.parametrize("axes", [3, 4])
def test_reduction_reports_what_it_did(axes):
    model = Model.tree_from_grid(lobe(8, axes))
    reduced, report = model.reduced(percent=80)
    assert report.leaves_before == model.tree_leaves
    assert report.leaves_after == reduced.tree_leaves < model.tree_leaves
    assert report.rms_error > 0
    for bound in (0.0, 0.01, 0.2):
        reduced, report = model.reduced(max_error=bound)
        assert report.rms_error <= bound * (1 + 1e-6)
    assert reduced.tree_leaves < model.tree_leaves


def test_worst_direct_hemispherical_difference_is_found_by_integration():
    model = Model.tree_from_grid(lobe(8, 4))
    reduced, report = model.reduced(max_error=0.3)
    at = (np.arange(8) + 0.5) / 8 * 2 - 1
    a, b = np.meshgrid(at, at)
    # Shirley and Chiu's map, wedge by wedge.
    with np.errstate(divide="ignore", invalid="ignore"):
        wide = np.abs(a) >= np.abs(b)
        r = np.where(wide, a, b)
        phi = np.where(wide, np.pi / 4 * b / a, np.pi / 2 - np.pi / 4 * a / b)
    x, y = r * np.cos(phi), r * np.sin(phi)
    incident = np.stack([-x, -y, -np.sqrt(1 - x**2 - y**2)], axis=-1).reshape(-1, 3)
    totals = [
        Bsdf.from_models({("exterior", "transmission"): m}).integrate(incident, "transmission")
        for m in (model, reduced)
    ]
    assert report.worst_direct_hemispherical == pytest.approx(np.max(np.abs(totals[0] - totals[1])), rel=1e-6)


def test_reduction_asks_for_one_rule():
    model = Model.tree_from_grid(np.ones((2, 2, 2, 2)))
    for arguments in ({}, {"percent": 90, "max_error": 0.1}):
        with pytest.raises(TypeError, match="either"):
            model.reduced(**arguments)
    with pytest.raises(ClerestoryError, match="percentage"):
        model.reduced(percent=120)
    with pytest.raises(ClerestoryError, match="bound"):
        model.reduced(max_error=-1)


def test_other_models_are_not_trees():
    with pytest.raises(UnsupportedError, match="Lambertian"):
        Model.lambertian(0.5).reduced(percent=90)
    with pytest.raises(UnsupportedError, match="Lambertian"):
        _ = Model.lambertian(0.5).tree_rank


def test_mixtures_of_trees_stay_trees_at_full_resolution():
    fine, coarse = Model.tree_from_grid(lobe(8, 4)), Model.tree_from_grid(lobe(2, 4))
    mixture = Model.mixture([(0.5, fine), (0.4, coarse), (0.1, Model.lambertian(0.6))])
    assert (mixture.kind, mixture.tree_depth) == ("tensor tree", 3)
    rng = np.random.default_rng(2)
    incident = rng.normal(size=(200, 3)) * [1, 1, 0] - [0, 0, 1]
    outgoing = rng.normal(size=(200, 3)) * [1, 1, 0] + [0, 0, 1]

    def value(model):
        return Bsdf.from_models({("exterior", "transmission"): model}).evaluate(incident, outgoing)

    exact = 0.5 * value(fine) + 0.4 * value(coarse) + 0.1 * 0.6 / np.pi
    np.testing.assert_allclose(value(mixture), exact, rtol=1e-6)
    # Different ranks: a sum keeps each part as it is.
    assert Model.mixture([(0.5, fine), (0.5, Model.tree_from_grid(lobe(4, 3)))]).kind == "sum"
