"""Files of measurements that are damaged: one line that names the file, the place and the remedy, and nothing else."""

import gzip
import re
import struct

import numpy as np
import pytest

from clerestory import ClerestoryError, FileFormatError, measure
from clerestory.measure.files import read_bytes
from clerestory.measure.formats.sir import interpolant_of

HEAD = "#format: theta phi BSDF\n#intheta 30\n#inphi 40\n"
PAB = HEAD + "".join(f"{t} {p} 0.{t}{p}\n" for t in (10, 20) for p in (0, 90, 180))
IEA = "# theta_1: 30\n# phi_1: 0\n# isym: 0\n# phi_2 theta_2 BTDF\n0 120 0.5\n90 150 0.25\n"
ASTM = "TYPE BRDF\nNUM_POINTS 2\nVARS theta_i,phi_i,theta_s,phi_s,value\n0.5,0,0.5,3,0.25\n0.5,0,0.6,3,0.125\n"
CSV = "side,scatter,theta_i,phi_i,theta_o,phi_o,bsdf\nexterior,t,30,0,10,0,0.5\nexterior,t,30,0,20,0,0.25\n"


def float5(value):
    mantissa, exponent = np.frexp(value)
    return struct.pack(">ib", int(mantissa * 0x7FFFFFFF), int(exponent))


def sir(lobes=((2.0, 300, 8, 8),), *, header="GRIDRES=16\nBSDFMIN=0.01\n"):
    """An interpolant of two directions without plans."""
    text = f"#?RADIANCE\nNAME=plate\nSYMMETRY=0\nIO_SIDES= 1 -1\nCOLORIMETRY=CIE-Y\n{header}FORMAT=BSDF_RBFmesh\n\n"
    data = text.encode() + b"\x5a\x3c"
    for k, incident in enumerate(((0.0, 0.0, 1.0), (-0.6, 0.0, 0.8))):
        data += struct.pack(">i", k) + b"".join(map(float5, (*incident, 0.25))) + struct.pack(">i", len(lobes))
        for peak, radius, gx, gy in lobes:
            data += float5(peak) + struct.pack(">HHHH", 0xC256, radius, gx, gy)
    return data + struct.pack(">i", -1) + b"\xff" * 8


FILES = {
    "pab.txt": PAB.encode(),
    "iea.txt": IEA.encode(),
    "a.astm": ASTM.encode(),
    "t.csv": CSV.encode(),
    "s.sir": sir(),
}


