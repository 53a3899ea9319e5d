"""Text of BSDF laboratories: what each variant of a file means, and what is written is read."""

import gzip
import hashlib
import re

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings

from clerestory import ClerestoryError, FileFormatError, measure
from clerestory.directions import angles
from clerestory.measure import Measurement, Scan
from clerestory.measure.files import writable_formats
from measured import apart_deg, measurements, mountain_points, mountain_text, peak_of, scans, unit

TEXT = ("mountain", "iea21", "astm", "table")


def read_text(tmp_path, text, name="file.txt", **choices):
    path = tmp_path / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return measure.read(path, **choices)


def only(contents):
    (measurement,) = contents.measurements
    (scan,) = measurement.scans
    return scan


ROW = "10 20 0.5\n"
HEAD = "#format: theta phi BSDF\n#intheta 30\n#inphi 40\n"


# pab Mountain


def test_front_is_the_exterior_and_azimuths_are_seen_from_there(tmp_path):
    """Seen from outside, up is #upphi and azimuths run counter-clockwise: mirrored left to right for the room."""
    text = "#format: theta phi BSDF\n#intheta 30\n#inphi 90\n#upphi 90\n150 270 1\n170 0 0.5\n"
    scan = only(read_text(tmp_path, text))
    assert (scan.incident_side, scan.scatter) == ("exterior", "transmission")
    assert (scan.incident_theta_deg, scan.incident_phi_deg) == (30.0, 90.0)
    np.testing.assert_allclose(scan.theta_deg, [30.0, 10.0])
    np.testing.assert_allclose(scan.phi_deg, [270.0, 180.0])
    # Straight transmission keeps the line.
    np.testing.assert_allclose(scan.outgoing[0], -scan.incident, atol=1e-12)
    assert "front is the exterior" in scan.source.convention
    inside = only(read_text(tmp_path, text, front="interior"))
    assert (inside.incident_side, inside.incident_phi_deg) == ("interior", 90.0)
    np.testing.assert_allclose(inside.phi_deg, [270.0, 0.0])


@pytest.mark.parametrize("front", ["exterior", "interior"])
@pytest.mark.parametrize("up", [0, 90, 217])
@pytest.mark.parametrize("transmitted", [True, False])
def test_a_peak_stands_where_the_sample_sends_it(tmp_path, front, up, transmitted):
    """A prism that throws light to the right as seen from its front, told in azimuths that count from anywhere."""
    points = mountain_points(30.0, 20.0, transmitted=transmitted)
    points[:, 1] += up - 90.0
    scan = only(read_text(tmp_path, mountain_text(points, 30, 20 + up - 90, up=up), front=front))
    turn = np.array([1.0, 1.0, 1.0]) if front == "interior" else np.array([-1.0, 1.0, -1.0])
    np.testing.assert_allclose(scan.incident, turn * unit(30.0, 20.0), atol=1e-6)
    brightest = scan.outgoing[np.argmax(scan.values[:, 0])]
    assert np.degrees(np.arccos(brightest @ (turn * peak_of(30.0, 20.0, transmitted=transmitted)))) < 3.0
    assert scan.quantity == "dsf"
    assert scan.scatter == ("transmission" if transmitted else "reflection")


@pytest.mark.parametrize(("word", "quantity"), [("DSF", "dsf"), ("BSDF", "bsdf"), ("BRDF", "bsdf"), ("btdf", "bsdf")])
def test_words_of_the_format(tmp_path, word, quantity):
    scan = only(read_text(tmp_path, f"#intheta 0\n#inphi 0\n#format: theta\tphi\t{word}\n{ROW}"))
    assert scan.quantity == quantity


def test_both_ways_to_give_the_incident_angle(tmp_path):
    a = only(read_text(tmp_path, HEAD + ROW))
    b = only(read_text(tmp_path, f"#incident_angle\t30\t40\n#format: theta phi BSDF\n{ROW}"))
    assert (a.incident_theta_deg, a.incident_phi_deg) == (b.incident_theta_deg, b.incident_phi_deg)


