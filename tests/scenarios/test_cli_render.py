"""`clerestory render` as a person uses it."""

from __future__ import annotations

import csv
import json

import pytest

from clerestory.cli import main
from clerestory.picture import Picture


def test_a_picture_and_its_glare(tmp_path, capsys):
    out = tmp_path / "office.hdr"
    assert main(["render", "office", "-o", str(out), "--size", "64,64", "--samples", "4", "--glare"]) == 0
    told = capsys.readouterr().out
    assert "DGP" in told
    assert "4 paths a pixel" in told
    picture = Picture.read(out)
    assert picture.shape == (64, 64)
    assert picture.view is not None
    assert picture.view.projection == "a"
    assert main(["glare", str(out)]) == 0


def test_false_colours(tmp_path):
    out = tmp_path / "office.png"
    assert main(["render", "office", "-o", str(out), "--view", "room", "--size", "48,32", "--samples", "2"]) == 0
    assert out.read_bytes().startswith(b"\x89PNG")


def test_illuminances(tmp_path, capsys):
    out = tmp_path / "plane.csv"
    assert main(["render", "cell-71t", "--sensors", "workplane", "-o", str(out), "--samples", "256", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    with out.open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(found["illuminance"]) > 20
    assert float(rows[0]["illuminance_lx"]) == pytest.approx(found["illuminance"][0], rel=1e-4)


WRONG = {
    "SCENE is missing": [],
    "no output is named": ["office"],
    "no room has this name": ["offce", "--glare"],
    "the name does not tell the format": ["office", "-o", "x.gif"],
    "illuminances are written as a table": ["office", "--sensors", "workplane", "-o", "x.hdr"],
    "there is no view": ["office", "--view", "nowhere", "--glare"],
    "not a size in pixels": ["office", "--size", "0,5", "--glare"],
}


@pytest.mark.parametrize(("text", "words"), WRONG.items(), ids=list(WRONG))
def test_wrong_calls(text, words, capsys):
    assert main(["render", *words]) in (1, 2)
    told = capsys.readouterr().err
    assert text in told
    assert told.startswith("error: ")
    assert told.count("\n") == 1
