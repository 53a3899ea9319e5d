"""`clerestory trace` as a person uses it."""

import csv
import json
import re
from contextlib import contextmanager
from importlib import import_module

import numpy as np
import pytest

import clerestory
from clerestory.cli import main
from clerestory.directions import direction
from clerestory.trace import Settings, load, names
from clerestory.trace import run as measure_run

trace_command = import_module("clerestory.cli.trace")


def run(capsys, *words):
    code = main([str(word) for word in words])
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def test_a_blind_becomes_an_xml_file(tmp_path, capsys):
    output = tmp_path / "blind.xml"
    code, out, _ = run(capsys, "trace", "flat-blind", "-o", output, "--samples", 64)
    assert code == 0
    assert re.search(r"visible +exterior +transmission +[01]\.\d+ ± 0\.\d+ +0\.4\d+ ± 0\.\d+", out)
    assert re.search(r"of all light transmitted 0\.\d+, reflected .*, lost 0$", out, re.MULTILINE)
    assert f"wrote {output}: Flat 80 mm slats, level" in out
    bsdf = clerestory.read(output)
    assert bsdf.metadata.name == "Flat 80 mm slats, level"
    assert bsdf.metadata.thickness_m == pytest.approx(0.08)
    told = "\n".join(bsdf.metadata.comments)
    assert f"clerestory {clerestory.__version__} trace" in told
    assert "seed 1" in told
    assert "width_mm = 80.0" in told


def test_json(tmp_path, capsys):
    output = tmp_path / "blind.bsdf.npz"
    code, out, err = run(
        capsys, "trace", "flat-blind", "-o", output, "--samples", 16, "--side", "exterior", "--seed", 7, "--json"
    )
    result = json.loads(out)
    assert (code, err) == (0, "")
    assert result["sample"] == "Flat 80 mm slats, level"
    assert {v["scatter"] for v in result["values"]} == {"transmission", "reflection"}
    assert {v["side"] for v in result["values"]} == {"exterior"}
    assert sum(result["balance"]["visible"].values()) == pytest.approx(1.0, abs=1e-9)
    bsdf = clerestory.read(output)
    value, error = bsdf.integrate_with_error(direction(0, 0), "transmission")
    assert 0.5 < float(value) <= 1.0
    assert 0.0 <= float(error) < 0.2


def test_results_do_not_depend_on_threads(tmp_path, capsys):
    for threads in (1, 2):
        run(
            capsys, "trace", "flat-blind", "-o", tmp_path / f"{threads}.bsdf.npz", "--samples", 16, "--threads", threads
        )
    assert (tmp_path / "1.bsdf.npz").read_bytes() == (tmp_path / "2.bsdf.npz").read_bytes()


def test_list(capsys):
    code, out, _ = run(capsys, "trace", "--list")
    assert code == 0
    assert [line.split()[0] for line in out.splitlines()[1:]] == names()
    assert {"round-robin-blind", "flat-blind"} <= set(names())
    code, out, _ = run(capsys, "trace", "--list", "--json")
    assert [r["name"] for r in json.loads(out)] == names()


def test_a_picture_of_the_geometry(tmp_path, capsys):
    picture = tmp_path / "blind.png"
    code, out, _ = run(capsys, "trace", "flat-blind", "--plot-geometry", picture)
    assert code == 0
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert f"wrote {picture}" in out


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ((), "SAMPLE: none is given"),
        (("flat-blind",), "-o: no file to write is given"),
        (("flat-blind", "-o", "blind.txt"), "blind.txt: the name does not tell the format"),
        (("flat-blind", "-o", "b.xml", "--side", "outside"), "--side outside: not known"),
    ],
)
def test_wrong_usage_is_one_line(words, message, capsys):
    code, out, err = run(capsys, "trace", *words)
    assert (code, out) == (2, "")
    assert err.startswith(f"error: {message}")
    assert err.count("\n") == 1


def test_a_faulty_recipe_is_one_line_and_leaves_no_file(tmp_path, capsys):
    recipe = tmp_path / "blind.toml"
    recipe.write_text('[sample]\nkind = "venetian-blind"\npitch_mm = 72\nslat.width = 80\n')
    code, out, err = run(capsys, "trace", recipe, "-o", tmp_path / "blind.xml")
    assert (code, out) == (1, "")
    assert err == f"error: {recipe}: sample.slat.width: there is no such key (did you mean width_mm?)\n"
    assert not (tmp_path / "blind.xml").exists()


