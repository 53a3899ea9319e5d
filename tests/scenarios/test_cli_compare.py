"""`clerestory compare` as a person uses it."""

import json

import numpy as np
import pytest

from clerestory import Basis, Bsdf, Model
from clerestory.cli import main


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Two data sets of a blind-like sample, and a solar one."""
    folder = tmp_path_factory.mktemp("files")
    basis = Basis.named("klems-quarter")
    out = basis.outgoing_centres("interior")
    lobe = np.maximum(out @ out.T, 0.0) ** 8
    for name, factor in (("one", 0.10), ("two", 0.11)):
        parts = {("exterior", "transmission"): Model.matrix(factor * lobe, basis)}
        Bsdf.from_models(parts).write(folder / f"{name}.xml")
        Bsdf.from_models({"solar": parts}).write(folder / f"{name}_solar.xml.gz")
    return folder


def run(capsys, *words):
    code = main(["compare", *(str(word) for word in words)])
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def test_a_report_is_written_and_summed_up(folder, tmp_path, capsys):
    report = tmp_path / "report.html"
    code, out, err = run(
        capsys, f"HSLU={folder / 'one.xml'}", f"ISE={folder / 'two.xml'}", "-o", report, "--patches", "1,41"
    )
    assert code == 0, err
    assert "agree within 9.5 %" in out
    assert f"wrote {report}" in err
    text = report.read_text(encoding="utf-8")
    assert "clerestory compare HSLU=one.xml ISE=two.xml --patches 1,41 -o report.html" in text
    assert "HSLU" in text


def test_json_is_all_that_is_printed(folder, capsys):
    code, out, _ = run(capsys, folder / "one.xml", folder / "two.xml", "--json", "--patches", "1")
    assert code == 0
    made = json.loads(out)
    assert [s["label"] for s in made["sets"]] == ["one", "two"]
    values = {q["key"]: q["values"] for q in made["quantities"]}
    assert values["T_d-h, Klems 1"][1] / values["T_d-h, Klems 1"][0] == pytest.approx(1.1, rel=1e-5)
    assert len(made["sets"][0]["sha256"]) == 64
    assert made["distances"][-1]["relative_l1"][0][1] == pytest.approx(0.1 / 1.05, rel=1e-4)


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        (["{one}", "{two}"], 2, "the report has no name"),
        (["{one}", "-o", "{new}"], 1, "1 data set cannot be compared"),
        (["{one}", "{two}", "-o", "{one}"], 2, "the report is an HTML file"),
        (["{one}", "{two}", "-o", "{missing}"], 2, "does not exist (create it first)"),
        (["{one}", "{two}", "-o", "{folder}/x.png"], 2, "the report is an HTML file"),
        (["{one}", "{folder}/no.xml", "-o", "{new}"], 1, "no.xml: no such file"),
        (["{one}", "{two}", "-o", "{new}", "--label", "a"], 2, "1 label for 2 files"),
        (["A={one}", "B={two}", "-o", "{new}", "--label", "a", "--label", "b"], 2, "labels are there twice"),
        (["{one}", "{two}", "-o", "{new}", "--patches", "1,x"], 2, "not numbers with commas"),
        (["{one}", "{two}", "-o", "{new}", "--patches", "999"], 1, "Klems patch 999 does not exist"),
        (["{one}", "{two}", "-o", "{new}", "--band", "nir"], 1, "has no band 'nir'"),
        (["{one}", "{two}", "-o", "{new}", "--scatter", "reflection"], 1, "one: "),
        (["{one}", "{folder}/one_solar.xml.gz", "-o", "{new}"], 1, "no band in common"),
    ],
)
def test_failures_end_in_one_line_and_leave_no_file(folder, tmp_path, capsys, words, code, message):
    names = {
        "one": folder / "one.xml",
        "two": folder / "two.xml",
        "folder": folder,
        "new": tmp_path / "new.html",
        "missing": tmp_path / "no" / "new.html",
    }
    before = (folder / "one.xml").read_bytes()
    found, out, err = run(capsys, *(word.format(**names) for word in words))
    assert found == code
    assert out == ""
    assert message in err
    assert len(err.strip().splitlines()) == 1
    assert list(tmp_path.iterdir()) == []
    assert (folder / "one.xml").read_bytes() == before


def test_one_system_at_several_resolutions(sample_data, capsys):
    """Klems half and quarter that bsdf2klems made of a tensor tree: their totals are those of the tree."""
    names = ["tensortree/b30.xml", "klems/derived_b30_klems_half.xml", "klems/derived_b30_klems_quarter.xml"]
    code, out, err = run(capsys, *(sample_data / name for name in names), "--json", "--side", "interior")
    assert code == 0, err
    made = json.loads(out)
    values = {q["key"]: q["values"] for q in made["quantities"]}
    assert np.ptp(values["T_h-h, uniform"]) < 0.05 * np.mean(values["T_h-h, uniform"])
    angles = np.array(made["distances"][-1]["transport_deg"])
    assert 1.0 < angles[0, 1] < 12.0
    assert made["turns"] == []
