"""What is read of photographs, and what is said where something does not fit."""

import json
import re
import tomllib
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
import tifffile
from PIL import Image

from camera import TIMES, Maker
from clerestory import ClerestoryError, FileFormatError
from clerestory.photo import (
    Given,
    Lens,
    Photograph,
    Response,
    Session,
    Spot,
    Vignetting,
    develop,
    find_circle,
    merge,
    read_series,
    read_table,
    recover_response,
)
from clerestory.photo.colour import PRIMARIES, luminance_shares, to_radiance
from clerestory.photo.figure import response_curves
from clerestory.photo.series import third_of_a_stop
from clerestory.photo.session import CalibrationKeys, CameraKeys, CheckKeys, LensKeys, OutputKeys, VignettingKeys
from clerestory.photo.spot import read_spot
from clerestory.photo.vignetting import read_points
from clerestory.picture import Picture
from clerestory.plot import render
from clerestory.trace.keys import RecipeError

MAKER = Maker(Lens("equisolid", (36.0, 24.0), 22.0), shape=(48, 72))
HDRGEN = """4 2.4836 -2.5791 1.0083 0.0852 0.0020
4 2.6082 -2.7529 1.0658 0.0769 0.0020
4 3.1745 -3.6133 1.4038 0.0321 0.0029
"""


def flat(folder, name, time="1/60", *, size=(64, 48), level=100, **more):
    path = folder / name
    image = Image.new("RGB", size, (level, level, level))
    image.save(path, exif=MAKER.exif(Fraction(time), **more).tobytes())
    return path


# --- reading ---------------------------------------------------------------------------------------------------------


def test_exif_of_jpeg_png_and_tiff(tmp_path):
    for name in ("a.jpg", "a.png", "a.tif"):
        photo = Photograph.open(flat(tmp_path, name, "1/125"))
        assert photo.exposure.words == "1/125 s, f/5, ISO 100"
        assert photo.exposure.value == pytest.approx(100.0 / 125.0 / 25.0)
        assert photo.camera.model == "Canon EOS 5D Mark II"
        assert photo.camera.lens == "EF8-15mm f/4L FISHEYE USM"
        assert photo.camera.focal_length == 8.0
        assert photo.camera.automatic_white_balance is False
        assert (photo.shape, photo.bits) == ((48, 64), 8)
        np.testing.assert_allclose(photo.levels(), 100, atol=1)


@pytest.mark.parametrize("suffix", [".jpg", ".tif"])
def test_pictures_are_turned_upright(tmp_path, suffix):
    upright = np.zeros((32, 48, 3), dtype=np.uint8)
    upright[:8, :8] = 255  # upper left
    for number, turn in {
        1: lambda p: p,
        3: lambda p: p[::-1, ::-1],
        6: lambda p: np.rot90(p, 1),
        8: lambda p: np.rot90(p, -1),
    }.items():
        exif = MAKER.exif(Fraction(1, 60))
        exif[274] = number
        path = tmp_path / f"turned{number}{suffix}"
        Image.fromarray(np.ascontiguousarray(turn(upright))).save(path, exif=exif.tobytes())
        photo = Photograph.open(path)
        assert photo.shape == (32, 48)
        levels = photo.levels()
        assert levels[:6, :6].min() > 200
        assert levels[10:, 10:].max() < 60


def test_sixteen_bits_are_kept(tmp_path):
    levels = np.random.default_rng(1).integers(0, 65536, (20, 30, 3), dtype=np.uint16)
    for name, compression in (("plain.tif", None), ("deflated.tif", "zlib")):
        tifffile.imwrite(tmp_path / name, levels, photometric="rgb", compression=compression)
        photo = Photograph.open(tmp_path / name, Given(0.01, 5.0, 100.0))
        assert photo.bits == 16
        assert np.array_equal(photo.levels(), levels)


