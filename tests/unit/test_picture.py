"""Pictures: files, luminances, views, and what people see of them."""

import subprocess
from pathlib import Path

import numpy as np
import pytest

from clerestory import ClerestoryError, FileFormatError
from clerestory.picture import Picture, View, falsecolour, tone_map, tone_mapped
from clerestory.plot import render

VIEW = View("-vta -vp 1 2 3 -vd 0 1 0 -vu 0 0 1 -vh 180 -vv 180")


@pytest.fixture
def picture():
    rng = np.random.default_rng(5)
    return Picture(10.0 ** rng.uniform(-3, 5, (40, 50, 3)), VIEW, header=["SOFTWARE= a test"])


@pytest.mark.parametrize(("suffix", "tolerance"), [(".hdr", 1 / 256), (".pic", 1 / 256), (".xyze", 0.1), (".exr", 0.0)])
def test_files_come_back(picture, suffix, tolerance, tmp_path):
    path = tmp_path / f"picture{suffix}"
    picture.write(path)
    back = Picture.read(path)
    assert back.view == VIEW
    assert back.shape == (40, 50)
    largest = picture.pixels.max(axis=2, keepdims=True)
    assert np.all(np.abs(back.pixels - picture.pixels) <= tolerance * largest)
    if suffix != ".exr":
        assert "SOFTWARE= a test" in back.header
    # A second time nothing is lost, and the file is the same.
    if suffix == ".hdr":
        back.write(tmp_path / "again.hdr")
        assert np.array_equal(Picture.read(tmp_path / "again.hdr").pixels, back.pixels)


def test_luminance_follows_primaries():
    pixels = np.eye(3)[None]
    assert Picture(pixels).luminance[0] == pytest.approx(179.0 * np.array([0.265074126, 0.670114631, 0.064811243]))
    srgb = Picture(pixels, primaries=[0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290])
    assert srgb.luminance[0] == pytest.approx(179.0 * np.array([0.2126, 0.7152, 0.0722]), rel=2e-3)
    with pytest.raises(ClerestoryError, match="no colours of a display"):
        _ = Picture(pixels, primaries=[0.1] * 8).luminance


def test_values_of_regions():
    luminance = np.full((100, 100), 100.0)
    luminance[40:60, 60:80] = 1000.0
    picture = Picture(np.repeat(luminance[..., None] / 179.0, 3, axis=2), VIEW)
    assert picture.luminance_at(70, 50) == pytest.approx(1000.0)
    assert picture.mean_in_rectangle((60, 80), (40, 60)) == pytest.approx(1000.0)
    direction = VIEW.rays([[0.7, 0.5]])[1][0]
    assert picture.mean_in_cone(direction, 5.0) == pytest.approx(1000.0)
    assert 100.0 < picture.mean_in_cone(direction, 60.0) < 400.0
    for call in (
        lambda: picture.luminance_at(100, 0),
        lambda: picture.mean_in_rectangle((5, 5), (0, 9)),
        lambda: picture.mean_in_cone([0.0, -1.0, 0.0], 1.0),
        lambda: Picture(picture.pixels).mean_in_cone([0, 1, 0], 5.0),
    ):
        with pytest.raises(ClerestoryError):
            call()