def test_colour_and_header_lines_are_kept(tmp_path):
    text = f"#lamp: halogen\n#colorimetry: CIE-XYZ\n{HEAD}10 20 1 2 3\n"
    scan = only(read_text(tmp_path, text))
    assert scan.channels == ("X", "Y", "Z")
    np.testing.assert_array_equal(scan.values, [[1.0, 2.0, 3.0]])
    assert scan.conditions["lamp"] == "halogen"
    assert scan.source.header == tuple(text.splitlines()[:-1])
    assert scan.source.sha256 == hashlib.sha256(text.encode()).hexdigest()


def test_angles_are_wrapped(tmp_path):
    """Negative polar angles lie at the opposite azimuth, as an in-plane scan writes them."""
    scan = only(
        read_text(tmp_path, "#format: theta phi BSDF\n#intheta -20\n#inphi 90\n#upphi 90\n-30 90 1\n30 450 2\n")
    )
    np.testing.assert_allclose(scan.incident, [0.0, -np.sin(np.radians(20)), -np.cos(np.radians(20))], atol=1e-12)
    np.testing.assert_allclose(scan.theta_deg, [30.0, 30.0])
    np.testing.assert_allclose(scan.phi_deg, [270.0, 90.0])


def test_several_directions_and_both_sides_in_one_file(tmp_path):
    text = f"{HEAD}10 0 1\n# between\n20 0 2\n100 0 3\n#intheta 50\n30 0 4\n"
    (measurement,) = read_text(tmp_path, text).measurements
    shown = [(s.incident_theta_deg, s.scatter, s.values[:, 0].tolist()) for s in measurement.scans]
    assert shown == [(30.0, "reflection", [1.0, 2.0]), (30.0, "transmission", [3.0]), (50.0, "reflection", [4.0])]
    assert "#intheta 50" in measurement.scans[2].source.header
    assert "# between" in measurement.scans[0].source.header


def test_transmission_below_90_is_understood_when_it_is_said(tmp_path):
    scan = only(read_text(tmp_path, HEAD + ROW, scatter="transmission"))
    assert scan.scatter == "transmission"
    assert scan.theta_deg == [10.0]
    assert "side that it leaves to" in scan.source.convention


def test_light_on_the_back(tmp_path):
    scan = only(read_text(tmp_path, HEAD.replace("30", "150") + ROW))
    assert (scan.incident_side, scan.scatter, scan.incident_theta_deg) == ("interior", "transmission", 30.0)
    scan = only(read_text(tmp_path, HEAD.replace("30", "150") + ROW, side="exterior"))
    assert (scan.incident_side, scan.side) == ("exterior", "interior")


# IEA Task 21


def iea_text(theta_1=30, phi_1=0, head="", body="", kind="BTDF"):
    return f"# Sample: twill\n# theta_1: {theta_1}\n# phi_1 = {phi_1}\n{head}# phi_2 theta_2 {kind}\n{body}"


def grid_of_a_diffuser(step, value):
    rings = [(p, 180.0 - t, value) for t in range(0, 91, step) for p in range(0, 360, step)]
    return "\n".join(f"{p} {t} {v}" for p, t, v in rings)


@pytest.mark.parametrize("step", [5, 2])
def test_grids_come_to_the_stated_transmittance(tmp_path, step):
    body = grid_of_a_diffuser(step, 0.5 / np.pi)
    contents = read_text(tmp_path, iea_text(head="# hemispherical transmittance: 0.5\n# isym: 4\n", body=body))
    scan = only(contents)
    assert contents.warnings == ()
    assert contents.measurements[0].sample == "twill"
    assert scan.conditions["hemispherical"] == "0.5"
    assert scan.conditions["symmetry"].startswith("isym 4")
    wrong = read_text(tmp_path, iea_text(head="# hemispherical transmittance: 43 %\n", body=body))
    assert re.search("come to a hemispherical value of 0.(49|5).*, and the file states 0.43", wrong.warnings[0])
    few = read_text(
        tmp_path, iea_text(head="# hemispherical transmittance: 0.5\n", body="0 180 1\n0 175 1\n90 175 1\n")
    )
    assert "do not span enough" in few.warnings[0]


