"""Files that we write, in the hands of the programs that they are for; and their test vectors in ours.

The vectors' values were computed from their formulas and confirmed with Radiance's programs.
"""

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

import clerestory
from clerestory import Basis, Bsdf, Model

FULL = Basis.named("klems-full")
AREAS = FULL.projected_solid_angles


def toward(theta_deg, phi_deg):
    """Unit vector; polar angle from +z (the room), so more than 90° is the exterior."""
    t, p = np.radians([theta_deg, phi_deg])
    return np.array([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)])


def vector_a():
    """0.2 diffuse and 0.4 straight transmission, diffuse reflection."""
    return Bsdf.from_models(
        {
            ("exterior", "transmission"): Model.matrix(0.2 / np.pi + np.diag(0.4 / AREAS), FULL),
            ("exterior", "reflection"): Model.matrix(np.full((145, 145), 0.2 / np.pi), FULL),
            ("interior", "reflection"): Model.matrix(np.full((145, 145), 0.1 / np.pi), FULL),
        }
    )


def vector_b(side="exterior"):
    """Transmission with a value of its own for each pair of patches."""
    values = 0.004 + 2e-6 * np.arange(145 * 145).reshape(145, 145)
    return Bsdf.from_models({(side, "transmission"): Model.matrix(values, FULL)})


@pytest.fixture
def radiance(require_pyradiance, tmp_path):
    def run(program, *arguments):
        command = [Path(require_pyradiance.anci.BINPATH) / program, *arguments]
        done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=tmp_path, env=os.environ)
        return done.stdout

    return run


def test_radiance_reads_vector_a(radiance, tmp_path):
    vector_a().write(tmp_path / "a.xml", target="radiance")
    report = radiance("checkBSDF", "a.xml")
    for words in ("Type: Klems_Full", "Interior Refl\t10.0", "Exterior Refl\t20.0"):
        assert words in report
    through = next(line for line in report.splitlines() if line.startswith("Ext->Int Trans"))
    assert "20.0" in through
    assert "60.0%" in through
    assert "8.56 deg" in through


@pytest.mark.parametrize(("side", "expected"), [("exterior", 16.98867), ("interior", 21.70156)])
def test_radiance_multiplies_vector_b(radiance, tmp_path, side, expected):
    vector_b(side).write(tmp_path / "b.xml", target="radiance")
    head = "#?RADIANCE\nNROWS={}\nNCOLS={}\nNCOMP=3\nFORMAT=ascii\n\n"

    def matrix(name, rows):
        rows = np.atleast_2d(rows)
        body = "\n".join(" ".join(f"{x!r} {x!r} {x!r}" for x in row) for row in rows.tolist())
        (tmp_path / name).write_text(head.format(*rows.shape) + body + "\n")

    matrix("v.mtx", AREAS)
    matrix("d.mtx", np.eye(145))
    matrix("s.mtx", np.arange(1.0, 146.0)[:, None])
    result = float(radiance("dctimestep", "-h", "v.mtx", "b.xml", "d.mtx", "s.mtx").split()[0])
    assert result == pytest.approx(expected, rel=2e-6)
    # The same product from what we read; a missing side is answered by reciprocity.
    model, by_reciprocity = clerestory.read(tmp_path / "b.xml").model("exterior", "transmission")
    assert by_reciprocity == (side == "interior")
    transfer = model.values * AREAS[None, :]
    assert AREAS @ transfer @ np.arange(1.0, 146.0) == pytest.approx(expected, rel=1e-6)


def test_vector_a_has_the_published_values(tmp_path):
    vector_a().write(tmp_path / "a.xml")
    bsdf = clerestory.read(tmp_path / "a.xml")
    sources = np.array([toward(*a) for a in [(180, 0), (150, 90), (130, 90), (110, 90), (120, 37), (95, 200)]])
    assert bsdf.integrate(sources, "transmission") == pytest.approx(0.6, abs=1e-12)
    published = [16.826, 16.996, 17.937, 18.317, 20.379, 22.872]
    assert bsdf.evaluate(sources, -sources) == pytest.approx(published, rel=4e-4)


def test_vector_b_has_the_published_values(tmp_path):
    vector_b().write(tmp_path / "b.xml")
    bsdf = clerestory.read(tmp_path / "b.xml")
    rows = [
        ((180, 0), (0, 0), 0.0040000),
        ((150, 90), (30, 270), 0.0156800),
        ((150, 90), (30, 90), 0.0127800),
        ((150, 0), (10, 45), 0.0046500),
        ((130, 90), (50, 270), 0.0294040),
        ((110, 90), (70, 270), 0.0416680),
        ((97, 10), (88, 350), 0.0428480),
        ((120, 45), (60, 225), 0.0355360),
        ((120, 45), (20, 100), 0.0079860),
    ]
    for source, leaving, expected in rows:
        value = bsdf.evaluate(toward(*source), toward(*leaving))
        assert value == pytest.approx(expected, abs=1e-12)
    probes = np.array([toward(180, 0), toward(150, 90), toward(110, 90)])
    published = [0.0759899, 0.0762413, 0.0768005]
    assert bsdf.integrate(probes, "transmission") == pytest.approx(published, abs=6e-8)