@pytest.fixture
def fails(tmp_path):
    """Read a file and give the one line that it fails with, behind its path."""

    def read(content, **choices):
        path = tmp_path / "file.dat"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        with pytest.raises(ClerestoryError) as raised:
            measure.read(path, **choices)
        text = str(raised.value)
        assert re.fullmatch(rf"{re.escape(str(path))}: [^\n]*\(.+\)", text), text
        return text.removeprefix(f"{path}: ")

    return read


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", "empty"),
        ("\0" * 5000, "zeros"),
        ("some words\nof a letter\n", "no format"),
        (HEAD, "line 4: no points follow"),
        (HEAD + "10 20\n", "line 4: .* 3 columns"),
        (HEAD + "10 20 1\n20 30 4 5\n", "line 5: .* 3 columns"),
        (HEAD + "10 20 nan\n", 'line 4: "nan" is not a finite number'),
        (HEAD + "10 20 1\n10 20 inf\n", 'line 5: "inf"'),
        (HEAD + "10 20 1e999\n", 'line 4: "1e999"'),
        (HEAD + "10,0 20,0 0,5\n", "line 4: a comma stands inside of a number .*decimal point"),
        (HEAD + "10;20;0,5\n", "line 4: a comma"),
        (HEAD + "10 20 \x00\n", "line 4: "),
        (HEAD + "10 20 1\n<xml>\n", "line 5: "),
        (HEAD.replace("30", "30,5") + "10 20 1\n", "line 2: .*comma"),
        (HEAD.replace("30", "much") + "10 20 1\n", "line 2: #intheta 'much'"),
        (HEAD.replace("BSDF", "BSSRDF") + "10 20 1\n", "line 1: .*BSSRDF"),
        (HEAD.replace("theta phi", "phi theta") + "#intheta 3\n10 20 1\n", "line 1: "),
        ("#intheta 30\n#inphi 30\n10 20 1\n", "line 3: .*#format"),
        ("#format: theta phi DSF\n#inphi 30\n10 20 1\n", "line 3: .*#intheta"),
        ("#colorimetry: RGB\n" + HEAD + "10 20 1\n", "line 1: colorimetry"),
        ("#colorimetry: CIE-XYZ\n" + HEAD + "10 20 1\n", "line 5: .* 5 columns"),
        ("#datapoints_in_file: 3\n" + HEAD + "10 20 1\n", "1 points, and the header announces 3"),
        ("#datapoints_in_file: -7\n#purpose: fun\n" + HEAD + "10 20 1\n", "line 2: purpose"),
    ],
)
def test_pab(fails, text, expected):
    assert re.match(f".*{expected}", fails(text)), fails(text)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (IEA.split("0 120")[0], "no points follow"),
        (IEA.replace("0 120 0.5", "0 120"), "line 6: .* 2 columns"),
        (IEA.replace("0.25", "0.25 7"), "line 6: .* 3 columns"),
        (IEA.replace("theta_1: 30", "theta_1: 95"), "theta_1 95 is beyond 90"),
        (IEA.replace("theta_1: 30", "theta_1: 3O,1"), "line 1: .*comma|line 1: .*3O"),
        (IEA.replace("150", "30"), "both sides"),
        ("# points: 3\n" + IEA, "2 of 3 points"),
        ("# theta_1: 3\n# phi_1: 4\n# isym: 2\n0 50 1\n", "whether light is transmitted or reflected"),
        ("# hemispherical: many\n" + IEA, "hemispherical value 'many'"),
    ],
)
def test_iea(fails, text, expected):
    choices = {"scatter": "transmission"} if "both sides" in expected else {}
    assert re.search(expected, fails(text, **choices)), fails(text, **choices)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (ASTM.split("0.5,0,0.5")[0], "line 4: no rows follow VARS"),
        (ASTM.replace("NUM_POINTS 2", "NUM_POINTS -2").replace(",0.125", ""), "line 5: .* 5 columns"),
        (ASTM.replace("0.125", "1/8"), 'line 5: "1/8"'),
        (ASTM.replace("theta_s,phi_s", "phi_s,theta_s"), "line 3: VARS .*does not begin"),
        (ASTM.replace(",value", "").replace(",0.25", "").replace(",0.125", ""), "no column of values"),
        ("ANGLE_UNIT radians\n" + ASTM.replace("0.5,0,0.5", "30,0,50"), "cannot be radians"),
        ("INCIDENT_SIDE top\n" + ASTM, "top"),
    ],
)
def test_astm(fails, text, expected):
    assert re.search(expected, fails(text)), fails(text)


@pytest.mark.parametrize(
    ("text", "choices", "expected"),
    [
        (CSV.split("exterior")[0], {}, "line 2: no rows"),
        (CSV.replace("0.25", ""), {}, "no value"),
        (CSV.replace("0.25", "viele"), {}, 'line 3: "viele"'),
        (CSV.replace("20,0,", "20,"), {}, "line 3: .* 7 columns"),
        (CSV.replace("exterior,t,30,0,20", "top,t,30,0,20"), {}, "side 'top'"),
        (CSV.replace("theta_o", "outgoing_theta").replace("phi_o", "theta_o"), {}, "two columns are theta_o"),
        (CSV.replace("theta_i", "polar"), {}, "no column gives theta_i"),
        (CSV.replace("phi_o", "around"), {}, "no column gives phi_o"),
        (CSV.replace(",t,", ",x,"), {}, "transmitted or reflected"),
        (CSV.replace("10,0,0.5", '"10,0,0.5'), {}, "line 2: "),
        (CSV, {"columns": {"thetao": "theta_o"}}, "'thetao' is not known"),
        (CSV, {"columns": "theta_o"}, "columns is not a table"),
        (CSV.replace("30,0,10", "300,0,10"), {}, "angle to the normal is 300°"),
    ],
)
def test_csv(fails, text, choices, expected):
    assert re.search(expected, fails(text, **choices)), fails(text, **choices)


