"""Turned, mirrored, flipped and reversed samples against the original at turned directions."""

import numpy as np
import pytest

from clerestory import Bsdf
from clerestory.directions import outgoing_side
from registry import CASES, outgoing

by_case = pytest.mark.parametrize("case", CASES.values(), ids=lambda c: c.name)
by_reversible = pytest.mark.parametrize("case", [c for c in CASES.values() if c.reversible], ids=lambda c: c.name)

FLIP = np.diag([-1.0, 1.0, -1.0])  # half a turn about y
MIRROR = np.diag([-1.0, 1.0, 1.0])


def about_normal(angle_deg):
    sin, cos = np.sin(np.radians(angle_deg)), np.cos(np.radians(angle_deg))
    return np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])


def random_pairs(case, side, scatter, n=400, seed=3):
    """Directions all over both hemispheres; some are so near to straight on that a beam's cells are met."""
    rng = np.random.default_rng(seed)
    r, phi = np.sqrt(rng.random((2, n))), 2 * np.pi * rng.random((2, n))
    incident, to = np.stack([r * np.cos(phi), r * np.sin(phi)], axis=-1)
    # Not exactly straight on, which is a border of the cells of isotropic trees.
    to[: n // 4] = 0.99 * incident[: n // 4] + rng.normal(0, 0.003, (n // 4, 2))
    return outgoing(-incident, side, "reflection"), outgoing(to, side, scatter)


def assert_same(case, moved, matrix):
    """`moved` at directions turned by `matrix` is the original; a pair in a thousand may fall over a border."""
    for band, side, scatter in case.components:
        i, o = random_pairs(case, side, scatter)
        for of in ("evaluate", "pdf"):
            only = {"scatter": scatter} if of == "pdf" else {}
            before = getattr(case.bsdf, of)(i, o, band, **only)
            after = getattr(moved, of)(i @ matrix.T, o @ matrix.T, band, **only)
            same = np.isclose(after, before, rtol=1e-9, atol=1e-12)
            assert np.mean(~same) <= 0.005
        for k in range(0, len(i), 37):
            found = sorted((p.value, *p.outgoing) for p in moved.peaks(matrix @ i[k], scatter, band))
            known = sorted((p.value, *(matrix @ p.outgoing)) for p in case.bsdf.peaks(i[k], scatter, band))
            assert np.allclose(found, known, atol=1e-9)
        totals = case.bsdf.integrate(i[::8], scatter, band=band)
        turned = moved.integrate(i[::8] @ matrix.T, scatter, band=band)
        assert np.mean(~np.isclose(turned, totals, rtol=1e-9)) <= 0.02


@by_case
@pytest.mark.parametrize("angle_deg", [90.0, -36.0, 222.2])
def test_rotation_turns_directions(case, angle_deg):
    assert_same(case, case.bsdf.rotated(angle_deg), about_normal(angle_deg))


@by_case
def test_mirror_exchanges_left_and_right(case):
    assert_same(case, case.bsdf.mirrored(), MIRROR)


@by_case
def test_flip_is_half_a_turn_about_the_vertical(case):
    assert_same(case, case.bsdf.flipped(), FLIP)


@by_case
def test_mirror_flip_and_turn_combine(case):
    moved = case.bsdf.rotated(25.0).mirrored().flipped().rotated(-70.0)
    assert_same(case, moved, about_normal(-70.0) @ FLIP @ MIRROR @ about_normal(25.0))


@by_case
@pytest.mark.parametrize(
    "back",
    [
        lambda b: b.rotated(90).rotated(90).rotated(90).rotated(90),
        lambda b: b.rotated(33.3).rotated(-33.3),
        lambda b: b.mirrored().mirrored(),
        lambda b: b.flipped().flipped(),
        lambda b: b.rotated(180).flipped().rotated(180).flipped(),
    ],
    ids=["four quarters", "there and back", "two mirrors", "two flips", "two flips and halves"],
)
def test_what_is_undone_is_the_identity(case, back):
    assert_same(case, back(case.bsdf), np.eye(3))


@by_reversible
def test_reversed_paths_have_the_same_value(case):
    """f'(o, i) = f(i, o) for the reciprocal model, and a missing transmission side is answered so."""
    for band, side, scatter in case.components:
        model = case.bsdf.models[band][side, scatter]
        there = Bsdf.from_models({(side, scatter): model})
        other = outgoing_side(side, scatter)
        back = Bsdf.from_models({(other, scatter): model.reciprocal()})
        i, o = random_pairs(case, side, scatter)
        assert np.mean(~np.isclose(back.evaluate(o, i), there.evaluate(i, o), rtol=1e-9)) <= 0.005
        if scatter == "transmission":
            _, by_reciprocity = there.model(other, scatter)
            assert by_reciprocity
            assert np.array_equal(there.evaluate(o, i), back.evaluate(o, i))
        for k in range(0, len(i), 37):
            straight = sum(p.value for p in there.peaks(i[k], scatter))
            mirrored = -i[k] if scatter == "transmission" else i[k] * [-1, -1, 1]
            assert sum(p.value for p in back.peaks(mirrored, scatter)) == pytest.approx(straight, abs=case.beams)


@by_reversible
def test_reversing_twice_gives_the_original(case):
    for band, side, scatter in case.components:
        model = case.bsdf.models[band][side, scatter]
        twice = Bsdf.from_models({(side, scatter): model.reciprocal().reciprocal()})
        i, o = random_pairs(case, side, scatter)
        before = case.bsdf.evaluate(i, o, band)
        assert np.mean(~np.isclose(twice.evaluate(i, o), before, rtol=1e-9)) <= 0.005
