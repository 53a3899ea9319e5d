"""Mean weights of samples against integrals, for every model."""

import numpy as np
import pytest

from chi2 import chi2_tail, corrected, draw
from partition import MIDDLE
from registry import CASES, incident_directions, outgoing


def flux_by_cell(case, incident, side, scatter, band):
    """Flux into each cell by the model's values and peaks."""
    cells = case.partition(incident)
    flux = case.bsdf.evaluate(incident, outgoing(cells.points(MIDDLE)[:, 0], side, scatter), band) * cells.areas
    for peak in case.bsdf.peaks(incident, scatter, band):
        flux[cells.index(peak.outgoing[:2])] += peak.value
    return cells, flux


def scores(case, draws=400_000):
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
                            assert error < 0.001
                            found.append((sampled.mean() - known) / error)
    return found


@pytest.mark.slow
def test_mean_weights_are_the_integrals():
    """All z-scores together at 1 %, and their variance is that of honest errors."""
    z = np.concatenate([scores(case) for case in CASES.values() if case.cells is not None])
    assert len(z) > 400
    assert chi2_tail(np.max(z**2), 1) > corrected(len(z))
    assert 0.7 < np.var(z) < 1.4


@pytest.mark.parametrize("case", [c for c in CASES.values() if c.cells is None], ids=lambda c: c.name)
def test_mean_weights_are_the_integrals_where_no_cells_are_known(case):
    for side in case.sides:
        for k, incident in enumerate(incident_directions(side)):
            weights = draw(case, incident, side, 20_000, k).weights.sum(axis=-1)
            total = sum(case.bsdf.integrate(incident, c, band=b) for b in case.bsdf.bands for c in case.scatters(side))
            error = weights.std() / np.sqrt(len(weights))
            assert weights.mean() == pytest.approx(total, abs=case.tolerance * total + 4 * error)
