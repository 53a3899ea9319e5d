"""Models published as XML with a catalogue; records of samples; the catalogue of instruments and programs."""

import json

import numpy as np
import pytest

import laboratory
from clerestory import Bsdf, ClerestoryError, Model, read
from clerestory.measure.database import Database, catalogue
from clerestory.measure.database.library import publish
from clerestory.measure.database.record import keep_record, read_record
from clerestory.npz import encode


@pytest.fixture
def database(tmp_path):
    with Database.open(tmp_path / "lab.sqlite", create=True) as opened:
        opened.add(laboratory.contents(laboratory.scan(0.0), laboratory.scan(40.0)))
        yield opened


def add(database: Database, name: str, data: bytes, file_name: str = "twill.bsdf.npz") -> int:
    return database.add_model(
        "twill",
        name,
        data,
        file_name=file_name,
        scans=database.measurement("twill").scans,
        command="clerestory measure fit twill",
        settings={"basis": "klems-full"},
    )


def diffuse(value: float = 0.3) -> Bsdf:
    return Bsdf.from_models({("exterior", "transmission"): Model.lambertian(value)})


def test_models_are_published_with_all_that_is_known(database, tmp_path):
    database.describe_sample("twill", thickness_mm=0.5, description="a screen / of one kind", symmetry="none")
    add(database, "patches", encode(diffuse().to_matrix("klems-full")))
    add(database, "fine", encode(diffuse(0.4).to_tree("tensor4", resolution=3)))
    scans = database.measurement("twill").scans
    database.add_model("twill", "prepared", b"zip", file_name="p.zip", scans=scans, command="prepare", kind="scans")
    published, paths = publish(database, tmp_path / "library")
    assert sorted(path.name for path in paths) == [
        "catalogue.html",
        "catalogue.json",
        "twill_fine.xml",
        "twill_fine_klems-full.xml",
        "twill_patches.xml",
    ]
    for name, value in (("twill_patches", 0.3), ("twill_fine", 0.4), ("twill_fine_klems-full", 0.4)):
        bsdf = read(tmp_path / "library" / f"{name}.xml")
        assert float(bsdf.integrate(np.array([0.0, 0.0, -1.0]), "transmission")) == pytest.approx(value, rel=1e-4)
        known = bsdf.metadata
        assert (known.name, known.manufacturer, known.thickness_m) == ("twill", "MechoShade", pytest.approx(0.0005))
    # Prepared scans are no models.
    assert [one.name for one in database.models() if one.kind == "scans"] == ["prepared"]
    models = json.loads((tmp_path / "library" / "catalogue.json").read_text())["models"]
    assert [model["name"] for model in models] == ["patches", "fine"]
    assert models[0]["laboratories"] == ["HSLU"]
    assert models[0]["measured"] == ["a.txt"]
    assert models[0]["points"] == 1000
    assert models[0]["settings"] == {"basis": "klems-full"}
    assert models[0]["missing"] == ["structure period"]
    text = (tmp_path / "library" / "catalogue.html").read_text()
    for part in ("twill_fine.xml", "MechoShade", "HSLU, 2020-06-01", "structure period"):
        assert part in text
    assert len(published) == 2


def test_names_of_files_do_not_clash(database, tmp_path):
    add(database, "a/b", encode(diffuse().to_matrix("klems-quarter")))
    add(database, "a:b", encode(diffuse(0.4).to_matrix("klems-quarter")))
    _, paths = publish(database, tmp_path / "library")
    assert {path.name for path in paths} >= {"twill_a_b.xml", "twill_a_b_2.xml"}


def test_what_cannot_be_published_is_named(database, tmp_path):
    with pytest.raises(ClerestoryError, match="no models to publish"):
        publish(database, tmp_path / "library")
    assert not (tmp_path / "library").exists()
    add(database, "odd", b"no model at all", "odd.bsdf.npz")
    with pytest.raises(ClerestoryError, match=r"model 'odd': odd.bsdf.npz is no BSDF"):
        publish(database, tmp_path / "library")


