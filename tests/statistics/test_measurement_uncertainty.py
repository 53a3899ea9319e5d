"""How often the stated intervals of 95 % hold the truth, in repetitions of a synthetic laboratory."""

import numpy as np
import pytest

import pg2
from coverage_lab import held, repetition

REPETITIONS = 40
"""Of each of the five samples."""


def test_repetitions_are_held():
    """A part of the long run below."""
    found = [repetition("off-specular", seed) for seed in (0, 100)]
    totals = np.concatenate([one.totals for one in found])
    assert np.abs(totals).max() < 4.0
    assert held(np.concatenate([one.patches for one in found])) > 0.9


@pytest.mark.long
@pytest.mark.timeout(7200)
@pytest.mark.parametrize("sample", pg2.SAMPLES)
def test_intervals_hold_the_truth(sample):
    found = [repetition(sample, seed) for seed in range(REPETITIONS)]
    for name in ("totals", "patches"):
        errors = np.stack([getattr(one, name) for one in found])
        which = np.stack([one.measured for one in found])
        for measured in (True, False):
            # Intervals may be wider than needed, never narrower; nor so wide that they say nothing.
            assert held(errors[which == measured]) >= 0.93, (name, measured)
            assert np.sqrt(np.median(errors[which == measured] ** 2)) > 0.05, (name, measured)
