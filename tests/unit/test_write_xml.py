"""Writing BSDF XML: what is kept, what each program gets, and files written whole or not at all."""

import gzip

import numpy as np
import pytest

import clerestory
from clerestory import Basis, Bsdf, ClerestoryError, MissingDataError, Model, UnsupportedError

QUARTER = Basis.named("klems-quarter")
FACES = [(side, scatter) for side in ("exterior", "interior") for scatter in ("transmission", "reflection")]
NAMES = {"name": "A", "manufacturer": "B", "device_type": "Other"}
THERMAL = {**NAMES, "emissivity_exterior": 0.8, "emissivity_interior": 0.7, "tir": 0.1, "thickness_m": 0.0005}


def model(seed, basis=QUARTER):
    values = np.random.default_rng(seed).random((len(basis), len(basis)))
    return Model.matrix(values / np.pi, basis)


def sample(*bands, faces=FACES):
    return Bsdf.from_models({b: {f: model(10 * k + j) for j, f in enumerate(faces)} for k, b in enumerate(bands)})


def same(a, b):
    assert a.bands == b.bands
    for band, members in a.models.items():
        assert members.keys() == b.models[band].keys()
        for face, m in members.items():
            other = b.models[band][face]
            assert np.array_equal(m.values, other.values)
            assert (m.incident_basis, m.outgoing_basis) == (other.incident_basis, other.outgoing_basis)


@pytest.mark.parametrize("suffix", [".xml", ".xml.gz"])
def test_all_bands_sides_and_digits_come_back(tmp_path, suffix):
    bsdf = sample("visible", "solar", "nir", "cie-x", "cie-z", "550 nm").with_metadata(
        **{**THERMAL, "name": '<A> & "B" é'}
    )
    path = tmp_path / f"a{suffix}"
    assert bsdf.write(path) == []
    again = clerestory.read(path)
    same(bsdf, again)
    assert again.warnings == []
    assert again.metadata.name == '<A> & "B" é'
    assert again.metadata.thickness_m == 0.0005
    assert (path.read_bytes()[:2] == b"\x1f\x8b") == (suffix == ".xml.gz")
    first = path.read_bytes()
    bsdf.write(path)
    assert path.read_bytes() == first


def test_extreme_numbers_come_back(tmp_path):
    values = np.zeros((41, 41))
    values[0, :8] = [5e-324, 1e-300, 1e300, 0.1 + 0.2, 1 / 3, -1e-7, -0.0, 123456789.12345678]
    bsdf = Bsdf.from_models({("exterior", "reflection"): Model.matrix(values, QUARTER)})
    bsdf.write(tmp_path / "a.xml")
    again = clerestory.read(tmp_path / "a.xml")
    read = again.models["visible"]["exterior", "reflection"].values
    assert read.tobytes() == values.tobytes()
    assert again.warnings == [w for w in again.warnings if "1 negative value, -1e-7" in w] != []


def test_any_bases_come_back(tmp_path):
    own = Basis.from_rings("own & only", [(0, 12.3, 0, 1), (12.3, 90, 41.7, 6)])
    shadow = Basis.from_rings("LBNL/Klems Quarter", [(0, 20, 0, 1), (20, 90, 55, 5)])
    rectangular = Model.matrix(np.arange(7.0 * 41).reshape(7, 41), QUARTER, own)
    square = Model.matrix(np.arange(36.0).reshape(6, 6), shadow)
    bsdf = Bsdf.from_models({("exterior", "transmission"): rectangular, ("exterior", "reflection"): square})
    bsdf.write(tmp_path / "a.xml")
    again = clerestory.read(tmp_path / "a.xml")
    same(bsdf, again)
    assert again.models["visible"]["exterior", "transmission"].outgoing_basis.name == "own & only"


def test_other_models_are_refused_with_the_remedy(tmp_path):
    bsdf = Bsdf.from_models({("exterior", "transmission"): Model.lambertian(0.5)})
    with pytest.raises(UnsupportedError, match=r"a.xml: .*Lambertian.*convert it") as info:
        bsdf.write(tmp_path / "a.xml")
    assert "\n" not in str(info.value)
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(ClerestoryError, match="does not tell the format"):
        bsdf.write(tmp_path / "a.txt")


def test_a_failure_leaves_the_old_file(tmp_path, monkeypatch):
    path = tmp_path / "a.xml"
    path.write_text("old")

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("pathlib.Path.write_bytes", full)
    with pytest.raises(OSError, match="No space"):
        sample("visible").write(path)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_missing_folder_is_the_systems_error(tmp_path):
    with pytest.raises(FileNotFoundError) as info:
        sample("visible").write(tmp_path / "absent" / "a.xml")
    assert str(info.value.filename).endswith("a.xml")


def test_radiance_gets_visible_light_and_colour(tmp_path):
    bsdf = sample("visible", "solar", "cie-x", "cie-z", "cie-u")
    notes = bsdf.write(tmp_path / "a.xml", target="radiance")
    assert notes == ["Radiance does not use these bands, which are left out: solar, cie-u"]
    assert clerestory.read(tmp_path / "a.xml").bands == ("visible", "cie-x", "cie-z")
    with pytest.raises(MissingDataError, match=r"Radiance needs band \"visible\"; the data set has: solar"):
        sample("solar").write(tmp_path / "b.xml", target="radiance")


