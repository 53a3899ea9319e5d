"""A fisheye of a room beside Radiance's, region by region."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import pytest

from clerestory import room
from clerestory.picture import View
from samples import ABSENT, sample_root, unpacked

room_radiance = pytest.importorskip("room_radiance", reason="pyradiance is not installed")

if TYPE_CHECKING:
    from pathlib import Path

#: Regions of equal solid angle of the hemisphere before the eye.
RINGS, SECTORS = 4, 12
#: Rays of rtrace in a region are one in each cell of a grid, its ambient divisions, and independent runs.
GRID, DIVISIONS, RUNS = (16, 12), 64, 4
#: Pixels along either side of ours, and paths a pixel.
SIZE, SAMPLES = 256, 16


@dataclass(frozen=True)
class Case:
    """A window system, as both programs have it."""

    name: str
    file: str | None


CASES = [Case("glass", None), Case("film", "klems/cl_Tn0.5.xml"), Case("blind-klems", "klems/blinds30.xml")]


def loaded(case: Case, folder: Path) -> room.Room:
    """The room under an overcast sky; its scene for the other program lies in the folder."""
    if case.file is None:
        system: dict[str, object] = {"glass": 0.8}
        material = room_radiance.glass(0.8)
    else:
        root = sample_root()
        if root is None:
            pytest.skip(ABSENT)
        (folder / "window.xml").write_bytes(unpacked(root / case.file, folder).read_bytes())
        system = {"file": str(folder / "window.xml"), "treatment": "high"}
        material = "void BSDF window 6 0 window.xml 0 0 1 . 0 0"
    made = room.load(room_radiance.tables(system, sun=False, sky=True))
    room_radiance.octree(made, material, folder, sun=False, sky=True)
    return made


def ours(made: room.Room) -> tuple[np.ndarray, np.ndarray]:
    """Mean luminance of the regions and its standard error, of a picture."""
    view = made.view("eye").model_copy(update={"size_px": [SIZE, SIZE]})
    picture = made.picture(view, samples=SAMPLES)
    weight = View(picture.view).solid_angles(SIZE, SIZE)
    at = (np.arange(SIZE) + 0.5) / SIZE - 0.5
    x, y = np.meshgrid(at, -at)
    theta, phi = np.pi * np.hypot(x, y), np.arctan2(y, x) % (2 * np.pi)
    inside = theta < np.pi / 2
    ring = np.minimum((RINGS * (1.0 - np.cos(theta))).astype(int), RINGS - 1)
    region = (SECTORS * ring + np.minimum((SECTORS * phi / (2 * np.pi)).astype(int), SECTORS - 1))[inside]

    def over(values: np.ndarray) -> np.ndarray:
        return np.bincount(region, values[inside], RINGS * SECTORS)

    area = over(weight)
    return over(picture.luminance * weight) / area, np.sqrt(over((picture.noise * weight) ** 2)) / area


def theirs(made: room.Room, folder: Path) -> tuple[np.ndarray, np.ndarray]:
    """The same by rays of rtrace, each run with others."""
    view = made.view("eye")
    right, up, forward = np.array([-1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0]), np.array(view.direction)
    across, along = GRID
    means = []
    for seed in range(RUNS):
        jitter = np.random.default_rng(seed).random((2, RINGS, SECTORS, across, along))
        r, s, a, b = np.indices((RINGS, SECTORS, across, along))
        cos = 1.0 - (r + (a + jitter[0]) / across) / RINGS
        phi = 2.0 * np.pi * (s + (b + jitter[1]) / along) / SECTORS
        sin = np.sqrt(1.0 - cos**2)
        rays = (sin * np.cos(phi))[..., None] * right + (sin * np.sin(phi))[..., None] * up + cos[..., None] * forward
        found = room_radiance.luminance(
            folder, np.array(view.point_m), rays.reshape(-1, 3), divisions=DIVISIONS, bounces=12
        )
        means.append(found.reshape(RINGS * SECTORS, -1).mean(axis=1))
    return np.mean(means, axis=0), np.std(means, axis=0, ddof=1) / np.sqrt(RUNS)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_regions(case, tmp_path):
    """Within 5 % and three combined standard errors in each of 48 regions, which are known to 3 % on average."""
    made = loaded(case, tmp_path)
    (luminance, error), (expected, other) = ours(made), theirs(made, tmp_path)
    # Errors of four runs are rough: the mean relative one of all regions is taken where it is larger.
    other = np.maximum(other, np.mean(other / expected) * expected)
    combined = np.hypot(error, other)
    assert np.mean(combined / expected) < 0.03
    told = np.c_[luminance, expected, combined].round(1)
    assert (np.abs(luminance - expected) <= 0.05 * expected + 3.0 * combined).all(), told
    # Regions err this way and that: together they are nearer.
    assert luminance.mean() == pytest.approx(expected.mean(), rel=0.02)
