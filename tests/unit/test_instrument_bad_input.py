"""Damaged files of optics programs and instruments: one line of error with its place and what to do."""

import gzip
import hashlib
import re
import struct
import tracemalloc
from importlib import import_module

import numpy as np
import pytest

import instrument_files as files
from clerestory import measure
from clerestory._core import ClerestoryError, FileFormatError
from clerestory.measure.contents import Contents
from clerestory.measure.formats import all_formats

ALL = [(kind, name) for kind, many in files.GOLDEN.items() for name in many]
TEXTS = [(kind, name) for kind, name in ALL if kind != "rgl" and name != "binary.ssdd"]


def read(kind, data, name):
    return import_module(f"clerestory.measure.formats.{kind}").read(data, name)


def attempt(kind, data, name):
    """What is read, and the message where it is refused."""
    try:
        return read(kind, data, name), ""
    except ClerestoryError as error:
        return Contents(), str(error)


def refused(kind, data, name):
    """The message of a file that is refused: one line with a remedy in brackets at its end."""
    with pytest.raises(FileFormatError) as caught:
        read(kind, data, name)
    message = str(caught.value)
    assert "\n" not in message
    assert len(message) < 300
    assert re.search(r"\([^()]*(\([^()]*\)[^()]*)*\)$", message), message
    return message


@pytest.mark.parametrize(("kind", "name"), TEXTS)
def test_nothing_is_no_file(kind, name):
    assert "JSON" in refused(kind, b"", name) if kind == "product_json" else "empty" in refused(kind, b"", name)
    assert not any(f.recognises(b"", name) for f in all_formats())


@pytest.mark.parametrize(("kind", "name"), TEXTS)
def test_ends_of_lines_make_no_difference(kind, name):
    data = re.sub(rb"\r\n?", b"\n", files.GOLDEN[kind][name])
    expected = values_of(read(kind, data, name))
    for end in (b"\r\n", b"\r"):
        got = values_of(read(kind, data.replace(b"\n", end), name))
        assert len(got) == len(expected)
        for one, other in zip(expected, got, strict=True):
            np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize(("kind", "name"), TEXTS)
@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "gzip"])
def test_encodings_and_packing_make_no_difference(kind, name, encoding, tmp_path):
    data = files.GOLDEN[kind][name]
    packed = gzip.compress(data) if encoding == "gzip" else data.decode("utf-8").encode(encoding)
    path = tmp_path / (f"{name}.gz" if encoding == "gzip" else name)
    path.write_bytes(packed)
    contents = measure.read(path)
    for one, other in zip(values_of(read(kind, data, name)), values_of(contents), strict=True):
        np.testing.assert_array_equal(one, other)
    sources = [s.source for m in contents.measurements for s in m.scans] + [v.source for v in contents.sphere_values]
    assert {(s.name, s.sha256) for s in sources} == {(path.name, hashlib.sha256(packed).hexdigest())}


def values_of(contents):
    return [s.values for m in contents.measurements for s in m.scans] + [v.values for v in contents.sphere_values]


@pytest.mark.parametrize(("kind", "name"), ALL)
def test_half_of_a_file_is_refused_or_smaller(kind, name):
    data = files.GOLDEN[kind][name]
    whole = sum(v.size for v in values_of(read(kind, data, name)))
    for share in (0.3, 0.5, 0.7, 0.9):
        got, message = attempt(kind, data[: int(share * len(data))], name)
        assert "\n" not in message
        assert sum(v.size for v in values_of(got)) <= whole


