"""Clerestory's own file: nothing is lost, and nothing unsound gets in."""

import contextlib
import io
import json
import struct
import zipfile

import numpy as np
import pytest

import clerestory
from clerestory import Basis, Bsdf, Model, _core

QUARTER = Basis.named("klems-quarter")
ODD = Basis.from_rings("of my own", [(0, 12.5, 0, 1), (12.5, 61.25, 40, 6), (61.25, 90, 75, 10)])


def table(basis=QUARTER, *, errors=True):
    values = np.random.default_rng(1).normal(0.1, 0.1, (len(basis), len(basis)))
    return Model.matrix(values, basis, standard_errors=np.abs(0.1 * values) if errors else None)


def tree():
    """A tree of rank 4 with one block."""
    entries = np.linspace(0, 1, 16).astype(np.float32).view(np.uint32)
    core = _core.Model.from_parts("tree", [("rank", 4.0), ("root", 2.0**31)], [], [("entries", entries)], [])
    return Model(core)


def wrapped(kind, model, **numbers):
    return Model(_core.Model.from_parts(kind, list(numbers.items()), [], [], [model._core]))


def data_set():
    """Every kind of model."""
    deep = Model.sum([(0.25, table(ODD)), (0.5, wrapped("turned", tree(), angle=0.3, mirrored=1.0))])
    models = {
        "visible": {
            ("exterior", "transmission"): wrapped("separated", tree()),
            ("exterior", "reflection"): table(),
            ("interior", "transmission"): deep,
            ("interior", "reflection"): Model.lambertian(0.3),
        },
        "550 nm": {
            ("exterior", "transmission"): Model.specular(0.7),
            ("exterior", "reflection"): Model.specular([0.1, 0.2, 1.0]),
            ("interior", "transmission"): Model.specular(np.linspace(0, 1, 41), basis=QUARTER),
            ("interior", "reflection"): wrapped("reversed", table(ODD, errors=False)),
        },
        "solar": {
            ("exterior", "transmission"): Model(
                _core.Model.from_parts(
                    "pane",
                    [("refractive_index", 1.52), ("internal_transmittance", 0.97), ("reflected", 0.0)],
                    [],
                    [],
                    [],
                )
            )
        },
    }
    leaf = ("Name", [("unit", "mm"), ("x", "ü")], "Blende <&>", [])
    metadata = (
        "System",
        ("Material", [], "", [leaf]),
        ("Geometry", [("format", "MGF")], "xf -t 0 0 1\n", []),
        ["made by hand"],
        [("WindowElement/Optical", leaf)],
    )
    core = Bsdf.from_models(models)._core.with_metadata_parts(metadata).with_warnings(["a", "ß"])
    return Bsdf(core)


def parts(model):
    kind, numbers, bases, arrays, models = model.to_parts()
    return (
        kind,
        numbers,
        [(b.name, b.rings) for b in bases],
        [(name, a.dtype, a.tobytes()) for name, a in arrays],
        [parts(m) for m in models],
    )


def everything(bsdf):
    bands = [
        (name, source, detector, [(s, c, parts(m)) for s, c, m in members])
        for name, source, detector, members in bsdf._core.bands()
    ]
    return bands, bsdf._core.metadata_parts(), bsdf.warnings, bsdf.conversion


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "a.bsdf.npz"
    data_set().save(path)
    return path


def test_nothing_is_lost(file):
    again = clerestory.read(file)
    assert everything(again) == everything(data_set())
    direction = clerestory.direction(30, 90)
    np.testing.assert_array_equal(
        again.integrate(direction, "transmission"), data_set().integrate(direction, "transmission")
    )


def test_conversion_reports_are_kept(tmp_path):
    converted = data_set().to_matrix("klems-quarter", samples=8, bands=["visible", "550 nm"])
    converted.save(tmp_path / "b.bsdf.npz")
    again = clerestory.read(tmp_path / "b.bsdf.npz")
    assert again.conversion == converted.conversion
    assert len(again.conversion) == 8


def test_the_same_data_set_gives_the_same_bytes(file, tmp_path):
    other = tmp_path / "b.bsdf.npz"
    clerestory.read(file).save(other)
    assert other.read_bytes() == file.read_bytes()


def test_numpy_opens_it(file):
    with np.load(file, allow_pickle=False) as arrays:
        header = json.loads(arrays["header.json"])
        assert header["format"] == "clerestory-bsdf"
        values = arrays["visible/exterior/reflection/values"].reshape(41, 41)
    np.testing.assert_array_equal(values.T, table().values)


