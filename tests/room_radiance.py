"""The same room for Radiance's programs."""

from __future__ import annotations

import math
import os
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pyradiance

from clerestory.room import Room
from clerestory.room.builder import build
from clerestory.room.recipe import Box

PACKAGE = Path(pyradiance.__file__).parent
EFFICACY = 179.0
WEIGHTS = np.array([0.265074126, 0.670114631, 0.064811243])
SIZE = {"width_m": 3.6, "depth_m": 5.0, "height_m": 2.8}
REFLECTANCES = {"floor": 0.2, "walls": 0.6, "ceiling": 0.8}
SUN = (35.0, 200.0)
"""Altitude and compass azimuth [°]."""

SUN_ALONE = 50_000.0
"""Illuminance that faces the sun where there is nothing else [lx]."""

GLOWS = """
skyfunc glow sky_glow 0 0 4 1 1 1 0
sky_glow source sky 0 0 4 0 0 1 180
skyfunc glow ground_glow 0 0 4 1 1 1 0
ground_glow source ground 0 0 4 0 0 -1 180
"""


def environment() -> dict[str, str]:
    """Where the programs find each other."""
    return {
        **os.environ,
        "RAYPATH": f".{os.pathsep}{PACKAGE / 'lib'}",
        "PATH": f"{PACKAGE / 'bin'}{os.pathsep}{os.environ['PATH']}",
    }


def run(*command: str, folder: Path, data: str | bytes = b"") -> bytes:
    """Standard output of a program, which has a group of its own: rcontrib that fails kills the one that it is in."""
    done = subprocess.run(
        command,
        cwd=folder,
        env=environment(),
        input=data.encode() if isinstance(data, str) else data,
        capture_output=True,
        check=False,
        timeout=600,
        start_new_session=True,
    )
    if done.returncode:
        raise RuntimeError(f"{command[0]}: status {done.returncode}: {done.stderr.decode()[-500:]}")
    return done.stdout


def tables(system: dict[str, Any], *, sun: bool, sky: bool) -> dict[str, Any]:
    """A recipe of the room under gensky's clear sky with its sun, the overcast one, or one all but black with a sun."""
    light = {} if sky else {"direct_illuminance": SUN_ALONE, "diffuse_illuminance": 1e-3, "ground_reflectance": 0.0}
    return {
        "sky": {"kind": "clear" if sun else "overcast", "sun_deg": list(SUN), "preset": "radiance", **light},
        "room": {
            **SIZE,
            **REFLECTANCES,
            "openings": [{"width_m": 3.2, "height_m": 1.7, "sill_m": 0.9, "system": "window"}],
        },
        "systems": {"window": system},
        "views": {"eye": {"point_m": [1.8, 3.0, 1.2], "direction": [0.0, -1.0, 0.0], "size_px": [256, 256]}},
    }


def glass(transmittance: float) -> str:
    """The window's material for a clear pane: Radiance's transmissivity of a transmittance, for its index of 1.52."""
    root = math.sqrt(0.8402528435 + 0.0072522239 * transmittance**2)
    transmissivity = (root - 0.9166530661) / 0.0036261119 / transmittance
    return f"void glass window 0 0 3 {transmissivity} {transmissivity} {transmissivity}"


def octree(room: Room, material: str, folder: Path, *, sun: bool, sky: bool) -> None:
    """The scene with the window's material, which is called `window`, as `scene.oct` in a folder."""
    altitude, azimuth = SUN
    found = run("gensky", "-ang", str(altitude), str(azimuth - 180.0), "+s" if sun else "-c", folder=folder).decode()
    (folder / "sky.rad").write_text(found + GLOWS if sky else _sun_alone())
    text = [material, *surfaces(room), *panes(room)]
    (folder / "room.rad").write_text("\n".join(text) + "\n")
    (folder / "scene.oct").write_bytes(run("oconv", "sky.rad", "room.rad", folder=folder))


def surfaces(room: Room) -> list[str]:
    """Lines of a scene: a room's surfaces with their materials."""
    text = [f"void plastic {name} 0 0 5 {v} {v} {v} 0 0" for name, v in REFLECTANCES.items()]
    box = room.recipe.room
    assert isinstance(box, Box)
    for quad in build(box)[0]:
        name = quad.name if quad.name in REFLECTANCES else "walls"
        text += [_polygon(name, f"{quad.name.replace(' ', '_')}.{k}", c) for k, c in enumerate(quad.corners)]
    return text


def panes(room: Room) -> list[str]:
    """Lines of a scene: a room's windows, of a material that is called `window`."""
    return [_polygon("window", window.name, window.corners) for window in room.windows]


def _polygon(material: str, name: str, corners: np.ndarray) -> str:
    numbers = " ".join(f"{v:.9g}" for v in np.ravel(corners))
    return f"{material} polygon {name} 0 0 {np.size(corners)} {numbers}"


def _sun_alone() -> str:
    altitude, azimuth = (math.radians(angle) for angle in SUN)
    x, y, z = math.cos(altitude) * math.sin(azimuth), math.cos(altitude) * math.cos(azimuth), math.sin(altitude)
    radiance = SUN_ALONE / EFFICACY / (2.0 * math.pi * (1.0 - math.cos(math.radians(0.2665))))
    return f"void light solar 0 0 3 {radiance} {radiance} {radiance}\nsolar source sun 0 0 4 {x} {y} {z} 0.533\n"


def illuminance(
    folder: Path, points: np.ndarray, normals: np.ndarray, *more: str, divisions: int, bounces: int
) -> np.ndarray:
    """Illuminance (n,) [lx] by rtrace without its ambient cache; `more` are options of its own."""
    return _traced(folder, points, normals, "-I", *more, divisions=divisions, bounces=bounces)


def luminance(
    folder: Path, eye: np.ndarray, directions: np.ndarray, *more: str, divisions: int, bounces: int
) -> np.ndarray:
    """Luminance (n,) [cd/m²] by rtrace without its ambient cache, from an eye (3,) along directions (n, 3)."""
    origins = np.broadcast_to(eye, directions.shape)
    return _traced(folder, origins, directions, *more, divisions=divisions, bounces=bounces)


def _traced(
    folder: Path, origins: np.ndarray, directions: np.ndarray, *more: str, divisions: int, bounces: int
) -> np.ndarray:
    """Photometric values of rays by rtrace: every ambient value is computed anew, and paths end by chance."""
    rows = "\n".join(" ".join(f"{v:.9g}" for v in (*p, *d)) for p, d in zip(origins, directions, strict=True))
    options = f"-h -n 2 -ab {bounces} -ad {divisions} -as 0 -aa 0 -lw {0.1 / divisions:.3g} -lr -{bounces + 4}"
    quality = "-ds .05 -dj .8 -dt 0 -dc 1 -st 0 -ss 4 -u+"
    found = run("rtrace", *options.split(), *quality.split(), *more, "scene.oct", folder=folder, data=rows)
    values = np.array([[float(v) for v in line.split()] for line in found.decode().splitlines() if line.strip()])
    return np.asarray(EFFICACY * values @ WEIGHTS)