@pytest.mark.parametrize("pair", ["{}: {}", "{} = {}", "{} {}", "{}:{} deg"])
@pytest.mark.parametrize("names", [("theta_1", "phi_1"), ("Theta1", "Phi1"), ("theta_i", "phi_i"), ("θ₁", "φ₁")])
def test_headers_of_any_kind(tmp_path, pair, names):
    text = f"# {pair.format(names[0], 36)}\n# {pair.format(names[1], 20)}\n# theta_2 phi_2 BTDF\n120 0 1\n"
    scan = only(read_text(tmp_path, text))
    assert (scan.incident_theta_deg, scan.incident_phi_deg) == (36.0, 160.0)
    assert (scan.theta_deg[0], scan.phi_deg[0]) == (60.0, 180.0)


def test_straight_light_stays_on_the_line_whichever_way_theta_is_counted(tmp_path):
    for theta in (150, 30):
        scan = only(read_text(tmp_path, iea_text(30, 70, body=f"250 {theta} 1\n")))
        np.testing.assert_allclose(scan.outgoing[0], -scan.incident, atol=1e-12)
    mirrored = only(read_text(tmp_path, iea_text(30, 70, body="250 30 1\n", kind="BRDF")))
    np.testing.assert_allclose(mirrored.outgoing[0], mirrored.incident * [-1, -1, 1], atol=1e-12)


def test_columns_that_are_not_named_are_guessed_and_said(tmp_path):
    head = "# BTDF\n# theta_1: 30\n# phi_1: 0\n"
    usual = read_text(tmp_path, head + "200 150 1\n")
    swapped = read_text(tmp_path, head + "150 200 1\n")
    for contents in (usual, swapped):
        assert only(contents).theta_deg == [30.0]
        assert "does not name the columns" in contents.warnings[0]


# ASTM E2387


def astm_text(vars_="value", rows="0.5,0,0.5,3.14159265358979,0.25\n", head=""):
    return f"TYPE BRDF\nSAMPLE_ID plate\nLAMBDA 633\n{head}VARS theta_i,phi_i,theta_s,phi_s,{vars_}\n{rows}"


def test_radians_and_the_mirrored_direction(tmp_path):
    contents = read_text(tmp_path, astm_text())
    scan = only(contents)
    assert contents.measurements[0].sample == "plate"
    assert scan.conditions["wavelength_nm"] == "633"
    np.testing.assert_allclose(scan.outgoing[0], scan.incident * [-1, -1, 1], atol=1e-12)
    assert "radians" in scan.source.convention
    assert "assumed" in scan.source.convention


@pytest.mark.parametrize(
    ("vars_", "channels"),
    [("R,G,B", ("R", "G", "B")), ("X,Y,Z", ("X", "Y", "Z")), ("450nm,550nm,650nm", ("450 nm", "550 nm", "650 nm"))],
)
def test_columns_of_colour(tmp_path, vars_, channels):
    scan = only(read_text(tmp_path, astm_text(vars_, "0.5,0,0.5,-1,1,2,3\n")))
    assert scan.channels == channels
    assert scan.values.tolist() == [[1.0, 2.0, 3.0]]


def test_one_column_without_a_name_and_values_with_the_cosine(tmp_path):
    text = astm_text(head="QUANTITY COSINE_CORRECTED_BSDF\n").replace(",value", "")
    assert only(read_text(tmp_path, text)).quantity == "dsf"


def test_degrees_where_radians_should_be(tmp_path):
    contents = read_text(tmp_path, astm_text(rows="30,0,45,180,0.25\n"))
    assert only(contents).theta_deg == [45.0]
    assert "taken for degrees" in contents.warnings[0]