@pytest.mark.parametrize("name", names())
def test_every_recipe_that_is_shipped_runs(name):
    sample = load(name)
    assert sample.warnings == []
    measured = measure_run(sample, Settings(basis="klems-quarter", samples=16))
    for balance in measured.balance.values():
        assert balance.sum == pytest.approx(1.0, abs=1e-9)
        assert balance.lost == 0.0
        assert balance.cut_off < 0.002
        assert 0.0 < balance.transmitted < 1.0


def test_a_scan_of_two_directions(tmp_path, capsys):
    output = tmp_path / "scan.csv"
    words = ("trace", "flat-blind", "--incident", "0,0", "--incident", "60,90", "--samples", 256, "-o", output)
    code, out, err = run(capsys, *words, "--basis", "klems-quarter")
    assert (code, err) == (0, "")
    assert re.search(r"visible +from above, 60° +transmission", out)
    rows = list(csv.DictReader(output.read_text(encoding="utf-8").splitlines()))
    assert {(r["incident_theta_deg"], r["incident_phi_deg"]) for r in rows} == {("0", "0"), ("60", "90")}
    level = [r for r in rows if r["incident_theta_deg"] == "0" and r["scatter"] == "transmission"]
    (beam,) = (float(r["value"]) for r in level if r["quantity"] == "beam")
    (total,) = (float(r["value"]) for r in level if r["quantity"] == "total")
    # Level light passes between level slats, all of it straight on.
    assert beam == total == pytest.approx(1.0)
    steep = [r for r in rows if r["incident_theta_deg"] == "60" and r["scatter"] == "transmission"]
    (beam,) = (float(r["value"]) for r in steep if r["quantity"] == "beam")
    assert beam == 0.0, "beyond the cut-off angle of 42°"
    assert sum(float(r["value"]) for r in steep if r["quantity"] == "bsdf") > 0.0


@pytest.mark.parametrize("suffix", ["csv", "npz"])
def test_rays_for_other_programs(suffix, tmp_path, capsys):
    path = tmp_path / f"rays.{suffix}"
    words = ("trace", "flat-blind", "--rays", path, "--incident", "60,90", "--samples", 400)
    code, out, _ = run(capsys, *words, "--json")
    result = json.loads(out)
    assert code == 0
    if suffix == "csv":
        rows = np.genfromtxt(path, delimiter=",", skip_header=1, usecols=range(7))
        positions, ways, flux = rows[:, :3] / 1000.0, rows[:, 3:6], rows[:, 6]
    else:
        with np.load(path) as kept:
            positions, ways, flux = kept["position_m"], kept["direction"], kept["flux"][:, 0]
    assert len(flux) == result["rays"]["rays"]
    assert np.allclose(np.linalg.norm(ways, axis=1), 1.0, atol=1e-8)
    assert np.allclose(np.abs(positions[:, 2]), 0.04, atol=1e-5), "at the end of the sample's depth"
    assert (np.sign(ways[:, 2]) == np.sign(positions[:, 2])).all(), "away from it"
    assert 0.1 < flux.sum() < 0.9


def test_an_error_to_reach(tmp_path, capsys):
    output = tmp_path / "blind.xml"
    words = ("trace", "flat-blind", "-o", output, "--basis", "klems-quarter", "--json")
    code, out, _ = run(capsys, *words, "--error", "4%")
    rough = json.loads(out)
    assert code == 0
    code, out, _ = run(capsys, *words, "--error", "0.02")
    fine = json.loads(out)
    assert code == 0
    assert rough["error"] <= 0.04
    assert fine["error"] <= 0.02
    assert fine["paths"] > 1.5 * rough["paths"]


def test_ctrl_c_keeps_what_was_finished(tmp_path, capsys, monkeypatch):
    output = tmp_path / "blind.bsdf.npz"
    words = ("trace", "honeycomb-shade", "-o", output, "--samples", 4096, "--basis", "klems-quarter")
    calls = []

    def tell(*shares):
        calls.append(shares)
        raise KeyboardInterrupt

    @contextmanager
    def bar():
        yield tell

    with monkeypatch.context() as patch:
        patch.setattr(trace_command, "_bar", bar)
        code, out, err = run(capsys, *words)
    assert (code, out) == (130, "")
    partial = tmp_path / "blind.partial.npz"
    assert re.search(
        rf"note: \d+ of 82 parts are kept in {re.escape(str(partial))} \(the same command with --resume", err
    )
    assert not output.exists()
    code, _, _ = run(capsys, *words[:-4], "--samples", 2048, "--basis", "klems-quarter", "--resume")
    assert code == 1, "other settings cannot go on with it"
    code, _, _ = run(capsys, *words, "--resume")
    assert code == 0
    assert not partial.exists()
    resumed = output.read_bytes()
    code, _, _ = run(capsys, *words)
    assert output.read_bytes() == resumed, "the same as without an interruption"