def test_interpolant(fails):
    whole = sir()
    assert "before its last direction" in fails(whole[:-70])
    assert "before the end of its plans" in fails(whole[:-4])
    assert "lobes do not fit" in fails(
        whole.replace(struct.pack(">i", 1) + float5(2.0), struct.pack(">i", -5) + float5(2.0))
    )
    assert "lies nowhere" in fails(sir(((1.0, 30, 16, 0),)))
    assert "IO_SIDES" in fails(whole.replace(b"IO_SIDES= 1 -1", b"IO_SIDES= 1 2"))
    assert "GRIDRES=" in fails(sir(header=""))
    assert "GRIDRES=-4" in fails(sir(header="GRIDRES=-4\n"))
    assert "not transferred as binary" in fails(whole.replace(b"\x5a\x3c", b"\x5a\x0d"))


def test_packed(fails, tmp_path):
    assert "nothing but zeros" in fails(gzip.compress(bytes(80 << 20), 9))
    assert "unpack to more than" in fails(gzip.compress(PAB.encode() + b" " * (90 << 20), 9))
    assert "end too early" in fails(gzip.compress(PAB.encode())[:-12])
    assert "is not text of utf-16-le" in fails(b"\xff\xfe" + PAB.encode("utf-16-le") + b"\x00\xd8\x41")


def test_wrong_paths_and_choices(tmp_path):
    with pytest.raises(ClerestoryError, match="no such file"):
        measure.read(tmp_path / "absent")
    with pytest.raises(ClerestoryError, match="no measurement in the folder"):
        measure.read(tmp_path)
    with pytest.raises(ClerestoryError, match="no file to read"):
        measure.read([])
    (tmp_path / "a.txt").write_text(PAB)
    with pytest.raises(ClerestoryError, match="side 'left' is not known"):
        measure.read(tmp_path, side="left")
    with pytest.raises(ClerestoryError, match="choice 'syde' is not known"):
        measure.read(tmp_path, syde="exterior")


@pytest.mark.parametrize("name", FILES)
def test_mutated_files_are_read_or_refused(name, tmp_path):
    """Bytes changed, taken out, doubled and exchanged: never another error than ours, nor a point out of range."""
    rng = np.random.default_rng(5)
    original, path = FILES[name], tmp_path / name
    assert read_bytes(original, name).measurements
    messages = []
    for _ in range(1500):
        data = bytearray(original)
        for _ in range(rng.integers(1, 4)):
            at, length = int(rng.integers(len(data) + 1)), int(rng.integers(1, 30))
            kind = rng.integers(5)
            if kind == 0 and data:
                data[min(at, len(data) - 1)] = int(rng.integers(256))
            elif kind == 1:
                del data[at : at + length]
            elif kind == 2:
                data[at:at] = data[at : at + length]
            elif kind == 3:
                data[at:at] = rng.choice(
                    [b"-", b",", b"nan", b"1e400", b"\r", b"#", b"\0", b"\xff", b'"', b"999999999999"]
                )
            else:
                del data[at:]
        try:
            contents = read_bytes(bytes(data), name)
        except ClerestoryError as error:
            messages.append(str(error))
            continue
        for measurement in contents.measurements:
            for scan in measurement.scans:
                assert np.isfinite(scan.values).all()
                assert np.isfinite(scan.outgoing).all()
    assert len(messages) > 100
    assert [text for text in messages if not text.startswith(f"{name}: ") or "\n" in text] == []
    assert not path.exists()


def test_an_interpolant_holds_what_stands_in_it():
    interpolant = interpolant_of(sir(), front="interior")
    assert (interpolant.side, interpolant.scatter, interpolant.grid) == ("interior", "transmission", 16)
    np.testing.assert_allclose(interpolant.incident, [[0, 0, 1], [-0.6, 0, 0.8]], atol=1e-8)
    (lobes, _) = interpolant.lobes
    np.testing.assert_allclose(lobes.peaks, [2.0], rtol=1e-8)
    np.testing.assert_allclose(lobes.radii, [300.5 * np.pi / 65536], rtol=1e-12)
    np.testing.assert_allclose(interpolant.dsf([0, 0, 1], lobes.centres), [2.0], rtol=1e-8)
    with pytest.raises(ClerestoryError, match="no lobes for light from there"):
        interpolant.dsf([0.6, 0, 0.8], lobes.centres)
    with pytest.raises(FileFormatError):
        interpolant_of(sir()[:-30])
