"""Golden files that lie in the repository: every arrangement of values, read back by its formula."""

from pathlib import Path

import numpy as np
import pytest

import clerestory

GOLDEN = Path(__file__).parent.parent / "data" / "xml"


def values(name, side, scatter, band="visible"):
    bsdf = clerestory.read(GOLDEN / name)
    assert bsdf.warnings == []
    return bsdf.models[band][side, scatter]


def test_columns_on_a_listed_klems_basis():
    k = np.arange(41.0 * 41).reshape(41, 41)
    for factor, face in [
        (1e-5, ("exterior", "transmission", "visible")),
        (2e-5, ("interior", "reflection", "visible")),
    ]:
        assert values("quarter.xml", *face).values == pytest.approx(factor * k, rel=1e-5, abs=1e-12)
    solar = values("quarter.xml", "exterior", "transmission", "solar")
    assert solar.values == pytest.approx(3e-5 * k, rel=1e-5, abs=1e-12)
    assert solar.incident_basis == clerestory.Basis.named("klems-quarter")
    data = clerestory.read(GOLDEN / "quarter.xml").metadata
    assert (data.thickness_m, data.emissivity_exterior, data.emissivity_interior) == (0.002, 0.8, 0.7)


def test_rows_on_a_basis_of_its_own():
    model = values("user_rows.xml", "interior", "transmission")
    assert len(model.incident_basis) == 17
    assert model.incident_basis.name == "golden user basis"
    # Rows list the outgoing values of one incident patch after another; ours has incident patches as columns.
    assert model.values == pytest.approx(1e-4 * np.arange(17.0 * 17).reshape(17, 17).T, rel=1e-5, abs=1e-12)


def test_incident_and_outgoing_bases_may_differ():
    model = values("rectangular.xml", "exterior", "reflection")
    assert (len(model.incident_basis), len(model.outgoing_basis)) == (41, 17)
    assert model.values == pytest.approx(1e-5 * np.arange(17.0 * 41).reshape(17, 41), rel=1e-5, abs=1e-12)


def test_tree_grids_have_their_last_axis_fastest():
    isotropic = clerestory.read(GOLDEN / "tree3.xml")
    # Incident radius in cell 1; the outgoing square point in cells 3 and 2 once the light's plane is turned to +x.
    source = np.array([0.0, np.sin(np.radians(28)), -np.cos(np.radians(28))])
    out = np.radians(33), np.radians(300)
    leaving = np.array([np.sin(out[0]) * np.cos(out[1]), np.sin(out[0]) * np.sin(out[1]), np.cos(out[0])])
    assert isotropic.evaluate(source, leaving) == pytest.approx(0.002 * (1 * 16 + 3 * 4 + 2 + 1), rel=1e-5)

    anisotropic = clerestory.read(GOLDEN / "tree4.xml")
    # Light travelling toward +x and -y is in the incident cells 3 and 1; it leaves in the cells 2 and 3.
    source = np.array([-0.9, 0.3, 0.0])
    source[2] = np.sqrt(1 - source @ source)
    leaving = np.array([0.05, 0.6, 0.0])
    leaving[2] = np.sqrt(1 - leaving @ leaving)
    cells = [3, 1, 2, 3]
    number = ((cells[0] * 4 + cells[1]) * 4 + cells[2]) * 4 + cells[3]
    assert anisotropic.evaluate(source, leaving) == pytest.approx(0.001 * (number + 1), rel=1e-5)