def test_rows_of_directions_in_any_order(tmp_path):
    rows = "0.5,0,0.1,0,1\n0.6,0,0.1,0,2\n0.5,0,0.2,0,3\n"
    (measurement,) = read_text(tmp_path, astm_text(rows=rows)).measurements
    assert [scan.values[:, 0].tolist() for scan in measurement.scans] == [[1.0, 3.0], [2.0]]


def test_announced_points_are_counted(tmp_path):
    with pytest.raises(FileFormatError, match=r"file.txt: line \d+: 1 rows, and NUM_POINTS announces 2 \("):
        read_text(tmp_path, astm_text(head="NUM_POINTS 2\n"))


# CSV


def test_columns_of_the_virtual_goniophotometer(tmp_path):
    """What `clerestory trace --scan` writes: bands become channels, beams and totals values of spheres."""
    rows = [
        "visible,exterior,30,90,transmission,bsdf,10,0,0.1,0.001",
        "visible,exterior,30,90,transmission,bsdf,20,0,0.2,0.002",
        "visible,exterior,30,90,transmission,beam,,,0.3,",
        "visible,exterior,30,90,transmission,total,,,0.5,0.01",
        "solar,exterior,30,90,transmission,bsdf,10,0,0.3,0.003",
        "solar,exterior,30,90,transmission,bsdf,20,0,0.4,0.004",
    ]
    from clerestory.trace.export import SCAN_COLUMNS

    contents = read_text(tmp_path, "\n".join([",".join(SCAN_COLUMNS), *rows]))
    scan = only(contents)
    assert scan.channels == ("visible", "solar")
    assert scan.values.tolist() == [[0.1, 0.3], [0.2, 0.4]]
    assert scan.standard_errors.tolist() == [[0.001, 0.003], [0.002, 0.004]]
    assert [(v.collected, v.values.tolist(), v.bands) for v in contents.sphere_values] == [
        ("direct", [0.3], ("visible",)),
        ("hemispherical", [0.5], ("visible",)),
    ]


def test_what_the_virtual_goniophotometer_writes(tmp_path):
    from clerestory.basis import Basis
    from clerestory.trace.export import scan_table
    from clerestory.trace.instrument import Seen

    basis = Basis.named("klems-quarter")
    count = len(basis)
    incident = np.array([0.0, 0.5, -np.sqrt(0.75)])
    seen = [
        Seen(
            "visible", incident, "transmission", np.arange(count) / 50.0, np.full(count, 0.01), (0.1, 0.0), (0.4, 0.01)
        )
    ]
    scan = only(read_text(tmp_path, scan_table(seen, basis)))
    np.testing.assert_allclose(scan.incident, incident, atol=1e-6)
    np.testing.assert_allclose(scan.outgoing, basis.outgoing_centres("interior"), atol=1e-5)
    np.testing.assert_allclose(scan.values[:, 0], seen[0].values)


def test_names_that_a_person_gives(tmp_path):
    text = 'Winkel;Azimut [rad];Wert;Notiz\n10;1.5;0.5;"a;b"\n20;1.5;0.25;\n'
    given = {"theta_o": "Winkel", "phi_o": "Azimut [rad]", "value": "Wert"}
    light = {"side": "interior", "scatter": "reflection", "incident_theta_deg": 8.0, "incident_phi_deg": 0.0}
    contents = read_text(tmp_path, text, columns=given, **light)
    scan = only(contents)
    np.testing.assert_allclose(scan.phi_deg, np.degrees([1.5, 1.5]))
    assert (scan.incident_side, scan.values[:, 0].tolist()) == ("interior", [0.5, 0.25])
    assert contents.warnings == ("file.txt: column 'Notiz' is not known and left out",)
    with pytest.raises(ClerestoryError, match="no column 'Weert' \\(it has: Winkel"):
        read_text(tmp_path, text, columns={**given, "value": "Weert"}, **light)


def test_front_and_back_of_a_table(tmp_path):
    text = "side,scatter,theta_i,phi_i,theta_o,phi_o,value\nback,T,0,0,10,0,1\n"
    assert only(read_text(tmp_path, text)).incident_side == "interior"
    assert only(read_text(tmp_path, text, front="interior")).incident_side == "exterior"