def test_a_table_of_exposures(tmp_path):
    table = tmp_path / "table.csv"
    table.write_text("\ufefffile, time_s, f_number, iso\na.png, 1/125, 5.6, 200\nb.png, 0.5,,\n", encoding="utf-8")
    found = read_table(table)
    assert found == {"a.png": Given(1 / 125, 5.6, 200.0), "b.png": Given(0.5, None, None)}
    for name in "ab":
        Image.new("RGB", (16, 16)).save(tmp_path / f"{name}.png")
    series = read_series([tmp_path / "b.png", tmp_path / "a.png"], found, given=Given(f_number=5.6, iso=200.0))
    assert [p.path.name for p in series.photographs] == ["a.png", "b.png"]


def test_exposure_times_as_thirds_of_a_stop(tmp_path):
    assert third_of_a_stop(1 / 60) == 1 / 64
    assert third_of_a_stop(1 / 4000) == 1 / 4096
    assert third_of_a_stop(1 / 100) == pytest.approx(2.0 ** (-20 / 3))
    paths = [flat(tmp_path, f"{k}.png", time) for k, time in enumerate(("1/15", "1/60"))]
    assert [p.exposure.time for p in read_series(paths, times="thirds").photographs] == [1 / 64, 1 / 16]


@pytest.mark.parametrize(
    ("name", "make", "words"),
    [
        ("a.cr2", lambda p: p.write_bytes(b"raw"), "dcraw"),
        ("a.gif", lambda p: p.write_bytes(b"GIF89a"), "not a photograph by its name"),
        ("a.jpg", lambda p: p.write_bytes(b"no picture"), "not a picture"),
        ("a.tif", lambda p: p.write_bytes(b"no picture"), "not a TIFF"),
        ("a.png", lambda p: Image.new("L", (9, 9)).save(p), "mode L"),
        ("a.jpg", lambda p: Image.new("RGB", (9, 9)).save(p), "no exposure time and no f-number and no ISO speed"),
        ("a.png", lambda p: Image.fromarray(np.zeros((9, 9), np.uint16)).save(p), "PNG of 16 bits"),
        ("a.tif", lambda p: tifffile.imwrite(p, np.zeros((9, 9), np.uint8)), "not of red, green and blue"),
        ("a.tif", lambda p: tifffile.imwrite(p, np.zeros((9, 9, 3), np.float32), photometric="rgb"), "float32"),
    ],
)
def test_files_that_are_no_photographs(name, make, words, tmp_path):
    path = tmp_path / name
    make(path)
    with pytest.raises(ClerestoryError, match=words) as caught:
        Photograph.open(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert str(caught.value).endswith(")")


def test_a_compression_that_is_not_read(tmp_path):
    path = tmp_path / "lzw.tif"
    Image.new("RGB", (16, 16)).save(path, compression="tiff_lzw")
    with pytest.raises(ClerestoryError, match=r"LZW.*uncompressed"):
        Photograph.open(path, Given(0.1, 5.0, 100.0)).levels()


def test_a_damaged_jpeg(tmp_path):
    path = MAKER.jpegs(tmp_path, TIMES[:1])[0]
    path.write_bytes(path.read_bytes()[:900])
    with pytest.raises(FileFormatError, match="damaged"):
        Photograph.open(path).levels()


# --- a series --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("second", "words"),
    [
        (None, "one picture holds no range"),
        ({"time": "1/60"}, "has the exposure of"),
        ({"size": (60, 48)}, "its size is 60 × 48 pixels"),
        ({"_33437": 8.0}, "its f-number is f/8"),
        ({"_41987": 0}, "its white balance is automatic"),
        ({"_42036": "another"}, "its lens is another"),
        ({"_37386": 15.0}, "its focal length is 15.0 mm"),
        ({"_33434": None}, "EXIF holds no exposure time"),
        ({"_33437": None}, "EXIF holds no f-number"),
    ],
)
def test_what_makes_no_series(second, words, tmp_path):
    paths = [flat(tmp_path, "a.png"), flat(tmp_path, "c.png", "1/30")][: 1 if second is None else 2]
    if second is not None:
        paths.append(flat(tmp_path, "b.png", **({"time": "1/125"} | second)))
    with pytest.raises(ClerestoryError, match=words) as caught:
        read_series(paths)
    assert str(caught.value).startswith(str(paths[-1] if second != {"time": "1/60"} else tmp_path / "b.png"))