@pytest.mark.parametrize(
    ("kind", "change", "message"),
    [
        (
            "zemax",
            (b"AngleOfIncidence\t2", b"AngleOfIncidence\t3"),
            "line 11: number 3 of 3 angles of AngleOfIncidence",
        ),
        ("zemax", (b"AngleOfIncidence\t2", b"AngleOfIncidence\t1"), "line 10: '30' is no keyword"),
        ("zemax", (b"AngleOfIncidence\t2", b"AngleOfIncidence\t99999999999999"), "are declared, but the file ends"),
        ("zemax", (b"AngleOfIncidence\t2", b"AngleOfIncidence\t1.5"), "not a whole number"),
        ("zemax", (b"0\t10\t70", b"0\t10\t190"), "190° of angles of ScatterRadial is not within 0 to 180°"),
        ("zemax", (b"0.000000", b"nan"), "'nan', not a number"),
        ("zemax", (b"0.001000", b"0,001"), r"'0,001', not a number \(correct it, with a point for decimals\)"),
        ("zemax", (b"0.001000", b"1e999"), "not a number"),
        ("zemax", (b"0.001000", b"1_0"), "not a number"),
        ("zemax", (b"0.001000", b"0.001 5"), "where TIS should be"),
        ("zemax", (b"TIS 0.1", b"TIS much"), "line 18: total integrated scatter is 'much'"),
        ("zemax", (b"DataEnd", b""), "the file ends where DataEnd should be"),
        ("zemax", (b"Symmetry\tPlaneSymmetrical", b"Symmetry\tround"), "Symmetry 'round'"),
        ("zemax", (b"ScatterType\tBRDF", b""), "without scattertype"),
        ("lighttools", (b"AOI 40", b"AOI 200"), "AOI 200 is not an angle"),
        ("lighttools", (b"Side Front", b"Side Top"), "Side 'Top' is not known"),
        ("lighttools", (b"ScatterType BTDF", b"ScatterType BRDF"), "second block"),
        ("lighttools", (b"DataEnd", b""), "the file ends where TIS should be"),
        ("lighttools", (b"ScatterRadial 3", b"ScatterRadial 4"), "number 4 of 4 angles of ScatterRadial"),
        ("reflet", (b"Phi measure step :\t90", b"Phi measure step :\t45"), "azimuths -90 to 0° by 45° are declared"),
        ("reflet", (b"Theta Lighting\t30", b"Theta Lighting\t130"), "130 is not an angle"),
        ("reflet", (b"30\t4\t5", b"30\t4"), "1 values where 2 azimuths"),
        ("reflet", (b"30\t4\t5", b"95\t4\t5"), "polar angle 95"),
        ("jdv", (b"-90\t1\t3\t4", b"-90\t1\t3"), "2 values where 3 polar angles"),
        ("jdv", (b"Incidence:\t30", b"Incidence:\tsteep"), "Incidence is 'steep'"),
        ("speos", (b"v1.0", b"v7.0"), "not version v1.0"),
        ("speos_own", (b"v8.0\n0\n", b"v8.0\n1\n"), "a binary file"),
        ("speos_own", (b"1\t0\n1\n", b"1\t1\n1\n"), "reflection and transmission in one file are not read"),
        ("speos_own", (b"1\t0\n1\n", b"yes\n1\n"), "does not say whether there is reflection"),
        ("speos_own", (b"80\t1\t1", b"100\t1\t1"), "polar angles from 0 to 100° for reflection"),
        ("speos_own", (b"350\t50", b"350\thalf"), "half"),
        ("speos", (b"\n2\n", b"\n2000000\n"), "2e.06 wavelengths, but the file ends"),
        ("integra", (b"sigma 2", b"sigma 3"), "number 3 of 3 angles of sigma"),
        ("integra", (b"kbdf 2 3", b"kbdf 2"), "number 2 of 2 factors of kbdf"),
        ("integra", (b"4 6\n", b"4 6 7\n"), "after the last channel"),
        ("integra", (b"TypeSym PlaneSymmetrical", b"TypeSym odd"), "TypeSym 'odd'"),
        ("integra_specular", (b"0.7 0.8 0.9", b"0.7 0.8"), "2 words left where 3 shares"),
        ("ssdd", (b"PARAM2_LIST 0 30 90", b"PARAM2_LIST 0 90 30"), "do not rise"),
        ("ssdd", (b"PARAM2_LIST 0 30 90", b"PARAM2_LIST 0 30 91"), "91° of PARAM2_LIST"),
        ("ssdd", (b"DATA_TYPE brdf", b"DATA_TYPE sheen"), "DATA_TYPE 'sheen'"),
        ("ssdd", (b"PARAM_TYPE spherical_coordinate_system\n", b""), "DATA without PARAM_TYPE"),
        ("ssdd", (b"5 105 205", b"5 105"), "ends within this line"),
        ("ssdd", (b"PARAM4_LIST 0 -10", b"PARAM4_LIST 0"), "not as many offsets"),
        ("ssdd", (b"PARAM4_LIST 0 -10", b"PARAM4_LIST 0 80"), "leaves 0 to 90°"),
        ("fred", (b"scale=2", b"scale=much"), "scale is 'much'"),
        ("fred", (b"angles=deg", b"angles=grad"), "angles=grad"),
        ("fred", (b"30\t0\n0\t0", b"0\t0"), "values before an incident direction"),
        ("fred", (b"30\t0\n", b"95\t0\n"), "95° of incidence"),
        ("fred", (b"30\t90\t0.2", b"30\t90\t0.2\t1"), "line 6: the row does not have 3 columns"),
        ("viavi", (b"24.0", b"1e300"), "line 3: a number below is beyond"),
        ("viavi", (b"24.0", b"nan"), 'line 5: "nan" is not a finite number'),
        ("brf", (b"0 0 45 180 3.14", b"0 45 180 3.14"), "5 columns instead of 6"),
        ("brf", (b"450nm", b"blue"), "not wavelengths"),
        ("igdb_dat", (b"Microns", b"Feet"), "name no unit"),
        ("igdb_dat", (b"0.305 ", b"0.300 "), "line 5: wavelengths do not rise"),
        ("igdb_dat", (b"0.047 0.049", b"47 0.049"), "47 is no share"),
        ("product_json", (b'"Rf": 0.5', b'"Rf": "half"'), "Rf of Slat is 'half'"),
        ("product_json", (b'"Rf": 0.5', b'"Rf": 50'), "no share of the light"),
        ("product_json", (b'"wavelength": 0.31', b'"wavelength": 0.3'), "there twice"),
        ("product_json", (b'"wavelength": 0.31', b'"wavelength": 310000'), "give micrometres"),
        ("product_json", (b"}]}", b""), "no JSON"),
        ("sphere_csv", (b",value,", b",worth,"), "column 'worth' is not known"),
        ("sphere_csv", (b"8,400,front,T,diffuse,0.2", b"8,400,front,T,diffuse,20"), "put % into the name"),
        ("sphere_csv", (b"8,500,front,T,hem", b"8,400,front,T,hem"), "line 4: a second value"),
        ("sphere_csv", (b"60,400", b"95,400"), "not within 0 to 90°"),
        ("sphere_csv", (b",back,", b",top,"), "side 'top' is not known"),
        ("sphere_csv", (b"0.25,0.02", b"0.25"), "6 cells instead of 7"),
        ("reflectances", (b"AOI 0 0.5 0.25", b"AOI 0 50 25"), "give shares"),
        ("reflectances", (b"AOI 0 0.5 0.25", b"AOI 0 0.5"), "2 numbers after AOI"),
    ],
)
def test_what_is_wrong_is_named_with_its_place(kind, change, message):
    name, data = next(iter(files.GOLDEN[kind].items()))
    assert data.count(change[0]) >= 1
    assert re.search(message, refused(kind, data.replace(*change, 1), name))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"vndf": None}, "no field vndf"),
        ({"vndf": np.ones((1, 2, 4, 4), dtype=np.float32)}, r"do not have \(1, 3\) incident directions"),
        ({"vndf": np.ones((3, 4, 4), dtype=np.float32)}, "instead of 4 dimensions"),
        ({"vndf": -np.ones((1, 3, 4, 4), dtype=np.float32)}, "density is negative"),
        ({"spectra": np.full((1, 3, 2, 4, 4), np.nan, dtype=np.float32)}, "no numbers"),
        ({"spectra": np.ones((1, 3, 2, 1, 1), dtype=np.float32)}, "fewer than 2 nodes"),
        ({"spectra": np.ones((1, 3, 5, 4, 4), dtype=np.float32)}, "5 channels where 2"),
        ({"theta_i": np.array([0.8, 0.4, 0.0], dtype=np.float32)}, "do not rise"),
        ({"theta_i": np.array([0.0, 40.0, 80.0], dtype=np.float32)}, r"\[rad\]"),
        ({"wavelengths": None}, "no field wavelengths"),
    ],
)
def test_materials_that_do_not_fit_are_refused(change, message):
    fields = files.material() | change
    data = files.tensor_file({key: value for key, value in fields.items() if value is not None})
    assert re.search(message, refused("rgl", data, "a.bsdf"))


