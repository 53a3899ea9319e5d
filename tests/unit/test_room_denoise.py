"""Denoising: less noise, the same light, and nothing touched that is not noise on a surface."""

from __future__ import annotations

import numpy as np
import pytest

from clerestory import room
from clerestory.cli import main
from clerestory.glare import evaluate
from clerestory.picture import Picture
from clerestory.room.denoise import filtered

SIZE = [120, 120]


@pytest.fixture(scope="module")
def made():
    return room.load("office")


@pytest.fixture(scope="module")
def pictures(made):
    """A noisy picture, the same denoised, and a reference of many paths."""
    view = made.view("desk").model_copy(update={"size_px": SIZE})
    noisy = made.picture(view, samples=8)
    return noisy, made.denoise(noisy), made.picture(view, samples=160, seed=9)


@pytest.fixture(scope="module")
def surfaces(made, pictures):
    """Pixels (height, width) that are all of surfaces."""
    return made._core.features(pictures[0].view, *SIZE)[:, 0].reshape(SIZE[::-1]) > 1.0 - 1e-6


def test_errors_fall_and_means_stay(pictures, surfaces):
    noisy, smooth, reference = pictures
    assert surfaces.sum() > 5000

    def rms(picture):
        return np.sqrt(np.mean((picture.luminance - reference.luminance)[surfaces] ** 2))

    assert rms(smooth) < 0.5 * rms(noisy)
    # Blocks of 20 by 20 pixels that are all of surfaces: within four times what is not known of them.
    blocks = 0
    for y in range(0, SIZE[1], 20):
        for x in range(0, SIZE[0], 20):
            part = (slice(y, y + 20), slice(x, x + 20))
            if surfaces[part].all():
                blocks += 1
                error = np.sqrt(np.sum(noisy.noise[part] ** 2)) / 400.0
                assert abs(smooth.luminance[part].mean() - noisy.luminance[part].mean()) <= 4.0 * error
    assert blocks >= 5
    whole = smooth.luminance[surfaces].mean() / reference.luminance[surfaces].mean()
    assert whole == pytest.approx(1.0, abs=0.01)


def test_windows_and_their_edges_stay(pictures, surfaces):
    noisy, smooth, _ = pictures
    assert (smooth.radiance[~surfaces] == noisy.radiance[~surfaces]).all()
    assert (smooth.noise == noisy.noise).all()


def test_the_sun_s_disc_stays(made):
    view = made.view("desk").model_copy(update={"point_m": [1.8, 0.6, 1.0], "size_px": SIZE})
    tables = {**made.recipe.model_dump(), "sky": {"kind": "preetham", "turbidity": 3.0, "sun_deg": [20.0, 180.0]}}
    sunny = room.load(tables)
    noisy = sunny.picture(view, samples=2)
    assert noisy.luminance.max() > 1e6
    smooth = sunny.denoise(noisy)
    bright = noisy.luminance > 1e5
    assert (smooth.radiance[bright] == noisy.radiance[bright]).all()


def test_edges_of_light_and_of_surfaces_stay():
    """Two halves of other light, and two of other normals, with noise: each keeps its mean."""
    rng = np.random.default_rng(1)
    truth = np.ones((40, 60))
    truth[:, 30:] = 4.0
    noise = 0.2 * truth
    level = truth + noise * rng.standard_normal(truth.shape)
    features = np.zeros((40, 60, 6))
    features[..., 0], features[..., 4], features[..., 5] = 1.0, 2.0, 0.5
    features[:20, :, 3], features[20:, :, 1] = 1.0, 1.0
    level[20:] += 0.3
    found = filtered(np.repeat((level / 179.0)[..., None], 3, axis=2), noise, features).mean(axis=-1) * 179.0
    # The columns beside the edge, and the rows beside the fold.
    for rows, columns, expected in (
        (slice(0, 20), 29, 1.0),
        (slice(0, 20), 30, 4.0),
        (19, slice(0, 25), 1.0),
        (20, slice(0, 25), 1.3),
    ):
        error = 0.2 * expected / np.sqrt(20.0)
        assert abs(found[rows, columns].mean() - expected) < 4.0 * error
    assert found[:15, 5:25].std() < 0.4 * level[:15, 5:25].std()


def test_glare_is_rated_as_it_was_before(pictures, tmp_path, capsys):
    noisy, smooth, _ = pictures
    assert not any("DENOISED" in line for line in noisy.picture().header)
    assert any("denoised" in text for text in evaluate(smooth.picture()).warnings)
    words = ["render", "office", "--size", "64,64", "--samples", "4", "--glare"]
    assert main([*words, "-o", str(tmp_path / "plain.hdr")]) == 0
    plain = capsys.readouterr().out
    output = tmp_path / "smooth.hdr"
    assert main([*words, "-o", str(output), "--denoise"]) == 0

    def rating(text):
        return next(line for line in text.splitlines() if line.startswith("E_v"))

    assert rating(capsys.readouterr().out) == rating(plain)
    assert any(line.startswith("DENOISED=") for line in Picture.read(output).header)
    assert main([*words, "--denoise", "--glare-denoised"]) == 0
    assert "the picture is denoised" in capsys.readouterr().out
    assert main([*words, "--glare-denoised"]) == 2
    assert "goes with --denoise" in capsys.readouterr().err
