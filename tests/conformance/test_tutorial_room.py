"""Three phases in the room of Radiance's tutorial, beside its published illuminances and rfluxmtx."""

import numpy as np
import pytest

tutorial_room = pytest.importorskip("tutorial_room", reason="pyradiance is not installed")


def test_illuminances_are_the_published_ones(tmp_path, sample_data):
    """The blind's are less noisy than the pane's, whose sun is in few patches."""
    found = tutorial_room.compare(sample_data, tmp_path, every=4)
    for name, mean, spread in (("tutorial_ven0.xml", 0.02, 0.05), ("tutorial_clear.xml.gz", 0.03, 0.12)):
        case = found[name]
        # What the published ones lack is more than a tenth in the depth of the room.
        lacking = case.enough / case.again
        assert lacking.mean() > 1.1, name
        assert np.mean(case.again / case.published) == pytest.approx(1.0, abs=mean), name
        ratio = case.ours / (case.published * lacking)
        assert ratio.mean() == pytest.approx(1.0, abs=mean), (name, ratio)
        assert np.sqrt(np.mean((ratio - 1.0) ** 2)) < spread, (name, ratio)
        ratio = case.ours / case.enough
        assert ratio.mean() == pytest.approx(1.0, abs=mean), (name, ratio)
