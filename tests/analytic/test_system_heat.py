"""Heat through windows that were built of layers, and their data sheets."""

import csv
import json

import numpy as np
import pytest

from clerestory import MissingDataError, Model
from clerestory.bsdf import Bsdf
from clerestory.cli import main
from clerestory.rating.classes import edition
from clerestory.rating.product import rate_device, rate_window
from clerestory.rating.sheet import directions, sheet
from clerestory.report.html import html
from clerestory.system.build import load
from clerestory.system.heat import heat
from clerestory.system.traced import traced_thermal
from clerestory.thermal.layer import permeability_of_slats
from clerestory.trace import load as load_sample
from samples import ABSENT, sample_root

PANE = {"kind": "glass", "glass": "clear", "thickness_mm": 3.048}
AIR = {"kind": "gap", "gas": "air", "width_mm": 12.7}


def cloth(folder):
    parts = {
        (side, scatter): Model.lambertian(value)
        for side in ("exterior", "interior")
        for scatter, value in (("transmission", 0.1), ("reflection", 0.6))
    }
    Bsdf.from_models({"visible": parts, "solar": parts}).save(folder / "cloth.bsdf.npz")
    return {"kind": "file", "file": str(folder / "cloth.bsdf.npz"), "name": "cloth"}


THERMAL = {
    "emissivity_exterior": 0.9,
    "emissivity_interior": 0.9,
    "tir": 0.05,
    "conductivity": 0.15,
    "thickness_mm": 1.0,
}


@pytest.mark.skipif(sample_root() is None, reason=ABSENT)
def test_clear_double_glazing():
    """U and SHGC of pywincalc 3.3.1 for panes of CLEAR_3 with 12.7 mm of air between them."""
    pane = {"kind": "glass", "file": str(sample_root() / "glazing" / "products" / "CLEAR_3.DAT")}
    made = load({"layers": [pane, AIR, pane], "system": {"standard": "nfrc300"}})
    found = heat(made.window, made.solve(), each=True)
    assert found.u == pytest.approx(2.7296, abs=1e-3)
    assert found.g == pytest.approx(0.7633, abs=1e-3)
    theta = np.degrees(np.arccos(-found.basis.incident_centres("exterior")[:, 2]))
    at_30 = found.gain.shgc[np.isclose(theta, 30.0, atol=0.01)]
    # Polarisation is kept between the panes here, so that a little more passes at oblique incidence.
    np.testing.assert_allclose(at_30, 0.7553, atol=0.002)
    assert found.diffuse < found.g


def test_fractions_of_one_direction_serve_all(tmp_path):
    made = load({"layers": [PANE, AIR, cloth(tmp_path) | THERMAL]})
    built = made.solve()
    quick, exact = (heat(made.window, built, each=each) for each in (False, True))
    assert quick.g == pytest.approx(exact.g, abs=1e-6)
    np.testing.assert_allclose(quick.gain.shgc, exact.gain.shgc, atol=0.004)
    total = quick.gain.transmitted + quick.gain.absorbed.sum(axis=0)
    assert (quick.gain.shgc <= total).all()


def test_open_edges_let_heat_in(tmp_path):
    tight = load({"layers": [PANE, AIR, cloth(tmp_path) | THERMAL]})
    open_ = load({"layers": [PANE, AIR, cloth(tmp_path) | THERMAL | {"edges_mm": {"top": 10, "bottom": 10}}]})
    found = [heat(made.window, made.solve()) for made in (tight, open_)]
    assert found[1].u > found[0].u + 0.5
    assert found[1].g > found[0].g


def test_what_heat_lacks_is_named(tmp_path):
    made = load({"layers": [PANE, AIR, cloth(tmp_path)]})
    with pytest.raises(MissingDataError, match=r"layer 3 \(cloth\): heat needs its emissivity_exterior"):
        heat(made.window, made.solve())
    with pytest.raises(Exception, match="nfrc-winter"):
        heat(made.window, made.solve(), winter="arctic")


