"""`clerestory plot`: every kind becomes a file, and what makes no sense is refused in one line."""

import json

import numpy as np
import pytest

from clerestory import Basis, Bsdf, Model
from clerestory.bsdf import Region
from clerestory.cli import main
from clerestory.cli import plot as command
from clerestory.directions import direction

MAGIC = {"png": b"\x89PNG", "pdf": b"%PDF", "svg": b"<?xml"}


def fabric(value):
    return Bsdf.from_models(
        {("exterior", "transmission"): Model.sum([(1, Model.specular(0.05)), (1, Model.lambertian(value))])}
    )


@pytest.fixture
def files(tmp_path, monkeypatch):
    """Names of two files that read as two fabrics."""
    sets = {tmp_path / "one.xml": fabric(0.1), tmp_path / "two.xml": fabric(0.2)}
    for path in sets:
        path.write_text("its content is not looked at")
    monkeypatch.setattr("clerestory.cli.plot.read", sets.__getitem__, raising=True)
    return [str(path) for path in sets]


def run(capsys, *words):
    code = main([str(w) for w in words])
    captured = capsys.readouterr()
    return code, captured.out, captured.err


@pytest.mark.parametrize(
    ("kind", "suffix", "options"),
    [
        (None, "png", ["--incident", "40,90"]),
        ("hemisphere", "svg", ["--linear", "--dsf", "--orthographic"]),
        ("patches", "png", ["--basis", "klems-quarter"]),
        ("slices", "pdf", ["--patch", "1", "--patch", "41"]),
        ("close-up", "png", ["--half-width", "1", "--step", "10", "--centre", "30,270"]),
        ("solid", "png", []),
        ("mountain", "png", ["--linear"]),
        ("map", "png", []),
        ("bars", "svg", ["--patch", "88"]),
        ("grid", "png", []),
    ],
)
def test_every_kind_becomes_a_file(files, tmp_path, capsys, kind, suffix, options):
    target = tmp_path / f"picture.{suffix}"
    chosen = ["--kind", kind] if kind else []
    code, out, err = run(capsys, "plot", files[0], "-o", target, "--dpi", 40, *chosen, *options)
    assert (code, out, err) == (0, "", f"wrote {target}\n")
    assert target.read_bytes().startswith(MAGIC[suffix])


@pytest.mark.parametrize("kind", [None, "slices", "bars", "map"])
def test_several_files_stand_side_by_side(files, tmp_path, capsys, kind):
    target = tmp_path / "picture.svg"
    chosen = ["--kind", kind] if kind else []
    assert run(capsys, "plot", *files, "-o", target, *chosen, "--label", "Lucerne", "--label", "Freiburg")[0] == 0
    assert target.stat().st_size > 1000


def test_a_basis_is_drawn_without_a_file(tmp_path, capsys):
    target = tmp_path / "basis.png"
    assert run(capsys, "plot", "-o", target, "--basis", "klems-half", "--dpi", 40)[0] == 0
    assert target.read_bytes().startswith(MAGIC["png"])