def test_nothing_is_left_behind_where_writing_fails(tmp_path):
    with pytest.raises(OSError, match="nowhere"):
        data_set().save(tmp_path / "nowhere" / "a.bsdf.npz")
    with pytest.raises(IsADirectoryError):
        data_set().save(tmp_path)
    model = Model.lambertian(0.5)
    for _ in range(40):
        model = wrapped("turned", model, angle=0.1, mirrored=0.0)
    deep = Bsdf.from_models({("exterior", "transmission"): model})
    with pytest.raises(clerestory.UnsupportedError, match="more than 32 deep"):
        deep.save(tmp_path / "deep.bsdf.npz")
    assert list(tmp_path.iterdir()) == []


def members(path):
    with zipfile.ZipFile(path) as archive:
        return {m.filename: archive.read(m) for m in archive.infolist()}


def write(path, content):
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in content.items():
            archive.writestr(name, data)


def refused(path, match):
    with pytest.raises(clerestory.FileFormatError, match=match) as error:
        clerestory.read(path)
    text = str(error.value)
    assert text.startswith(f"{path}: ")
    assert "\n" not in text
    assert text.count(str(path)) == 1
    assert text.endswith(")"), text


def npy(array, **kwargs):
    stream = io.BytesIO()
    np.lib.format.write_array(stream, array, **kwargs)
    return stream.getvalue()


VALUES = "visible/exterior/reflection/values.npy"
SOUND = np.zeros(41 * 41)


@pytest.mark.parametrize(
    ("data", "match"),
    [
        (None, f"{VALUES} is missing"),
        (b"", "bytes where about"),
        (npy(SOUND[:-1]), "shape .1680,. where float64"),
        (npy(SOUND.astype(np.float32)), "bytes where about"),
        (npy(SOUND.view(np.int64)), "type int64"),
        (npy(SOUND.reshape(41, 41)), "shape"),
        (npy(np.full(41 * 41, np.nan)), "holds nan at place 0"),
        (npy(np.where(np.arange(41 * 41) == 7, np.inf, 0.0)), "holds inf at place 7"),
        (npy(SOUND, version=(2, 0)), "format 1.0"),
        (b"x" * len(npy(SOUND)), "not a NumPy array"),
        (npy(SOUND)[:10] + b"(" * (len(npy(SOUND)) - 10), "not a NumPy array"),
        (npy(SOUND) + b"more", "13452 bytes of values where 13448 belong"),
    ],
    ids=["missing", "empty", "short", "float32", "int64", "shape", "nan", "inf", "version", "noise", "header", "long"],
)
def test_unsound_arrays_are_refused(file, data, match):
    content = members(file)
    content.pop(VALUES)
    if data is not None:
        content[VALUES] = data
    write(file, content)
    refused(file, match)


def test_objects_are_never_unpickled(file):
    content = members(file)
    stream = io.BytesIO()
    np.lib.format.write_array(stream, np.array([print] * 200, dtype=object), allow_pickle=True)
    content[VALUES] = stream.getvalue().ljust(len(content[VALUES]), b"\0")
    write(file, content)
    refused(file, "type object")


def change(path, edit):
    content = members(path)
    header = json.loads(content["header.json"])
    edit(header)
    content["header.json"] = json.dumps(header).encode()
    write(path, content)


def first_model(header):
    return header["bands"][0]["components"][1]["model"]


def deeper(header):
    model = first_model(header)
    for _ in range(50):
        model["models"] = [{"kind": "turned", "numbers": {}, "bases": [], "arrays": {}, "models": []}]
        model = model["models"][0]


