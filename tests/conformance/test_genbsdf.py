"""The virtual goniophotometer against genBSDF's job, on the same scene files, sampled box and setting."""

from __future__ import annotations

import numpy as np
import pytest

from chi2 import chi2_tail, corrected
from clerestory import Basis, trace
from clerestory.directions import SCATTERS, SIDES

genbsdf = pytest.importorskip("genbsdf", reason="pyradiance is not installed")

BASIS = Basis.named("klems-full")
AREA = BASIS.projected_solid_angles
#: Paths an incident patch: the other program's, and ours, which are the better ones.
THEIRS, OURS = 1500, 16384
#: Relative difference of hemispherical values that is allowed besides the errors. Between mirrors the peer returns 2 to
#: 3 % less of the light that is reflected several times; transmission agrees, and with level mirrors ours is the closed
#: form (tests/analytic).
ALLOWED = {("mirror_15", "reflection"): 0.04}
#: Expected paths of a cell below which cells are pooled.
LEAST = 10.0


@pytest.fixture(scope="module", params=genbsdf.scenes(), ids=lambda scene: scene.name)
def pair(request, tmp_path_factory):
    """Both results for a scene, and its name."""
    scene = request.param
    folder = tmp_path_factory.mktemp(scene.name)
    # One process: with two, one run in many returned a few incident patches that differ from all its other runs.
    theirs = genbsdf.generate(scene, folder, samples=THEIRS, processes=1)
    ours = trace.measure(genbsdf.recipe(scene, folder), samples=OURS, seed=7)
    return ours, theirs, scene.name


def flux(bsdf, side, scatter):
    """Share of the flux from each patch (columns) that goes to each patch (rows)."""
    return AREA[:, None] * bsdf.to_matrix("klems-full").models["visible"][side, scatter].values


def standard_errors(bsdf, side, scatter):
    """Of the shares of our result; those of the other program have at most the variance of counted paths."""
    return AREA[:, None] * bsdf.to_matrix("klems-full").models["visible"][side, scatter].standard_errors


@pytest.mark.parametrize("scatter", SCATTERS)
@pytest.mark.parametrize("side", SIDES)
def test_hemispherical_values(pair, side, scatter):
    """Within 1 % and three combined standard errors, over all and from each patch."""
    ours, theirs = (flux(b, side, scatter) for b in pair[:2])
    allowed = ALLOWED.get((pair[2], scatter), 0.01)
    incident = BASIS.incident_centres(side)
    values, errors = pair[0].integrate_with_error(incident, scatter)
    totals = theirs.sum(axis=0)
    share = np.clip(np.maximum(totals, values), 0.0, 1.0)
    error = np.hypot(errors, np.sqrt(share * (1.0 - share) / THEIRS))
    assert ours.sum(axis=0) == pytest.approx(values, abs=1e-9)
    weights = AREA / np.pi
    whole = abs(weights @ (values - totals))
    assert whole <= allowed * (weights @ totals) + 3.0 * np.sqrt(weights**2 @ error**2)
    # 145 patches: three errors are passed by one in a few runs of the suite without any fault, 4.5 are not.
    assert (np.abs(values - totals) <= allowed * totals + 4.5 * error + 1e-6).all()


@pytest.mark.parametrize("scatter", SCATTERS)
@pytest.mark.parametrize("side", SIDES)
def test_cells(pair, side, scatter):
    """Chi-squared over all cells of a component, pooled where few paths are expected."""
    statistic, freedom = chi_squared(
        *(flux(b, side, scatter) for b in pair[:2]), standard_errors(pair[0], side, scatter)
    )
    tests = len(genbsdf.scenes()) * len(SIDES) * len(SCATTERS)
    assert chi2_tail(statistic, freedom) > corrected(tests), (statistic, freedom)


def chi_squared(ours: np.ndarray, theirs: np.ndarray, errors: np.ndarray) -> tuple[float, int]:
    """Statistic and degrees of freedom. Cells that expect few of the other program's paths are pooled with their
    neighbours of the same incident patch; its variance is that of counted paths, which is the most that it can be.
    """
    statistic, freedom = 0.0, 0
    for mean, other, error in zip(ours.T, theirs.T, errors.T, strict=True):
        order = np.argsort(mean)
        rest = np.zeros(3)
        for cell in order:
            rest += mean[cell], other[cell], error[cell] ** 2
            if rest[0] * THEIRS >= LEAST:
                expected, found, variance = rest
                variance += max(expected * (1.0 - min(expected, 1.0)), expected / THEIRS) / THEIRS
                statistic += (expected - found) ** 2 / variance
                freedom += 1
                rest[:] = 0.0
        # What is left over cannot hold much.
        assert rest[1] <= rest[0] + 6.0 * np.sqrt((rest[0] + 2.0 / THEIRS) / THEIRS)
    return statistic, freedom


def test_the_test_of_cells_finds_a_fault(pair):
    """A tenth of the light moved to neighbouring cells is found."""
    ours, theirs = (flux(b, "exterior", "transmission") for b in pair[:2])
    errors = standard_errors(pair[0], "exterior", "transmission")
    moved = 0.9 * theirs + 0.1 * np.roll(theirs, 1, axis=0)
    before, freedom = chi_squared(ours, theirs, errors)
    after, _ = chi_squared(ours, moved, errors)
    if theirs.max() > 0.5:
        assert after > before
        assert chi2_tail(after, freedom) < 1e-6
