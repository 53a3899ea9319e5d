"""The virtual goniophotometer beside genBSDF's job: agreement, speed, time to equal error, memory."""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

import genbsdf
from chi2 import chi2_tail
from clerestory import Basis, trace
from clerestory.directions import SCATTERS, SIDES
from conformance.test_genbsdf import chi_squared, flux, standard_errors
from timing import table

if TYPE_CHECKING:
    from typing import Any

    from clerestory import Bsdf

BASIS = Basis.named("klems-full")
AREA = BASIS.projected_solid_angles
SEEDS = 5
PROCESSORS = os.cpu_count() or 1
#: Paths an incident patch for the comparison: the other program's are dear.
THEIRS, OURS = 4_000, 65_536
PLASTIC = "void plastic slat\n0\n0\n5 .5 .5 .5 0 0\n"


def profile(crown_mm: float = 0.0) -> dict[str, Any]:
    """The blind of the comparison as an extruded section."""
    return {
        "sample": {
            "kind": "venetian-blind",
            "pitch_mm": 72.0,
            "slat": {"width_mm": 80.0, "crown_mm": crown_mm, "upper": "slat"},
        },
        "materials": {"slat": {"kind": "lambertian", "reflectance": 0.5}},
    }


def _agreement(folder: Path) -> str:
    rows = []
    for scene in genbsdf.scenes():
        theirs = genbsdf.generate(scene, folder, samples=THEIRS, processes=PROCESSORS)
        ours = trace.measure(genbsdf.recipe(scene, folder), samples=OURS, seed=5)
        cells, worst, chance = [], 0.0, 1.0
        for side in SIDES:
            for scatter in SCATTERS:
                mine, peer = flux(ours, side, scatter), flux(theirs, side, scatter)
                values, errors = ours.integrate_with_error(BASIS.incident_centres(side), scatter)
                totals = peer.sum(axis=0)
                share = np.clip(np.maximum(totals, values), 0.0, 1.0)
                error = np.hypot(errors, np.sqrt(share * (1.0 - share) / THEIRS))
                excess = np.abs(values - totals) - 3.0 * error
                worst = max(worst, float((excess / np.maximum(totals, 0.01)).max()))
                cells.append(f"{AREA @ values / np.pi:.4f} / {AREA @ totals / np.pi:.4f}")
                statistic, freedom = chi_squared(mine, peer, standard_errors(ours, side, scatter))
                chance = min(chance, chi2_tail(statistic, freedom))
        rows.append([scene.name, *cells, f"{100.0 * max(worst, 0.0):.1f} %", f"{chance:.2g}"])
    head = ["scene", "T exterior", "R exterior", "T interior", "R interior", "beyond 3 errors", "least chance"]
    return table(head, rows)


@dataclass
class _Job:
    """One way of ours, and the peer's job that it is compared with."""

    name: str
    recipe: dict[str, Any]
    scene: genbsdf.Scene
    levels: int
    ours: int
    """Paths an incident patch or cell."""
    theirs: int


def _speed(folder: Path) -> str:
    flat = genbsdf.blind("flat", PLASTIC)
    curved = genbsdf.blind("curved", PLASTIC, crown=0.010)
    jobs = [
        _Job("flat blind, section, Klems", profile(), flat, 0, 32_768, 1_000),
        _Job("curved blind, section, Klems", profile(10.0), curved, 0, 32_768, 1_000),
        _Job("curved blind, mesh, Klems", genbsdf.recipe(curved, folder), curved, 0, 16_384, 1_000),
        _Job("curved blind, section, tree of 1,024²", profile(10.0), curved, 5, 4_096, 100),
        _Job("curved blind, mesh, tree of 1,024²", genbsdf.recipe(curved, folder), curved, 5, 2_048, 100),
    ]
    rows = []
    for job in jobs:
        ours, theirs, inside = [], [], []
        patches = 4**job.levels if job.levels else len(BASIS)
        for seed in range(SEEDS):
            basis = "tensor4" if job.levels else "klems-full"
            settings = trace.Settings(basis, resolution=job.levels, samples=job.ours, seed=seed)
            measured = trace.run(job.recipe, settings)
            ours.append(measured.paths / measured.seconds)
            clock = genbsdf.Clock()
            genbsdf.generate(
                job.scene, folder, samples=job.theirs, processes=PROCESSORS, levels=job.levels, clock=clock
            )
            paths = 2 * patches * job.theirs
            theirs.append(paths / clock.whole)
            inside.append(paths / clock.rays)
        ratios = [a / b for a, b in zip(ours, theirs, strict=True)]
        rows.append(
            [
                job.name,
                f"{statistics.median(ours) / 1e6:.2f}",
                f"{statistics.median(theirs) / 1e6:.3f}",
                f"{statistics.median(inside) / 1e6:.3f}",
                f"**{statistics.median(ours) / statistics.median(theirs):.0f}**",
                f"{min(ratios):.0f} to {max(ratios):.0f}",
            ]
        )
    head = ["job", "Clerestory [M paths/s]", "genBSDF [M paths/s]", "in rfluxmtx [M paths/s]", "ratio", "spread"]
    return table(head, rows)