def test_declared_sizes_allocate_nothing():
    huge = b"tensor_file\0\1\0" + struct.pack("<I", 2**32 - 1)
    field = struct.pack("<H", 4) + b"vndf" + struct.pack("<HBQ", 4, 10, 0) + struct.pack("<4Q", *[2**40] * 4)
    half = files.HALF_HEAD.replace(b"PARAM0_LIST 0 90", b"PARAM0_LIST " + b" ".join(b"%d" % k for k in range(90)))
    wide = half.replace(b"PARAM2_LIST 0 90", b"PARAM2_LIST " + b" ".join(b"%d" % k for k in range(90)))
    cases = [
        ("rgl", huge + field),
        ("rgl", huge),
        ("ssdd", wide + b"DATA binary\n" + bytes(40)),
        ("ssdd", wide + b"DATA ascii\n1\n2\n"),
        ("zemax", files.zemax().replace(b"SampleRotation\t1\n0", b"SampleRotation\t99999999999\n0")),
        ("integra", files.DDR.replace(b"psi 1", b"psi 123456789012345")),
    ]
    for kind, data in cases:
        tracemalloc.start()
        refused(kind, data, next(iter(files.GOLDEN[kind])))
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert peak < 2_000_000


@pytest.mark.parametrize(("kind", "name"), ALL)
def test_any_damage_gives_our_errors_only(kind, name):
    rng = np.random.default_rng(20260101)
    data = files.GOLDEN[kind][name]
    for _ in range(60):
        broken = bytearray(data)
        for _ in range(rng.integers(1, 4)):
            at, length = int(rng.integers(len(broken))), int(rng.integers(1, 12))
            match rng.integers(5):
                case 0:
                    broken[at] ^= 1 << int(rng.integers(8))
                case 1:
                    del broken[at : at + length]
                case 2:
                    broken[at:at] = broken[at : at + length]
                case 3:
                    broken[at : at + 1] = rng.choice([b"-", b"9e99", b"nan", b" ", b"\n", b"\0", b'"', b"\xff", b","])
                case _:
                    broken[at:] = broken[at : at + int(rng.integers(len(broken)))]
            broken = broken or bytearray(b"x")
        for form in all_formats():
            form.recognises(bytes(broken), name)
        assert "\n" not in attempt(kind, bytes(broken), name)[1]