def test_long_wave_values_and_openness_of_a_recipe():
    """A blind that is black in the long waves, level: what passes between flat slats is known in closed form."""
    sample = load_sample(
        {
            "bands": {"names": ["visible", "thermal"]},
            "sample": {
                "kind": "venetian-blind",
                "pitch_mm": 20.0,
                "slat": {"width_mm": 20.0, "upper": "black"},
            },
            "materials": {"black": {"kind": "lambertian", "reflectance": 0.0}},
        }
    )
    from clerestory import trace

    found = traced_thermal(sample, trace.measure(sample, samples=2048))
    # Two strips of equal width face to face at a distance equal to it: F = √2 − 1 (Hottel's crossed strings).
    assert found.tir == pytest.approx(np.sqrt(2.0) - 1.0, abs=0.01)
    assert found.emissivity_exterior == pytest.approx(1.0 - found.tir, abs=0.01)
    assert found.openness == permeability_of_slats(0.02, 0.02, 0.0)
    assert found.slat_tilt_deg == 0.0


def test_a_sheet_holds_what_was_found(tmp_path):
    limits = edition("en-14501:2005")
    made = load({"layers": [PANE, AIR, cloth(tmp_path) | THERMAL]})
    built = made.solve()
    found = heat(made.window, built)
    rated = rate_window(built.bsdf, limits, g=found.g, secondary=float(found.gain.secondary[0]), name="window")
    text = html(sheet(rated, built.bsdf, limits, heat=found, built=built))
    for wanted in ("window", f"{found.u:.2f} W", f"{found.g:.3f}", "2. cloth", "glare control", "data:image/png"):
        assert wanted in text
    rows = directions(found)
    assert len(rows) == 145
    assert rows[0]["shgc"] == found.g
    device = rate_device(Bsdf.from_models({("exterior", "transmission"): Model.lambertian(0.1)}), limits, name="film")
    assert "the data have no band solar" in html(
        sheet(device, Bsdf.from_models({("exterior", "transmission"): Model.lambertian(0.1)}), limits)
    )


def test_the_command(tmp_path, capsys):
    thermal = "\n".join(f"{key} = {value}" for key, value in THERMAL.items())
    cloth(tmp_path)
    spec = tmp_path / "window.toml"
    spec.write_text(
        '[system]\nname = "window"\n[[layers]]\nkind = "glass"\nglass = "clear"\nthickness_mm = 6\n'
        '[[layers]]\nkind = "gap"\ngas = "air"\nwidth_mm = 100\n'
        f'[[layers]]\nkind = "file"\nfile = "cloth.bsdf.npz"\nname = "cloth"\n{thermal}\n',
        encoding="utf-8",
    )
    path, table = tmp_path / "sheet.pdf", tmp_path / "gain.csv"
    assert main(["system", "rate", str(spec), "-o", str(path), "--directions", str(table), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["heat"]["g"] == pytest.approx(found["quantities"]["g_tot"])
    assert path.read_bytes().startswith(b"%PDF")
    with table.open(encoding="utf-8") as file:
        assert len(list(csv.DictReader(file))) == 145
    assert main(["system", "rate", str(tmp_path / "cloth.bsdf.npz")]) == 0
    assert "g with reference glazing" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--glazing", "E"], "--glazing E"),
        (["--position", "inside-out"], "--position"),
        (["--edition", "en-14501:2021"], "not public"),
        (["-o", "sheet.docx"], "sheet.docx"),
        (["--directions", "gain.csv"], "--directions"),
    ],
)
def test_wrong_usage(tmp_path, capsys, words, message):
    cloth(tmp_path)
    assert main(["system", "rate", str(tmp_path / "cloth.bsdf.npz"), *words]) != 0
    error = capsys.readouterr().err.strip()
    assert message in error
    assert error.count("\n") == 0
