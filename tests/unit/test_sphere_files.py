"""Values of integrating spheres: products of the glazing database, tables, and direct values by difference."""

from dataclasses import replace

import numpy as np
import pytest

import instrument_files as files
from clerestory import ClerestoryError
from clerestory.measure import SphereValues
from clerestory.measure.direct import direct_of_pairs, direct_values
from clerestory.measure.formats import igdb_dat, product_json, sphere_csv
from clerestory.measure.formats.sphere_columns import Column, column
from samples import ABSENT, sample_root


def pick(values, **wanted):
    (found,) = [v for v in values if all(getattr(v, key) == value for key, value in wanted.items())]
    return found


def test_version_1_has_the_spectra_of_a_product_and_its_materials():
    values = product_json.read(files.PRODUCT_1, "v1.json").sphere_values
    assert {v.sample for v in values} == {"Slat"}
    front = pick(values, scatter="reflection", incident_side="exterior", collected="hemispherical")
    np.testing.assert_allclose(front.wavelength_nm, [300.0, 310.0])
    np.testing.assert_array_equal(front.values, [0.6, 0.5])
    assert front.conditions["thickness_mm"] == "0.2"
    # What is null is not there.
    assert len(pick(values, scatter="reflection", incident_side="interior").values) == 1
    assert pick(values, collected="diffuse").bands == ("solar", "visible")
    assert pick(values, collected="direct").values[0] == 0.02


def test_version_2_tells_the_regular_from_the_diffuse_part_by_angle():
    values = product_json.read(files.PRODUCT_2, "v2.json").sphere_values
    assert {v.theta_deg for v in values} == {8.0}
    regular = pick(values, incident_side="exterior", scatter="transmission", collected="direct")
    np.testing.assert_array_equal(regular.values, [0.2, 0.25])
    assert pick(values, incident_side="exterior", collected="diffuse").values[0] == 0.3
    assert pick(values, incident_side="interior", collected="diffuse").scatter == "reflection"


def test_optics_text_has_three_spectra():
    transmitted, front, back = igdb_dat.read(files.DAT, "CLEAR.DAT").sphere_values
    np.testing.assert_allclose(transmitted.wavelength_nm, [300.0, 305.0])
    np.testing.assert_array_equal(back.values, [0.048, 0.049])
    assert (front.incident_side, back.incident_side, front.scatter) == ("exterior", "interior", "reflection")
    assert (transmitted.sample, transmitted.conditions["thickness_mm"]) == ("Clear", "3.048")


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("Wavelength [nm]", Column("wavelength")),
        ("lambda (µm)", Column("wavelength", 1000.0)),
        ("wavelength_um", Column("wavelength", 1000.0)),
        ("Incidence angle (deg)", Column("theta")),
        ("theta_i", Column("theta")),
        ("T", Column("value", 1.0, "transmission")),
        ("Rb", Column("value", 1.0, "reflection", None, "interior")),
        ("tau_n-h", Column("value", 1.0, "transmission", "hemispherical")),
        ("τ_n-n", Column("value", 1.0, "transmission", "direct")),
        ("rho_d-h [%]", Column("value", 0.01, "reflection", "hemispherical")),
        ("T direct-hemispherical vis", Column("value", 1.0, "transmission", "hemispherical", None, "visible")),
        ("transmittance diffuse front %", Column("value", 0.01, "transmission", "diffuse", "exterior")),
        ("R_back solar", Column("value", 1.0, "reflection", None, "interior", "solar")),
        ("standard_error", Column("error")),
        ("theta_o", None),
        ("temperature", None),
        ("T [K]", None),
    ],
)
def test_columns_are_known_by_the_words_of_laboratories(name, expected):
    assert column(name) == expected


def test_a_row_a_value():
    values = sphere_csv.read(files.SPHERES, "long.csv").sphere_values
    total = pick(values, scatter="transmission", collected="hemispherical")
    np.testing.assert_array_equal(total.values, [0.5, 0.6])
    np.testing.assert_array_equal(total.standard_errors, [0.01, 0.01])
    assert (total.theta_deg, total.sample, total.conditions["lamp"]) == (8.0, "long", "xenon")
    assert pick(values, incident_side="interior").theta_deg == 60.0


def test_a_column_for_each_kind_of_value():
    values = sphere_csv.read(files.WIDE, "wide.csv", sample="blind").sphere_values
    assert {v.sample for v in values} == {"blind"}
    diffuse = pick(values, collected="diffuse")
    np.testing.assert_allclose(diffuse.wavelength_nm, [300.0, 400.0])
    np.testing.assert_allclose(diffuse.values, [0.1, 0.2])
    # An empty cell is no value.
    np.testing.assert_array_equal(pick(values, incident_side="interior").values, [0.2])
    assert not sphere_csv.recognises(b"theta_i,phi_i,theta_o,phi_o,value\n0,0,0,0,1\n", "a.csv")


def test_bands_and_even_light():
    table = b"angle,T_vis,T_sol [%]\ndiffuse,0.5,40\n0,0.7,60\n"
    values = sphere_csv.read(table, "a.csv").sphere_values
    assert np.isnan(values[0].theta_deg)
    assert values[0].bands == ("visible", "solar")
    np.testing.assert_allclose(values[1].values, [0.7, 0.6])


