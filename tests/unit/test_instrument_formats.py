"""Files of optics programs and instruments, and where their values lie in the sample's frame."""

import gzip
from importlib import import_module

import numpy as np
import pytest

import instrument_files as files
from clerestory._core import ClerestoryError, FileFormatError
from clerestory.integrals import continued
from clerestory.measure.formats import FORMATS, UnknownFormatError, all_formats
from samples import ABSENT, sample_root


def read(kind, data=None, name=None, **choices):
    name = name or next(iter(files.GOLDEN[kind]))
    return import_module(f"clerestory.measure.formats.{kind}").read(data or files.GOLDEN[kind][name], name, **choices)


def only(contents):
    (measurement,) = contents.measurements
    return measurement


def at(scan, theta_deg, phi_deg, channel=0):
    """The one value of a scan in a direction of the sample's frame."""
    near = np.isclose(scan.theta_deg, theta_deg, atol=1e-6)
    turned = (scan.phi_deg - phi_deg + 180.0) % 360.0 - 180.0
    near &= np.isclose(turned, 0.0, atol=1e-6) | (scan.theta_deg < 1e-9)
    (value,) = scan.values[near, channel]
    return value


@pytest.mark.parametrize(("kind", "name"), [(kind, name) for kind, many in files.GOLDEN.items() for name in many])
def test_each_format_recognises_its_own_files_alone(kind, name):
    data = files.GOLDEN[kind][name]
    known = [f.__name__.rsplit(".", 1)[1] for f in all_formats() if f.recognises(data, name)]
    assert known == [kind]


@pytest.mark.parametrize(("kind", "name"), [(kind, name) for kind, many in files.GOLDEN.items() for name in many])
def test_every_file_keeps_where_it_came_from(kind, name):
    contents = read(kind, name=name)
    parts = [scan for m in contents.measurements for scan in m.scans] + list(contents.sphere_values)
    assert parts
    for part in parts:
        assert part.source.name == name
        assert len(part.source.sha256) == 64
        assert part.source.format == import_module(f"clerestory.measure.formats.{kind}").NAME
        assert part.source.header
        assert part.source.convention


def test_zemax_angles_are_about_the_specular_direction():
    at_normal, slanted = only(read("zemax")).scans
    assert (slanted.incident_side, slanted.scatter, slanted.channels) == ("exterior", "reflection", ("650 nm",))
    assert (slanted.incident_theta_deg, slanted.incident_phi_deg) == (30.0, 90.0)
    assert slanted.conditions["hemispherical"] == "0.1"
    assert slanted.conditions["symmetry"].startswith("PlaneSymmetrical")
    # Light from above is mirrored downward; azimuth 0 leads from there to the normal and beyond, up again.
    assert at(slanted, 30.0, 270.0) == files.zemax_value(30, 0, 0)
    assert at(slanted, 20.0, 270.0) == files.zemax_value(30, 0, 1)
    assert at(slanted, 40.0, 90.0) == files.zemax_value(30, 0, 2)
    assert at(slanted, 40.0, 270.0) == files.zemax_value(30, 2, 1)
    # 70° beyond 30° lies below the horizon; the pole counts once.
    assert len(slanted) == 1 + 3 + 2
    # Counter-clockwise against the light: from outside, looking down along it, azimuth 90° is to the right, -x.
    sideways = slanted.values[:, 0] == files.zemax_value(30, 1, 1)
    (across,) = slanted.outgoing[sideways]
    mirrored = np.array([0.0, -0.5, -np.sqrt(0.75)])
    toward_normal = np.array([0.0, np.sqrt(0.75), -0.5])
    expected = np.cos(np.radians(10.0)) * mirrored + np.sin(np.radians(10.0)) * np.cross(mirrored, toward_normal)
    np.testing.assert_allclose(across, expected, atol=1e-12)
    # At the normal azimuth 0 points to where the light tilts to, above.
    assert at(at_normal, 10.0, 90.0) == files.zemax_value(0, 0, 1)


