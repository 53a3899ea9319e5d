"""`clerestory system build` as a person meets it: specifications, files, results, and what goes wrong."""

import json
from pathlib import Path

import numpy as np
import pytest

import clerestory
from clerestory import Basis, Bsdf, Model
from clerestory.cli import main

PANE = '[[layers]]\nkind = "glass"\nglass = "clear"\nthickness_mm = 6\n'
GAP = '[[layers]]\nkind = "gap"\nwidth_mm = 16\ngas = { argon = 0.9, air = 0.1 }\n'
COMPONENTS = [(side, scatter) for side in ("exterior", "interior") for scatter in ("transmission", "reflection")]


def shade(path: Path, *, without: tuple[str, str] | None = None, scale: float = 1.0, bands=("visible", "solar")) -> str:
    """A file of a diffuser with holes on Klems half, and the layer of it."""
    basis = Basis.named("klems-half")
    values = np.full((len(basis), len(basis)), 0.3 / np.pi)
    hole = np.diag(0.2 / basis.projected_solid_angles)
    models = {
        key: Model.matrix(scale * (values + (hole if key[1] == "transmission" else 0.0)), basis) for key in COMPONENTS
    }
    models.pop(without, None)
    Bsdf.from_models(dict.fromkeys(bands, models)).with_metadata(name="screen").save(path)
    return f'[[layers]]\nkind = "file"\nfile = "{path.name}"\n'


def spec(folder: Path, *parts: str, system: str = "") -> Path:
    path = folder / "window.toml"
    path.write_text(f"[system]\n{system}\n" + "".join(parts))
    return path


def failed(capsys, *arguments: object) -> str:
    assert main(["system", "build", *map(str, arguments)]) != 0
    error = capsys.readouterr().err.strip().splitlines()[-1]
    assert error.startswith("error: ")
    return error


def test_glass_and_a_shade_of_another_basis(tmp_path, capsys):
    path = spec(tmp_path, PANE, GAP, PANE, GAP, shade(tmp_path / "shade.bsdf.npz"), system='basis = "klems-quarter"')
    out = tmp_path / "window.xml"
    assert main(["system", "build", str(path), "-o", str(out), "--json"]) == 0
    captured = capsys.readouterr()
    found = json.loads(captured.out)
    assert "layer 5 (screen), visible: converted from LBNL/Klems Half to LBNL/Klems Quarter" in captured.err
    assert [layer["name"] for layer in found["layers"]] == ["clear 6 mm", "clear 6 mm", "screen"]
    assert found["layers"][0]["emissivity_exterior"] == 0.84
    assert found["gaps"][0]["gas"] == {"argon": 0.9, "air": 0.1}
    assert set(found["bands"]) == {"visible", "solar", "nir"}
    assert 0.0 < found["broad_bands_differ_by"]["solar"] < 0.02
    for sides in found["bands"].values():
        for values in sides.values():
            total = np.array(values["transmission"]["by_patch"]) + values["reflection"]["by_patch"]
            total += np.array(values["absorptance"]["by_patch"]).sum(axis=0)
            np.testing.assert_allclose(total, 1.0, atol=1e-9)
    read = clerestory.read(out)
    assert set(read.bands) == {"visible", "solar", "nir"}
    assert read.metadata.emissivity_exterior == 0.84
    normal = np.array([0.0, 0.0, -1.0])
    expected = found["bands"]["visible"]["exterior"]["transmission"]["normal"]
    assert float(read.integrate(normal, "transmission")) == pytest.approx(expected, rel=1e-6)


def test_sharp_beams_in_an_own_file(tmp_path, capsys):
    layer = shade(tmp_path / "shade.bsdf.npz") + "separate_peaks = true\n"
    path = spec(tmp_path, PANE, GAP, layer, system='resolution = "layers"\nbasis = "klems-quarter"')
    out = tmp_path / "window.bsdf.npz"
    assert main(["system", "build", str(path), "-o", str(out)]) == 0
    assert "visible, from the exterior" in capsys.readouterr().out
    read = clerestory.read(out)
    assert read.models["visible"]["exterior", "transmission"].kind == "sum"
    assert "XML holds no beams" in failed(capsys, path, "-o", tmp_path / "window.xml")
    assert not (tmp_path / "window.xml").exists()


def test_curves_of_the_panes(tmp_path, capsys):
    path = spec(tmp_path, PANE, GAP, PANE)
    for name in ("curves.csv", "curves.png"):
        assert main(["system", "build", str(path), "--curves", str(tmp_path / name)]) == 0
    assert (tmp_path / "curves.csv").read_text().startswith("band,theta_deg,transmittance")
    assert (tmp_path / "curves.png").read_bytes().startswith(b"\x89PNG")
    capsys.readouterr()
    assert main(["system", "build", "--list", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)[0]["name"] == "double-glazing-roller-blind"


def test_what_is_wrong_names_the_layer(tmp_path, capsys):
    def of(*parts: str, system: str = "") -> str:
        return failed(capsys, spec(tmp_path, *parts, system=system), "-o", tmp_path / "out.xml")

    good = shade(tmp_path / "good.bsdf.npz")
    half = shade(tmp_path / "half.bsdf.npz", without=("interior", "reflection"))
    bright = shade(tmp_path / "bright.bsdf.npz", scale=1.5)
    thermal = shade(tmp_path / "thermal.bsdf.npz", bands=("thermal",))
    assert "layer 3 (screen): band 'visible'" in of(PANE, GAP, half)
    assert "reflection" in of(PANE, GAP, half)
    assert "layer 3 (screen): 120.0 % of the visible light from the exterior" in of(PANE, GAP, bright)
    message = of(PANE, GAP, thermal)
    assert "no band in common (layer 1 (clear 6 mm): nir, solar, visible; layer 3 (screen): thermal)" in message
    assert "layer 2 (gap): gas: what the gap is filled with is not given" in of(
        PANE, '[[layers]]\nkind = "gap"\nwidth_mm = 16\n', good
    )
    assert "layer 2 (gap): gas: 'helium' is not known" in of(PANE, GAP.replace("argon", "helium"), good)
    assert "layer 1 is a gap, but comes first" in of(GAP, PANE)
    assert "layer 2 is a gap, but comes last" in of(PANE, GAP)
    assert "layers 2 and 3 are both gaps" in of(PANE, GAP, GAP, PANE)
    assert "between layers 1 and 2 there is no gap" in of(PANE, PANE)
    assert "layer 1 (opal): no glass 'opal'" in of(PANE.replace("clear", "opal"))
    assert "layer 1 (none.dat): " in of('[[layers]]\nkind = "glass"\nfile = "none.dat"\n')
    assert "layer 1 (clear): thickness_mm: the thickness" in of('[[layers]]\nkind = "glass"\nglass = "clear"\n')
    assert "layer 1 (clear): thicknes_mm: there is no such key" in of(PANE.replace("thickness", "thicknes"))
    assert "layer 1 (wood): kind: 'wood' is not known" in of('[[layers]]\nkind = "wood"\n')
    assert "standard" in of(PANE, system='standard = "din"')
    assert "angle basis" in of(PANE, system='basis = "mine"') or "mine" in of(PANE, system='basis = "mine"')
    assert not (tmp_path / "out.xml").exists()
    assert "end it with" in failed(capsys, tmp_path / "window.toml", "-o", tmp_path / "out.txt")