def test_window_asks_for_what_is_missing(tmp_path):
    bsdf = sample("visible", "solar", "uv")
    with pytest.raises(MissingDataError) as info:
        bsdf.with_metadata(tir=0.1).write(tmp_path / "a.xml", target="window")
    assert "--emissivity-exterior, --emissivity-interior, --thickness" in str(info.value)
    assert "--tir" not in str(info.value)
    with pytest.raises(
        MissingDataError, match=r"needs .*--thickness.* and band \"solar\".*has: visible \(merge a file"
    ):
        sample("visible").write(tmp_path / "a.xml", target="window")
    with pytest.raises(MissingDataError, match=r"needs band \"solar\""):
        sample("visible").with_metadata(**THERMAL).write(tmp_path / "a.xml", target="window")
    half = sample("visible", "solar", faces=FACES[:3]).with_metadata(**THERMAL)
    with pytest.raises(
        MissingDataError, match=r"Reflection Back \(light from the interior\) of band \"solar\", Refl.*holds them"
    ):
        half.write(tmp_path / "a.xml", target="window")
    notes = bsdf.with_metadata(**THERMAL).write(tmp_path / "a.xml", target="window")
    assert notes == ["WINDOW does not use these bands, which are left out: uv"]
    again = clerestory.read(tmp_path / "a.xml")
    assert again.bands == ("solar", "visible")
    assert again.metadata.thickness_m == 0.0005
    assert b'<Thickness unit="Millimeter">0.5</Thickness>' in (tmp_path / "a.xml").read_bytes()


def test_window_files_name_the_sample(tmp_path):
    thermal = {k: v for k, v in THERMAL.items() if k not in NAMES}
    notes = sample("visible", "solar").with_metadata(**thermal).write(tmp_path / "a.xml", target="window")
    assert len(notes) == 3
    data = clerestory.read(tmp_path / "a.xml").metadata
    assert (data.name, data.manufacturer, data.device_type) == ("unnamed", "unknown", "Other")


def test_a_missing_transmission_side_is_filled_by_reciprocity(tmp_path):
    faces = [f for f in FACES if f != ("interior", "transmission")]
    bsdf = sample("visible", "solar", faces=faces).with_metadata(**THERMAL)
    notes = bsdf.write(tmp_path / "a.xml", target="window")
    assert len(notes) == 2
    assert all("by reciprocity" in n for n in notes)
    again = clerestory.read(tmp_path / "a.xml").models["visible"]["interior", "transmission"].values
    turn = QUARTER.reversed
    assert np.array_equal(again, bsdf.models["visible"]["exterior", "transmission"].values.T[np.ix_(turn, turn)])


def test_energyplus_does_without_the_exterior_reflection(tmp_path):
    faces = [("exterior", "transmission"), ("interior", "reflection")]
    bsdf = sample("visible", "solar", faces=faces).with_metadata(**THERMAL)
    with pytest.raises(MissingDataError, match="--conductivity"):
        bsdf.write(tmp_path / "a.xml", target="energyplus")
    whole = bsdf.with_metadata(thermal_conductivity=0.2)
    notes = whole.write(tmp_path / "a.xml", target="energyplus")
    assert any("EnergyPlus does without" in n for n in notes)
    with pytest.raises(ClerestoryError, match="above 0"):
        whole.with_metadata(emissivity_exterior=0.0).write(tmp_path / "a.xml", target="energyplus")


def test_window_and_energyplus_take_klems_bases_only(tmp_path):
    basis = Basis.named("reinhart:1")
    models = {f: model(1, basis) for f in FACES}
    bsdf = Bsdf.from_models({"visible": models, "solar": models}).with_metadata(**THERMAL)
    with pytest.raises(UnsupportedError, match="--basis klems-full"):
        bsdf.write(tmp_path / "a.xml", target="window")


def test_negative_values_are_zero_for_window(tmp_path):
    values = np.full((41, 41), 0.1)
    values[3, 4] = -0.2
    models = {f: Model.matrix(values, QUARTER) for f in FACES}
    bsdf = Bsdf.from_models({"visible": models, "solar": models}).with_metadata(**THERMAL)
    notes = bsdf.write(tmp_path / "a.xml", target="window")
    assert sum("1 negative value of" in n for n in notes) == 8
    assert clerestory.read(tmp_path / "a.xml").models["solar"]["exterior", "reflection"].values[3, 4] == 0.0


def test_a_band_that_two_files_hold_is_named(tmp_path):
    with pytest.raises(ClerestoryError, match=r"more than one .*\"visible\".*rename"):
        Bsdf.merged([sample("solar", "visible"), sample("visible")])
    assert Bsdf.merged([sample("solar"), sample("visible")]).bands == ("solar", "visible")


def test_foreign_elements_and_geometry_come_back(tmp_path):
    sample("visible").with_metadata(name="A").write(tmp_path / "a.xml")
    mgf = "m red =\n\tc\n\t\tcxy 0.6 0.3\n# 1 < 2 & so on"
    text = (tmp_path / "a.xml").read_text()
    geometry = "<Geometry format='MGF'><MGFblock unit='Meter'>" + mgf.replace("&", "&amp;").replace("<", "&lt;")
    text = text.replace("</Material>", "</Material>" + geometry + "</MGFblock></Geometry><Note a='1'>kept</Note>")
    text = text.replace("<Optical>", "<Checksum>17</Checksum><Optical>")
    (tmp_path / "b.xml.gz").write_bytes(gzip.compress(text.encode()))
    first = clerestory.read(tmp_path / "b.xml.gz")
    assert (first.metadata.geometry, first.metadata.geometry_format) == (mgf, "MGF")
    first.write(tmp_path / "c.xml")
    second = clerestory.read(tmp_path / "c.xml")
    assert second._core.metadata_parts() == first._core.metadata_parts()
    assert {e[0] for _, e in second._core.metadata_parts()[4]} == {"Checksum", "Note"}