def test_what_is_doubtful_in_a_series(tmp_path):
    paths = [
        flat(tmp_path, "a.png", "1/1000", _41987=0),
        flat(tmp_path, "b.png", "1/30", _41987=0, _34855=200),
    ]
    warnings = " ".join(read_series(paths).warnings)
    assert "white balance was automatic" in warnings
    assert "ISO speed changes" in warnings
    assert "67-fold" in warnings


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("name,time\na,1\n", "no columns file and time_s"),
        ("file,time_s,speed\na,1,2\n", "'speed' is not known"),
        ("file,time_s\na,fast\n", "line 2: time_s 'fast'"),
        ("file,time_s\na,1/0\n", "line 2: time_s"),
        ("file,time_s\na,\n", "line 2 lacks"),
        ("file,time_s\na,1\na,2\n", "names a again"),
        ("file,time_s\n", "no line under the head"),
    ],
)
def test_tables_that_do_not_fit(text, words, tmp_path):
    path = tmp_path / "t.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(FileFormatError, match=words) as caught:
        read_table(path)
    assert str(caught.value).startswith(f"{path}: ")


def test_a_picture_that_the_table_lacks(tmp_path):
    with pytest.raises(ClerestoryError, match=r"b\.png: is not in the table"):
        read_series([flat(tmp_path, "a.png"), flat(tmp_path, "b.png", "1/30")], {"a.png": Given(0.1)})


# --- response --------------------------------------------------------------------------------------------------------


def test_responses_come_back_from_files(tmp_path):
    level = np.arange(256) / 255.0
    made = Response(np.stack([0.9 * level**2.2, level**2.2, 1.1 * level**2.1]), "debevec", 0.01)
    made.write(tmp_path / "r.json")
    back = Response.read(tmp_path / "r.json")
    np.testing.assert_allclose(back.curves, made.curves, rtol=1e-6)
    assert json.loads((tmp_path / "r.json").read_text())["method"] == "debevec"
    table = back.table(16)
    assert table.shape == (3, 65536)
    assert table[1, 257 * 100] == pytest.approx(made.curves[1, 100], rel=1e-6)
    assert render(response_curves({"": made}), ".png", dpi=40).startswith(b"\x89PNG")


def test_response_of_hdrgen(tmp_path):
    path = tmp_path / "camera.rsp"
    path.write_text(HDRGEN, encoding="ascii")
    response = Response.read(path)
    x = 200.5 / 256.0
    top = 255.5 / 256.0
    green = [2.6082, -2.7529, 1.0658, 0.0769, 0.0020]
    assert response.curves[1, 200] == pytest.approx(np.polyval(green, x) / np.polyval(green, top), rel=1e-9)
    assert (np.diff(response.curves, axis=1) > 0.0).all()
    assert response.curves.min() > 0.0


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("a.json", "{}", "not a response"),
        ("a.json", '{"red": [1], "green": [1], "blue": [1]}', "does not fit"),
        ("a.json", json.dumps({key: list(range(256, 0, -1)) for key in ("red", "green", "blue")}), "falls"),
        ("a.rsp", "1 1 0\n1 1 0\n", "three lines"),
        ("a.rsp", "2 1 0\n2 1 0\n2 1 0\n", "three lines"),
        ("a.rsp", "1 -1 1\n1 1 0\n1 1 0\n", "does not rise"),
    ],
)
def test_files_that_are_no_response(name, text, words, tmp_path):
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    with pytest.raises(FileFormatError, match=words) as caught:
        Response.read(path)
    assert str(caught.value).startswith(f"{path}: ")


def test_a_series_without_even_spots(tmp_path):
    paths = [flat(tmp_path, f"{k}.png", time, level=k) for k, time in enumerate(("1/60", "1/30"))]
    with pytest.raises(ClerestoryError, match="only 0 even spots"):
        recover_response(read_series(paths))


# --- merging ---------------------------------------------------------------------------------------------------------


