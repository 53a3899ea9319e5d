"""The command line as a person uses it: results, messages, exit codes."""

import json
import os
import re
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

import clerestory
from clerestory import Basis, Bsdf, Model
from clerestory.cli import _COMMANDS, main

KLEMS = Basis.named("klems-full")
AREAS = KLEMS.projected_solid_angles


def matrix(values):
    return Model.matrix(values, KLEMS)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A clear pane, a diffuser that gives too much light, and a solar band of its own."""
    folder = tmp_path_factory.mktemp("files")
    diagonal = np.diag(1.0 / AREAS)
    pane = {
        (side, scatter): matrix(diagonal * value)
        for side in ("exterior", "interior")
        for scatter, value in (("transmission", 0.8), ("reflection", 0.1))
    }
    Bsdf.from_models(pane).with_metadata(name="Pane", thickness_m=0.006).write(folder / "pane.xml")
    flat = np.full((145, 145), 1.0 / np.pi)
    Bsdf.from_models(
        {("exterior", "transmission"): matrix(flat * 0.9), ("exterior", "reflection"): matrix(flat * 0.3)}
    ).write(folder / "glows.xml")
    Bsdf.from_models({"solar": {key: model.scaled(0.9) for key, model in pane.items()}}).write(folder / "solar.xml.gz")
    (folder / "broken.xml").write_text("<WindowElement><Layer>")
    return folder


def run(capsys, *words):
    code = main([str(word) for word in words])
    captured = capsys.readouterr()
    return code, captured.out, captured.err


@pytest.mark.parametrize("command", _COMMANDS)
def test_help_has_an_example(command, capsys):
    code, out, err = run(capsys, command, "--help")
    assert (code, err) == (0, "")
    example = re.search(r"^  Example: (clerestory .*)$", out, re.MULTILINE)
    assert example is not None
    assert example.group(1).split()[1] == command
    assert "--json" in out


@pytest.mark.parametrize("command", ["info", "check"])
@pytest.mark.parametrize("file", ["missing.xml", "broken.xml"])
def test_a_file_that_cannot_be_read_is_one_line(command, file, folder, capsys):
    code, out, err = run(capsys, command, folder / file)
    assert (code, out) == (1, "")
    assert re.fullmatch(rf"error: {re.escape(str(folder / file))}: [^\n]+\([^\n]+\)\n", err)


def test_info(folder, capsys):
    code, out, err = run(capsys, "info", folder / "pane.xml")
    assert (code, err) == (0, "")
    assert "name: Pane" in out
    assert "thickness: 6 mm" in out
    assert re.search(r"visible +exterior +transmission +matrix 145 × 145, LBNL/Klems Full", out)
    assert re.search(r"visible +exterior +transmission +0.8000 +0.8000 +0.8000 +0.8000 +0.8000", out)
    assert "Nothing suspicious" in out
    assert re.search(r"Cut-off angle\n  visible, light from the exterior: not cut off below 90°\n", out)
    assert "(1 % of that at 0°), light from above in steps of 1°, data resolve" in out
    code, out, _ = run(capsys, "info", folder / "glows.xml")
    assert code == 0
    assert "error: visible, light from the exterior: more light leaves than arrives in 145 of 145" in out


def test_info_as_json(folder, capsys):
    code, out, err = run(capsys, "info", folder / "pane.xml", "--json")
    result = json.loads(out)
    assert (code, err) == (0, "")
    assert result["bands"] == ["visible"]
    assert len(result["components"]) == 4
    assert result["components"][0]["direct_hemispherical"]["30"] == pytest.approx(0.8, rel=1e-5)
    assert result["metadata"]["name"] == "Pane"
    cut_offs = {(c["side"], c["scatter"]): c["cut_off"] for c in result["components"]}
    assert cut_offs["exterior", "reflection"] is None
    assert cut_offs["exterior", "transmission"]["angle_deg"] is None
    assert "data resolve" in cut_offs["exterior", "transmission"]["words"]


def test_check(folder, capsys):
    code, out, err = run(capsys, "check", folder / "pane.xml", "--for", "glare")
    assert (code, err) == (0, "")
    assert "1 warning" in out.splitlines()[0]
    assert "the sun is 0.53° wide" in out
    assert "Light from the exterior, 30° above the horizon: 80 % passes, mainly downward into the room" in out
    code, out, _ = run(capsys, "check", folder / "pane.xml", folder / "glows.xml")
    assert code == 1
    assert "more light leaves than arrives" in out
    assert out.count("Where the light goes") == 2


def test_check_goes_on_after_a_broken_file(folder, capsys):
    code, out, err = run(capsys, "check", folder / "broken.xml", folder / "pane.xml")
    assert code == 1
    assert err.startswith("error: ")
    assert err.count("\n") == 1
    assert "pane.xml: 1 note" in out
    code, out, err = run(capsys, "check", folder / "broken.xml", folder / "pane.xml", "--json")
    first, second = json.loads(out)
    assert code == 1
    assert "error" in first
    assert {f["severity"] for f in second["findings"]} <= {"error", "warning", "note"}
    assert second["light"][0]["words"].startswith("Light from the exterior")


def test_query(folder, capsys):
    words = ("query", folder / "pane.xml", "--incident", "40,90", "--cone", 5, "--ring", "5,20", "--patch", 64)
    code, out, err = run(capsys, *words)
    assert (code, err) == (0, "")
    assert "Light from above, 40°, from the exterior (Klems 64), in visible" in out
    assert "leaves downward, 40°, into the room (Klems 64)" in out
    assert re.search(r"all directions +0.800000", out)
    assert out.count("patch Klems 64") == 2
    code, out, _ = run(capsys, *words, "--json")
    result = json.loads(out)
    assert result["bsdf_per_sr"] == pytest.approx(0.8 / AREAS[63], rel=1e-5)
    assert [share["region"] for share in result["integrals"]] == [
        "all directions",
        "patch Klems 64",
        "within 5°",
        "5° to 20°",
        "patch Klems 64",
    ]
    values = [share["value"] for share in result["integrals"]]
    assert values[2] < values[1] == pytest.approx(0.8, rel=1e-5)
    assert values[2] + values[3] == pytest.approx(0.8, rel=0.02)
    assert result["peaks"] == []


def test_query_of_reflection_and_by_reciprocity(folder, capsys):
    code, out, _ = run(
        capsys, "query", folder / "pane.xml", "--incident", "40,90", "--outgoing", "40,270", "--outgoing-side", "ext"
    )
    assert code == 0
    assert "that is reflected and leaves downward, 40°, to the outside" in out
    assert re.search(r"all directions +0.100000", out)
    code, out, _ = run(capsys, "query", folder / "glows.xml", "--incident", "40,90", "--side", "interior")
    assert code == 0
    assert "answered by reciprocity" in out


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--incident", "95,0"], r"--incident 95,0: the angle to the normal goes from 0 to 90°"),
        (["--incident", "40"], r"--incident 40: not two angles"),
        (["--incident", "40,90", "--side", "front"], r"--side front: not known \(give exterior or interior\)"),
        (["--incident", "40,90", "--ring", "9,3"], r"--ring 9,3: not an inner and a larger outer angle"),
        (["--incident", "40,90", "--cone", "-1"], r"--cone -1: not the half angle"),
        (["--incident", "40,90", "--patch", "146"], r"--patch 146: .* \(give 1 to 145\)"),
        ([], r"missing option '--incident' \(see `clerestory query --help`\)"),
        (["--incident", "40,90", "--nonsense"], r"no such option: --nonsense"),
    ],
)
def test_wrong_usage_is_one_line_and_two(words, message, folder, capsys):
    code, out, err = run(capsys, "query", folder / "pane.xml", *words)
    assert (code, out) == (2, "")
    assert re.fullmatch(rf"error: {message}[^\n]*\n", err)


def test_query_of_a_missing_band(folder, capsys):
    code, out, err = run(capsys, "query", folder / "pane.xml", "--incident", "0,0", "--band", "nir")
    assert (code, out) == (1, "")
    assert err == f"error: {folder / 'pane.xml'}: no band 'nir' (the data set has: visible)\n"


def test_convert_merges_bands_and_sets_metadata(folder, tmp_path, capsys):
    output = tmp_path / "both.xml"
    code, out, err = run(
        capsys,
        *("convert", folder / "pane.xml", folder / "solar.xml.gz", output, "--for", "window"),
        *("--manufacturer", "Glassworks", "--emissivity-exterior", 0.84, "--emissivity-interior", 0.84, "--tir", 0),
    )
    assert (code, out) == (0, f"wrote {output}: solar, visible\n"), err
    bsdf = clerestory.read(output)
    assert set(bsdf.bands) == {"visible", "solar"}
    assert bsdf.metadata.manufacturer == "Glassworks"
    assert bsdf.metadata.thickness_m == pytest.approx(0.006)


def test_convert_to_another_basis_reports_its_error(folder, tmp_path, capsys):
    output = tmp_path / "quarter.xml.gz"
    code, out, _ = run(capsys, "convert", folder / "pane.xml", output, "--basis", "klems-quarter")
    assert code == 0
    assert out.count("exact") == 4
    assert len(clerestory.read(output).models["visible"]["exterior", "transmission"].incident_basis) == 41
    code, out, _ = run(capsys, "convert", folder / "pane.xml", output, "--basis", "klems-quarter", "--json")
    assert len(json.loads(out)["conversion"]) == 4


def smooth_tree():
    """A tensor tree with more leaves than it needs: a broad lobe on 16 cells an axis."""
    middles = (np.arange(16) + 0.5) / 16
    a, b, c, d = np.meshgrid(*[middles] * 4, indexing="ij")
    return Model.tree_from_grid(0.3 * np.exp(-8.0 * ((a - c) ** 2 + (b - d) ** 2)))


def test_convert_culls_a_tree(tmp_path, capsys):
    Bsdf.from_models({("exterior", "transmission"): smooth_tree()}).with_metadata(name="Lobe").write(tmp_path / "t.xml")
    _, out, _ = run(capsys, "info", tmp_path / "t.xml")
    assert "tensor tree of rank 4, 16 cells an axis, 7.2° at normal" in out
    output = tmp_path / "culled.xml"
    code, out, err = run(capsys, "convert", tmp_path / "t.xml", output, "--cull", 80)
    assert (code, err) == (0, "")
    before, after = (int(n.replace(",", "")) for n in re.search(r"([\d,]+) to ([\d,]+)", out).groups())
    assert after < 0.5 * before
    culled = clerestory.read(output)
    assert culled.metadata.name == "Lobe"
    assert culled.models["visible"]["exterior", "transmission"].tree_leaves == after
    code, out, err = run(capsys, "convert", tmp_path / "t.xml", output, "--cull", 101)
    assert (code, out) == (2, "")
    assert "--cull 101: not a percentage" in err


def test_convert_makes_trees(folder, tmp_path, capsys):
    output = tmp_path / "tree.xml"
    words = ("convert", folder / "glows.xml", output, "--basis")
    code, out, _ = run(capsys, *words, "tensor4", "--resolution", 3, "--samples", 4)
    assert code == 0
    assert "from matrix" in out
    model = clerestory.read(output).models["visible"]["exterior", "transmission"]
    assert (model.kind, model.tree_rank) == ("tensor tree", 4)
    assert run(capsys, *words, "tensor3", "--resolution", 3, "--json")[0] == 0
    assert clerestory.read(output).models["visible"]["exterior", "transmission"].tree_rank == 3
    code, _, err = run(capsys, *words, "klems-full", "--cull", 80)
    assert code == 2
    assert "--cull" in err


def test_convert_for_radiance_names_the_bands_that_it_wrote(folder, tmp_path, capsys):
    output = tmp_path / "both.xml"
    assert run(capsys, "convert", folder / "pane.xml", folder / "solar.xml.gz", output)[0] == 0
    code, out, err = run(capsys, "convert", output, tmp_path / "r.xml", "--for", "radiance")
    assert (code, out) == (0, f"wrote {tmp_path / 'r.xml'}: visible\n")
    assert "left out: solar" in err


@pytest.mark.parametrize(
    "options",
    [
        ("--samples", 0),
        ("--samples", 64),
        ("--basis", "klems-full", "--samples", -4),
        ("--resolution", 3),
        ("--basis", "klems-half", "--resolution", 3),
        ("--basis", "tensor4", "--resolution", 11),
        ("--cull", 101),
        ("--rotate", "nan"),
    ],
)
def test_convert_refuses_numbers_without_sense_or_effect(options, folder, tmp_path, capsys):
    code, out, err = run(capsys, "convert", folder / "pane.xml", tmp_path / "x.xml", *options)
    assert (code, out) == (2, "")
    assert re.fullmatch(r"error: --(samples|resolution|cull|rotate) [^\n]+ \(give [^\n]+\)\n", err)
    assert list(tmp_path.iterdir()) == []


def test_convert_turns_the_sample(folder, tmp_path, capsys):
    values = np.diag(np.where(KLEMS.outgoing_centres("interior")[:, 1] < -0.1, 0.5, 0.1) / AREAS)
    Bsdf.from_models({("exterior", "transmission"): matrix(values)}).write(tmp_path / "a.xml")
    assert run(capsys, "convert", tmp_path / "a.xml", tmp_path / "b.xml", "--rotate", 180)[0] == 0
    assert run(capsys, "convert", tmp_path / "a.xml", tmp_path / "c.xml", "--flip")[0] == 0
    above = clerestory.direction(50, 90)
    assert clerestory.read(tmp_path / "a.xml").integrate(above, "transmission") == pytest.approx(0.5, rel=1e-5)
    assert clerestory.read(tmp_path / "b.xml").integrate(above, "transmission") == pytest.approx(0.1, rel=1e-5)
    assert set(clerestory.read(tmp_path / "c.xml").models["visible"]) == {("interior", "transmission")}


def test_convert_renames_a_band(folder, tmp_path, capsys):
    output = tmp_path / "x.xml"
    words = ("convert", folder / "pane.xml", output, "--band-of")
    assert run(capsys, *words, "pane.xml=solar")[0] == 0
    assert clerestory.read(output).bands == ("solar",)
    assert run(capsys, *words, "pane.xml")[0] == 2
    code, _, err = run(capsys, *words, "other.xml=solar")
    assert code == 2
    assert "other.xml is none of the inputs" in err


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        (["pane.xml", "pane.xml"], 2, "would overwrite an input"),
        (["pane.xml", "x.txt"], 2, "does not tell the format"),
        (["pane.xml", "x.xml", "--basis", "nonsense"], 2, "--basis nonsense: "),
        (["pane.xml", "x.xml", "--cull", "90"], 2, "no tensor trees in the input (give --basis tensor4 too)"),
        (["pane.xml", "x.xml", "--for", "excel"], 2, "give plain or radiance or window or energyplus"),
        (["pane.xml", "glows.xml", "x.xml"], 1, "visible"),
        (["pane.xml", "x.xml", "--for", "window"], 1, "emissivity"),
        (["pane.xml", "x.xml", "--tir", "2"], 1, "2"),
        (["pane.xml", "no/x.xml"], 1, "no/x.xml"),
        (["missing.xml", "x.xml"], 1, "missing.xml: no such file"),
    ],
)
def test_convert_that_cannot_be_done_writes_nothing(words, code, message, folder, monkeypatch, capsys):
    monkeypatch.chdir(folder)
    before = {p.name: p.read_bytes() for p in folder.iterdir()}
    found, out, err = run(capsys, "convert", *words)
    assert (found, out) == (code, "")
    assert message in err
    assert err.count("\n") == 1
    assert re.search(r"\([^()]+\)\n$", err), err
    assert {p.name: p.read_bytes() for p in folder.iterdir()} == before


def test_warnings_of_a_file_go_to_standard_error(folder, tmp_path, capsys):
    text = (folder / "pane.xml").read_text(encoding="utf-8")
    (tmp_path / "logged.xml").write_text("genBSDF: a line of its log\n" + text, encoding="utf-8")
    code, out, err = run(capsys, "query", tmp_path / "logged.xml", "--incident", "0,0", "--json")
    assert code == 0
    assert json.loads(out)["band"] == "visible"
    assert re.fullmatch(rf"warning: {re.escape(str(tmp_path / 'logged.xml'))}: [^\n]+\n", err)
    _, out, err = run(capsys, "check", tmp_path / "logged.xml")
    assert err == ""
    assert "  warning: " in out


def test_a_reader_that_leaves_is_no_error(folder):
    program = subprocess.Popen(
        [sys.executable, "-m", "clerestory", "check", *[str(folder / "pane.xml")] * 3],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    program.stdout.close()
    assert program.stderr.read() == b""
    program.stderr.close()
    program.wait()


@pytest.mark.skipif(os.name == "nt", reason="Windows has no SIGINT for one process")
def test_interruption_is_one_line(tmp_path):
    """Ctrl-C while a file is read from a pipe that stays open."""
    os.mkfifo(tmp_path / "slow.xml")
    program = subprocess.Popen(
        [sys.executable, "-m", "clerestory", "info", str(tmp_path / "slow.xml")], stderr=subprocess.PIPE, text=True
    )
    handle = os.open(tmp_path / "slow.xml", os.O_WRONLY)  # returns once the program has opened it
    time.sleep(0.2)
    program.send_signal(signal.SIGINT)
    _, err = program.communicate(timeout=60)
    os.close(handle)
    assert program.returncode == 130
    assert err == "error: interrupted\n"