def test_resuming_needs_something_to_go_on_with(tmp_path, capsys):
    code, _, err = run(capsys, "trace", "flat-blind", "-o", tmp_path / "b.xml", "--resume")
    assert code == 2
    assert "there is no" in err
    (tmp_path / "b.partial.npz").write_bytes(b"nothing")
    code, _, err = run(capsys, "trace", "flat-blind", "-o", tmp_path / "b.xml", "--resume")
    assert code == 1
    assert "not what an interrupted trace leaves" in err


SCENE = """
void plastic grey 0 0 5 0.5 0.5 0.5 0 0
grey polygon slat 0 0 12
  0 0 -0.04   0.1 0 -0.04   0.1 0 0.04   0 0 0.04
"""


def test_a_radiance_scene(tmp_path, capsys):
    scene = tmp_path / "slat.rad"
    scene.write_text(SCENE)
    words = ("trace", scene, "-o", tmp_path / "slat.xml", "--samples", 256, "--json", "--basis", "klems-quarter")
    code, out, err = run(capsys, *words, "--unit", "m", "--period", "0.1,0.072")
    assert (code, err) == (0, "")
    value = next(v for v in json.loads(out)["values"] if (v["side"], v["scatter"]) == ("exterior", "transmission"))
    # The flat slats of a radiosity calculation.
    assert value["hemispherical"][0] == pytest.approx(0.480_36, abs=4 * value["hemispherical"][1] + 1e-3)
    code, _, err = run(capsys, *words)
    assert code == 2
    assert "the unit of its lengths is not known" in err
    code, _, err = run(capsys, *words, "--unit", "m")
    assert code == 2
    assert "either --period or --region is asked for" in err
    mesh = tmp_path / "slat.obj"
    mesh.write_text("v 0 0 -0.04\nv 0.1 0 -0.04\nv 0.1 0 0.04\nusemtl slat\nf 1 2 3\n")
    code, _, err = run(capsys, "trace", mesh, *words[2:], "--unit", "m", "--period", "0.1,0.072")
    assert err == f"error: {mesh}: nothing is said of 'slat' (give --reflectance, or write a recipe)\n"
    scene.write_text("grey polygon")
    code, _, err = run(capsys, *words, "--unit", "m", "--period", "0.1,0.072")
    assert err.startswith(f"error: {scene}: ")
    assert err.count(str(scene)) == 1
    code, _, err = run(capsys, "trace", "flat-blind", "-o", tmp_path / "b.xml", "--unit", "m")
    assert code == 2
    assert "goes with a scene" in err


@pytest.mark.parametrize("name", ["prismatic-film", "twill-1-percent", "blind-and-pane"])
def test_pictures_of_bodies_meshes_and_layers(name, tmp_path, capsys):
    picture = tmp_path / "sample.png"
    code, _, _ = run(capsys, "trace", name, "--plot-geometry", picture)
    assert code == 0
    assert picture.stat().st_size > 5000


def test_a_tree(tmp_path, capsys):
    output = tmp_path / "blind.bsdf.npz"
    words = ("trace", "flat-blind", "--basis", "tensor4", "--resolution", 3, "--samples", 256, "--seed", 3)
    code, out, _ = run(capsys, *words, "--cull", 90, "-o", output, "--json")
    assert code == 0
    value = next(v for v in json.loads(out)["values"] if (v["side"], v["scatter"]) == ("exterior", "transmission"))
    assert value["hemispherical"][0] == pytest.approx(0.480_36, abs=4 * value["hemispherical"][1] + 1e-3)
    bsdf = clerestory.read(output)
    model, _ = bsdf.model("exterior", "reflection")
    assert model.kind == "tensor tree"
    code, _, err = run(capsys, "trace", "flat-blind", "--cull", 90, "-o", output)
    assert code == 2
    assert "--cull 90: a percentage for trees" in err