def levelled(folder, levels, *, change=None):
    """A series with one picture for each stop, all of one even level."""
    for k, level in enumerate(levels):
        pixels = np.full((16, 16, 3), level, dtype=np.uint8)
        if change is not None and k == change:
            pixels[:4, :4] = 230
        Image.fromarray(pixels).save(folder / f"{k}.png", exif=MAKER.exif(Fraction(2**k, 1000)))
    return read_series([folder / f"{k}.png" for k in range(len(levels))])


def test_too_bright_too_dark_and_between(tmp_path):
    for name in ("bright", "dark", "between"):
        (tmp_path / name).mkdir()
    bright = merge(levelled(tmp_path / "bright", (252, 255)), Response.linear())
    assert bright.saturated.all()
    assert not bright.between.any()
    # The limit is that of the highest reliable level of the shortest exposure.
    np.testing.assert_allclose(bright.pixels, bright.most, rtol=1e-5)
    level = np.maximum(np.arange(256) / 255.0, 1e-3) ** 2.2
    camera = Response(np.stack([level] * 3), "debevec")
    dark = merge(levelled(tmp_path / "dark", (0, 2)), camera)
    assert dark.dark.all()
    assert not dark.saturated.any()
    between = merge(levelled(tmp_path / "between", (3, 255)), camera)
    assert between.between.all()
    assert not (between.dark | between.saturated).any()


def test_ghosts_are_found(tmp_path):
    level = np.maximum(np.arange(256) / 255.0, 1e-3) ** 2.2
    camera = Response(np.stack([level] * 3), "debevec")
    levels = [40 * 2 ** (k / 2.2) for k in range(5)]
    assert not merge(levelled(tmp_path, levels), camera).ghosts.any()
    ghosts = merge(levelled(tmp_path, levels, change=1), camera).ghosts
    assert ghosts[:4, :4].all()
    assert not ghosts[4:, 4:].any()


# --- lens and spots --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("x", "y", "radius"), [(361.3, 238.6, 225.0), (350.0, 240.0, 300.0), (400.2, 262.8, 210.4)])
def test_the_circle_is_found(x, y, radius):
    maker = Maker(Lens("equisolid", (x, y), radius))
    levels = (255.0 * np.clip(maker.light() / 130.0, 0.0, 1.0) ** 0.45).astype(np.uint8)
    levels = np.clip(levels + np.random.default_rng(2).integers(0, 4, levels.shape), 0, 255).astype(np.uint8)
    circle = find_circle(levels)
    assert np.abs(np.array(circle.centre) - (x, y)).max() < 0.5
    assert circle.radius == pytest.approx(radius, abs=1.0)
    assert circle.share > (0.95 if radius < 230 else 0.25)


@pytest.mark.parametrize("scene", ["lower half dark", "a third lit"])
def test_the_circle_is_found_by_a_part_of_its_border_within_stray_light(scene):
    maker = Maker(Lens("equisolid", (361.3, 238.6), 225.0))
    y, x = np.mgrid[0:480, 0:720]
    lit = y <= 260 if scene == "lower half dark" else np.abs(np.arctan2(y - 238, x - 361)) < 1.0
    haze = 1.5 * np.exp(-np.maximum(np.hypot(x - 361.3, y - 238.6) - 225.0, 0.0) / 40.0)
    light = maker.light() * lit[..., None] + haze[..., None]
    levels = 255.0 * np.clip(light / 130.0, 0.0, 1.0) ** 0.45 + np.random.default_rng(2).normal(0.0, 2.0, light.shape)
    circle = find_circle(np.clip(levels, 0, 255).astype(np.uint8))
    assert circle.radius == pytest.approx(225.0, abs=1.0)
    assert np.abs(np.array(circle.centre) - (361.3, 238.6)).max() < 1.0


