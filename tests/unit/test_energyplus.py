"""Windows as EnergyPlus' objects: fields by its data dictionary, the order of matrices, and what it cannot take."""

import json
import re

import numpy as np
import pytest

from clerestory import Basis, Bsdf, ClerestoryError, Model
from clerestory.system.energyplus import epjson, fenestration, idf
from clerestory.system.energyplus.fields import FIELDS, json_name
from clerestory.system.glass import Thermal
from clerestory.system.layer import Gap, Layer
from clerestory.system.shelf import glass
from clerestory.system.window import Window

QUARTER = Basis.named("klems-quarter")
COMPONENTS = [(side, scatter) for side in ("exterior", "interior") for scatter in ("transmission", "reflection")]
# Fields that Energy+.idd 25.2 has, or asks for at least, each with the name.
AT_MOST = {
    "Construction:ComplexFenestrationState": 36,
    "WindowThermalModel:Params": 8,
    "WindowMaterial:Gap": 6,
    "WindowMaterial:GasMixture": 11,
}
AT_LEAST = {
    "WindowMaterial:Glazing": 14,
    "WindowMaterial:ComplexShade": 12,
    "WindowMaterial:Gas": 3,
    "WindowMaterial:GasMixture": 7,
}


def cloth(bands=("visible", "solar"), **thermal):
    """A layer whose values differ for every pair of patches, sides and bands."""
    rng = np.random.default_rng(5)
    parts = {
        band: {key: Model.matrix(rng.uniform(0.02, 0.12, (41, 41)), QUARTER) for key in COMPONENTS} for band in bands
    }
    known = {"thickness_m": 0.001, "conductivity": 0.3, "emissivity_exterior": 0.8, "emissivity_interior": 0.7}
    known |= {"tir": 0.05, "openness": 0.03, "edges_m": (0.01, 0.02, 0.0, 0.0)} | thermal
    return Layer("cloth, 3 %", bsdf=Bsdf.from_models(parts), thermal=Thermal(**known))


def pane(name="pane"):
    clear = glass("clear", 0.006)
    return Layer(name, pane=clear, thermal=clear.thermal)


@pytest.fixture(scope="module")
def made():
    window = Window(
        [pane(), pane("inner"), cloth()], [Gap("g", 0.016, {"argon": 0.9, "air": 0.1}), Gap("a", 0.05, {"air": 1.0})]
    )
    built = window.solve(QUARTER)
    objects, assumed = fenestration(window, built, "Panes; cloth, inside")
    assert assumed == []
    return built, objects


def parsed(text):
    """Objects of an IDF: class, and fields without their comments."""
    plain = re.sub(r"!.*", "", text)
    return [[field.strip() for field in part.split(",")] for part in plain.split(";") if part.strip()]


def test_fields_are_those_of_the_data_dictionary(made):
    _, objects = made
    found = parsed(idf(objects))
    assert len(found) == len(objects)
    for (kind, *fields), held in zip(found, objects, strict=True):
        assert (kind, fields[0]) == (held.kind, held.name)
        assert len(fields) <= AT_MOST.get(kind, 10**9)
        assert len(fields) >= AT_LEAST.get(kind, 0)
        if kind == "Matrix:TwoDimension":
            assert len(fields) - 3 == int(fields[1]) * int(fields[2])
    assert len(FIELDS["Construction:ComplexFenestrationState"]) + 1 == 36
    state = found[-1]
    assert state[0] == "Construction:ComplexFenestrationState"
    assert state[1] == "Panes cloth inside"
    names = {fields[1] for fields in found}
    assert {field for field in state[4:] if field and field != "None"} <= names
    # Gaps lie between layers, with their reserved fields left blank.
    label = "Panes cloth inside"
    assert state[10:16] == [f"{label}_Layer1", f"{label}_Layer1_fAbs", f"{label}_Layer1_bAbs", f"{label}_Gap1", "", ""]


