"""What XML files say of a product besides light: written and read back."""

import numpy as np
import pytest

import clerestory
from clerestory import Basis, Bsdf, ClerestoryError, Model
from clerestory.system.product import Curve, Heat, Orientation, ProductData, product_of, with_product

FULL = Basis.named("klems-full")
DATA = ProductData(
    components=(
        {
            "number": 1,
            "kind": "glass",
            "name": "a & b <c>",
            "file": "x.dat",
            "flipped": True,
            "thickness_m": 0.006,
            "tir": 0.0,
        },
        {"number": 2, "kind": "gap", "name": "gas", "width_m": 0.016, "gas": {"argon": 0.9, "air": 0.1}},
    ),
    parameter="tilt_deg",
    value=30.0,
    heat=Heat(1.1, 0.35, 0.3, "NFRC winter", "NFRC summer"),
    curve=Curve((0.0, 20.0, 60.0), (None, 37.7, -33.3), (80.0, 72.0, 8.0), 3.0, 5.0),
    orientation=Orientation("roof", 0.0, 15.0, (0.0, 45.0)),
)


def data_set():
    parts = {
        (side, scatter): Model.matrix(
            np.full((145, 145), 0.2 / np.pi) + np.diag(k * 0.1 / FULL.projected_solid_angles), FULL
        )
        for k, (side, scatter) in enumerate(
            (s, c) for s in ("exterior", "interior") for c in ("transmission", "reflection")
        )
    }
    return Bsdf.from_models({"visible": parts, "solar": parts}).with_metadata(
        name="N",
        manufacturer="M",
        device_type="Other",
        thickness_m=0.02,
        emissivity_exterior=0.8,
        emissivity_interior=0.7,
        tir=0.0,
    )


def test_all_comes_back(tmp_path):
    for k, suffix in enumerate((".xml", ".xml.gz", ".bsdf.npz")):
        path = tmp_path / f"a{suffix}"
        with_product(data_set(), DATA).write(path)
        assert product_of(clerestory.read(path)) == DATA, k
    assert product_of(data_set()) is None
    again = with_product(with_product(data_set(), DATA), ProductData(value=1.0, parameter="height"))
    assert product_of(again) == ProductData(value=1.0, parameter="height")


@pytest.mark.parametrize(
    ("old", "new", "match"),
    [
        (">37.7<", ">steep<", "ControlCurve/Point: 'steep' is no number"),
        ("80.0 72.0 8.0", "80.0 72.0", "ControlCurve/Slats: 2 numbers where 3 belong"),
        ('mounting="roof"', 'mounting="floor"', "Orientation: mounting 'floor' is not known"),
        ("<SHGC>0.35</SHGC>", "", "Heat: <SHGC> is missing"),
        ('number="1"', 'number="one"', "Component: number 'one' is none"),
        (">0.006<", ">inf<", "Component 1/thickness_m"),
    ],
)
def test_damage_is_named(tmp_path, old, new, match):
    path = tmp_path / "a.xml"
    with_product(data_set(), DATA).write(path)
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    with pytest.raises(ClerestoryError, match=match):
        product_of(clerestory.read(path))
