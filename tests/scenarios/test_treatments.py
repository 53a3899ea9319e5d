"""The four treatments of a fabric in a window: what they do to glare, and what they leave alone."""

from __future__ import annotations

import pytest

from clerestory import room, trace
from clerestory.glare import evaluate
from clerestory.trace.recipe import read_toml

TREATMENTS = ("klems", "klems-peaks", "high", "high-peaks")
#: The shipped 1 % twill lets the sun from the south pass straight up to about 52°.
CUT_OFF_DEG = 52.0


@pytest.fixture(scope="module")
def rated(tmp_path_factory):
    """E_v [lx] and DGP by treatment, with the sun 10° inside the cut-off."""
    path = tmp_path_factory.mktemp("treatments") / "fabric.xml"
    # XML holds no beams: they go into the cells that they fall into, as in a measured file.
    trace.measure("twill-1-percent", basis="tensor4", resolution=5, samples=2048).write(path)
    found = {}
    for treatment in TREATMENTS:
        tables = read_toml(room.shipped.ROOMS.path_of("office"))
        tables["systems"]["window"] = {"file": str(path), "treatment": treatment}
        tables["sky"] = {"kind": "preetham", "turbidity": 3.0, "sun_deg": [CUT_OFF_DEG - 10.0, 180.0]}
        # Near enough to the window to see the sun through it.
        tables["views"]["desk"] |= {"point_m": [1.8, 1.2, 1.2], "size_px": [320, 320]}
        rating = evaluate(room.load(tables).picture("desk", samples=16).picture())
        found[treatment] = (rating.vertical_illuminance, rating.dgp)
    return found


@pytest.mark.parametrize("resolution", ["klems", "high"])
def test_peaks_raise_glare_and_hardly_illuminance(rated, resolution):
    """Peak extraction raises the DGP by more than 0.05; E_v stays within 10 %."""
    plain, peaks = rated[resolution], rated[f"{resolution}-peaks"]
    assert peaks[1] > plain[1] + 0.05, rated
    assert peaks[0] == pytest.approx(plain[0], rel=0.1), rated