@pytest.mark.parametrize("scene", ["black", "full", "square"])
def test_where_no_circle_is(scene):
    levels = np.zeros((200, 300, 3), dtype=np.uint8)
    if scene == "full":
        levels += 120
    if scene == "square":
        levels[60:140, 40:260] = 200
    with pytest.raises(ClerestoryError, match="no circle of a fisheye was found"):
        find_circle(levels)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Lens("orthographic", (0, 0), 10.0, 95.0), "an orthographic lens does not reach 95°"),
        (lambda: Lens("perspective", (0, 0), 10.0, 90.0), "a perspective lens does not reach 90°"),
        (lambda: Lens("equisolid", (0, 0), -1.0), "radius of -1"),
        (lambda: Lens(None, (0, 0), 10.0), "a projection or a table"),
        (lambda: Lens.of_table([(0, 0), (40, 2), (30, 3), (90, 2.5)], (0, 0), 10.0), "grows with the angle"),
        (lambda: Lens.of_table([(0, 0), (40, 2)], (0, 0), 10.0), "does not reach 90°"),
        (lambda: Vignetting(), "polynomial or a table"),
        (lambda: Vignetting(coefficients=(-0.9,)), "no lens's"),
        (lambda: Vignetting.fit([(0, 1.0), (30, 0.9)]), "do not determine"),
        (lambda: Vignetting.fit([(0, 1.0), (30, -0.9)]), "not above 0"),
        (lambda: Spot(100.0), "pixels or in a direction"),
        (lambda: Spot(-1.0, (3.0, 4.0)), "not possible"),
        (lambda: Spot(1.0, (3.0,)), "1 numbers"),
    ],
)
def test_lenses_vignettings_and_spots_that_cannot_be(make, words):
    with pytest.raises(ClerestoryError, match=words):
        make()


def test_spots():
    luminance = np.full((60, 80), 10.0, dtype=np.float32)
    luminance[20:30, 40:50] = 30.0
    doubtful = np.zeros((60, 80), dtype=bool)
    doubtful[0, 0] = True
    lens = Lens("equidistant", (40.0, 30.0), 30.0)
    for spot, count, mean in [
        (Spot(60.0, (45.0, 25.0)), 1, 30.0),
        (Spot(60.0, (45.0, 25.0, 2.0)), 13, 30.0),
        (Spot(60.0, (49.0, 29.0, 40.0, 20.0)), 100, 30.0),
        (Spot(60.0, direction=(15.0, 15.0, 6.0)), 13, 30.0),
        (Spot(60.0, (30.0, 20.0, 49.0, 29.0)), 200, 20.0),
    ]:
        reading = read_spot(spot, luminance, doubtful, lens)
        assert reading.pixels == pytest.approx(count, abs=3 if spot.direction else 0)
        assert reading.mean == pytest.approx(mean)
        assert reading.factor == pytest.approx(60.0 / mean)
    for spot, words in [
        (Spot(1.0, (80.0, 5.0)), "not within the picture of 80 × 60"),
        (Spot(1.0, (1.0, 1.0, 5.0)), "not within"),
        (Spot(1.0, (0.0, 0.0)), "too bright or too dark"),
        (Spot(1.0, direction=(120.0, 0.0)), "not within"),
    ]:
        with pytest.raises(ClerestoryError, match=words):
            read_spot(spot, luminance, doubtful, lens)
    with pytest.raises(ClerestoryError, match="needs a lens"):
        read_spot(Spot(1.0, direction=(0.0, 0.0)), luminance, doubtful, None)
    with pytest.raises(ClerestoryError, match="black in the picture"):
        read_spot(Spot(1.0, (5.0, 5.0)), 0.0 * luminance, doubtful, None)


def test_tables_of_points(tmp_path):
    path = tmp_path / "v.csv"
    path.write_text("# uniform source\ntheta_deg,value\n0,1\n45, 0.9\n", encoding="utf-8")
    np.testing.assert_array_equal(read_points(path), [[0.0, 1.0], [45.0, 0.9]])
    for text, words in (("theta,value\n0,1\n5,x\n", "line 3"), ("0,1,2\n3,4,5\n6,7,8\n", "line 2"), ("0,1\n", "fewer")):
        path.write_text(text, encoding="utf-8")
        with pytest.raises(FileFormatError, match=words):
            read_points(path)