def test_zemax_transmission_goes_straight_on_and_has_colours():
    scan = only(read("zemax", name="b.bsdf", side="interior")).scans[1]
    assert (scan.incident_side, scan.scatter, scan.side) == ("interior", "transmission", "exterior")
    assert scan.channels == ("X", "Y", "Z")
    assert at(scan, 30.0, 270.0, 2) == files.zemax_value(30, 0, 0, 2)
    assert scan.conditions["hemispherical"] == "0.2"
    assert "thin sheet" in scan.source.convention


def test_zemax_rotations_of_the_sample_are_azimuths_of_the_light():
    scans = only(read("zemax", name="c.bsdf")).scans
    assert [(s.incident_theta_deg, s.incident_phi_deg) for s in scans] == [(0, 90), (30, 90), (0, 180), (30, 180)]
    # From outside, turning the sample counter-clockwise turns the light clockwise in its frame: to the outside's right.
    np.testing.assert_allclose(scans[3].incident, [-0.5, 0.0, -np.sqrt(0.75)], atol=1e-12)
    assert at(scans[3], 30.0, 0.0) == files.zemax_value(30, 0, 0, turn=1)


def test_lighttools_angles_are_absolute():
    reflected, transmitted = only(read("lighttools")).scans
    assert (reflected.incident_theta_deg, reflected.incident_phi_deg) == (40.0, 90.0)
    assert (reflected.scatter, transmitted.scatter) == ("reflection", "transmission")
    assert reflected.channels == ("550 nm",)
    # Azimuth 0 is the right as seen from outside, our left.
    assert at(reflected, 40.0, 180.0) == 1.0
    assert at(reflected, 40.0, 270.0) == 4.0
    assert at(transmitted, 40.0, 270.0) == 104.0
    assert transmitted.conditions["hemispherical"] == "0.75"
    # The horizon is left out, the pole counts once.
    assert len(reflected) == 5


def test_lighttools_has_sides_colours_and_planes():
    scans = only(read("lighttools", name="m.bsdf")).scans
    assert [(s.incident_side, s.scatter) for s in scans] == [
        ("exterior", "reflection"),
        ("exterior", "transmission"),
        ("interior", "reflection"),
        ("interior", "transmission"),
    ]
    assert scans[0].channels == ("X", "Y", "Z")
    assert scans[0].incident_phi_deg == 45.0
    assert at(scans[2], 40.0, 180.0, 1) == 1011.0
    back = read("lighttools", files.lighttools().replace(b"AOI 40", b"AOI 140"), side="interior")
    assert only(back).scans[0].incident_theta_deg == 40.0
    assert "40° from its normal" in back.warnings[0]
    behind = read("lighttools", files.lighttools().replace(b"0 40 90", b"0 40 140"))
    assert at(only(behind).scans[1], 40.0, 180.0) == 0.0
    assert len(only(behind).scans[0]) == 5


def test_reflet_tables_are_meshes_or_slices():
    bsdf, signal = only(read("reflet")).scans
    assert (bsdf.quantity, bsdf.scatter, signal.quantity, signal.scatter) == (
        "bsdf",
        "reflection",
        "signal",
        "transmission",
    )
    # Positive angles at azimuth -90° are where the mirrored light from above goes, negative ones toward the source.
    assert at(bsdf, 30.0, 270.0) == 4.0
    assert at(bsdf, 30.0, 90.0) == 1.0
    assert at(bsdf, 30.0, 180.0) == 5.0
    assert len(bsdf) == 5
    in_plane = only(read("reflet", name="slice.txt")).scans[0]
    np.testing.assert_array_equal(in_plane.phi_deg, [90.0, 270.0, 270.0])
    assert at(in_plane, 20.0, 270.0) == 0.9
    assert only(read("reflet", quantity="dsf")).scans[1].quantity == "dsf"


