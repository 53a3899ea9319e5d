"""What our XML files say of a product is passed over by the programs that they are for."""

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

import clerestory
from clerestory import Basis, Bsdf, Model
from clerestory.system.product import Curve, Heat, Orientation, ProductData, with_product

FULL = Basis.named("klems-full")
DATA = ProductData(
    components=({"number": 1, "kind": "glass", "name": "pane", "Thickness": "7"},),
    heat=Heat(1.1, 0.35, 0.3, "NFRC winter", "NFRC summer"),
    curve=Curve((0.0, 20.0), (None, 37.7), (80.0, 72.0, 8.0)),
    orientation=Orientation("roof", 0.0, 15.0, (0.0, 45.0)),
)


@pytest.fixture
def written(tmp_path):
    """A file with an element of ours, its data set, and the same without."""
    rng = np.random.default_rng(3)
    parts = {
        (side, scatter): Model.matrix(rng.uniform(0.0, 0.2, (145, 145)), FULL)
        for side in ("exterior", "interior")
        for scatter in ("transmission", "reflection")
    }
    bsdf = Bsdf.from_models({"visible": parts, "solar": parts}).with_metadata(
        name="N",
        manufacturer="M",
        device_type="Other",
        thickness_m=0.02,
        emissivity_exterior=0.8,
        emissivity_interior=0.7,
        tir=0.0,
    )
    bsdf.write(tmp_path / "without.xml")
    with_product(bsdf, DATA).write(tmp_path / "with.xml")
    assert "<ProductData" in (tmp_path / "with.xml").read_text()
    return bsdf, tmp_path


def test_lbnls_parser(written):
    pywincalc = pytest.importorskip("pywincalc", reason="pywincalc absent")
    bsdf, folder = written
    layer = pywincalc.parse_bsdf_xml_file(str(folder / "with.xml"))
    assert (layer.emissivity_front, layer.emissivity_back) == (0.8, 0.7)
    # Its objects do not keep each other alive: each step is held by a name.
    measurements = layer.measurements
    solar = measurements.solar
    block = solar.reflectance_back
    assert np.array_equal(np.array(block.data), bsdf.models["solar"]["interior", "reflection"].values)


def test_radiance(written, require_pyradiance):
    _, folder = written

    def run(program, *arguments):
        command = [Path(require_pyradiance.anci.BINPATH) / program, *arguments]
        return subprocess.run(command, capture_output=True, text=True, check=True, cwd=folder, env=os.environ).stdout

    for program, arguments in (("checkBSDF", ()), ("bsdf2klems", ("-q", "-n", "16"))):
        told = [run(program, *arguments, f"{name}.xml").replace(f"{name}.xml", "") for name in ("without", "with")]
        assert told[0] == told[1], program
        assert len(told[0]) > 200
    (folder / "klems.xml").write_text(run("bsdf2klems", "-n", "16", "with.xml"))
    assert clerestory.read(folder / "klems.xml").bands == ("visible",)