def test_numbers_are_given_as_json(files, tmp_path, capsys):
    words = ["--region", "cone:30,270,20", "--region", "patches:1,3-5,4@klems-half", "--region", "ring:0,0,10,20"]
    code, out, _ = run(capsys, "plot", files[1], "-o", tmp_path / "a.png", "--dpi", 40, "--json", *words)
    assert code == 0
    result = json.loads(out)
    assert result["kind"] == "hemisphere"
    (value,) = result["values"]
    assert value["label"] == "two"
    assert value["incident"] == "from above, 30° (Klems 41)"
    assert value["direct_hemispherical"] == pytest.approx(0.25)
    assert value["peaks"][0]["value"] == pytest.approx(0.05)
    down = direction(30, 270, side="interior")
    regions = [
        Region.cone(down, 20),
        Region.patches(Basis.named("klems-half"), [0, 2, 3, 4]),
        Region.ring([0, 0, 1], 10, 20),
    ]
    expected = [float(fabric(0.2).integrate(direction(30, 90), "transmission", r)) for r in regions]
    assert [r["value"] for r in value["regions"]] == pytest.approx(expected)
    assert value["regions"][0]["region"] == "within 20° of downward, 30°"


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        (["A", "-o", "x.gif"], "x.gif: the name of a picture ends in .gif"),
        (["A", "-o", "x"], "has no suffix (give .png"),
        (["A", "-o", "nowhere/x.png"], "nowhere"),
        (["A", "-o", "x.png", "--kind", "cake"], "--kind cake: not known"),
        (["A", "B", "-o", "x.png", "--kind", "solid"], "2 files do not fit"),
        (["A", "-o", "x.png", "--kind", "solid", "--patch", "1", "--patch", "2"], "shows one incident direction"),
        (["A", "-o", "x.png", "--kind", "solid", "--dsf"], "--dsf: has no effect on --kind solid"),
        (["A", "B", "-o", "x.png", "--label", "one"], "1 name for 2 files"),
        (["A", "B", "-o", "x.png", "--label", "one", "--label", "one"], "given twice"),
        (["A", "-o", "x.png", "--patch", "146"], "1 to 145"),
        (["A", "-o", "x.png", "--incident", "95,0"], "0 to 90"),
        (["A", "-o", "x.png", "--scatter", "reflection"], "reflection"),
        (["A", "-o", "x.png", "--band", "solar"], "solar"),
        (["A", "-o", "x.png", "--region", "dome:1"], "dome:1: not known"),
        (["A", "-o", "x.png", "--region", "cone:1,2"], "3 numbers"),
        (["A", "-o", "x.png", "--region", "cone:10,90,0"], "within 0°"),
        (["A", "-o", "x.png", "--region", "ring:10,90,20,10"], "20° to 10°"),
        (["A", "-o", "x.png", "--region", "patches:0"], "no patch 0"),
        (["A", "-o", "x.png", "--region", "patches:x"], "not patch numbers"),
        (["A", "-o", "x.png", "--dpi", "0"], "10 to 2400"),
        (["-o", "x.png"], "none is given"),
        (["-o", "x.png", "--kind", "map"], "a file is needed"),
        (["A", "-o", "A"], "ends in .xml"),
    ],
)
def test_what_makes_no_sense_is_refused_and_nothing_written(files, tmp_path, capsys, monkeypatch, words, complaint):
    monkeypatch.chdir(tmp_path)
    before = sorted(tmp_path.iterdir())
    named = [{"A": files[0], "B": files[1]}.get(word, word) for word in words]
    code, out, err = run(capsys, "plot", *named)
    assert code in (1, 2)
    assert out == ""
    assert err.startswith("error: ")
    assert err.count("\n") == 1
    assert complaint in err
    assert sorted(tmp_path.iterdir()) == before


def test_names_of_files_become_labels():
    from pathlib import Path

    assert command._labels([Path("a/x.xml.gz"), Path("y.bsdf.npz")], None) == ["x", "y"]
    assert command._labels([Path("a/x.xml"), Path("b/x.xml")], None) == ["a/x", "b/x"]


def test_several_files_are_shown_in_one_band(tmp_path, capsys):
    flat = Model.matrix(np.full((41, 41), 0.1), Basis.named("klems-quarter"))
    both = Bsdf.from_models({band: {("exterior", "transmission"): flat} for band in ("visible", "solar")})
    one = Bsdf.from_models({"solar": {("exterior", "transmission"): flat}})
    other = Bsdf.from_models({"nir": {("exterior", "transmission"): flat}})
    for name, bsdf in (("both", both), ("one", one), ("other", other)):
        bsdf.write(tmp_path / f"{name}.xml")
    target = tmp_path / "x.png"
    words = ("--kind", "bars", "--patch", 1, "-o", target, "--dpi", 40, "--json")
    code, out, _ = run(capsys, "plot", tmp_path / "both.xml", tmp_path / "one.xml", *words)
    assert code == 0
    assert json.loads(out)["band"] == "solar"
    assert {row["band"] for row in json.loads(out)["values"]} == {"solar"}
    code, out, err = run(capsys, "plot", tmp_path / "one.xml", tmp_path / "other.xml", *words)
    assert (code, out) == (1, "")
    assert "no band in common (there are: one: solar; other: nir" in err
    code, _, err = run(capsys, "plot", tmp_path / "one.xml", "--band", "visible", "-o", target)
    assert code == 1
    assert err.startswith(f"error: {tmp_path / 'one.xml'}: no band 'visible'")


def test_real_files_are_drawn(sample_data, tmp_path, capsys):
    blind = sample_data / "klems" / "ExtVenetianBlind_17tilt.xml"
    tree = sample_data / "tensortree" / "b30.xml"
    assert run(capsys, "plot", blind, "-o", tmp_path / "a.png", "--patch", 88, "--dpi", 50)[0] == 0
    assert run(capsys, "plot", blind, tree, "-o", tmp_path / "b.png", "--dpi", 50)[0] == 0
    code, out, _ = run(capsys, "plot", tree, "-o", tmp_path / "c.png", "--kind", "map", "--dpi", 50, "--json")
    assert code == 0
    assert json.loads(out)["values"] == []
    assert np.all([(tmp_path / f"{n}.png").read_bytes().startswith(MAGIC["png"]) for n in "abc"])