QUARTER_FILE = """<WindowElement><Optical><Layer><DataDefinition>
<IncidentDataStructure>{structure}</IncidentDataStructure></DataDefinition><WavelengthData>
<Wavelength>Visible</Wavelength><WavelengthDataBlock>
<WavelengthDataDirection>{direction}</WavelengthDataDirection>{basis}
<ScatteringData>{data}</ScatteringData></WavelengthDataBlock></WavelengthData></Layer></Optical></WindowElement>
"""
KLEMS = "<ColumnAngleBasis>LBNL/Klems Quarter</ColumnAngleBasis><RowAngleBasis>LBNL/Klems Quarter</RowAngleBasis>"
TREE = "<AngleBasis>LBNL/Shirley-Chiu</AngleBasis>"


@pytest.mark.parametrize(
    ("direction", "source", "leaving", "columns", "rows"),
    [
        ("Transmission Front", (150, 90), (30, 0), 387, 747),
        ("Transmission Back", (30, 90), (150, 0), 387, 747),
        ("Reflection Front", (150, 90), (150, 0), 387, 747),
        ("Reflection Back", (30, 90), (30, 0), 387, 747),
    ],
)
def test_order_and_sides_of_a_block(tmp_path, direction, source, leaving, columns, rows):
    data = " ".join(repr(0.004 + 1e-4 * k) for k in range(41 * 41))
    for structure, number in (("Columns", columns), ("Rows", rows)):
        path = tmp_path / f"{structure}.xml"
        path.write_text(QUARTER_FILE.format(structure=structure, direction=direction, basis=KLEMS, data=data))
        value = clerestory.read(path).evaluate(toward(*source), toward(*leaving))
        assert value == pytest.approx(0.004 + 1e-4 * number, abs=1e-12)


def tree_file(tmp_path, structure, data):
    path = tmp_path / "tree.xml"
    text = QUARTER_FILE.format(structure=structure, direction="Transmission Front", basis=TREE, data=data)
    path.write_text(text)
    return clerestory.read(path)


def test_anisotropic_tree_has_the_published_values(tmp_path):
    values = [0.01 * (n + 1) for n in range(16)]
    branch = tree_file(tmp_path, "TensorTree4", "{" + " ".join(f"{{{v}}}" for v in values) + "}")
    grid = tree_file(tmp_path, "TensorTree4", "{" + " ".join(map(str, values)) + "}")
    rows = [
        ((140, 20), (40, 200), 0.01, 0.01),
        ((140, 110), (40, 200), 0.02, 0.09),
        ((140, 200), (40, 20), 0.16, 0.16),
        ((140, 290), (50, 100), 0.11, 0.06),
        ((170, 10), (80, 300), 0.05, 0.03),
    ]
    for source, leaving, of_branch, of_grid in rows:
        assert branch.evaluate(toward(*source), toward(*leaving)) == pytest.approx(of_branch, rel=1e-6)
        assert grid.evaluate(toward(*source), toward(*leaving)) == pytest.approx(of_grid, rel=1e-6)
    assert branch.integrate(toward(140, 20), "transmission") == pytest.approx(0.07 * np.pi, rel=1e-6)


def test_isotropic_tree_has_the_published_values(tmp_path):
    data = "{" + ", ".join(repr(0.002 * (k + 1)) for k in range(64)) + "}"
    bsdf = tree_file(tmp_path, "TensorTree3", data)
    rows = [
        ((173, 10), (20, 50), 0.044),
        ((152, 0), (33, 170), 0.060),
        ((152, 90), (33, 300), 0.062),
        ((110, 45), (60, 100), 0.002),
        ((100, 205), (12, 21), 0.020),
        ((133, 180), (47, 12), 0.030),
    ]
    for source, leaving, expected in rows:
        assert bsdf.evaluate(toward(*source), toward(*leaving)) == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("structure", ["TensorTree3", "TensorTree4"])
def test_radiance_reads_our_trees(radiance, tmp_path, structure):
    size = 64 if structure == "TensorTree3" else 256
    data = "{" + " ".join(str(0.1 + 0.001 * (k % 7)) for k in range(size)) + "}"
    bsdf = tree_file(tmp_path, structure, data)
    bsdf.write(tmp_path / "out.xml", target="radiance")
    assert "Tensor_Tree" in radiance("checkBSDF", "out.xml")


@pytest.mark.parametrize("target", ["plain", "window", "energyplus"])
def test_lbnls_parser_reads_window_files(tmp_path, target):
    pywincalc = pytest.importorskip("pywincalc", reason="pywincalc absent")
    rng = np.random.default_rng(7)
    faces = [(side, scatter) for side in ("exterior", "interior") for scatter in ("transmission", "reflection")]
    bands = {
        band: {face: Model.matrix(rng.random((145, 145)) / 4, FULL) for face in faces} for band in ("visible", "solar")
    }
    bsdf = Bsdf.from_models(bands).with_metadata(
        name="A",
        manufacturer="B",
        emissivity_exterior=0.8,
        emissivity_interior=0.7,
        tir=0.1,
        thickness_m=0.0005,
        thermal_conductivity=0.2,
    )
    path = tmp_path / "a.xml"
    bsdf.write(path, target=target)
    layer = pywincalc.parse_bsdf_xml_file(str(path))
    assert (layer.emissivity_front, layer.emissivity_back, layer.ir_transmittance) == (0.8, 0.7, 0.1)
    if target != "plain":
        assert layer.thickness == 0.5
    names = {"transmission": "transmittance", "reflection": "reflectance"}
    # Its objects do not keep each other alive: each step is held by a name.
    measurements = layer.measurements
    for band, members in bands.items():
        of_band = getattr(measurements, band)
        for (side, scatter), model in members.items():
            block = getattr(of_band, f"{names[scatter]}_{'front' if side == 'exterior' else 'back'}")
            assert np.array_equal(np.array(block.data), model.values)