def _error(result: Bsdf, reference: dict[tuple[str, str], np.ndarray]) -> float:
    """RMS over all components, weighted by both projected solid angles, over the mean of the reference."""
    weights = np.outer(AREA, AREA)
    squares = total = 0.0
    for (side, scatter), values in reference.items():
        squares += float((weights * (flux(result, side, scatter) / AREA[:, None] - values) ** 2).sum())
        total += float((weights * values).sum())
    size = weights.sum() * len(reference)
    return float(np.sqrt(squares / size) / (total / size))


def _equal_error(folder: Path) -> str:
    scene = genbsdf.blind("curved", PLASTIC, crown=0.010)
    steps = (125, 250, 500)
    many = genbsdf.generate(scene, folder, samples=50 * steps[-1], processes=PROCESSORS)
    exact = trace.measure(genbsdf.recipe(scene, folder), samples=400_000, seed=99)
    keys = [(side, scatter) for side in SIDES for scatter in SCATTERS]
    reference = {key: 0.5 * (flux(many, *key) + flux(exact, *key)) / AREA[:, None] for key in keys}
    rows = []

    def row(name: str, samples: int, times: list[float], errors: list[float]) -> float:
        cost = statistics.median(times) * statistics.median(errors) ** 2
        rows.append([name, str(samples), f"{statistics.median(times):.2f}", f"{statistics.median(errors):.4f}", cost])
        return cost

    for samples in steps:
        clocks, errors = [], []
        for k in range(SEEDS):
            # The program has no seed: another part of the same endless blind is.
            low, high = (limit + 0.0091 * k for limit in scene.y)
            shifted = replace(scene, y=(low, high))
            clock = genbsdf.Clock()
            result = genbsdf.generate(shifted, folder, samples=samples, processes=PROCESSORS, clock=clock)
            clocks.append(clock.whole)
            errors.append(_error(result, reference))
        row("genBSDF, one path a sample", samples, clocks, errors)
    clock = genbsdf.Clock()
    result = genbsdf.generate(scene, folder, samples=60, processes=PROCESSORS, params=(), clock=clock)
    row("genBSDF, as it is by default", 60, [clock.whole], [_error(result, reference)])
    for name, recipe in (("Clerestory, mesh", genbsdf.recipe(scene, folder)), ("Clerestory, section", profile(10.0))):
        for samples in (4_096, 16_384, 65_536):
            runs = [trace.run(recipe, trace.Settings(samples=samples, seed=seed)) for seed in range(SEEDS)]
            row(name, samples, [r.seconds for r in runs], [_error(r.bsdf, reference) for r in runs])
    peer = rows[len(steps) - 1][-1]
    for line in rows:
        line[-1] = f"{peer / line[-1]:.3g}"
    return table(["job", "samples a patch", "time [s]", "error", "speed to equal error"], rows)


MEMORY = """
import resource, sys
from clerestory import trace
recipe, levels, samples = {recipe!r}, int(sys.argv[1]), int(sys.argv[2])
measured = trace.run(recipe, trace.Settings("tensor4", resolution=levels, samples=samples))
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0, measured.seconds, measured.paths)
"""


def _memory(folder: Path) -> str:
    del folder
    rows = []
    for levels, samples in ((6, 512), (7, 64)):
        script = MEMORY.format(recipe=profile(10.0))
        run = subprocess.run(
            [sys.executable, "-c", script, str(levels), str(samples)], capture_output=True, text=True, check=True
        )
        peak, seconds, paths = map(float, run.stdout.split())
        rows.append([f"{4**levels:,}²", str(samples), f"{peak:.0f}", f"{seconds:.1f}", f"{paths / 1e6:.1f}"])
    return table(["directions", "paths a cell", "peak [MiB]", "time [s]", "paths [M]"], rows)


def report(data: Path) -> str:
    """Text of the section."""
    del data
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        return f"""### The virtual goniophotometer and genBSDF

The peer is pyradiance's `generate_bsdf`, which drives rfluxmtx, with {PROCESSORS} processes; Clerestory takes as many
threads. The scenes are the same files, the sampled box is the same, neither averages by reciprocity. The peer follows
one path a sample (`{" ".join(genbsdf.ONE_PATH)}`) unless said otherwise.

Diffuse-hemispherical values of both (Clerestory / genBSDF); the largest difference of direct-hemispherical values of
any incident patch beyond three combined standard errors, over the value (1 % is allowed); and the least chance of the
chi-squared tests over the cells of the four components. {THEIRS:,} paths an incident patch by genBSDF, {OURS:,} by
Clerestory.

{_agreement(folder)}

Paths a second, {SEEDS} runs in turn; the start of the process is in neither, reading the scene is in both. Aims: 25
times for meshes, 50 times for extruded sections.

{_speed(folder)}

Time to equal error on a curved blind as a Klems matrix: the error is the RMS difference to a reference over its mean,
weighted by projected solid angles; the reference is the mean of both programs at 50 times the samples. Cost is time ×
error²; the last column is the cost of genBSDF at its greatest number of samples over the row's. Aim: 100.

{_equal_error(folder)}

Peak memory of the whole process for tensor trees of a curved blind, all four components. Aims: below 1 GB and below 3
GB.

{_memory(folder)}
"""