def test_every_name_in_json_is_the_schemas(made):
    _, objects = made
    held = json.loads(epjson(objects))
    state = held["Construction:ComplexFenestrationState"]["Panes cloth inside"]
    assert state["layer_2_directional_front_absorptance_matrix_name"] == "Panes cloth inside_Layer2_fAbs"
    assert state["solar_optical_complex_back_reflectance_matrix_name"] == "Panes cloth inside_RbSol"
    gap = held["WindowMaterial:Gap"]["Panes cloth inside_Gap1"]
    assert gap == {"thickness": 0.016, "gas_or_gas_mixture_": "Panes cloth inside_Gap1_Gas", "pressure": 101325.0}
    mixture = held["WindowMaterial:GasMixture"]["Panes cloth inside_Gap1_Gas"]
    assert (mixture["gas_1_type"], mixture["gas_1_fraction"]) == ("Argon", 0.9)
    assert json_name("CFS Gap 1 Directional Front Absorptance Matrix Name") == (
        "cfs_gap_1_directional_front_absorptance_matrix_name"
    )
    shade = held["WindowMaterial:ComplexShade"]["Panes cloth inside_Layer3"]
    # Gaps at the edges are counted in widths of the gap beside the cloth.
    assert shade["top_opening_multiplier"] == pytest.approx(0.2)
    assert shade["bottom_opening_multiplier"] == pytest.approx(0.4)
    assert shade["front_opening_multiplier"] == pytest.approx(0.078 * 0.03**1.2)
    assert (shade["front_emissivity"], shade["back_emissivity"], shade["ir_transmittance"]) == (0.8, 0.7, 0.05)


def test_matrices_keep_their_order(made):
    built, objects = made
    by_name = {m.name.rpartition("_")[2]: m for m in objects if m.kind == "Matrix:TwoDimension"}
    models = built.matrices.models
    for name, band, key in (
        ("TfSol", "solar", ("exterior", "transmission")),
        ("RbSol", "solar", ("interior", "reflection")),
        ("TfVis", "visible", ("exterior", "transmission")),
        ("TbVis", "visible", ("interior", "transmission")),
    ):
        expected = models[band][key].values
        assert not np.allclose(expected, expected.T)
        rows = np.array(by_name[name].values).reshape(41, 41)
        # Rows are outgoing patches: the sun's beam in patch i is Σ λ(o) f(o, i).
        assert np.array_equal(rows, expected)
        text = next(fields for fields in parsed(idf([by_name[name]])))
        np.testing.assert_allclose(np.array(text[4:], dtype=float).reshape(41, 41), expected, rtol=1e-7)
    area = QUARTER.projected_solid_angles
    tau = area @ np.array(by_name["TfSol"].values).reshape(41, 41)
    np.testing.assert_allclose(
        tau, built.bsdf.integrate(QUARTER.incident_centres("exterior"), "transmission", band="solar"), rtol=1e-9
    )
    basis = np.array(by_name["Basis"].values).reshape(-1, 2)
    assert basis[:, 1].sum() == 41
    assert basis[0].tolist() == [0.0, 1.0]
    front = np.array([m.values for m in objects if m.name.endswith("_fAbs")])
    np.testing.assert_allclose(front, built.absorptance("solar"))


def test_what_it_cannot_take_is_named():
    air = [Gap("a", 0.05, {"air": 1.0})]

    def fails(window, match, basis=QUARTER):
        with pytest.raises(ClerestoryError, match=match):
            fenestration(window, window.solve(basis), "w")

    fails(Window([pane(), cloth()]), "the gaps between the layers are not given")
    fails(Window([cloth()]), r"layer 1 \(cloth, 3 %\): EnergyPlus takes no shading layer alone")
    fails(Window([pane(), cloth()], air), "takes Klems bases, not Tregenza", "tregenza")
    fails(Window([pane()] * 6, air * 5), "takes 5 solid layers, the window has 6")
    fails(Window([pane(), cloth(("visible",))], air), "the window has no band 'solar'")
    fails(Window([pane(), cloth(conductivity=None)], air), r"layer 2 \(cloth, 3 %\): heat needs its conductivity")