def test_jdv_samples_stay_apart():
    left, right = read("jdv").measurements
    assert (left.sample, right.sample) == ("left", "right")
    assert left.scans[0].quantity == "signal"
    assert left.scans[0].incident_theta_deg == 30.0
    assert at(left.scans[0], 30.0, 270.0) == 4.0
    assert at(left.scans[0], 30.0, 0.0) == 2.0
    assert left.scans[0].conditions["date"] == "7/12/2025"


def test_exports_for_speos_give_the_measured_table_only():
    contents = read("speos")
    scan = only(contents).scans[0]
    assert (scan.incident_theta_deg, len(scan)) == (60.0, 5)
    assert at(scan, 30.0, 270.0) == 4.0
    assert "no angle of incidence" in contents.warnings[0]
    said = read("speos", incident_theta_deg=45.0)
    assert (only(said).scans[0].incident_theta_deg, said.warnings) == (45.0, ())
    with pytest.raises(FileFormatError, match="incident_theta_deg"):
        read("speos", files.SPEOS.replace(b"Sample 60", b"no number"))


@pytest.mark.parametrize(("scatter", "kind"), [("reflection", 1), ("transmission", 0), ("transmission", 1)])
def test_speos_own_files_have_the_stated_level_and_straight_light_at_azimuth_0(scatter, kind):
    data = files.speos(scatter, kind=kind)
    scans = only(read("speos_own", data)).scans
    assert [(s.incident_theta_deg, round(s.incident_phi_deg) % 360, s.scatter) for s in scans] == [
        (0.0, 90, scatter),
        (40.0, 90, scatter),
        (0.0, 180, scatter),
        (40.0, 180, scatter),
    ]
    for scan in scans:
        assert scan.channels == ("350 nm", "850 nm")
        bsdf = scan.as_bsdf()
        even = np.median(bsdf.values, axis=0)
        # Light from 0° is even, and half and a quarter of it leave.
        np.testing.assert_allclose(even, [0.5 / np.pi, 0.25 / np.pi], rtol=2e-3)
        if scan.incident_theta_deg:
            brightest = bsdf.outgoing[int(np.argmax(bsdf.values[:, 0]))]
            np.testing.assert_allclose(brightest, continued(scan.incident, scatter), atol=1e-9)
            assert bsdf.values[:, 0].max() == pytest.approx(3.0 * even[0], rel=1e-4)


def test_speos_spectral_files_have_a_level_a_wavelength():
    scans = only(read("speos_own", files.speos_spectral(), "s.brdf")).scans
    assert [(s.incident_theta_deg, s.channels) for s in scans] == [
        (0.0, ("450 nm",)),
        (0.0, ("650 nm",)),
        (30.0, ("450 nm",)),
        (30.0, ("650 nm",)),
    ]
    np.testing.assert_allclose(scans[0].values, 0.4 / np.pi, rtol=2e-3)
    np.testing.assert_allclose(scans[1].values, 0.8 / np.pi, rtol=2e-3)


def test_integra_luminance_is_a_radiance_factor_and_intensity_has_the_cosine():
    scan = only(read("integra")).scans[1]
    assert at(scan, 30.0, 270.0) == pytest.approx(3.0 * 4.0 / np.pi)
    assert at(scan, 10.0, 270.0) == pytest.approx(3.0 * 5.0 / np.pi)
    assert at(scan, 50.0, 270.0) == pytest.approx(3.0 * 6.0 / np.pi)
    first, turned = only(read("integra", name="b.ddt")).scans
    assert (first.scatter, first.quantity, first.channels) == ("transmission", "dsf", ("500 nm", "600 nm"))
    # The straight beam leaves at sigmaT; psi turns the light counter-clockwise as seen from outside: to the left there.
    assert at(first, 25.0, 270.0, 1) == 5.0
    assert turned.incident_phi_deg == 0.0
    np.testing.assert_allclose(turned.as_bsdf().values[0], turned.values[0] / np.cos(np.radians(turned.theta_deg[0])))
    with pytest.raises(FileFormatError, match="give scatter"):
        read("integra", files.DDR, "noname.txt")
    assert only(read("integra", files.DDR, "x.txt", scatter="transmission")).scans[0].scatter == "transmission"
    relative = read("integra", files.DDR.replace(b"Absolute", b"Relative"))
    assert only(relative).scans[1].quantity == "signal"
    assert only(relative).scans[1].conditions["hemispherical"] == "3"