# What is written is read


def unescaped(conditions):
    """Keys that mean something else in ASTM's tables are marked there."""
    return {key.removeprefix("CONDITION_"): value for key, value in conditions.items()}


def _order(scan):
    light = (
        scan.incident_side,
        scan.scatter,
        round(scan.incident_theta_deg, 9),
        round(scan.incident_phi_deg, 9) % 360.0,
    )
    what = (scan.channels, scan.quantity, scan.purpose, sorted(scan.conditions.items()))
    return (*light, *what, scan.values.tolist(), np.round(scan.outgoing, 6).tolist())


def assert_same(scan, again):
    assert (again.incident_side, again.scatter, again.quantity, again.purpose) == (
        scan.incident_side,
        scan.scatter,
        scan.quantity,
        scan.purpose,
    )
    np.testing.assert_allclose(again.incident, scan.incident, atol=1e-9)
    np.testing.assert_allclose(again.outgoing, scan.outgoing, atol=1e-9)


@pytest.mark.parametrize("kind", TEXT)
@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(measurement=measurements())
def test_write_then_read_gives_the_same_points(tmp_path_factory, kind, measurement):
    folder = tmp_path_factory.mktemp("out")
    written = measure.write(measurement, folder, kind)
    (again,) = measure.read(folder).measurements
    assert again.sample == " ".join(measurement.sample.split())
    assert len(written.paths) >= 1
    assert written.notes == ()
    # Channels may have files of their own.
    left = [(scan, k) for scan in again.scans for k in range(len(scan.channels))]
    for scan in measurement.scans:
        for k, channel in enumerate(scan.channels):
            found = next(
                (
                    (other, j)
                    for other, j in left
                    if other.channels[j] == channel
                    and np.array_equal(other.values[:, j], scan.values[:, k])
                    and (other.incident_side, other.scatter) == (scan.incident_side, scan.scatter)
                    and other.incident @ scan.incident > 1.0 - 1e-12
                    and (other.quantity, other.purpose) == (scan.quantity, scan.purpose)
                    and np.allclose(other.outgoing, scan.outgoing, atol=1e-9)
                    and unescaped(other.conditions) == dict(scan.conditions)
                ),
                None,
            )
            assert found is not None, (scan, [s for s, _ in left])
            left = [pair for pair in left if pair[0] is not found[0] or pair[1] != found[1]]
    assert not left


