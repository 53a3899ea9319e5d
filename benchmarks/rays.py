"""Rays a second on one thread beside Embree's, on the same slats and the same rays."""

from __future__ import annotations

import json
import os
import statistics
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene

from timing import REPETITIONS, seconds, table

ROOT = Path(__file__).resolve().parent.parent
WIDTH, PITCH = 0.08, 0.072
TURNS = {"flat slats": 0.0, "curved slats": 1.0}
FACETS = 64
SLATS = 61  # as many as rays that do not leave can reach, but for one in a thousand
LENGTH = 40.0


def _trace(rays: Path) -> list[dict[str, float | str]]:
    done = subprocess.run(
        ["cargo", "bench", "--quiet", "--locked", "-p", "clerestory", "--bench", "rays"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "CLERESTORY_RAYS": str(rays)},
    )
    return [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]


def _slats(turn: float) -> tuple[np.ndarray, np.ndarray]:
    """Corners (n, 3) and triangles (m, 3) of slats whose middle rises where they are curved."""
    facets = FACETS if turn else 1
    at = np.linspace(-0.5, 0.5, facets + 1)
    if turn:
        radius = WIDTH / (2 * np.sin(turn / 2))
        z, y = radius * np.sin(turn * at), radius * (np.cos(turn * at) - np.cos(turn / 2))
    else:
        z, y = WIDTH * at, np.zeros_like(at)
    corners, triangles = [], []
    for slat in range(SLATS):
        for x in (-LENGTH, LENGTH):
            corners.append(np.column_stack([np.full_like(z, x), y + (slat - SLATS // 2) * PITCH, z]))
        first = slat * 2 * (facets + 1)
        a = first + np.arange(facets)
        b = a + facets + 1
        triangles += [np.column_stack([a, a + 1, b]), np.column_stack([a + 1, b + 1, b])]
    return np.concatenate(corners), np.concatenate(triangles)


def _embree(turn: float, rays: np.ndarray) -> tuple[float, np.ndarray]:
    """Rays a second, and the distance to each ray's hit [m]."""
    scene = EmbreeScene()
    corners, triangles = _slats(turn)
    TriangleMesh(scene, corners.astype(np.float32), triangles.astype(np.int32))
    # Off the surface that they start on, by more than the facets' distance from the arc.
    origins = (rays[:, :3] + 2e-5 * rays[:, 3:]).astype(np.float32)
    directions = rays[:, 3:].astype(np.float32)
    distances = scene.run(origins, directions, query="DISTANCE")
    times = [seconds(lambda: scene.run(origins, directions, query="DISTANCE")) for _ in range(REPETITIONS)]
    return len(rays) / min(times), distances


def report(_data: Path) -> str:
    """Text of the section."""
    with tempfile.TemporaryDirectory() as folder:
        cases = _trace(Path(folder))
        theirs = {}
        for name, turn in TURNS.items():
            rays = np.fromfile(Path(folder) / f"{name.replace(' ', '-')}.rays").reshape(-1, 6)
            theirs[name], _ = _embree(turn, rays)
    rows = []
    for case in cases:
        if "rays_per_s" not in case:
            continue
        name, ours = str(case["case"]), float(case["rays_per_s"])
        peer = theirs.get(name.removeprefix("mesh of "))
        rows.append(
            [name, f"{ours / 1e6:.1f}", f"{peer / 1e6:.1f}" if peer else "", f"{ours / peer:.2f}" if peer else ""]
        )
    paths = [[str(c["case"]), f"{float(c['paths_per_s']) / 1e6:.2f}"] for c in cases if "paths_per_s" in c]
    ratio, meshes = (
        statistics.fmean(float(r[3]) for r in rows if r[3] and r[0].startswith("mesh") is mesh)
        for mesh in (False, True)
    )
    head = ["section", "Clerestory [10⁶ rays/s]", "Embree [10⁶ rays/s]", "ratio"]
    return f"""### Rays

One thread, rays of diffuse paths (into the sample, then on from where they met it), the best of {REPETITIONS} runs
each. Clerestory meets the exact section; Embree, through embreex, a mesh of it: {SLATS} slats of {FACETS} facets where
they are curved, one where they are flat. The mean ratio is {ratio:.1f}; on the same meshes it is {meshes:.2f}. A
repeated mesh is one slat, repeated without end.

{table(head, rows)}

Whole measurements, one thread, Lambertian slats of reflectance 0.5, Klems full both ways:

{table(["section", "10⁶ paths/s"], paths)}
"""