@pytest.mark.parametrize("name", PRIMARIES)
def test_colours_keep_their_luminance(name):
    rng = np.random.default_rng(4)
    pixels = np.concatenate([rng.uniform(0.0, 500.0, (200, 3)), 100.0 * np.eye(3), np.full((1, 3), 179.0)])
    shares = luminance_shares(PRIMARIES[name])
    if name == "srgb":
        np.testing.assert_allclose(shares, [0.2126, 0.7152, 0.0722], atol=1e-4)
    made = to_radiance(pixels[None], PRIMARIES[name])
    assert made.min() >= 0.0
    np.testing.assert_allclose(Picture(made).luminance[0], pixels @ shares, rtol=2e-5)
    np.testing.assert_allclose(made[0, -1], 1.0, rtol=1e-3)  # white stays white


# --- sessions --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("tables", "words"),
    [
        ({}, "pictures: is missing"),
        ({"pictures": []}, "pictures"),
        ({"picture": ["a"]}, "picture: there is no such key .did you mean pictures"),
        ({"lens": {"projection": "equisold"}}, "lens.projection"),
        ({"lens": {"centre_px": [1, 2]}}, "lens.radius_px: the centre is given but not the radius"),
        ({"lens": {"projection": "perspective"}}, "draws no circle"),
        ({"lens": {"projection": "table"}}, "go together"),
        ({"camera": {"encoding": "linear", "response": "a.rsp"}}, "camera.response: linear pictures"),
        ({"vignetting": {}}, "vignetting.points: either"),
        ({"calibration": {"factor": 1, "by_illuminance": True}}, "exclude each other"),
        ({"calibration": {"by_illuminance": True}}, "check.illuminance: the calibration needs it"),
        ({"calibration": {"spots": [{"luminance": 5}]}}, r"calibration.spots\[1\].pixels: either"),
        ({"calibration": {"spots": [{"luminance": 0, "pixels": [1, 2]}]}}, r"spots\[1\].luminance"),
        ({"check": {"fill_overflow": True}}, "needs a measured illuminance"),
        ({"lens": {"projection": "none"}, "check": {"illuminance": 5}}, "needs to know where the lens"),
        ({"output": {"size_px": 5}}, "output.size_px"),
    ],
)
def test_sessions_that_cannot_be_followed(tables, words):
    given = tables if not tables or "pictur" in next(iter(tables)) else {"pictures": ["a.jpg"]} | tables
    with pytest.raises(RecipeError, match=words):
        Session.of(given)


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    folder = tmp_path_factory.mktemp("small")
    maker = replace(MAKER, shape=(160, 240), lens=Lens("equisolid", (120.0, 80.0), 75.0), noise=0.2)
    maker.jpegs(folder, TIMES[1::2])
    return folder


@pytest.mark.parametrize(
    ("tables", "words"),
    [
        ({"pictures": ["*.png"]}, r"\*.png: stands for no file"),
        ({"output": {"view": "-vtv"}}, "output.view: a perspective view is not made"),
        ({"output": {"view": "-vta -vh 120"}}, "180° by 180°"),
        ({"output": {"view": "-vd 0 0 1"}}, "parallel"),
        ({"lens": {"centre_px": [900, 80], "radius_px": 70}}, "outside of the pictures"),
        ({"lens": {"field_deg": 360.0, "projection": "stereographic"}}, "does not reach 180°"),
        ({"exposures": "no.csv"}, "no.csv"),
        ({"calibration": {"spots": [{"pixels": [1, 1], "luminance": 50}]}}, "too bright or too dark|black"),
    ],
)
def test_sessions_that_fail_on_their_files(tables, words, small):
    with pytest.raises((ClerestoryError, OSError), match=words):
        develop(Session.of({"pictures": ["*.JPG"]} | tables), small)


def test_what_a_session_may_leave_out(small):
    made = develop(Session.of({"pictures": ["*.JPG"], "output": {"size_px": 64}}), small)
    words = " ".join(made.warnings)
    assert "vignetting is not corrected" in words
    assert "nothing calibrates the picture" in words
    assert any("equisolid" in text for text in made.assumptions)
    assert made.difference_percent is None
    assert made.circle.radius == pytest.approx(75.0, abs=1.0)
    flat_one = develop(Session.of({"pictures": ["*.JPG"], "lens": {"projection": "none"}}), small)
    assert flat_one.picture.view is None
    assert flat_one.picture.shape == (160, 240)


