"""CSV tables whose columns are called otherwise: what is said of them, and names that a person gives."""

import numpy as np
import pytest

from clerestory import ClerestoryError
from clerestory.measure import read
from clerestory.measure.formats import UnknownFormatError

SPHERE = "angle,wavelenght,T\n8,500,0.3\n8,600,0.4\n"
UNITS = "Winkel;Wl. (µm);T [%];Bemerkung\n8;0.5;30;gut\n8;0.6;40;\n"
POINTS = "theta_i,phi_i,theta_o,phi_o,wert\n0,0,10,0,0.3\n0,0,20,0,0.2\n"
KNOWN = POINTS.replace("wert", "value")


def put(folder, text, name="t.csv"):
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (SPHERE, "a table of angle, wavelenght, T, of which 'wavelenght' is not known: values of a sphere need"
         " wavelength or band, and T, R or value (name what is called otherwise, such as --column"
         " wavelength=wavelenght)"),
        (UNITS, "of which 'Winkel', 'Bemerkung' are not known (name what counts, such as --column theta=Winkel; other"),
        ("angle,T\n8,0.3\n", "a table of angle, T: values of a sphere need wavelength or band, and T, R or value (add"
         " what is missing: wavelength)"),
        ("angle,wavelength,share of T\n8,500,0.1\n", "such as --column value='share of T')"),
        (POINTS, "of which 'wert' is not known: points need theta_o and value (name what is called otherwise, such as"
         " --column value=wert)"),
        (POINTS.replace("theta_o", "theta_out_").replace("wert", "bsdf"), "such as --column theta_o=theta_out_)"),
        (POINTS.replace(",", " "), "'wert' is not known: points need theta_o and value"),
        ("# made by hand\nu1,u2,u3\n1,2,3\n", "a table of u1, u2, u3, whose columns are not known: points need theta_o"
         " and value, values of a sphere need wavelength or band, and T, R or value (name those"),
        ("a note,of some words\nthat follow,and more\n", "no format of measurements is recognised (docs/"),
        ("This is a note\nof some words here\n", "no format of measurements is recognised (docs/"),
        ("1,2,3\n4,5,6\n", "no format of measurements is recognised (docs/"),
    ],
)  # fmt: skip
def test_what_is_said_of_unknown_columns(tmp_path, text, told):
    with pytest.raises(UnknownFormatError) as raised:
        read(put(tmp_path, text), scatter="transmission")
    assert told in str(raised.value)
    assert "\n" not in str(raised.value)


def test_the_remedy_that_is_named_mends_it(tmp_path):
    (values,) = read(put(tmp_path, SPHERE), columns={"wavelength": "wavelenght"}).sphere_values
    assert (values.theta_deg, values.wavelength_nm.tolist()) == (8.0, [500.0, 600.0])
    assert values.values.tolist() == [0.3, 0.4]
    found = read(put(tmp_path, POINTS), columns={"value": "wert"}, scatter="transmission")
    assert found.measurements[0].scans[0].values[:, 0].tolist() == [0.3, 0.2]


def test_a_header_keeps_its_unit_and_the_others_are_left_out(tmp_path):
    contents = read(put(tmp_path, UNITS), columns={"theta": "Winkel", "wavelength": "Wl. (µm)"})
    (values,) = contents.sphere_values
    assert values.theta_deg == 8.0
    np.testing.assert_allclose(values.wavelength_nm, [500.0, 600.0])
    np.testing.assert_allclose(values.values, [0.3, 0.4])
    assert contents.warnings == ("t.csv: column 'Bemerkung' is not known and left out",)
    (named,) = read(put(tmp_path, UNITS), columns={"Rb diffuse": "T [%]", "theta": "Winkel"}).sphere_values
    assert (named.scatter, named.collected, named.incident_side) == ("reflection", "diffuse", "interior")
    np.testing.assert_allclose(named.values, [0.3, 0.4])


def test_a_name_tells_which_kind_of_table_it_is(tmp_path):
    """θ, a name that is not known and a value are points, unless a person says that there are wavelengths."""
    path = put(tmp_path, "theta,wavelenght,value\n8,500,0.3\n8,600,0.4\n")
    with pytest.raises(ClerestoryError, match=r"no column gives theta_i, .* \(name it: --column theta_i="):
        read(path, scatter="transmission")
    (values,) = read(path, scatter="transmission", columns={"wavelength": "wavelenght"}).sphere_values
    assert values.theta_deg == 8.0


def test_files_of_a_folder_are_not_touched_by_what_is_said_of_another(tmp_path):
    put(tmp_path, SPHERE, "sphere.csv")
    put(tmp_path, KNOWN, "points.csv")
    put(tmp_path, "angle,wavelength,T\n8,500,0.5\n", "known.csv")
    put(tmp_path, "words that are no table\n", "readme.txt")
    contents = read(tmp_path, scatter="transmission", columns={"wavelength": "wavelenght"})
    assert [values.sample for values in contents.sphere_values] == ["known", "sphere"]
    assert [len(m.scans) for m in contents.measurements] == [1]
    assert contents.warnings == (
        "known.csv: there is no column 'wavelenght' (it has: angle, wavelength, T)",
        "readme.txt: no format of measurements is recognised; left out",
    )


@pytest.mark.parametrize(
    ("columns", "told"),
    [
        ({"wavelength": "wavelenghth"}, "columns: the file has no column 'wavelenghth' (it has: angle, wavelenght, T)"),
        ({"wavelengt": "wavelenght"}, "columns: 'wavelengt' of 'wavelenght' is not known (points: theta_i, "),
        ({"theta_o": "wavelenght"}, "of which 'wavelenght' is not known"),
        ({"wavelength": "wavelenght", "wl": "T"}, "(add what is missing: value)"),
        ("wavelength", "columns is not a table of names"),
    ],
)
def test_wrong_names(tmp_path, columns, told):
    with pytest.raises(ClerestoryError) as raised:
        read(put(tmp_path, SPHERE), columns=columns)
    assert told in str(raised.value), str(raised.value)


def test_what_only_spheres_have_is_nothing_of_points(tmp_path):
    with pytest.raises(ClerestoryError, match=r"columns: 'collected' is not known \(theta_i, phi_i"):
        read(put(tmp_path, KNOWN), scatter="transmission", columns={"collected": "phi_o"})
