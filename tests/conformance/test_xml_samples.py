"""Real files of the field: the values that their READMEs list, their faults, and nothing lost by writing them again."""

import re
from pathlib import Path

import numpy as np
import pytest

import clerestory
from samples import ABSENT, sample_files, sample_root

DIRECTIONS = {
    "Tf": ("exterior", "transmission"),
    "Tb": ("interior", "transmission"),
    "Rf": ("exterior", "reflection"),
    "Rb": ("interior", "reflection"),
}
NORMAL = {"exterior": [0.0, 0.0, -1.0], "interior": [0.0, 0.0, 1.0]}


def content_check(kind: str) -> list:
    """Rows of the table of values in a folder's README, a parameter each."""
    root = sample_root()
    if root is None:
        return [pytest.param(None, None, marks=pytest.mark.skip(reason=ABSENT), id="absent")]
    text = (root / kind / "README.md").read_text().split("## Content check")[1]
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in text.splitlines() if line.startswith("| ")]
    rows = [row for row in rows[1:] if not row[0].startswith("mini/")]
    assert len(rows) > 8
    return [pytest.param(root / kind / row[0], row, id=row[0]) for row in rows]


@pytest.mark.parametrize(("path", "row"), content_check("klems"))
def test_klems_files_give_the_listed_values(path: Path, row):
    bsdf = clerestory.read(path)
    listed = 0
    for cell in row[4].split(";"):
        band, direction, first, most = re.match(r"\s*(\S+) (\w\w) ([\d.]+) \(([\d.]+)\)", cell).groups()
        model = bsdf.models["solar" if band.lower().startswith("s") else "visible"][DIRECTIONS[direction]]
        values = model.outgoing_basis.projected_solid_angles @ np.clip(model.values, 0.0, None)
        assert values[0] == pytest.approx(float(first), abs=6e-5)
        assert values.max() == pytest.approx(float(most), abs=6e-4)
        listed += 1
    assert listed == sum(len(members) for members in bsdf.models.values())


@pytest.mark.parametrize(("path", "row"), content_check("tensortree"))
def test_tree_files_give_the_listed_values(path: Path, row):
    bsdf = clerestory.read(path)
    held = bsdf.models["visible"]
    # Normal incidence is a corner of four cells of a tree; any of them may have answered there.
    steps = np.array([[1, 1, 0], [1, -1, 0], [-1, 1, 0], [-1, -1, 0]]) * 1e-6
    seen = 0
    for direction, cell in zip(("Tb", "Tf", "Rb", "Rf"), row[4:8], strict=True):
        side, scatter = DIRECTIONS[direction]
        if (side, scatter) in held:
            values = bsdf.integrate(np.array(NORMAL[side]) + steps, scatter)
            assert np.any(np.isclose(values, float(cell), rtol=5e-3, atol=6e-5)), (direction, values, cell)
            seen += 1
    assert seen == len(held)


@pytest.mark.parametrize("path", sample_files("klems", "tensortree"))
def test_writing_and_reading_again_loses_nothing(path: Path, tmp_path):
    first = clerestory.read(path)
    assert first.write(tmp_path / "a.xml") == []
    second = clerestory.read(tmp_path / "a.xml")
    assert second._core.metadata_parts() == first._core.metadata_parts()
    described = [[band[:3] for band in bsdf._core.bands()] for bsdf in (first, second)]
    assert described[0] == described[1]
    for band, members in first.models.items():
        assert members.keys() == second.models[band].keys()
        for face, model in members.items():
            other = second.models[band][face]
            assert model.kind == other.kind
            if model.kind == "matrix":
                assert model.values.tobytes() == other.values.tobytes()
                assert model.incident_basis.rings == other.incident_basis.rings
                assert model.incident_basis.name == other.incident_basis.name
    second.write(tmp_path / "b.xml")
    assert (tmp_path / "a.xml").read_bytes() == (tmp_path / "b.xml").read_bytes()
    # Only what is odd about the values themselves is still to be warned of.
    assert [w for w in second.warnings if "negative value" not in w and "value for value" not in w] == []


@pytest.mark.parametrize(
    ("name", "fault"),
    [
        ("tutorial_blinds_with_log_line.xml", "line 1: text stands before the XML"),
        ("CS-TBK7-12_112916.xml.gz", 'written "solar" instead of "Solar"'),
        ("blinds30.xml", "label of the wrong direction"),
        ("ec60.xml", 'Reflection Back of band "solar" is the same, value for value, as Transmission Front'),
    ],
)
def test_faults_of_real_files_are_named(sample_data, name, fault):
    warnings = clerestory.read(sample_data / "klems" / name).warnings
    assert any(fault in w for w in warnings), warnings


def test_sound_files_give_no_warnings(sample_data):
    for name in ("clear_unit.xml", "diffuse50.xml"):
        warnings = clerestory.read(sample_data / "klems" / name).warnings
        assert [w for w in warnings if "label of the wrong direction" not in w] == []
