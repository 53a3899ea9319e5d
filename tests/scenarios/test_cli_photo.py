"""`clerestory photo` and `clerestory photo-compare` as a person uses them."""

import json
import re
import subprocess
import sys
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from PIL import Image

from camera import TIMES, Maker
from clerestory.cli import main
from clerestory.glare import evaluate
from clerestory.photo import Lens, Response
from clerestory.picture import Picture, View
from glare_pictures import FISHEYES, disks, window

LENS = Lens("equisolid", (120.0, 80.0), 75.0)
SPOT = ["--spot-direction", "20,-35,4=323.5"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("photo")
    maker = Maker(LENS, shape=(160, 240), noise=0.2)
    maker.jpegs(folder, TIMES)
    (folder / "vignetting.csv").write_text(
        "theta_deg,value\n"
        + "".join(f"{t},{1.0 - 0.12 * np.radians(t) ** 2 + 0.01 * np.radians(t) ** 4}\n" for t in range(0, 91, 10))
    )
    (folder / "session.toml").write_text(
        """
pictures = ["IMG_*.JPG"]

[vignetting]
points = "vignetting.csv"

[[calibration.spots]]
direction_deg = [20, -35, 4]
luminance = 323.5

[check]
illuminance = 1830

[output]
size_px = 200
"""
    )
    return folder


def run(capsys, command, *words):
    code = main([command, *(str(word) for word in words)])
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def jpegs(folder):
    return sorted(folder.glob("IMG_*.JPG"))


def test_a_series(folder, capsys, tmp_path):
    out = tmp_path / "out.hdr"
    code, text, err = run(
        capsys,
        "photo",
        *jpegs(folder)[::-1],
        *SPOT,
        "--vignetting",
        folder / "vignetting.csv",
        "--illuminance",
        1830,
        "--size",
        200,
        "-o",
        out,
    )
    assert (code, err) == (0, f"wrote {out}\n")
    assert re.search(r"IMG_4002\.JPG +1/60 s, f/5, ISO 100 +2\.08 × +2\.0\d ×", text)
    assert "323.5 cd/m² by the meter, 323.5 cd/m² in the picture" in text
    assert re.search(r"E_v +18\d\d lx; measured 1830 lx, [+-]\d\.\d %: accepted", text)
    assert "fitted within" in text
    picture = Picture.read(out)
    assert picture.view == View("-vta -vh 180 -vv 180")
    assert any(line.startswith("CALIBRATION= spots") for line in picture.header)
    code, text, err = run(capsys, "glare", out, "--json")
    assert (code, err) == (0, "")
    assert json.loads(text)[0]["vertical_illuminance"] == pytest.approx(1830.0, rel=0.03)


def test_a_session_says_the_same(folder, capsys, tmp_path):
    code, text, _err = run(capsys, "photo", folder / "session.toml", "-o", tmp_path / "a.exr", "--json")
    assert code == 0
    session = json.loads(text)
    assert session["calibration"] == "spots"
    assert session["acceptable"] is True
    assert session["warnings"] == []
    code, text, _ = run(
        capsys,
        *("photo", *jpegs(folder), *SPOT, "--vignetting", folder / "vignetting.csv"),
        *("--illuminance", 1830, "--size", 200, "-o", tmp_path / "b.exr", "--json"),
    )
    assert code == 0
    options = json.loads(text)
    for key in ("factor", "illuminance", "lens", "vignetting", "steps", "difference_percent"):
        assert options[key] == session[key]
    assert (tmp_path / "a.exr").read_bytes() == (tmp_path / "b.exr").read_bytes()
    # So does the folder, whatever else is in it.
    code, text, _ = run(capsys, "photo", folder, "--size", 64, "--json")
    assert len(json.loads(text)["photographs"]) == len(TIMES)
    # An option wins over the file.
    code, text, _ = run(capsys, "photo", folder / "session.toml", "--size", 64, "--view", "-vth", "--json")
    assert json.loads(text)["size"] == [64, 64]
    assert json.loads(text)["view"].startswith("-vth")


def test_a_response_serves_another_series(folder, capsys, tmp_path):
    kept, drawn = tmp_path / "camera.json", tmp_path / "camera.png"
    code, _, err = run(
        capsys, "photo", *jpegs(folder), "--size", 64, "--save-response", kept, "--plot-response", drawn, "--json"
    )
    assert code == 0
    assert f"wrote {kept}\nwrote {drawn}\n" in err
    assert drawn.read_bytes().startswith(b"\x89PNG")
    assert Response.read(kept).method == "file"
    code, text, _ = run(capsys, "photo", *jpegs(folder)[::3], "--response", kept, *SPOT, "--size", 64, "--json")
    assert code == 0
    found = json.loads(text)
    assert found["response"] == {"method": "file", "residual": None}
    assert found["illuminance"] == pytest.approx(1840.0, rel=0.1)  # no vignetting corrected


def test_an_illuminance_that_is_far_off_is_said(folder, capsys):
    code, text, err = run(capsys, "photo", folder / "session.toml", "--illuminance", 3000)
    assert code == 0
    assert "NOT ACCEPTABLE" in text
    assert re.search(r"warning: .*is -39 % off the measured 3000 lx, beyond 25 %", err)


@pytest.mark.parametrize(
    ("words", "code", "text"),
    [
        (["IMG_4000.JPG"], 1, "one picture holds no range"),
        (["IMG_4000.JPG", "no.JPG"], 1, "no.JPG: no such file"),
        (["IMG_4000.JPG", "IMG_4001.JPG", "-o", "out.bmp"], 2, "out.bmp: the name does not tell the format"),
        (["IMG_4000.JPG", "IMG_4001.JPG", "-o", "no/out.hdr"], 2, "the folder no does not exist"),
        (["IMG_4000.JPG", "IMG_4001.JPG", "--spot", "3,4"], 2, "not a place and a luminance"),
        (["IMG_4000.JPG", "IMG_4001.JPG", "--spot", "3=5"], 2, "not a place and a luminance"),
        (["IMG_4000.JPG", "IMG_4001.JPG", "--projection", "fisheye"], 2, "--projection fisheye: not known"),
        (["IMG_4000.JPG", "IMG_4001.JPG", "--centre", "3"], 2, "2 numbers"),
        (
            ["IMG_4000.JPG", "IMG_4001.JPG", "--vignetting", "no.csv"],
            1,
            "--vignetting: no.csv does not exist (check it",
        ),
        (["IMG_4000.JPG", "IMG_4001.JPG", "--response", "session.toml"], 1, "session.toml: not a response"),
        (["IMG_4000.JPG", "IMG_4001.JPG", "--calibrate-by-illuminance"], 2, "--illuminance: the calibration"),
        (["IMG_4000.JPG", "IMG_4001.JPG", "--factor", "1", "--spot", "3,4=5"], 2, "exclude each other"),
        (["IMG_4000.JPG", "IMG_4001.JPG", "--vignetting", "1,2,3,4"], 2, "more than three coefficients"),
        (["IMG_4000.JPG", "IMG_4001.JPG", "--size", "5"], 2, "--size: 5 does not fit"),
        (["empty"], 1, "the folder holds no photographs"),
        (["session.toml", "IMG_4000.JPG"], 2, "a session names its pictures itself"),
        (["wrong.toml"], 1, "wrong.toml: lens.projektion: there is no such key (did you mean projection?)"),
        (["broken.toml"], 1, "broken.toml: not TOML"),
        (["compare", "cases.csv"], 2, "photo-compare"),
        ([], 2, "Missing argument"),
    ],
)
def test_what_goes_wrong_is_one_line(words, code, text, folder, capsys, monkeypatch):
    monkeypatch.chdir(folder)
    (folder / "wrong.toml").write_text('pictures = ["IMG_*.JPG"]\n[lens]\nprojektion = "equisolid"\n')
    (folder / "broken.toml").write_text("pictures = [\n")
    (folder / "empty").mkdir(exist_ok=True)
    before = {p.name for p in folder.iterdir()}
    found, out, err = run(capsys, "photo", *words)
    assert (found, out) == (code, "")
    assert re.fullmatch(r"error: [^\n]+\([^\n]+\)\n", err), err
    assert text.lower() in err.lower()
    assert {p.name for p in folder.iterdir()} == before


def test_inputs_are_never_overwritten(folder, capsys, tmp_path):
    times = tmp_path / "a.png"
    Image.new("RGB", (32, 32)).save(times)
    code, _, err = run(capsys, "photo", times, times, "-o", times)
    assert code == 2
    assert "would overwrite an input" in err


def test_overflow_and_movement_are_warned_of(tmp_path, capsys):
    maker = replace(Maker(LENS, shape=(160, 240), noise=0.2), source=60000.0)
    paths = maker.jpegs(tmp_path, TIMES)
    exif = maker.exif(Fraction(1, 60))
    with Image.open(paths[2]) as image:
        moved = np.array(image.convert("RGB"))
    moved[60:110, 70:110] = 200
    Image.fromarray(moved).save(paths[2], quality=97, exif=exif)
    code, _, err = run(capsys, "photo", *paths, *SPOT, "--size", 64)
    assert code == 0
    assert "pixels are too bright in all exposures" in err
    assert "at 8° to the right and 15° up" in err
    assert "something moved" in err


# --- comparison ------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def pairs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("pairs")
    rng = np.random.default_rng(1)
    rows = ["case,photo,rendering,measured_illuminance"]
    for k in range(9):
        view = View(FISHEYES["angular"])
        photo = window(180, view, k)
        factor = 2.0 if k == 4 else 1.0 + 0.1 * rng.normal()
        photo.write(folder / f"p{k}.hdr")
        Picture(photo.pixels * factor, view).write(folder / f"r{k}.hdr")
        measured = evaluate(photo).vertical_illuminance * (1.5 if k == 7 else 1.02)
        rows.append(f"office {k},p{k}.hdr,r{k}.hdr,{measured:.1f}")
    (folder / "cases.csv").write_text("\n".join(rows) + "\n")
    return folder


def test_many_cases(pairs, capsys, tmp_path):
    report = tmp_path / "report.html"
    code, text, err = run(capsys, "photo-compare", pairs / "cases.csv", "-o", report, "--json")
    assert (code, err) == (0, f"wrote {report}\n")
    found = json.loads(text)
    assert found["check"]["count"] == 9
    assert [name for name, _ in found["check"]["rejected"]] == ["office 7"]
    by = {a["quantity"]: a for a in found["agreement"]}
    assert by["illuminance"]["cases"] == [f"office {k}" for k in range(9) if k != 7]
    x, y = (np.array(by["dgi"][side]) for side in ("photo", "rendering"))
    assert by["dgi"]["correlation"] == pytest.approx(np.corrcoef(x, y)[0, 1] ** 2)
    assert by["dgi"]["determination"] == pytest.approx(1.0 - ((x - y) ** 2).sum() / ((x - x.mean()) ** 2).sum())
    assert by["dgi"]["rmse"] == pytest.approx(np.sqrt(((x - y) ** 2).mean()))
    assert [o["label"] for o in by["illuminance"]["outliers"]] == ["office 4"]
    html = report.read_text(encoding="utf-8")
    assert html.count('src="data:image/png;base64,') == 7
    assert not re.search(r"https?://|@import", html)
    code, text, _ = run(capsys, "photo-compare", pairs / "cases.csv")
    assert code == 0
    assert re.search(r"DGP of 8 cases: R² 0\.\d{3}, about 1:1 0\.\d{3}, bias", text)
    assert "left out, beyond 25 % of the measured E_v: office 7 (-33 %)" in text


def test_two_pictures(pairs, capsys, tmp_path):
    view = View(FISHEYES["hemispherical"])
    disks(80, view, 200.0, (9000.0, 0.0, 20.0, 10.0)).write(tmp_path / "r.hdr")
    disks(100, View(FISHEYES["angular"]), 100.0, (9000.0, 0.0, 20.0, 10.0)).write(tmp_path / "p.hdr")
    out = tmp_path / "pair.png"
    code, text, _ = run(capsys, "photo-compare", tmp_path / "p.hdr", tmp_path / "r.hdr", "-o", out)
    assert code == 0
    assert re.search(r"luminance down \[cd/m²\] +100\.\d +200\.\d +\+100\.0 %", text)
    assert out.read_bytes().startswith(b"\x89PNG")


def test_values_of_others_and_regions_of_ones_own(pairs, capsys, tmp_path):
    table = tmp_path / "values.csv"
    table.write_text(
        "case,photo_dgp,rendering_dgp\n" + "".join(f"{k},{0.2 + 0.02 * k},{0.21 + 0.019 * k}\n" for k in range(10))
    )
    out = tmp_path / "scatter.svg"
    code, text, _ = run(capsys, "photo-compare", table, "-o", out)
    assert code == 0
    assert text.startswith("DGP of 10 cases: R² 1.000, about 1:1 0.98")
    assert out.read_text().lstrip().startswith("<?xml")
    regions = tmp_path / "regions.csv"
    regions.write_text("name,azimuth_deg,elevation_deg,radius_deg\ndesk,0,-40,15\n")
    code, text, _ = run(capsys, "photo-compare", pairs / "p0.hdr", pairs / "r0.hdr", "--regions", regions, "--json")
    assert "luminance desk" in json.loads(text)["cases"][0]["values"]


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ("case,photo\na,p0.hdr\n", "no columns photo and rendering"),
        ("case,photo,rendering\na,p0.hdr,\n", "line 2 names one picture only"),
        ("case,photo,rendering\na,p0.hdr,no.hdr\n", "no.hdr: no such file"),
        ("case,photo,rendering\na,p0.hdr,r0.hdr\na,p1.hdr,r1.hdr\n", "two cases a"),
        ("case,photo,rendering,measured_illuminance\na,p0.hdr,r0.hdr,much\n", "measured_illuminance 'much'"),
        ("case,photo,rendering,measured_illuminance\na,p0.hdr,r0.hdr,1\n", "all 1 photographs are more than 25 %"),
        ("case,photo_dgp\na,0.3\n", "photo_dgp has no partner"),
        ("case,photo_dgp,rendering_dgp\na,0.3,\n", "rendering_dgp '' does not fit"),
        ("case,foto,rendering\n", "'foto' is not known"),
        ("case,photo,rendering\n", "no line under the head"),
    ],
)
def test_tables_that_cannot_be_compared(table, words, pairs, capsys):
    path = pairs / "wrong.csv"
    path.write_text(table)
    code, out, err = run(capsys, "photo-compare", path)
    assert (code, out) == (1, "")
    assert re.fullmatch(r"error: [^\n]+\([^\n]+\)\n", err), err
    assert words in err


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["p0.hdr"], "one table or two pictures"),
        (["cases.csv", "p0.hdr"], "one table is compared at a time"),
        (["cases.csv", "-o", "out.hdr"], "does not tell the format"),
        (["cases.csv", "--limit", "0"], "not a limit"),
    ],
)
def test_wrong_usage(words, text, pairs, capsys, monkeypatch):
    monkeypatch.chdir(pairs)
    code, _, err = run(capsys, "photo-compare", *words)
    assert code == 2
    assert text in err


def test_help_is_quick_to_load():
    code = (
        "import sys; from clerestory.cli import main; main(['photo', '--help']); "
        "print([m for m in ('numpy', 'scipy', 'PIL', 'matplotlib') if m in sys.modules])"
    )
    made = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert made.stdout.splitlines()[-1] == "[]"
