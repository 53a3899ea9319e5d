"""Samples against their density and against integrals, for every model."""

import numpy as np
import pytest

from chi2 import chi2_tail, compare, corrected
from partition import MIDDLE, Square
from registry import CASES, incident_directions, outgoing

DRAWS = 1_000_000
#: Of models that are slow to sample.
FEWER = 50_000
#: The oblique directions of the registry: what is special at the normal is a matter of the physics tests.
CHOSEN = (1, 2, 4)
#: An odd number, so that the bins lie across the cells of tables and trees.
ACROSS = Square(31)

by_case = pytest.mark.parametrize("case", CASES.values(), ids=lambda c: c.name)
TESTS = sum(2 * len(CHOSEN) * len(case.sides) for case in CASES.values())


def draw(case, incident, side, count, seed, bands=None):
    u = np.random.default_rng([seed, *case.name.encode()]).random((count, 2))
    return case.bsdf.sample(incident, u, bands or case.bsdf.bands, scatter=case.only(side))


def test_tail_of_chi_squared_is_the_tabulated_one():
    for x, freedom, chance in [(3.841459, 1, 0.05), (21.107513, 3, 1e-4), (18.307038, 10, 0.05), (149.448, 100, 1e-3)]:
        assert chi2_tail(x, freedom) == pytest.approx(chance, rel=1e-3)


@pytest.mark.slow
@by_case
def test_samples_follow_their_density(case, tmp_path):
    """10⁶ draws in bins along and across the cells; 1 % for the suite together, by Šidák's correction."""
    for side in case.sides:
        for k in CHOSEN:
            incident = incident_directions(side)[k]
            samples = draw(case, incident, side, FEWER if case.rough else DRAWS, k)
            if not samples.weights.any():
                assert all(case.bsdf.integrate(incident, c) == 0 for c in case.scatters(side))
                continue
            for bins in (case.exact(incident) or Square(16), ACROSS):
                outcome = compare(case, incident, side, bins, list(case.bsdf.bands), samples)
                if outcome.chance < corrected(TESTS):
                    pytest.fail(f"from {incident}: {outcome.words}; tables in {outcome.save(tmp_path, case.name)}")


@pytest.mark.parametrize("bins", [None, ACROSS], ids=["along", "across"])
def test_a_density_that_is_wrong_by_5_percent_in_one_cell_is_found(bins):
    case = CASES["matrix on klems-quarter"]
    (incident,) = incident_directions("exterior")[1:2]
    basis = case.bsdf.models["visible"]["exterior", "transmission"].outgoing_basis
    centres = basis.outgoing_centres("interior")
    cell = np.argmax(case.bsdf.evaluate(incident, centres) * basis.projected_solid_angles)

    def wrong(i, o):
        return case.bsdf.pdf(i, o, scatter="transmission") * np.where(basis.index_of_outgoing(o) == cell, 1.05, 1.0)

    samples = draw(case, incident, "exterior", DRAWS, 1)
    bins = bins or case.partition(incident)
    assert compare(case, incident, "exterior", bins, ["visible"], samples).chance > corrected(TESTS)
    assert compare(case, incident, "exterior", bins, ["visible"], samples, wrong).chance < corrected(TESTS)


def test_a_sample_where_the_density_is_zero_is_found():
    case = CASES["Lambertian"]
    (incident,) = incident_directions("exterior")[1:2]
    samples = draw(case, incident, "exterior", 1000, 1)

    def half(i, o):
        return case.bsdf.pdf(i, o, scatter="transmission") * (o[..., 0] > 0)

    assert compare(case, incident, "exterior", Square(4), ["visible"], samples, half).chance == 0


def flux_by_cell(case, incident, side, scatter, band):
    """Flux into each cell by the model's values and peaks."""
    cells = case.partition(incident)
    flux = case.bsdf.evaluate(incident, outgoing(cells.points(MIDDLE)[:, 0], side, scatter), band) * cells.areas
    for peak in case.bsdf.peaks(incident, scatter, band):
        flux[cells.index(peak.outgoing[:2])] += peak.value
    return cells, flux


def scores(case, draws=200_000):
    """Standardised differences between sampled and integrated flux into eighths of the hemisphere, in every band."""
    found = []
    for side in case.sides:
        for k in (1, 2, 3):
            incident = incident_directions(side)[k]
            samples = draw(case, incident, side, draws, 100 + k)
            for b, band in enumerate(case.bsdf.bands):
                weights = samples.weights[:, b]
                for scatter in case.scatters(side):
                    cells, flux = flux_by_cell(case, incident, side, scatter, band)
                    sign = outgoing(np.zeros(2), side, scatter)[2]
                    to = np.where(
                        np.sign(samples.outgoing[:, 2]) == sign, cells.index(samples.outgoing[:, :2]), len(flux)
                    )
                    # Groups of cells in their order, of which every model has at least eight.
                    groups = np.append(np.arange(len(flux)) * 8 // len(flux), 8)
                    for group in range(8):
                        sampled = weights * (groups[to] == group)
                        known = flux[groups[:-1] == group].sum()
                        error = sampled.std() / np.sqrt(draws)
                        if error < 1e-12:
                            # All of the light goes here, or none.
                            assert sampled.mean() == pytest.approx(known, rel=1e-9, abs=1e-12)
                        elif known * draws > 100:
                            assert error < 0.002
                            found.append((sampled.mean() - known) / error)
    return found


@pytest.mark.slow
def test_mean_weights_are_the_integrals():
    """All z-scores together at 1 %, and their variance is that of honest errors."""
    z = np.concatenate([scores(case) for case in CASES.values() if not case.rough])
    assert len(z) > 400
    assert chi2_tail(np.max(z**2), 1) > corrected(len(z))
    assert 0.7 < np.var(z) < 1.4