def test_tables_come_back():
    given = [
        SphereValues(
            "film, white",
            "interior",
            "reflection",
            60.0,
            [0.123456789, -0.001],
            "diffuse",
            [300.0, 300.5],
            phi_deg=90.0,
        ),
        SphereValues('a "fabric"', "exterior", "transmission", np.nan, [0.5], bands=("solar",), standard_errors=[0.01]),
    ]
    given = [replace(v, conditions={"lamp": "halogen", "port_mm": "25"}) for v in given]
    data = sphere_csv.write_spheres(given)
    assert sphere_csv.recognises(data, "a.csv")
    back = sphere_csv.read(data, "a.csv").sphere_values
    assert len(back) == 2
    for one, other in zip(given, back, strict=True):
        for key in ("sample", "incident_side", "scatter", "collected", "bands", "phi_deg", "conditions"):
            assert getattr(one, key) == getattr(other, key)
        for key in ("theta_deg", "values", "wavelength_nm", "standard_errors"):
            if getattr(one, key) is None:
                assert getattr(other, key) is None
            else:
                np.testing.assert_allclose(getattr(other, key), getattr(one, key), rtol=1e-9)
    assert sphere_csv.write_spheres(back) == data
    with pytest.raises(ClerestoryError, match="no sphere values"):
        sphere_csv.write_spheres([])


def pair(**changes):
    waves = np.array([400.0, 500.0, 600.0])
    total = SphereValues(
        "film", "exterior", "transmission", 8.0, [0.5, 0.6, 0.7], wavelength_nm=waves, standard_errors=[0.003] * 3
    )
    diffuse = SphereValues(
        "film", "exterior", "transmission", 8.0, [0.2, 0.3], "diffuse", waves[[0, 2]], standard_errors=[0.004] * 2
    )
    return replace(total, **changes), replace(diffuse, **changes)


def test_direct_is_what_is_left_of_all_light():
    direct = direct_values(*pair())
    np.testing.assert_allclose(direct.values.values, [0.3, 0.35, 0.4])
    np.testing.assert_allclose(direct.values.standard_errors, 0.005)
    assert (direct.values.collected, direct.warnings) == ("direct", ())
    total, diffuse = pair()
    outside = replace(diffuse, wavelength_nm=[450.0, 550.0])
    np.testing.assert_array_equal(direct_values(total, outside).values.wavelength_nm, [500.0])


def test_doubts_are_said():
    total, diffuse = pair()
    negative = direct_values(total, replace(diffuse, values=[0.52, 0.3]))
    assert "negative at 400 nm, down to -0.0200" in negative.warnings[0]
    # Within its noise it is no doubt.
    assert direct_values(total, replace(diffuse, values=[0.505, 0.3])).warnings == ()
    thick = {"thickness_mm": "6", "spot_mm": "10", "port_mm": "25"}
    lost = direct_values(*pair(conditions=thick))
    assert "lost sideways: 7.5 mm" in lost.warnings[0]
    assert direct_values(*pair(conditions=thick | {"port_mm": "60"})).warnings == ()
    clear = replace(pair(conditions=thick)[1], values=[0.01, 0.01])
    assert direct_values(pair(conditions=thick)[0], clear).warnings == ()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"sample": "other"}, "sample of"),
        ({"scatter": "reflection"}, "scatter of"),
        ({"theta_deg": 60.0}, "one angle"),
        ({"collected": "direct"}, "hemispherical and diffuse"),
        ({"wavelength_nm": [700.0, 800.0]}, "in common"),
    ],
)
def test_what_does_not_belong_together_gives_no_difference(changes, message):
    total, diffuse = pair()
    with pytest.raises(ClerestoryError, match=message):
        direct_values(total, replace(diffuse, **changes))


def test_pairs_find_each_other_in_a_file():
    values = sphere_csv.read(files.SPHERES, "long.csv").sphere_values
    (found,) = direct_of_pairs(values)
    np.testing.assert_allclose(found.values.values, [0.3, 0.35])
    assert direct_of_pairs([*values, found.values]) == []


def test_every_product_loads():
    root = sample_root()
    if root is None:
        pytest.skip(ABSENT)
    for path in sorted((root / "glazing/products").iterdir()):
        module = product_json if path.suffix == ".json" else igdb_dat
        data = path.read_bytes()
        assert module.recognises(data, path.name)
        assert module.read(data, path.name).sphere_values
    # The same pane in three formats.
    of = {
        name: (product_json if name.endswith("json") else igdb_dat)
        .read((root / "glazing/products" / name).read_bytes(), name)
        .sphere_values
        for name in ("CLEAR_3.DAT", "igsdb_v1_clear_3.json", "igsdb_v2_clear_3.json")
    }
    assert {v.sample for values in of.values() for v in values} == {"Generic Clear Glass (NFRC 102)"}
    spectra = [pick(v, incident_side="exterior", scatter="transmission") for v in of.values()]
    for other in spectra[1:]:
        np.testing.assert_allclose(other.values, spectra[0].values, atol=1e-6)
        np.testing.assert_allclose(other.wavelength_nm, spectra[0].wavelength_nm, atol=1e-3)
