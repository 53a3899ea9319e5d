"""Values and direct-hemispherical integrals of real files against Radiance's own library."""

import numpy as np
import pytest

from radiance import HEMISPHERICAL, INCIDENT, PAIRS, RELATIVE, RadianceError, compare
from samples import sample_files

#: Files that Radiance does not load, and what it says.
REFUSED = {"CS03_genBSDF.xml.gz": "unsupported IncidentDataStructure"}


@pytest.mark.parametrize("path", sample_files("klems", "tensortree"))
def test_lookups_are_radiances(path, require_pyradiance, tmp_path):
    """All sides and scatters that the file answers; directions are handed over as they are, so sides are tested too."""
    if path.name in REFUSED:
        with pytest.raises(RadianceError, match=REFUSED[path.name]):
            compare(path, tmp_path)
        return
    found = compare(path, tmp_path)
    assert found.pairs >= PAIRS
    assert found.set_aside <= 5
    assert max(c.ours.max() for c in found.components) > 0
    for component in found.components:
        where = f"{component.side} {component.scatter}"
        assert component.relative.max() <= RELATIVE, where
        if component.kind == "reversed":
            assert not np.any(component.theirs_hemispherical), "Radiance integrates reversed isotropic trees now"
        else:
            assert len(component.hemispherical) == INCIDENT
            assert component.hemispherical.max() <= HEMISPHERICAL, where


def test_a_deviation_of_a_thousandth_is_found(sample_data, require_pyradiance, tmp_path):
    found = compare(sample_data / "klems" / "ExtVenetianBlind_17tilt.xml", tmp_path)
    for component in found.components:
        component.ours *= 1.001
        assert component.relative.max() > RELATIVE
