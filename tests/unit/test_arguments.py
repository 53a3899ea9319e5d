"""Arguments of the Python API that make no sense end in one line of words, not in a guess or an accident."""

import numpy as np
import pytest

from clerestory import Basis, Bsdf, ClerestoryError, Model, Region, direction
from clerestory.check import check
from clerestory.integrals import cut_off, direct_direct, hemispherical

QUARTER = Basis.named("klems-quarter")
BSDF = Bsdf.from_models({("exterior", "transmission"): Model.matrix(np.full((41, 41), 0.1), QUARTER)})
ABOVE = direction(30, 90)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: direction(91, 0), "theta_deg 91 is not an angle"),
        (lambda: direction([10, np.nan], 0), "theta_deg nan is not an angle"),
        (lambda: direction(10, np.inf), "phi_deg inf is not an azimuth"),
        (lambda: direction(10, 0, side="up"), "side 'up' is not known"),
        (lambda: Region.cone([0, 0, 0], 5), "not an outgoing direction"),
        (lambda: Region.cone([[0, 0, 1]], 5), "not an outgoing direction"),
        (lambda: Region.patches(QUARTER, [3, -1]), "no patch of index -1"),
        (lambda: Region.patches(QUARTER, [41]), "no patch of index 41"),
        (lambda: BSDF.rotated(float("nan")), "not an angle to turn by"),
        (lambda: BSDF.to_matrix(samples=-4), "-4 samples cannot be taken"),
        (lambda: BSDF.to_matrix(seed=-1), "seed -1 is not possible"),
        (lambda: BSDF.to_tree(resolution=2, samples=10**12), "samples cannot be taken"),
        (lambda: hemispherical(BSDF, sky="blue"), "sky 'blue' is not known"),
        (lambda: direct_direct(BSDF, [ABOVE, ABOVE]), r"array of shape \(2, 3\)"),
        (lambda: cut_off(BSDF, step_deg=0), "a step of 0° is not possible"),
        (lambda: check(BSDF, purpose="sun"), "purpose 'sun' is not known"),
    ],
)
def test_nonsense_is_refused_in_words(call, words):
    with pytest.raises(ClerestoryError, match=words) as caught:
        call()
    assert "\n" not in str(caught.value)