def test_illuminance_calibrates_or_checks(small):
    base = {"pictures": ["*.JPG"], "output": {"size_px": 64}}
    made = develop(Session.of(base | {"check": {"illuminance": 900}, "calibration": {"by_illuminance": True}}), small)
    assert made.illuminance == pytest.approx(900.0)
    assert made.difference_percent is None
    factor = {"calibration": {"factor": made.factor}}
    for measured, limit, acceptable in ((1100.0, 25.0, True), (1250.0, 25.0, False), (1100.0, 10.0, False)):
        again = develop(Session.of(base | factor | {"check": {"illuminance": measured, "limit_percent": limit}}), small)
        assert again.illuminance == pytest.approx(900.0)
        assert again.difference_percent == pytest.approx(100.0 * (900.0 / measured - 1.0))
        assert again.acceptable is acceptable
        assert any("do not use it" in text for text in again.warnings) is not acceptable


def test_a_lens_that_does_not_see_the_hemisphere(small):
    made = develop(
        Session.of(
            {
                "pictures": ["*.JPG"],
                "lens": {"projection": "perspective", "radius_px": 100, "field_deg": 90},
                "output": {"size_px": 64},
            }
        ),
        small,
    )
    assert any("% of the hemisphere" in text for text in made.warnings)


def test_times_that_exif_rounds_are_noticed(tmp_path):
    maker = Maker(Lens("equisolid", (180.0, 120.0), 112.0), shape=(240, 360))
    written = [Fraction(1, n) for n in (15, 30, 60, 125, 250, 500)]
    for folder, kept in (("rounded", [Fraction(1, 2**k) for k in range(4, 10)]), ("exact", written)):
        (tmp_path / folder).mkdir()
        rows = [f"{p.name},{t}" for p, t in zip(maker.jpegs(tmp_path / folder, kept), written, strict=True)]
        (tmp_path / folder / "t.csv").write_text("\n".join(["file,time_s", *rows]), encoding="utf-8")
        tables = {"pictures": ["*.JPG"], "exposures": "t.csv", "output": {"size_px": 64}}
        for times in ("written", "thirds"):
            made = develop(Session.of(tables | {"times": times}), tmp_path / folder)
            told = any("--times thirds" in text for text in made.warnings)
            assert told is (folder == "rounded" and times == "written")


def test_light_that_changes_is_seen(small, tmp_path):
    for path in small.glob("*.JPG"):
        (tmp_path / path.name).write_bytes(path.read_bytes())
    times = "\n".join(f"{p.name},{t}" for p, t in zip(sorted(small.glob("*.JPG")), TIMES[1::2], strict=True))
    (tmp_path / "times.csv").write_text(f"file,time_s\n{times}\n".replace("1/500", "1/380"), encoding="utf-8")
    response = recover_response(read_series(sorted(small.glob("*.JPG"))))
    response.write(tmp_path / "r.json")
    tables = {"pictures": ["*.JPG"], "exposures": "times.csv", "camera": {"response": "r.json"}}
    made = develop(Session.of(tables | {"output": {"size_px": 64}}), tmp_path)
    assert sum("the light grew" in text for text in made.warnings) == 2


def test_the_guide_has_every_key_and_its_session_can_be_followed():
    text = (Path(__file__).parents[2] / "docs" / "photographs.md").read_text(encoding="utf-8")
    (session,) = re.findall(r"```toml\n(.*?)```", text, re.DOTALL)
    assert Session.of(tomllib.loads(session)).check.illuminance == 1800.0
    inner = {"camera": CameraKeys, "lens": LensKeys, "vignetting": VignettingKeys, "calibration": CalibrationKeys}
    inner |= {"check": CheckKeys, "output": OutputKeys}
    for name in Session.model_fields:
        keys = [f"{name}.{key}" for key in inner[name].model_fields] if name in inner else [name]
        for key in keys:
            assert f"`{key}`" in text, key
