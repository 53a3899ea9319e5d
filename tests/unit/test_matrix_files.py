"""Radiance's matrix files, and matrices that are kept on disk."""

import numpy as np
import pytest

from clerestory import Basis, ClerestoryError, FileFormatError
from clerestory.annual.cache import Cache
from clerestory.annual.exchange import read, write
from clerestory.annual.phases import Transfer, leaving
from clerestory.sky import SkyPatches
from clerestory.system import pane_from_normal

VALUES = np.random.default_rng(4).random((5, 7, 3))


@pytest.mark.parametrize(("form", "tolerance"), [("ascii", 1e-8), ("float", 1e-7), ("double", 0.0)])
def test_what_is_written_is_read(tmp_path, form, tolerance):
    path = tmp_path / "m.mtx"
    write(path, VALUES, form=form, header=["rcontrib of nothing"])
    assert np.allclose(read(path), VALUES, rtol=tolerance, atol=0.0)


def test_a_matrix_without_components_has_three(tmp_path):
    write(tmp_path / "m.mtx", VALUES[:, :, 0])
    found = read(tmp_path / "m.mtx")
    assert found.shape == (5, 7, 3)
    assert np.allclose(found, VALUES[:, :, :1])


def test_exposure_and_byte_order_count(tmp_path):
    head = b"#?RADIANCE\nNROWS=1\nNCOLS=2\nNCOMP=1\nEXPOSURE=2\nBigEndian=1\nFORMAT=float\n\n"
    (tmp_path / "m.mtx").write_bytes(head + np.array([2.0, 8.0], dtype=">f4").tobytes())
    assert read(tmp_path / "m.mtx").ravel().tolist() == [1.0, 4.0]


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"1 2 3\n", "head is missing"),
        (b"#?RADIANCE\nNCOLS=1\n\n1 1 1", "NROWS or NCOLS is missing"),
        (b"#?RADIANCE\nNROWS=0\nNCOLS=1\n\n", "make no matrix"),
        (b"#?RADIANCE\nNROWS=1\nNCOLS=2\n\n1 1 1", "3 numbers of 6"),
        (b"#?RADIANCE\nNROWS=1\nNCOLS=1\n\n1 1 1 1", "4 numbers where 3"),
        (b"#?RADIANCE\nNROWS=1\nNCOLS=1\n\n1 x 1", "something else than numbers"),
        (b"#?RADIANCE\nNROWS=1\nNCOLS=1\nFORMAT=32-bit_rle_rgbe\n\n", "is not read"),
        (b"#?RADIANCE\nNROWS=1\nNCOLS=1\nEXPOSURE=bright\n\n1 1 1", "EXPOSURE=bright is no number"),
    ],
)
def test_faults_are_named_with_their_file(tmp_path, content, words):
    path = tmp_path / "m.mtx"
    path.write_bytes(content)
    with pytest.raises(FileFormatError, match=words) as found:
        read(path)
    assert str(found.value).startswith(f"{path}: ")


def test_what_is_kept_is_found_by_its_key(tmp_path):
    made = []

    def compute():
        made.append(1)
        return {"values": VALUES}

    cache = Cache(tmp_path)
    for _ in range(2):
        assert np.array_equal(cache.get("view", {"seed": 1}, compute)["values"], VALUES)
    cache.get("view", {"seed": 2}, compute)
    assert len(made) == 2
    assert (cache.found, cache.computed) == (["view"], ["view", "view"])


@pytest.mark.parametrize("damage", ["cut", "changed", "other"])
def test_what_is_damaged_is_computed_again_and_told(tmp_path, damage):
    cache, key = Cache(tmp_path), {"seed": 1}
    cache.get("view", key, lambda: {"values": VALUES})
    path = cache.path_of("view", key)
    content = path.read_bytes()
    if damage == "cut":
        path.write_bytes(content[: len(content) // 2])
    elif damage == "other":
        path.write_bytes(b"no such file")
    else:
        np.savez(path, values=VALUES + 1.0, checksum=np.array("0"))
    again = Cache(tmp_path)
    assert np.array_equal(again.get("view", key, lambda: {"values": VALUES})["values"], VALUES)
    assert "computed again" in again.warnings[0]
    assert np.array_equal(Cache(tmp_path).get("view", key, dict)["values"], VALUES)


def test_a_matrix_of_other_patches_is_refused(tmp_path):
    """Sensors' columns are the windows' interior patches; a matrix of another basis does not go with them."""
    path, full = tmp_path / "view.mtx", Basis.named("klems-full")
    write(path, np.ones((3, 2 * 145)))
    assert read(path, columns_of=full).shape == (3, 290, 3)
    write(path, np.ones((3, 77)))
    with pytest.raises(FileFormatError, match=r"77 columns do not go with the 145 patches") as told:
        read(path, columns_of=full)
    assert str(told.value).startswith(f"{path}: ")
    assert "Klems Half has so many" in str(told.value)
    write(path, np.ones((2306, 1)))
    assert len(read(path, rows_of=SkyPatches.named("reinhart:4"))) == 2306
    with pytest.raises(FileFormatError, match=r"2306 rows do not go with the 578 patches of reinhart:2.*reinhart:4"):
        read(path, rows_of=SkyPatches.named("reinhart:2"))


def test_bases_of_windows_and_room_must_agree():
    full, half = (Basis.named(name) for name in ("klems-full", "klems-half"))
    pane = pane_from_normal(0.7, 0.08)
    one, other = Transfer.of(pane, full), Transfer.of(pane, half)
    with pytest.raises(ClerestoryError, match=r"77 patches \(group 2\) do not go with 145"):
        leaving([one, other])
    with pytest.raises(ClerestoryError, match=r"group 1 is 77 × 77, where .* 145 × 145"):
        leaving([one], [np.zeros((77, 77), dtype=np.float32)])