def test_integra_specular_shares_are_direct_values():
    values = read("integra_specular").sphere_values
    assert [v.theta_deg for v in values] == [0.0, 30.0, 60.0]
    assert (values[1].collected, values[1].scatter, values[1].bands) == (
        "direct",
        "reflection",
        ("red", "green", "blue"),
    )
    np.testing.assert_array_equal(values[1].values, [0.2, 0.5, 0.8])


def test_ssdd_holds_tables_about_the_normal_and_about_the_specular_direction():
    contents = read("ssdd")
    scans = only(contents).scans
    assert len(scans) == 6
    slanted = scans[3]
    assert (slanted.incident_theta_deg, slanted.incident_phi_deg, slanted.channels) == (
        40.0,
        90.0,
        ("red", "green", "blue"),
    )
    # The first list runs fastest: index = theta_i + 2 phi_i + 4 theta_o + 12 phi_o.
    assert at(slanted, 30.0, 180.0, 1) == 1 + 2 + 4 + 100
    assert at(slanted, 30.0, 0.0, 2) == 1 + 2 + 4 + 12 + 200
    assert slanted.conditions["description"] == "two words"
    through = scans[5]
    assert (through.scatter, through.incident_phi_deg) == ("transmission", 90.0)
    # 40° of incidence with an offset of -10° leaves at 30°.
    assert at(through, 30.0, 270.0) == 2.0
    assert at(through, 10.0, 270.0) == 4.0
    assert at(through, 50.0, 270.0) == 6.0
    normal, slant = contents.sphere_values
    assert (slant.theta_deg, slant.collected, slant.scatter) == (60.0, "direct", "transmission")
    np.testing.assert_array_equal(slant.wavelength_nm, [400.0, 500.0])
    np.testing.assert_array_equal(normal.values, [0.1, 0.2])


@pytest.mark.parametrize("name", ["half.ssdd", "binary.ssdd"])
def test_half_and_difference_angles_are_interpolated_at_chosen_directions(name):
    scans = only(read("ssdd", name=name, incident_theta_deg=[20.0, 70.0])).scans
    assert [s.incident_theta_deg for s in scans] == [20.0, 70.0]
    for scan in scans:
        assert len(scan) > 1000
        np.testing.assert_allclose(scan.values, 0.5 / np.pi, rtol=1e-6)
        assert "interpolated" in scan.conditions["evaluated"]


def test_fred_gives_the_specular_direction_and_both_sides():
    reflected, transmitted, other = only(read("fred")).scans
    # The beam goes to azimuth 0, the right as seen from outside, so the light comes from the left there, our right.
    assert (reflected.incident_theta_deg, reflected.incident_phi_deg) == (30.0, 0.0)
    assert at(reflected, 30.0, 180.0) == 1.0
    assert (transmitted.scatter, at(transmitted, 30.0, 180.0)) == ("transmission", 0.8)
    assert other.incident_phi_deg == 270.0
    radians = only(read("fred", b"type bsdf_data\nformat angles=rad bsdf=log scale=1\n0.5 0\n0.5 0 -1\n")).scans[0]
    assert radians.incident_theta_deg == pytest.approx(np.degrees(0.5))
    assert radians.values[0, 0] == pytest.approx(0.1)


