"""`clerestory trace` as a person uses it."""

import json
import re

import pytest

import clerestory
from clerestory.cli import main
from clerestory.trace import load, names
from clerestory.trace import run as measure_run


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
    assert f"wrote {output}: visible" in out
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
    model, _ = clerestory.read(output).model("exterior", "transmission")
    assert model.standard_errors is not None


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
    measured = measure_run(sample, basis="klems-quarter", samples=16)
    for balance in measured.balance.values():
        assert balance.sum == pytest.approx(1.0, abs=1e-9)
        assert balance.lost == 0.0
        assert balance.cut_off < 0.002
        assert 0.0 < balance.transmitted < 1.0