def test_records_of_samples_and_instruments(database, tmp_path):
    path = tmp_path / "lab.toml"
    path.write_text(
        """
[[samples]]
name = "twill"
structure_period_mm = 1
pictures = ["front.jpg"]
notes = ["cut from roll 7"]

[[instruments]]
name = "PG2"
kind = "scanning goniophotometer"
[[instruments.configurations]]
name = "halogen, large spot"
lamp = "halogen"
spot_mm = 70
lamp_wavelength_nm = [400, 500, 600]
lamp_power = [0.1, 0.5, 1]
"""
    )
    done = keep_record(database, read_record(path))
    assert done == ["sample twill", "configuration halogen, large spot of PG2"]
    keep_record(database, read_record(path))
    sample = database.sample("twill")
    assert (sample.structure_period_mm, sample.pictures, sample.manufacturer) == (1.0, ("front.jpg",), "MechoShade")
    assert [note.text for note in database.notes("sample", sample.id)] == ["cut from roll 7"]
    made = next(c for c in database.configurations() if c.name == "halogen, large spot")
    np.testing.assert_array_equal(database.lamp_spectrum(made.id)[1], [0.1, 0.5, 1.0])


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("[[samples]]\nnam = 'x'", r"samples\[1\].nam: there is no such key \(did you mean name\?\)"),
        ("[[samples]]\nname = 'x'\nwidth_mm = -3", r"samples\[1\].width_mm: -3"),
        ("[[samples]]\nname = 'x'\nwidth_mm = 'wide'", r"samples\[1\].width_mm: 'wide' does not fit"),
        ("[[samples]", "lab.toml: "),
        ("\xff", "lab.toml: "),
    ],
)
def test_a_wrong_record_names_its_key(tmp_path, text, told):
    path = tmp_path / "lab.toml"
    path.write_bytes(text.encode("latin-1"))
    with pytest.raises(ClerestoryError, match=told):
        read_record(path)


def test_a_spectrum_has_as_many_powers_as_wavelengths(database, tmp_path):
    path = tmp_path / "lab.toml"
    path.write_text('[[instruments]]\nname = "x"\n[[instruments.configurations]]\nname = "y"\nlamp_power = [1.0]')
    with pytest.raises(ClerestoryError, match="as many wavelengths as powers"):
        keep_record(database, read_record(path))
    assert all(c.instrument != "x" for c in database.configurations())


def test_the_catalogue_has_the_fields_of_the_report():
    found = {one.name: one for one in catalogue.instruments()}
    assert list(found) == [
        "PG2",
        "Reflet 180",
        "IBP / EPFL camera goniophotometer",
        "Mini-Diff V2",
        "Integrating sphere",
    ]
    assert found["PG2"].dynamic_range == 1e9
    assert found["PG2"].smallest_bsdf == 1e-4
    assert found["Mini-Diff V2"].dynamic_range == 1e5
    assert "IEA SHC Task 21" in found["IBP / EPFL camera goniophotometer"].gives
    for one in found.values():
        assert all((one.kind, one.features, one.gives, one.laboratories, one.incident_deg, one.source, one.limits))
    programs = {one.name: one for one in catalogue.software()}
    assert programs["pabopto2bsdf"].takes == ["pab Mountain"]
    assert programs["WINDOW 7.6"].gives == ["Klems full", "Klems half", "Klems quarter"]


def test_the_samples_of_the_round_robin_ship(database):
    keep_record(database, read_record(catalogue.record("roundrobin")))
    twill = database.sample("MechoShade EuroTwill 6216")
    assert "order 2" in twill.symmetry
    assert "openness 1 %" in twill.description
    assert database.sample("HELLA ARB 80").pictures
    assert catalogue.record("nothing") is None
