"""Samples against their density, for every model."""

import numpy as np
import pytest

from chi2 import chi2_tail, compare, corrected, draw
from partition import Square
from registry import CASES, incident_directions

DRAWS = 1_000_000
#: Of models whose cells are not known, so that their density takes long to integrate.
FEWER = 50_000
#: An odd number, so that the bins lie across the cells of tables and trees.
ACROSS = Square(31)
TESTS = sum(4 * len(case.sides) for case in CASES.values())


def test_tail_of_chi_squared_is_the_tabulated_one():
    for x, freedom, chance in [(3.841459, 1, 0.05), (21.107513, 3, 1e-4), (18.307038, 10, 0.05), (149.448, 100, 1e-3)]:
        assert chi2_tail(x, freedom) == pytest.approx(chance, rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize(("number", "case"), list(enumerate(CASES.values())), ids=list(CASES))
def test_samples_follow_their_density(number, case, tmp_path):
    """10⁶ draws in bins along and across the cells; 1 % for the suite together, by Šidák's correction."""
    for side in case.sides:
        # One of the ordinary directions in turn, and near the horizon.
        for k in (1 + number % 3, 4):
            incident = incident_directions(side)[k]
            samples = draw(case, incident, side, FEWER if case.cells is None else DRAWS, k)
            assert samples.weights.any()
            divisions = [case.exact(incident) or Square(16), ACROSS]
            for outcome in compare(case, incident, side, divisions, list(case.bsdf.bands), samples):
                if outcome.chance < corrected(TESTS):
                    pytest.fail(f"from {incident}: {outcome.words}; tables in {outcome.save(tmp_path, case.name)}")


def test_a_density_that_is_wrong_by_5_percent_in_one_cell_is_found():
    case = CASES["matrix on klems-quarter"]
    incident = incident_directions("exterior")[1]
    basis = case.bsdf.models["visible"]["exterior", "transmission"].outgoing_basis
    centres = basis.outgoing_centres("interior")
    cell = np.argmax(case.bsdf.evaluate(incident, centres) * basis.projected_solid_angles)

    def wrong(i, o):
        return case.bsdf.pdf(i, o, scatter="transmission") * np.where(basis.index_of_outgoing(o) == cell, 1.05, 1.0)

    samples = draw(case, incident, "exterior", DRAWS, 1)
    divisions = [case.partition(incident), ACROSS]
    for outcome in compare(case, incident, "exterior", divisions, ["visible"], samples):
        assert outcome.chance > corrected(TESTS)
    for outcome in compare(case, incident, "exterior", divisions, ["visible"], samples, wrong):
        assert outcome.chance < corrected(TESTS)


def test_a_sample_where_the_density_is_zero_is_found():
    case = CASES["Lambertian"]
    incident = incident_directions("exterior")[1]
    samples = draw(case, incident, "exterior", 1000, 1)

    def half(i, o):
        return case.bsdf.pdf(i, o, scatter="transmission") * (o[..., 0] > 0)

    (outcome,) = compare(case, incident, "exterior", [Square(4)], ["visible"], samples, half)
    assert outcome.chance == 0
