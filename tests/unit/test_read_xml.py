"""Reading BSDF XML from Python: hints, metadata, errors and warnings."""

import gzip

import numpy as np
import pytest

import clerestory
from clerestory import Basis, Bsdf, FileFormatError, Model
from samples import sample_files


def xml(
    values,
    *,
    direction="Transmission Front",
    basis="LBNL/Klems Quarter",
    band="Visible",
    structure="Columns",
    material="",
    listing="",
):
    """A small BSDF file with one block."""
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<WindowElement xmlns="http://windows.lbl.gov"><WindowElementType>System</WindowElementType>
<Optical><Layer><Material>{material}</Material>
<DataDefinition><IncidentDataStructure>{structure}</IncidentDataStructure>
<AngleBasis><AngleBasisName>{basis}</AngleBasisName>{listing}</AngleBasis></DataDefinition>
<WavelengthData><LayerNumber>System</LayerNumber><Wavelength unit="Integral">{band}</Wavelength>
<WavelengthDataBlock><WavelengthDataDirection>{direction}</WavelengthDataDirection>
<ColumnAngleBasis>{basis}</ColumnAngleBasis><RowAngleBasis>{basis}</RowAngleBasis>
<ScatteringData>{" ".join(map(str, values))}</ScatteringData></WavelengthDataBlock></WavelengthData>
</Layer></Optical></WindowElement>
"""


QUARTER = [0.004 + 1e-4 * k for k in range(41 * 41)]


@pytest.fixture
def write(tmp_path):
    def write(text, name="a.xml"):
        path = tmp_path / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    return write


def test_columns_list_incident_patches_fastest(write):
    matrix = clerestory.read(write(xml(QUARTER))).models["visible"]["exterior", "transmission"].values
    assert matrix[9, 18] == QUARTER[9 * 41 + 18]
    rows = clerestory.read(write(xml(QUARTER, structure="Rows"))).models["visible"]["exterior", "transmission"].values
    assert np.array_equal(rows, matrix.T)


def test_gzip_is_told_by_content(write):
    packed = clerestory.read(write(gzip.compress(xml(QUARTER).encode()), "a.xml"))
    assert packed.bands == ("visible",)


def test_errors_begin_with_file_line_and_element(write):
    path = write(xml(QUARTER[:-1]))
    with pytest.raises(FileFormatError) as info:
        clerestory.read(path)
    text = str(info.value)
    assert text.startswith(f"{path}: line 9, <ScatteringData>: 1680 values where 41 × 41 = 1681 belong")
    assert text.endswith(")")
    assert "\n" not in text


def test_missing_files_are_the_systems_errors(tmp_path):
    with pytest.raises(FileNotFoundError) as info:
        clerestory.read(tmp_path / "absent.xml")
    assert info.value.filename is not None


def test_what_is_ambiguous_is_refused_until_it_is_said(write):
    path = write(xml(QUARTER, direction="Transmission"))
    with pytest.raises(FileFormatError, match="from which side"):
        clerestory.read(path)
    bsdf = clerestory.read(path, side="interior")
    assert list(bsdf.models["visible"]) == [("interior", "transmission")]
    assert "was taken as Transmission Back" in bsdf.warnings[0]

    path = write(xml(QUARTER, direction="?"))
    with pytest.raises(FileFormatError, match="is not known"):
        clerestory.read(path, side="interior")
    assert clerestory.read(path, side="interior", scatter="reflection").models

    path = write(xml(QUARTER, band=""))
    with pytest.raises(FileFormatError, match="no <Wavelength>"):
        clerestory.read(path)
    assert clerestory.read(path, band="solar").bands == ("solar",)

    values = np.linspace(0.0, 0.2, 64)
    path = write(xml(values, basis="my own"))
    with pytest.raises(FileFormatError, match=r"\"my own\".*no standard basis has 64 values"):
        clerestory.read(path)
    own = Basis.from_rings("my own", [(0, 30, 0, 1), (30, 90, 60, 7)])
    model = clerestory.read(path, basis=own).models["visible"]["exterior", "transmission"]
    assert model.incident_basis == own


def test_a_standard_basis_may_be_given_by_name(write):
    # 145² values fit Klems full as well as Tregenza: the person says which.
    path = write(xml(np.zeros(145 * 145), basis="?"))
    bsdf = clerestory.read(path, basis="tregenza")
    assert bsdf.models["visible"]["exterior", "transmission"].incident_basis == Basis.named("tregenza")
    assert bsdf.warnings == []
    bsdf = clerestory.read(path)
    assert bsdf.models["visible"]["exterior", "transmission"].incident_basis == Basis.named("klems-full")
    assert 'the standard "LBNL/Klems Full" is used' in bsdf.warnings[0]


def test_metadata_is_read_and_given(write):
    material = (
        "<Name>Blind &amp; Co</Name><Thickness unit='Millimeter'>12</Thickness>"
        "<EmissivityFront>0.8</EmissivityFront><EmissivityBack>0.7</EmissivityBack><TIR>0.1</TIR>"
    )
    bsdf = clerestory.read(write(xml(QUARTER, material=material)))
    data = bsdf.metadata
    assert (data.name, data.thickness_m, data.tir) == ("Blind & Co", 0.012, 0.1)
    assert (data.emissivity_exterior, data.emissivity_interior) == (0.8, 0.7)
    assert data.manufacturer is None
    given = bsdf.with_metadata(manufacturer="Maker", tir=0.2).metadata
    assert (given.name, given.manufacturer, given.tir) == ("Blind & Co", "Maker", 0.2)
    assert bsdf.metadata.tir == 0.1
    for wrong in ({"tir": 1.5}, {"thickness_m": -1.0}, {"colour": "red"}, {"name": 3.0}):
        with pytest.raises(clerestory.ClerestoryError):
            bsdf.with_metadata(**wrong)


def test_emissivities_turn_with_the_sample():
    bsdf = Bsdf.from_models({("exterior", "transmission"): Model.lambertian(0.5)})
    turned = bsdf.with_metadata(emissivity_exterior=0.8, emissivity_interior=0.7).flipped().metadata
    assert (turned.emissivity_exterior, turned.emissivity_interior) == (0.7, 0.8)


@pytest.mark.parametrize("path", sample_files("klems", "tensortree"))
def test_every_sample_file_loads(path):
    bsdf = clerestory.read(path)
    assert bsdf.bands
    assert all(members for members in bsdf.models.values())


@pytest.mark.parametrize("path", sample_files("klems/mini"))
def test_parser_tests_are_refused(path):
    with pytest.raises(FileFormatError, match=r"4 values where 145 × 145 = 21025 belong"):
        clerestory.read(path)