@pytest.mark.parametrize("kind", TEXT)
@settings(max_examples=15, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(measurement=measurements())
def test_reading_writing_and_reading_loses_nothing(tmp_path_factory, kind, measurement):
    first, second = tmp_path_factory.mktemp("first"), tmp_path_factory.mktemp("second")
    measure.write(measurement, first, kind)
    (a,) = measure.read(first).measurements
    measure.write(a, second, kind)
    (b,) = measure.read(second).measurements
    assert len(a.scans) == len(b.scans)
    assert a.sample == b.sample
    # Files of single channels are named otherwise than those of a scan with several, and come in another order.
    for one, two in zip(sorted(a.scans, key=_order), sorted(b.scans, key=_order), strict=True):
        assert_same(one, two)
        assert one.channels == two.channels
        assert dict(one.conditions) == dict(two.conditions)
        np.testing.assert_array_equal(one.values, two.values)


@settings(max_examples=20, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(scan=scans(quantities=("signal", "bsdf"), errors=True))
def test_csv_holds_signals_and_standard_errors(tmp_path_factory, scan):
    folder = tmp_path_factory.mktemp("csv")
    measure.write(Measurement("s", (scan,)), folder / "all.csv", "table")
    again = only(measure.read(folder))
    assert_same(scan, again)
    if scan.standard_errors is None:
        assert again.standard_errors is None
    else:
        np.testing.assert_array_equal(again.standard_errors, scan.standard_errors)


def one_scan(**kinds):
    return Scan("exterior", "reflection", 10.0, 0.0, [10.0], [0.0], [[0.1]], **kinds)


@pytest.mark.parametrize("kind", ["mountain", "iea21", "astm"])
def test_what_a_format_cannot_hold_is_refused_or_said(tmp_path, kind):
    with pytest.raises(ClerestoryError, match="not a detector's signal"):
        measure.write(Measurement("s", (one_scan(quantity="signal"),)), tmp_path / "a", kind)
    assert not (tmp_path / "a").exists() or not list((tmp_path / "a").iterdir())
    written = measure.write(Measurement("s", (one_scan(standard_errors=[[0.1]]),)), tmp_path / "b", kind)
    assert "standard errors of 1 scan are left out" in written.notes[0]


def test_several_files_do_not_get_one_name(tmp_path):
    two = Measurement("s", (one_scan(), one_scan()))
    with pytest.raises(ClerestoryError, match="makes 2 files"):
        measure.write(two, tmp_path / "one.txt", "mountain")
    written = measure.write(two, tmp_path / "folder", "mountain")
    assert [path.name for path in written.paths] == [
        "s_exterior_reflection_t10_p000.txt",
        "s_exterior_reflection_t10_p000-2.txt",
    ]
    with pytest.raises(ClerestoryError, match="'excel' cannot be written \\(there are: "):
        measure.write(two, tmp_path, "excel")
    assert {"mountain", "iea21", "astm", "table"} <= set(writable_formats())


def test_nothing_is_left_of_a_set_that_cannot_be_written(tmp_path):
    (tmp_path / "s_exterior_reflection_t10_p000-2.txt").mkdir()
    with pytest.raises(IsADirectoryError):
        measure.write(Measurement("s", (one_scan(), one_scan())), tmp_path, "mountain")
    assert [path.name for path in tmp_path.iterdir()] == ["s_exterior_reflection_t10_p000-2.txt"]


# Folders, packed files and odd encodings


def test_a_folder_of_mixed_files_is_one_import(tmp_path):
    (tmp_path / "a").mkdir()
    (tmp_path / ".hidden").write_text("no")
    (tmp_path / "a" / "x.dat").write_text('#sample_name "twill"\n' + HEAD + ROW)
    (tmp_path / "y.bin").write_bytes(gzip.compress(iea_text(body="0 120 1\n").encode()))
    (tmp_path / "photo.jpg").write_bytes(bytes(range(256)) * 10)
    (tmp_path / "notes.txt").write_text("measured on a rainy day\n")
    contents = measure.read(tmp_path)
    (measurement,) = contents.measurements
    assert measurement.sample == "twill"
    assert len(measurement) == 2
    assert contents.warnings == tuple(
        f"{name}: no format of measurements is recognised; left out" for name in ("notes.txt", "photo.jpg")
    )
    (packed,) = (scan.source for scan in measurement.scans if scan.source.format == "IEA Task 21")
    assert packed.sha256 == hashlib.sha256((tmp_path / "y.bin").read_bytes()).hexdigest()
    with pytest.raises(FileFormatError, match=r"notes\.txt: no format"):
        measure.read(tmp_path, strict=True)
    assert measure.read([tmp_path / "a", tmp_path / "y.bin"], sample="other").measurements[0].sample == "other"


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "utf-16-be", "cp1252"])
def test_encodings_and_line_ends(tmp_path, encoding):
    mark = b"\xfe\xff" if encoding == "utf-16-be" else b""
    expected = only(read_text(tmp_path, f"#operator: Müller\n{HEAD}{ROW}"))
    for end in ("\r\n", "\r"):
        text = f"#operator: Müller\n{HEAD}{ROW}".replace("\n", end)
        scan = only(read_text(tmp_path, mark + text.encode(encoding)))
        assert scan.conditions["operator"] == "Müller"
        np.testing.assert_array_equal(scan.values, expected.values)
        assert apart_deg(scan.phi_deg, expected.phi_deg).max() == 0.0
        assert angles(scan.incident)[0] == pytest.approx(30.0)
