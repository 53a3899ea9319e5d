"""The tilt that keeps the sun out, beside its closed form."""

import csv
import json

import numpy as np
import pytest

from clerestory import ClerestoryError
from clerestory.annual.control.curve import control_curve, slats_of
from clerestory.annual.control.slats import Slats
from clerestory.cli import main
from clerestory.trace import load

FLAT = Slats(80.0, 72.0)


def test_flat_slats_have_a_closed_form():
    """asin(S cos Ω / W) − Ω; the values of 10 to 60° for S/W = 0.9."""
    found = control_curve(FLAT, range_deg=(-90.0, 90.0))
    at = [10, 20, 30, 40, 45, 50, 60]
    np.testing.assert_allclose(found.exact_deg[at], [52.4, 37.7, 21.2, 3.6, -5.5, -14.7, -33.3], atol=0.05)


def test_the_drive_has_steps_safety_and_ends():
    found = control_curve(FLAT, safety_deg=3.0, step_deg=5.0, range_deg=(0.0, 50.0))
    assert found.tilt_deg[30] == 25.0  # 21.2 + 3, the next step
    assert found.tilt_deg[60] == 0.0
    assert np.isnan(found.tilt_deg[10])  # beyond the range
    below = found.tilt_deg[np.isfinite(found.tilt_deg)]
    assert (np.diff(below) <= 0.0).all()


def test_slats_that_do_not_overlap_cannot_keep_a_low_sun_out():
    found = control_curve(Slats(70.0, 80.0))
    assert np.isnan(found.tilt_deg[0])
    assert np.isfinite(found.tilt_deg[60])
    assert found.as_dict()["tilt_deg"][0] is None


def test_of_a_recipe():
    assert slats_of(load("round-robin-blind")).width == 81.0
    with pytest.raises(ClerestoryError, match="no slats"):
        slats_of(load("twill-1-percent"))


def test_the_command(tmp_path, capsys):
    table = tmp_path / "curve.csv"
    assert main(["system", "curve", "--slats", "80,72,0", "-o", str(table)]) == 0
    with table.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert float(rows[40]["least_tilt_deg"]) == pytest.approx(3.6, abs=0.05)
    capsys.readouterr()
    for name in ("curve.json", "curve.png"):
        assert main(["system", "curve", "round-robin-blind", "-o", str(tmp_path / name), "--json"]) == 0
        assert json.loads(capsys.readouterr().out)["slats_mm"]["width"] == 81.0
    assert json.loads((tmp_path / "curve.json").read_text(encoding="utf-8"))["profile_deg"][1] == 1.0
    for words in (
        [],
        ["round-robin-blind", "--slats", "80,72,0"],
        ["--slats", "80,72"],
        ["--slats", "80,72,0", "--range", "90,0"],
        ["--slats", "80,72,0", "-o", "curve.txt"],
        ["twill-1-percent"],
    ):
        assert main(["system", "curve", *words]) != 0
        assert capsys.readouterr().err.startswith("error: ")
