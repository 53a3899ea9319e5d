"""`clerestory glare` as a person uses it."""

import json
import re
import subprocess
import sys

import numpy as np
import pytest

from clerestory.cli import main
from clerestory.picture import Picture, View
from glare_pictures import FISHEYES, disks, grey, window

ANGULAR = View(FISHEYES["angular"])


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("pictures")
    window(200, ANGULAR, 3).write(folder / "window.hdr")
    window(200, ANGULAR, 3).write(folder / "window.exr")
    disks(200, ANGULAR, 100.0).write(folder / "even.hdr")
    grey(np.full((50, 50), 100.0), ANGULAR.updated("-vtv -vh 60 -vv 60")).write(folder / "perspective.hdr")
    grey(np.full((50, 50), 100.0), ANGULAR.updated("-vh 120 -vv 120")).write(folder / "narrow.hdr")
    grey(np.zeros((50, 50)), ANGULAR).write(folder / "black.hdr")
    Picture(np.full((50, 50, 3), 1.0)).write(folder / "blind.hdr")
    pixels = np.full((50, 50, 3), 1.0)
    pixels[10, 20] = np.nan
    Picture(pixels, ANGULAR).write(folder / "nan.exr")
    return folder


def run(capsys, *words):
    code = main(["glare", *(str(word) for word in words)])
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def test_one_picture(folder, capsys):
    code, out, err = run(capsys, folder / "window.hdr")
    assert (code, err) == (0, "")
    assert re.search(r"window\.hdr +(imperceptible|perceptible|disturbing|intolerable) +[01]\.\d{3} ", out)
    assert "1 (peak)" in out
    assert "Settings: threshold 2000 cd/m²" in out


def test_many_pictures_as_json(folder, capsys):
    code, out, err = run(capsys, folder / "window.hdr", folder / "black.hdr", folder / "window.exr", "--json")
    first, second, third = json.loads(out)
    assert code == 1
    assert re.fullmatch(r"error: \S+black\.hdr: [^\n]*black[^\n]*\([^\n]+\)\n", err)
    assert "error" in second
    assert first["dgp"] == pytest.approx(third["dgp"], abs=2e-3)
    assert first["settings"]["threshold"] == 2000.0
    assert first["sources"][0]["peak"] is True
    assert len(first["sources"]) == len(third["sources"])


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("perspective.hdr", "fisheye of 180°"),
        ("blind.hdr", "give a view"),
        ("nan.exr", "column 21 and row 11"),
        ("no.hdr", "path"),
    ],
)
def test_what_cannot_be_rated(name, words, folder, capsys):
    code, out, err = run(capsys, folder / name)
    assert (code, out) == (1, "")
    assert re.fullmatch(rf"error: {re.escape(str(folder / name))}: [^\n]+\([^\n]+\)\n", err)
    assert words in err


def test_views_and_measured_illuminance(folder, capsys):
    code, out, err = run(capsys, folder / "narrow.hdr")
    assert code == 0
    assert "narrower than 180°" in err
    code, out, err = run(capsys, folder / "blind.hdr", "--view", "-vta -vh 180 -vv 180", "--json")
    assert code == 0
    assert "view" not in err
    code, out, err = run(capsys, folder / "perspective.hdr", "--vertical-illuminance", 900, "--json")
    assert code == 0
    assert json.loads(out)[0]["dgp"] == pytest.approx(5.87e-5 * 900 + 0.159, abs=1e-3)


def test_settings(folder, capsys):
    def found(*words):
        code, out, _ = run(capsys, folder / "window.hdr", "--json", *words)
        assert code == 0
        return json.loads(out)[0]

    assert found("--threshold", 4)["threshold"] == pytest.approx(4.0 * found()["mean_luminance"])
    task = found("--threshold", 4, "--task", "100,60,0.4")
    assert task["threshold"] == pytest.approx(4.0 * task["task_luminance"])
    assert not any(source["peak"] for source in found("--no-peaks")["sources"])
    old = found("--preset", "evalglare-1.x")["settings"]
    assert (old["threshold"], old["threshold_of"], old["background"], old["low_light"]) == (5.0, "mean", "mean", True)
    assert found("--preset", "evalglare-2.10")["settings"]["low_light"] is True
    assert found("--preset", "evalglare-2.10", "--no-low-light")["settings"]["low_light"] is False
    assert found("--position-index", "kim")["ugr"] != found()["ugr"]


def test_check_pictures(folder, capsys, tmp_path):
    for suffix in (".png", ".pdf", ".hdr"):
        target = tmp_path / f"check{suffix}"
        code, _, err = run(capsys, folder / "window.hdr", "--check-picture", target)
        assert (code, err) == (0, f"wrote {target}\n")
    original, check = Picture.read(folder / "window.hdr"), Picture.read(tmp_path / "check.hdr")
    assert check.view == original.view
    np.testing.assert_allclose(check.luminance, original.luminance, rtol=0.02, atol=1e-3)
    coloured = np.ptp(check.pixels, axis=2) > 0.1 * check.pixels.max(axis=2)
    assert 0.01 < coloured.mean() < 0.5


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["--task", "1,2"], "3 numbers"),
        (["--preset", "other"], "not known"),
        (["--peaks", "5", "--no-peaks"], "one of them"),
        (["--background", "sky"], "not known"),
    ],
)
def test_wrong_usage(words, text, folder, capsys):
    code, _, err = run(capsys, folder / "even.hdr", *words)
    assert code == 2
    assert text in err


def test_no_drawing_library_without_a_drawing(folder):
    code = (
        "import sys; from clerestory.cli import main; "
        f"main(['glare', {str(folder / 'window.hdr')!r}]); print('matplotlib' in sys.modules)"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.splitlines()[-1] == "False"
