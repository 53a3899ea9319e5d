"""The room of Radiance's tutorial on matrix methods (Subramaniam 2017), and its published illuminances.

They were made with 4 bounces, and lack what later ones bring: to be compared, they are raised by what rfluxmtx finds
with 12.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

import phases_radiance as phases
from clerestory import read, room
from clerestory.annual.cache import Cache
from clerestory.annual.exchange import read as read_matrix
from clerestory.annual.matrices import RoomMatrices
from clerestory.annual.phases import Transfer
from clerestory.sky import SkyPatches

if TYPE_CHECKING:
    from pathlib import Path

PARTS = ("Ground", "ExteriorWalls", "Floor", "InteriorWall", "Ceiling")
GLAZING = [[0.0, 0.0508, 0.904875], [0.0, 0.0508, 2.4384], [6.096, 0.0508, 2.4384], [6.096, 0.0508, 0.904875]]
#: The tutorial's photometric weights of red, green and blue [lm/W].
WEIGHTS = np.array([47.4, 119.9, 11.6])
#: Data sets and their published illuminances.
CASES = {"tutorial_clear.xml.gz": "3phase__3ph.ill", "tutorial_ven0.xml": "3phase__3phVen0.ill"}
BOUNCES, ENOUGH = 4, 12


@dataclass(frozen=True)
class Compared:
    """Illuminances at some of the points (n) [lx]."""

    ours: np.ndarray
    published: np.ndarray
    again: np.ndarray
    """By Radiance's programs, with as many bounces as then."""
    enough: np.ndarray
    """By them, with bounces enough."""


def compare(data: Path, folder: Path, every: int) -> dict[str, Compared]:
    """Every so many-th of the 100 points under the tutorial's sky, by data set."""
    home = data / "scenes" / "tutorial_room"
    scene = folder / "tutorial.rad"
    scene.write_text("\n".join((home / name).read_text() for name in _files()))
    rows = np.loadtxt(home / "points.txt")[::every]
    points, normals = rows[:, :3], rows[:, 3:]
    sky = read_matrix(home / "skies__NYC_Per_DH.sky")[:, 0] @ WEIGHTS

    made = room.load(
        {
            "sky": {"kind": "overcast"},
            "geometry": [{"file": str(scene), "unit": "m"}],
            "windows": {"glazing": {"corners_m": GLAZING, "system": "clear"}},
            "systems": {"clear": {"file": str(data / "klems" / "tutorial_clear.xml.gz"), "treatment": "klems"}},
        }
    )
    matrices = RoomMatrices(made, cache=Cache(folder / "cache"))
    arrives = matrices.daylight(0, SkyPatches.named("tregenza"), samples=2048).all @ sky
    view = matrices.view(points, normals, samples=8192).all

    numbers = " ".join(f"{v:g}" for corner in GLAZING for v in corner)
    phases.prepare(folder, [scene.read_text()], [f"window polygon glazing 0 0 12 {numbers}"])
    theirs = [
        (
            phases.view(folder, points, normals, divisions=5000, bounces=bounces)[0],
            phases.daylight(folder, samples=1000, bounces=bounces, divisions=16) @ sky,
        )
        for bounces in (BOUNCES, ENOUGH)
    ]
    found = {}
    for name, values in CASES.items():
        transmission = Transfer.of(read(data / "klems" / name), matrices.basis).transmission
        again, enough = (v @ transmission @ d for v, d in theirs)
        published = read_matrix(home / "expected" / values).ravel()[::every]
        found[name] = Compared(view @ transmission @ arrives, published, again, enough)
    return found


def _files() -> list[str]:
    return ["materials.rad", *(f"objects/{part}.rad" for part in PARTS)]