def test_viavi_diffusers_transmit():
    scan = only(read("viavi")).scans[0]
    assert (scan.scatter, scan.incident_theta_deg, scan.incident_phi_deg) == ("transmission", 10.0, 270.0)
    assert at(scan, 10.0, 90.0) == 24.0
    assert (len(scan), scan.conditions["date"]) == (2, "2014-10-28")
    assert only(read("viavi")).sample == "EDS10"


def test_reflectance_factors_are_pi_times_the_bsdf():
    first, second = only(read("brf")).scans
    assert first.channels == ("450 nm", "550.5 nm")
    assert at(first, 45.0, 0.0) == pytest.approx(1.0)
    assert len(second) == 2
    assert (second.incident_theta_deg, second.incident_phi_deg) == (45.0, 180.0)


def test_a_workbook_is_refused_with_what_to_export():
    workbook = import_module("clerestory.measure.formats.workbook")
    old = b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(100)
    assert workbook.recognises(old, "a.xls")
    with pytest.raises(UnknownFormatError, match=r"export text from its program \(\.jdv"):
        workbook.read(old, "a.xls")


@pytest.mark.parametrize(
    ("kind", "choices", "message"),
    [
        ("zemax", {"side": "front"}, "exterior, interior"),
        ("integra", {"scatter": "both"}, "transmission, reflection"),
        ("reflet", {"quantity": "radiance"}, "bsdf"),
        ("speos", {"incident_theta_deg": "steep"}, "degrees"),
        ("rgl", {"incident_theta_deg": [95.0]}, "0 to 89.5"),
        ("rgl", {"incident_theta_deg": "steep"}, "0 to 89.5"),
    ],
)
def test_what_a_person_says_is_checked(kind, choices, message):
    with pytest.raises(ClerestoryError, match=message):
        read(kind, **choices)


_REAL = {
    "zemax/AnoBlackNiTEonSteel.bsdf": ("zemax", 4),
    "zemax/ValidationTest_of_BRDF_via_MagicBlack.bsdf": ("zemax", 4),
    "rt300s/test_jdv.jdv": ("jdv", 4),
    "rt300s/test_lighttools.txt": ("reflet", 4),
    "rt300s/test_speos.rtd": ("speos", 4),
    "rpc_eds10/EDS10_0-0.txt.gz": ("viavi", 1),
    "rpc_eds10/EDS10_10-90.txt.gz": ("viavi", 1),
    "rpc_eds10/EDS10_5-45.txt.gz": ("viavi", 1),
    "fred/AnoBlackEC1onAlum_fullAz.txt": ("fred", 4),
    "blacklab/20250210_S7_sample_final.txt": ("brf", 17),
}


@pytest.mark.parametrize("path", _REAL)
def test_real_files_load(path):
    root = sample_root()
    if root is None:
        pytest.skip(ABSENT)
    data = (root / "gonio" / path).read_bytes()
    data = gzip.decompress(data) if path.endswith(".gz") else data
    kind, count = _REAL[path]
    known = [f.__name__.rsplit(".", 1)[1] for f in all_formats() if f.recognises(data, path)]
    assert known[:1] == [kind]
    contents = read(kind, data, path.rsplit("/", 1)[1])
    assert sum(len(m.scans) for m in contents.measurements) == count


def test_the_real_diffuser_sends_its_beam_straight_on():
    root = sample_root()
    if root is None:
        pytest.skip(ABSENT)
    data = gzip.decompress((root / "gonio/rpc_eds10/EDS10_10-90.txt.gz").read_bytes())
    scan = only(read("viavi", data, "EDS10.txt")).scans[0]
    weights = scan.values[:, 0] * np.cos(np.radians(scan.theta_deg)) * np.sin(np.radians(scan.theta_deg))
    beam = (weights[:, None] * scan.outgoing).sum(axis=0)
    beam /= np.linalg.norm(beam)
    assert np.degrees(np.arccos(beam @ -scan.incident)) < 1.0


def test_all_formats_are_listed():
    assert set(files.GOLDEN) | {"workbook"} <= set(FORMATS)
