"""Through-beams against Radiance's aBSDF material, direction by direction.

A small distant source stands behind a sheet; the irradiance of its direct light over the source's own is the
transmittance of the beam. Rays are traced backwards, so Radiance takes the data of the viewer's side: its beam for a
viewer in one direction is compared with ours for light from there.

Backwards, the cell of an isotropic tree at radius r covers directions of which it is not the middle, up to half a cell
off. Radiance counts the cell as it is in the tree; ours is what leaves through it, so that no light is lost or made. Up
to half a cell over r they differ there, as often one way as the other.
"""

import gzip
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

import clerestory
from clerestory.directions import SIDES, direction
from samples import sample_files

KLEMS = {
    "2011-SA1.XML.gz",
    "E_Screen_3pct_White-White.xml.gz",
    "SingleClear.xml",
    "blinds30.xml",
    "cgdb_46016_SEATEX_Midnight.xml.gz",
    "clear_unit.xml",
    "mcs6216_t3_g6_t80_-a_phi00_kl.xml",
    "tutorial_blinds_with_log_line.xml",
}
TREES = {
    "b00.xml",
    "b30.xml",
    "blinds_20deg_t45.xml.gz",
    "c30.xml",
    "clear_t4_4.xml",
    "pyradiance_t3.xml",
}
FILES = [p for p in sample_files("klems", "tensortree") if p.id in KLEMS | TREES | {"absent"}]
DIRECTIONS = 220
# Radiance changes every value of a table by up to 0.03 % on purpose.
RELATIVE, ABSOLUTE = 1e-3, 2e-4
SOURCE_DEG = 0.01
LUMINANCE = np.array([0.265, 0.670, 0.065])


def radiance_beams(radiance, path: Path, viewers: np.ndarray, folder: Path) -> np.ndarray:
    """Transmittance of the beam (n,) for viewers (n, 3) on one side of a sheet."""
    text = path.read_bytes()
    text = gzip.decompress(text) if path.suffix == ".gz" else text
    # One of the files begins with a line of a log, which Radiance does not read.
    (folder / "sheet.xml").write_bytes(text[text.index(b"<") :])
    lines = [
        "void aBSDF sheet\n5 sheet.xml 0 1 0 .\n0\n0",
        "sheet polygon pane\n0\n0\n12 -5 -5 0  5 -5 0  5 5 0  -5 5 0",
    ]
    names = [f"source{k}" for k in range(len(viewers))]
    for name, (x, y, z) in zip(names, -viewers, strict=True):
        lines.append(f"void light {name}\n0\n0\n3 1 1 1")
        lines.append(f"{name} source {name}_disk\n0\n0\n4 {x:.17g} {y:.17g} {z:.17g} {SOURCE_DEG}")
    (folder / "scene.rad").write_text("\n".join(lines) + "\n")
    (folder / "names").write_text("\n".join(names) + "\n")
    programs = Path(radiance.__file__).parent / "bin"
    environment = {**os.environ, "RAYPATH": f".:{Path(radiance.__file__).parent / 'lib'}"}

    def run(command: list[str], **options) -> bytes:
        done = subprocess.run(
            [str(programs / command[0]), *command[1:]], cwd=folder, env=environment, capture_output=True, **options
        )
        assert done.returncode == 0, done.stderr.decode()
        return done.stdout

    (folder / "scene.oct").write_bytes(run(["oconv", "scene.rad"]))
    side = np.sign(viewers[0, 2])
    sensor = f"0 0 {0.01 * side} 0 0 {-side}\n".encode()
    settings = ["-h", "-I+", "-ab", "0", "-dj", "0", "-dt", "0", "-c", "1", "-faa", "-M", "names"]
    table = np.array(run(["rcontrib", *settings, "scene.oct"], input=sensor).split(), dtype=float)
    solid_angle = 2 * np.pi * (1 - np.cos(np.radians(SOURCE_DEG / 2)))
    return table.reshape(len(viewers), 3) @ LUMINANCE / (solid_angle * np.abs(viewers[:, 2]))


def beams(separated: clerestory.Bsdf, incident: np.ndarray) -> np.ndarray:
    return separated.integrate(incident, "transmission", part="direct")


def agree(ours: np.ndarray, theirs: np.ndarray, slack: np.ndarray | float = 0.0) -> np.ndarray:
    return np.abs(ours - theirs) <= (RELATIVE + slack) * np.abs(theirs) + ABSOLUTE


def half_cell(path: Path, incident: np.ndarray, side: str) -> np.ndarray | float:
    """Half a cell over the radius where an isotropic tree is asked backwards, else 0."""
    data = clerestory.read(path)
    model, by_reciprocity = data.model(side, "transmission")
    if model.kind != "reversed":
        return 0.0
    assert by_reciprocity
    (tree,) = (m for (_, scatter), m in data.models["visible"].items() if scatter == "transmission")
    cells = 2**tree.tree_depth
    return np.minimum(1.2 / cells / np.maximum(np.hypot(*incident.T[:2]), 1e-9), 0.2)


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("path", FILES)
def test_beams_are_those_of_radiance(require_pyradiance, tmp_path, path, side):
    rng = np.random.default_rng(20)
    r, phi = np.sqrt(rng.random(DIRECTIONS)) * 0.999, rng.random(DIRECTIONS) * 360
    incident = direction(np.degrees(np.arcsin(r)), phi, side=side)
    separated = clerestory.read(path).separate_peaks()
    ours, theirs = beams(separated, incident), radiance_beams(require_pyradiance, path, incident, tmp_path)
    slack = half_cell(path, incident, side)
    wrong = np.flatnonzero(~agree(ours, theirs, slack))
    assert wrong.size == 0, [(incident[k].round(4).tolist(), ours[k], theirs[k]) for k in wrong]
    if np.any(slack):
        assert np.mean(ours) == pytest.approx(np.mean(theirs), rel=5e-3)
    # The test sees beams, and for fabrics and blinds different ones.
    assert np.count_nonzero(theirs) > DIRECTIONS // 2


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("path", FILES)
def test_directions_on_borders_of_cells_are_answered_as_on_one_side_of_them(require_pyradiance, tmp_path, path, side):
    """There the last bit of a coordinate decides which cells are probed, so Radiance is compared with all sides."""
    theta, phi = [0, 10, 20, 30, 30, 50, 65, 70, 80], [0, 0, 90, 270, 90, 270, 30, 270, 15]
    incident = direction(theta, phi, side=side)
    theirs = radiance_beams(require_pyradiance, path, incident, tmp_path)
    separated, slack = clerestory.read(path).separate_peaks(), half_cell(path, incident, side)
    near = np.zeros(len(incident), dtype=bool)
    for dx in (-1e-7, 0.0, 1e-7):
        for dy in (-1e-7, 0.0, 1e-7):
            near |= agree(beams(separated, incident + np.array([dx, dy, 0.0])), theirs, slack)
    if np.any(slack):
        # Exactly along the normal all azimuths are one cell backwards, of which Radiance counts a quarter.
        near[0] = agree(beams(separated, incident[:1]) / 4, theirs[:1])[0]
    assert near.all(), [(t, p) for t, p, ok in zip(theta, phi, near, strict=True) if not ok]
