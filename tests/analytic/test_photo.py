"""A known scene through a known camera comes back: response, luminance, illuminance, directions."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from camera import SRGB, TIMES, Maker, curve, scene
from clerestory.photo import (
    Lens,
    Session,
    Vignetting,
    develop,
    merge,
    read_series,
    recover_response,
    resample,
)
from clerestory.photo.illuminance import illuminance
from clerestory.picture import View

MAKER = Maker(Lens("equisolid", (361.3, 238.6), 225.0))
ANGULAR = View("-vta -vh 180 -vv 180")
# A circle in the flat panel of 320 cd/m² (azimuth 20°, elevation −35°).
PANEL = (20.0, -35.0, 4.0)
PANEL_LUMINANCE = float(320.0 * 1.06 * np.dot(SRGB, (1.2, 0.95, 0.8)))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("photographs")
    MAKER.jpegs(folder)
    MAKER.tiffs(folder)
    return folder


@pytest.fixture(scope="module")
def series(folder):
    paths = sorted(folder.glob("*.JPG"))
    return read_series([*paths[1::2], *paths[::-2]])  # in no order


@cache
def exact_illuminance() -> float:
    """Of the scene on the plane of the lens, by a fine map."""
    d = np.nan_to_num(ANGULAR.pixel_directions(900, 900) @ ANGULAR.frame.T)
    luminance = np.where(d[..., 2] > 0.0, scene(d) @ SRGB, 0.0)
    return illuminance(luminance, ANGULAR)


@pytest.mark.parametrize("method", ["debevec", "mitsunaga"])
def test_response(series, method):
    response = recover_response(series, method)
    light = np.linspace(0.0, 1.0, 200_001)
    truth = np.interp(np.arange(256), 255.0 * curve(light), light)
    used = slice(12, 246)
    for found in response.curves:
        ratio = found[used] / truth[used]
        ratio /= np.exp(np.log(ratio).mean())
        assert np.abs(ratio - 1.0).max() < 0.03
        assert np.sqrt(np.mean((ratio - 1.0) ** 2)) < 0.01
    # Grey stays grey.
    np.testing.assert_allclose(response.curves[:, 64:193], response.curves[1, 64:193] * np.ones((3, 1)), rtol=0.03)
    assert response.residual < 0.02


@pytest.mark.parametrize("method", ["debevec", "mitsunaga"])
def test_merged_light(series, method):
    merged = merge(series, recover_response(series, method))
    truth = MAKER.light()
    lit = truth.min(axis=2) > 0.0
    ratio = merged.pixels[lit] / truth[lit]
    scale = np.exp(np.log(ratio).mean())
    assert not merged.saturated.any()
    # Edges between a source and a wall are spread by JPEG; all else is within 2 %.
    assert np.sqrt(np.mean((merged.pixels[lit] @ SRGB / scale / (truth[lit] @ SRGB) - 1.0) ** 2)) < 0.02
    assert np.abs(np.exp(np.log(ratio / scale).mean(axis=0)) - 1.0).max() < 0.01
    assert merged.ghosts.mean() < 1e-3
    # A camera of nominal speed: the scene's scale is the sensor's saturation over that of the standard.
    assert scale == pytest.approx(78.0 / 0.65 / MAKER.saturation, rel=0.03)


@pytest.mark.parametrize("kind", ["JPG", "tif"])
@pytest.mark.parametrize("projection", ["-vta", "-vth"])
def test_luminance_and_illuminance(folder, kind, projection):
    tables = {
        "pictures": [f"*.{kind}"],
        "lens": {"projection": "equisolid", "centre_px": [361.3, 238.6], "radius_px": 225.0},
        "vignetting": {"coefficients": [-0.12, 0.01]},
        "calibration": {"spots": [{"direction_deg": list(PANEL), "luminance": PANEL_LUMINANCE}]},
        "output": {"view": projection, "size_px": 400},
    }
    if kind == "tif":
        table = "\n".join(f"raw_{k}.tif,{t},5,100" for k, t in enumerate(TIMES))
        (folder / "exposures.csv").write_text(f"file,time_s,f_number,iso\n{table}\n", encoding="utf-8")
        tables["exposures"] = "exposures.csv"
    made = develop(Session.of(tables), folder)
    assert made.response.is_linear == (kind == "tif")
    assert made.illuminance == pytest.approx(exact_illuminance(), rel=0.01)
    assert made.factor == pytest.approx(MAKER.saturation * 0.65 / 78.0, rel=0.02)

    # Luminances away from edges, which 400 pixels cannot hold.
    view = made.picture.view
    d = np.nan_to_num(view.pixel_directions(400, 400) @ view.frame.T)
    truth = np.where(d[..., 2] > 0.05, scene(d) @ SRGB, np.nan)
    around = np.stack([np.roll(truth, shift, axis=(0, 1)) for shift in ((2, 2), (-2, 2), (2, -2), (-2, -2))])
    even = np.all(np.abs(around / truth - 1.0) < 0.05, axis=0)
    assert even.mean() > 0.5
    ratio = made.picture.luminance[even] / truth[even]
    assert np.sqrt(np.mean((ratio - 1.0) ** 2)) < 0.02
    assert ratio.mean() == pytest.approx(1.0, abs=0.01)
    # Black behind the eye.
    behind = view.pixel_directions(400, 400) @ view.frame[2]
    assert made.picture.luminance[~(behind >= 0.0)].max() == 0.0


@pytest.mark.parametrize("projection", ["equisolid", "equidistant", "orthographic", "stereographic", "perspective"])
@pytest.mark.parametrize("output", ["-vta", "-vth"])
def test_a_point_lands_where_it_should(projection, output):
    radius_at, edge = {
        "equisolid": (lambda t: 2.0 * np.sin(t / 2.0), 90.0),
        "equidistant": (lambda t: t, 90.0),
        "orthographic": (np.sin, 90.0),
        "stereographic": (lambda t: 2.0 * np.tan(t / 2.0), 90.0),
        "perspective": (np.tan, 60.0),
    }[projection]
    lens = Lens(projection, (410.0, 290.0), 280.0, edge)
    view = ANGULAR.updated(output)
    points = [(0.0, 0.0), (5.0, 30.0), (25.0, 100.0), (48.0, 225.0), (58.0, 310.0)]
    pixels = np.zeros((600, 800, len(points)), dtype=np.float32)
    expected = []
    for k, (theta, azimuth) in enumerate(np.radians(points)):
        radius = 280.0 * radius_at(theta) / radius_at(np.radians(edge))
        x, y = 410.0 + radius * np.cos(azimuth), 290.0 - radius * np.sin(azimuth)
        pixels[int(y), int(x), k] = 1.0
        # The middle of the pixel that was lit.
        mid = np.array([int(x) + 0.5 - 410.0, 290.0 - int(y) - 0.5])
        seen = lens.theta_at(np.hypot(*mid))
        assert seen == pytest.approx(theta, abs=0.01)
        law = {"-vta": seen / (0.5 * np.pi), "-vth": np.sin(seen)}[output]
        across = mid / max(np.hypot(*mid), 1e-12)
        expected.append([200.0 - 200.5 * law * across[1], 200.0 + 200.5 * law * across[0]])
    shown = resample(pixels, lens, view, 401)
    for k, place in enumerate(expected):
        layer = shown[..., k]
        centre = (np.indices(layer.shape) * layer).sum(axis=(1, 2)) / layer.sum()
        assert np.abs(centre - place).max() < 0.5


def test_lens_and_its_inverse():
    points = [(0.0, 0.0), (20.0, 1.05), (45.0, 2.2), (70.0, 3.1), (95.0, 3.7)]
    lenses = [Lens(name, (400.0, 300.0), 250.0) for name in ("equisolid", "equidistant", "stereographic")]
    for lens in [*lenses, Lens.of_table(points, (400.0, 300.0), 250.0)]:
        theta = np.linspace(0.0, 0.5 * np.pi, 50)
        np.testing.assert_allclose(lens.theta_at(lens.radius_at(theta)), theta, atol=1e-12)
        assert lens.radius_at(0.5 * np.pi) == pytest.approx(250.0)
        directions = lens.directions(np.array([[420.0, 290.0], [300.0, 410.0]]))
        np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1.0)
        np.testing.assert_allclose(lens.locate(directions), [[420.0, 290.0], [300.0, 410.0]])
        # Right is right and up is up.
        assert directions[0, 0] > 0.0
        assert directions[0, 1] > 0.0


@pytest.mark.parametrize(("radius", "source_px"), [(225.0, 2.0), (700.0, 3.0), (700.0, 9.0)])
@pytest.mark.parametrize("output", ["-vta", "-vth"])
def test_resampling_keeps_the_illuminance(radius, source_px, output):
    lens = Lens("equisolid", (radius + 10.3, radius + 9.6), radius)
    shape = (int(2 * radius) + 20,) * 2
    theta = lens.thetas(shape)
    x, y = np.meshgrid(np.arange(shape[1]) + 0.5, np.arange(shape[0]) + 0.5)
    luminance = np.where(theta <= 0.5 * np.pi, 100.0 + 40.0 * np.sin(x / 30.0), 0.0).astype(np.float32)
    source = np.hypot(x - 1.37 * radius, y - 0.7 * radius) < source_px
    luminance[source] = 1e6
    # An equisolid lens: all pixels have one solid angle.
    omega = 2.0 * np.pi / (np.pi * radius**2)
    exact = float((luminance * np.cos(theta))[theta <= 0.5 * np.pi].sum() * omega)
    view = ANGULAR.updated(output)
    shown = resample(luminance, lens, view, 400)
    assert illuminance(shown, view) == pytest.approx(exact, rel=0.005)


def test_an_even_picture_stays_even():
    lens = Lens("equisolid", (260.0, 250.0), 240.0)
    shown = resample(np.full((500, 520), 70.0, dtype=np.float32), lens, ANGULAR, 300)
    inside = ANGULAR.pixel_directions(300, 300) @ ANGULAR.frame[2] >= 0.0
    np.testing.assert_allclose(shown[inside], 70.0, rtol=1e-5)
    assert shown[~inside].max() == 0.0


def test_vignetting_is_found_from_points():
    truth = Vignetting(coefficients=(-0.15, 0.03, -0.012))
    angles = np.arange(0.0, 91.0, 5.0)
    points = np.column_stack([angles, 37.0 * truth.at(np.radians(angles))])
    fitted = Vignetting.fit(points)
    np.testing.assert_allclose(fitted.coefficients, truth.coefficients, rtol=1e-6)
    assert fitted.residual < 1e-9
    noisy = Vignetting.fit(points * np.column_stack([np.ones(19), 1.0 + 0.01 * (-1.0) ** np.arange(19)]))
    assert noisy.residual == pytest.approx(0.01, rel=0.4)
    table = Vignetting.through(points)
    np.testing.assert_allclose(table.at(np.radians(angles)), truth.at(np.radians(angles)), rtol=1e-9)


def test_overflow_is_filled_up_to_the_measured_illuminance(tmp_path):
    maker = replace(MAKER, source=60000.0)
    maker.jpegs(tmp_path)
    d = np.nan_to_num(ANGULAR.pixel_directions(900, 900) @ ANGULAR.frame.T)
    truth = illuminance(np.where(d[..., 2] > 0.0, scene(d, 60000.0) @ SRGB, 0.0), ANGULAR)
    tables = {
        "pictures": ["*.JPG"],
        "lens": {"centre_px": [361.3, 238.6], "radius_px": 225.0},
        "vignetting": {"coefficients": [-0.12, 0.01]},
        "calibration": {"spots": [{"direction_deg": list(PANEL), "luminance": PANEL_LUMINANCE}]},
        "check": {"illuminance": truth},
        "output": {"size_px": 400},
    }
    plain = develop(Session.of(tables), tmp_path)
    assert plain.saturated_pixels > 20
    assert plain.illuminance < 0.99 * truth
    assert any("too bright in all exposures" in text for text in plain.warnings)
    assert plain.picture.luminance.max() < 1.15 * plain.most
    assert plain.overflow.azimuth_deg == pytest.approx(8.0, abs=1.0)
    assert plain.overflow.elevation_deg == pytest.approx(15.0, abs=1.0)
    filled = develop(Session.of(tables | {"check": {"illuminance": truth, "fill_overflow": True}}), tmp_path)
    assert filled.illuminance == pytest.approx(truth, rel=1e-4)
    assert filled.difference_percent == pytest.approx(plain.difference_percent)
    assert filled.picture.luminance.max() == pytest.approx(60000.0, rel=0.15)