@pytest.mark.parametrize(
    ("edit", "match"),
    [
        (lambda h: h.update(format="other"), "format is 'clerestory-bsdf'"),
        (lambda h: h.update(version=2), "version 2 is not known.*newer clerestory"),
        (lambda h: h.pop("bands"), "'bands' of the header"),
        (lambda h: h.update(bands=[]), "does not name it"),
        (lambda h: h.update(bands=h["bands"][:1] * 2), "used twice"),
        (lambda h: h["bands"][0]["components"].pop(0), "does not name it"),
        (lambda h: h["bands"][0]["components"][0].update(side="front"), "component 'front transmission'"),
        (lambda h: h["bands"][0]["components"][1].update(scatter="transmission"), "second component"),
        (lambda h: h["bands"][0].update(name=3), "'name' of band 0"),
        (lambda h: h["bands"][0].update(source_spectrum=[]), "'source_spectrum' of band 0"),
        (lambda h: first_model(h).update(kind="fabric"), "'kind'|not a kind of model"),
        (lambda h: first_model(h).update(bases=[0, 9]), "angle basis that is not there"),
        (lambda h: first_model(h).update(bases=[True, 0]), "angle basis that is not there"),
        (lambda h: first_model(h).update(bases=[]), "too few"),
        (lambda h: first_model(h).update(numbers={"x": "1"}), "number 'x'"),
        (lambda h: first_model(h).update(numbers={"x": 10**400}), "number 'x'"),
        (lambda h: first_model(h)["arrays"]["values"].update(length=10**12), "bytes where about"),
        (lambda h: first_model(h)["arrays"]["values"].update(length=-1), "no known type or length"),
        (lambda h: first_model(h)["arrays"]["values"].update(dtype="object"), "no known type or length"),
        (lambda h: first_model(h)["arrays"]["values"].update(name="../x"), "missing"),
        (deeper, "more than 32 deep"),
        (lambda h: h["bases"][0].update(rings=[[0, 10, 0, 1]]), "rings reach"),
        (lambda h: h["bases"][0].update(rings=[[0, 90, 0, 1e9]]), "a ring of angle basis 0"),
        (lambda h: h["bases"][0].update(rings=[[0, 90, 0, 10**9]]), "a ring of angle basis 0"),
        (lambda h: h["metadata"].update(material=["x"]), "'material' of the metadata is not an XML element"),
        (lambda h: h["metadata"].update(comments=[1]), "'comments'"),
        (lambda h: h["metadata"].update(other=[["x"]]), "'other'"),
        (lambda h: h.update(warnings="no"), "'warnings'"),
        (lambda h: h["provenance"].update(conversion=[[1]]), "conversion report"),
    ],
)
def test_unsound_headers_are_refused(file, edit, match):
    change(file, edit)
    refused(file, match)


@pytest.mark.parametrize(
    ("text", "match"),
    [
        (b"", "not JSON"),
        (b"[" * 100_000, "not JSON"),
        (b"\xff\xfe", "not JSON"),
        (b"[]", "format is"),
        (b'{"format": "clerestory-bsdf", "version": NaN}', "not JSON"),
    ],
)
def test_headers_that_are_no_json_are_refused(file, text, match):
    content = members(file)
    content["header.json"] = text
    write(file, content)
    refused(file, match)
    del content["header.json"]
    write(file, content)
    refused(file, "header.json is missing")


def test_files_cut_short_are_refused(file):
    data = file.read_bytes()
    for length in [4, 100, len(data) // 2, len(data) - 1]:
        file.write_bytes(data[:length])
        refused(file, "not a sound ZIP file")


def test_flipped_bytes_are_refused_or_harmless(file):
    data = bytearray(file.read_bytes())
    rng = np.random.default_rng(5)
    for place in rng.integers(0, len(data), 150):
        broken = data.copy()
        broken[place] ^= 1 << rng.integers(8)
        file.write_bytes(broken)
        with contextlib.suppress(clerestory.FileFormatError):
            clerestory.read(file)


def test_members_twice_and_unknown_members_are_refused(file):
    content = members(file)
    write(file, content)
    with zipfile.ZipFile(file, "a") as archive, pytest.warns(UserWarning, match="Duplicate"):
        archive.writestr(VALUES, content[VALUES])
    refused(file, "there twice")
    write(file, {**content, "more.npy": npy(SOUND)})
    refused(file, "does not name it")


def test_bombs_are_refused_before_they_are_unpacked(file):
    data = bytearray(file.read_bytes())
    # The central directory claims that the values unpack to 4 GB.
    start = 0
    while (start := data.find(b"PK\x01\x02", start)) >= 0:
        if data[start + 46 : start + 46 + len(VALUES)] == VALUES.encode():
            data[start + 24 : start + 28] = struct.pack("<I", 0xF000_0000)
        start += 4
    file.write_bytes(data)
    refused(file, "claim to hold")
    # An honest bomb: a member of zeros that no header asks for.
    write(file, {"header.json": b"{}", "zeros.npy": bytes(1 << 26)})
    assert file.stat().st_size < 100_000
    refused(file, "format is")
