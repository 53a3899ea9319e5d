"""A developed picture means the same to evalglare: illuminance at the lens, by its own weights of the channels."""

from pathlib import Path

import pytest

from camera import Maker
from clerestory.glare import evaluate
from clerestory.photo import Lens, Session, develop
from clerestory.picture import Picture
from glare_pictures import evalglare


@pytest.mark.parametrize("view", ["-vta", "-vth", "-vta -vp 1 2 1.2 -vd 0.6 0.8 0"])
def test_illuminance(view, require_pyradiance, tmp_path):
    program = Path(require_pyradiance.anci.BINPATH) / "evalglare"
    if not program.exists():
        pytest.skip("evalglare absent from pyradiance")
    Maker(Lens("equisolid", (120.0, 80.0), 75.0), shape=(160, 240), noise=0.2).jpegs(tmp_path)
    tables = {"pictures": ["*.JPG"], "calibration": {"factor": 0.105}, "output": {"view": view, "size_px": 300}}
    made = develop(Session.of(tables), tmp_path)
    made.picture.write(tmp_path / "out.hdr")
    theirs = evalglare(program, tmp_path / "out.hdr").values
    ours = evaluate(Picture.read(tmp_path / "out.hdr"))
    assert ours.vertical_illuminance == pytest.approx(made.illuminance, rel=2e-3)
    assert theirs["E_v"] == pytest.approx(made.illuminance, rel=3e-3)
    assert theirs["dgp"] == pytest.approx(ours.dgp, abs=0.002)
