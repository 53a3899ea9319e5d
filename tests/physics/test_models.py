"""What holds for every scattering model, over the registry."""

import re
from itertools import pairwise

import numpy as np
import pytest

from clerestory import Basis, Bsdf
from clerestory.bsdf import Region
from partition import MIDDLE, low_discrepancy
from registry import CASES, incident_directions, isotropic_beam, outgoing
from samples import ROOT

#: Equally spaced numbers to choose by, and others to go with them.
STRATA = np.column_stack([(np.arange(4096) + 0.5) / 4096, low_discrepancy(4096)[:, 0]])
CORNERS = np.array([[0.2, 0.3], [0.7, 0.1], [0.9, 0.8]])

by_case = pytest.mark.parametrize("case", CASES.values(), ids=lambda c: c.name)


def quadrature(case, incident, side, scatter, values):
    """∫ values dω cosθ over the outgoing hemisphere, one point a cell, and the sums over the cells' points."""
    cells = case.partition(incident)
    points = cells.points(MIDDLE)[:, 0]
    return np.sum(values(incident, outgoing(points, side, scatter)) * cells.areas)


def peaks(bsdf, incident, scatter, band):
    return sum(p.value for p in bsdf.peaks(incident, scatter, band))


def test_every_kind_of_model_is_listed():
    """The kinds are those that the compiled core names."""
    source = (ROOT / "crates/clerestory/src/bsdf/model.rs").read_text()
    body = re.search(r"fn kind\(.*?\n    }", source, re.DOTALL).group()
    kinds = set(re.findall(r'=> "(.*?)"', body))
    assert len(kinds) >= 8
    listed = {m.kind for case in CASES.values() for models in case.bsdf.models.values() for m in models.values()}
    # A measured beam never stands alone: it is a part of this sum.
    assert "measured beam beside a table" in CASES
    assert listed | {"beam"} == kinds


@by_case
def test_values_are_never_negative(case):
    for band, side, scatter in case.components:
        for incident in incident_directions(side):
            to = outgoing(case.partition(incident).points(CORNERS).reshape(-1, 2), side, scatter)
            assert case.bsdf.evaluate(incident, to, band).min() >= 0
            assert case.bsdf.pdf(incident, to, band, scatter=scatter).min() >= 0
            assert all(p.value >= 0 for p in case.bsdf.peaks(incident, scatter, band))


@pytest.mark.parametrize("case", [c for c in CASES.values() if c.conserving], ids=lambda c: c.name)
def test_energy_is_not_made(case):
    for side in case.sides:
        i = Basis.named("klems-full").incident_centres(side)
        for band in case.bsdf.bands:
            total = sum(case.bsdf.integrate(i, scatter, band=band) for scatter in case.scatters(side))
            assert total.max() <= 1 + 1e-12


def test_separated_peaks_keep_the_energy_of_the_side_that_was_not_measured():
    """An isotropic tree's reverse has no table of its own: its total stays what it was without the beam."""
    separated = CASES["separated reverse of an isotropic tree"].bsdf
    ((side, scatter),) = separated.models["visible"]
    whole = Bsdf.from_models({(side, scatter): isotropic_beam().reciprocal()})
    i = Basis.named("klems-full").incident_centres(side)
    assert separated.integrate(i, scatter, part="direct").max() > 0.1
    np.testing.assert_allclose(separated.integrate(i, scatter), whole.integrate(i, scatter), rtol=1e-9)


@by_case
def test_values_integrate_to_the_scattered_total(case):
    for band, side, scatter in case.components:
        for i in incident_directions(side):
            total = case.bsdf.integrate(i, scatter, band=band, part="scattered")
            found = quadrature(case, i, side, scatter, lambda i, o, band=band: case.bsdf.evaluate(i, o, band))
            assert found == pytest.approx(total, rel=case.tolerance, abs=1e-12)


@by_case
def test_total_is_scattered_and_direct(case):
    for band, side, scatter in case.components:
        for i in incident_directions(side):
            every, scattered, direct = (
                case.bsdf.integrate(i, scatter, band=band, part=part) for part in ("all", "scattered", "direct")
            )
            assert every == pytest.approx(scattered + direct, abs=1e-12)
            assert direct == pytest.approx(peaks(case.bsdf, i, scatter, band), abs=1e-12)