def test_views():
    assert View(VIEW.options) == VIEW
    assert VIEW.updated("-vth").projection == "h"
    assert VIEW.size_within(800, 600) == (600, 600)
    origins, directions = VIEW.rays([[0.5, 0.5], [1.0, 0.5]])
    np.testing.assert_allclose(origins, [[1, 2, 3]] * 2)
    np.testing.assert_allclose(directions, [[0, 1, 0], [1, 0, 0]], atol=1e-12)
    np.testing.assert_allclose(VIEW.locate(directions), [[0.5, 0.5], [1.0, 0.5]])
    exact = VIEW.updated("-vth").solid_angles(64, 64, exact=True).sum()
    assert exact == pytest.approx(2.0 * np.pi, rel=1e-4)
    with pytest.raises(ClerestoryError, match="parallel to the line of sight"):
        View("-vd 0 0 1 -vu 0 0 1")


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"GIF89a", "does not begin"),
        (b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 60000 +X 60000\n\x02\x02", "more than"),
        (b"#?RADIANCE\n\n-Y 2 +X 9\n\x02\x02\x00\x09\x89\x01\x89\x01", "ends before"),
        (b"\x76\x2f\x31\x01\x02\x00\x00\x00channels\x00", "OpenEXR"),
    ],
)
def test_damaged_files_are_named(content, words, tmp_path):
    path = tmp_path / "broken.hdr"
    path.write_bytes(content)
    with pytest.raises(FileFormatError, match=words) as caught:
        Picture.read(path)
    assert str(caught.value).startswith(f"{path}: ")


def test_a_name_without_a_format(picture, tmp_path):
    with pytest.raises(ClerestoryError, match="end it with"):
        picture.write(tmp_path / "picture.png")


def test_pictures_for_people(picture):
    for figure in (
        falsecolour(picture, isolines=[100.0, 1e5]),
        falsecolour(picture, scale="linear"),
        tone_mapped(picture),
    ):
        assert render(figure, ".png", dpi=40).startswith(b"\x89PNG")
    mapped = tone_map(picture)
    assert mapped.shape == (40, 50, 3)
    assert 0.0 <= mapped.min() <= mapped.max() <= 1.0
    assert np.all(tone_map(Picture(np.zeros((4, 4, 3)))) == 0.0)


def _programs(pyradiance) -> Path:
    return Path(pyradiance.anci.BINPATH)


def test_radiance_reads_what_we_write(picture, tmp_path, require_pyradiance):
    for suffix in (".hdr", ".xyze"):
        path = tmp_path / f"picture{suffix}"
        picture.write(path)
        command = [str(_programs(require_pyradiance) / "pvalue"), "-o", "-d", "-h", "-H", str(path)]
        run = subprocess.run(command, capture_output=True, text=True, check=True)
        values = np.array([line.split() for line in run.stdout.splitlines()], dtype=float).reshape(40, 50, 3)
        ours = Picture.read(path).pixels
        if suffix == ".xyze":
            # pvalue gives X, Y, Z with the exposure taken out: photometric values.
            np.testing.assert_allclose(values[..., 1], Picture.read(path).luminance, rtol=2e-3)
        else:
            np.testing.assert_allclose(values, ours, rtol=2e-3)


def test_xyze_of_radiance(picture, tmp_path, require_pyradiance):
    picture.write(tmp_path / "rgb.hdr")
    command = [str(_programs(require_pyradiance) / "ra_xyze"), str(tmp_path / "rgb.hdr"), str(tmp_path / "xyz.hdr")]
    subprocess.run(command, check=True)
    rgb, xyz = Picture.read(tmp_path / "rgb.hdr"), Picture.read(tmp_path / "xyz.hdr")
    largest = 179.0 * rgb.pixels.max(axis=2)
    assert np.all(np.abs(rgb.luminance - xyz.luminance) <= 0.01 * largest)
    assert xyz.view == VIEW


def test_real_pictures(sample_data, require_pyradiance):
    program = _programs(require_pyradiance) / "pvalue"
    for path in sorted((sample_data / "images").glob("*.hdr")):
        picture = Picture.read(path)
        command = [str(program), "-o", "-b", "-h", "-H", "-d", str(path)]
        run = subprocess.run(command, capture_output=True, text=True, check=True)
        values = np.array(run.stdout.split(), dtype=float).reshape(picture.shape)
        weights = np.array([0.265074126, 0.670114631, 0.064811243])
        np.testing.assert_allclose(values, picture.pixels @ weights, rtol=2e-3, err_msg=path.name)