@by_case
def test_density_integrates_to_one_less_the_peaks(case):
    """Over transmission and reflection together, and over each by itself."""
    for side in case.sides:
        scatters = case.scatters(side)
        for i in incident_directions(side):
            for band in case.bsdf.bands:
                totals = {c: float(case.bsdf.integrate(i, c, band=band)) for c in scatters}
                beams = {c: peaks(case.bsdf, i, c, band) for c in scatters}
                for asked in [scatters, *([c] for c in scatters)] if len(scatters) > 1 else [scatters]:
                    total = sum(totals[c] for c in asked)
                    only = {"scatter": asked[0]} if len(asked) == 1 else {}
                    chance = sum(beams[c] for c in asked) / total if total else 1.0
                    density = sum(
                        quadrature(
                            case,
                            i,
                            side,
                            c,
                            lambda i, o, band=band, only=only: (
                                case.bsdf.pdf(i, o, band, **only) / np.maximum(np.abs(o[:, 2]), 1e-300)
                            ),
                        )
                        for c in asked
                    )
                    assert density == pytest.approx(1 - chance, abs=case.tolerance)


@by_case
def test_peaks_are_sampled_by_their_share_of_the_total(case):
    """Half of equally spaced numbers, if half of the light is in the peaks."""
    for band, side, scatter in case.components:
        for i in incident_directions(side):
            total = float(case.bsdf.integrate(i, scatter, band=band))
            samples = case.bsdf.sample(i, STRATA, band, scatter=scatter)
            if total == 0:
                assert not samples.weights.any()
                continue
            direct = peaks(case.bsdf, i, scatter, band)
            assert np.mean(samples.weights * samples.peak) == pytest.approx(direct, abs=2.5 * total / len(STRATA))
            assert samples.peak.mean() == pytest.approx(direct / total, abs=2.5 / len(STRATA))
            for to in samples.outgoing[samples.peak]:
                known = [p.outgoing for p in case.bsdf.peaks(i, scatter, band)]
                assert min(np.linalg.norm(to - k) for k in known) < 1e-9
                break


@by_case
def test_regions_of_a_partition_sum_to_the_total(case):
    """A cone and the rings about it, and all patches of a basis."""
    for band, side, scatter in case.components:
        for i in incident_directions(side)[:4]:
            for part in ("all", "scattered", "direct"):
                total = float(case.bsdf.integrate(i, scatter, band=band, part=part))

                def integrate(region, i=i, scatter=scatter, band=band, part=part):
                    return float(case.bsdf.integrate(i, scatter, region, band, part=part))

                axis = outgoing(-i[:2], side, scatter)
                limits = [0.0, 10.0, 35.0, 80.0, 180.0]
                rings = sum(integrate(Region.ring(axis, a, b)) for a, b in pairwise(limits))
                assert rings == pytest.approx(total, abs=1e-9)
                own = next((m for m in [case.bsdf.model(side, scatter, band)[0]] if m.kind == "matrix"), None)
                if own is None and part != "all":
                    continue  # peaks and scattered light are told apart by the rings
                basis = own.outgoing_basis if own else Basis.named("klems-quarter")
                patches = sum(integrate(Region.patches(basis, [p])) for p in range(len(basis)))
                assert patches == pytest.approx(total, rel=1e-9 if own else 0.004, abs=1e-12)


@by_case
def test_regions_agree_with_quadrature(case):
    """Cones and patches against a fine sum over directions."""
    rng = np.random.default_rng(5)
    u = rng.random((400_000, 2))
    r, phi = np.sqrt(u[:, 0]), 2 * np.pi * u[:, 1]
    points = np.column_stack([r * np.cos(phi), r * np.sin(phi)])
    basis = Basis.named("klems-half")
    for band, side, scatter in case.components:
        to = outgoing(points, side, scatter)
        for i in incident_directions(side)[1:3]:
            values = case.bsdf.evaluate(i, to, band) * np.pi
            # A wide cone about straight through has its narrow peak, too.
            cones = (((0.3, -0.5), 25.0), ((-0.9, 0.1), 40.0), (tuple(-i[:2]), 20.0), (tuple(-i[:2]), 65.0))
            for axis, half_angle in cones:
                towards = outgoing(np.array(axis), side, scatter)
                inside = to @ towards > np.cos(np.radians(half_angle))
                found = case.bsdf.integrate(i, scatter, Region.cone(towards, half_angle), band, part="scattered")
                error = np.std(values * inside) / np.sqrt(len(to))
                assert found == pytest.approx(np.mean(values * inside), abs=5 * error + 2e-3 * values.mean())
            chosen = [3, 40, 41, 76]
            inside = np.isin(basis.index_of_outgoing(to), chosen)
            found = case.bsdf.integrate(i, scatter, Region.patches(basis, chosen), band, part="scattered")
            error = np.std(values * inside) / np.sqrt(len(to))
            assert found == pytest.approx(np.mean(values * inside), abs=5 * error + 2e-3 * values.mean())
