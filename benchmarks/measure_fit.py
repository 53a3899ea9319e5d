"""Scattered points to a tensor tree and to Klems patches: ours beside pabopto2bsdf, bsdf2ttree and bsdf2klems, with the
errors against the truth."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pyradiance

import clerestory
import pg2
from clerestory.basis import Basis
from clerestory.directions import angles, direction
from clerestory.measure import write
from timing import Pair, row, seconds, table

SAMPLE = "twill"
CHECKED = 12
#: Incident directions an axis of a patch, for the truth.
INCIDENT = 8
PACKAGE = Path(pyradiance.__file__).parent


def _theirs(files: list[str], target: Path, convert: list[str]) -> None:
    programs = PACKAGE / "bin"
    environment = {**os.environ, "RAYPATH": f".:{PACKAGE / 'lib'}", "PATH": f"{programs}:{os.environ['PATH']}"}
    middle = target.with_suffix(".sir")
    threads = str(os.cpu_count() or 1)
    for command, out in (
        ([str(programs / "pabopto2bsdf"), "-n", threads, "-s", "up", *files], middle),
        ([str(programs / convert[0]), *convert[1:], str(middle)], target),
    ):
        with out.open("wb") as stream:
            subprocess.run(command, env=environment, stdout=stream, stderr=subprocess.DEVNULL, check=True)


def _ours(files: list[str], target: Path, basis: str) -> None:
    arguments = ["measure", "fit", *files, "-o", str(target), "--symmetry", "rotational", "--basis", basis]
    arguments.append("--no-uncertainty")
    subprocess.run(
        [sys.executable, "-m", "clerestory", *arguments],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        check=True,
    )


def _error(path: Path) -> float:
    """RMS difference to the truth over its mean, at incident directions between the measured ones."""
    bsdf = clerestory.read(path)
    (side, scatter), *_ = bsdf.models["visible"]
    rng = np.random.default_rng(1)
    found = []
    for theta, phi in zip(rng.uniform(5.0, 70.0, CHECKED), rng.uniform(0.0, 360.0, CHECKED), strict=True):
        at = pg2.travel(theta, phi)
        incident = direction(theta, phi, side=side)
        sign = 1.0 if (side == "exterior") == (scatter == "transmission") else -1.0
        outgoing = pg2.EVEN * [1.0, 1.0, sign]
        values = bsdf.evaluate(np.tile(incident, (len(outgoing), 1)), outgoing)
        truth = pg2.bsdf(SAMPLE, at, pg2.EVEN)
        found.append(np.sqrt(np.mean((values - truth) ** 2)) / truth.mean())
    return float(np.mean(found))


def _patches(path: Path) -> np.ndarray:
    """Klems values [1/sr]."""
    return np.asarray(next(iter(clerestory.read(path).models["visible"].values())).values)


def _true_patches() -> np.ndarray:
    """Klems values of the sample [1/sr]."""
    basis = Basis.named("klems-full")
    outgoing = pg2.square(150)
    patch = basis.index_of_outgoing(outgoing)
    counts = np.bincount(patch, minlength=len(basis))
    grid = (np.arange(INCIDENT) + 0.5) / INCIDENT
    u = np.stack(np.meshgrid(grid, grid), axis=-1).reshape(-1, 2)
    rows = []
    for i in range(len(basis)):
        theta, phi = angles(basis.sample_incident(i, u, "exterior"))
        mean = np.mean([pg2.bsdf(SAMPLE, pg2.travel(*at), outgoing) for at in zip(theta, phi, strict=True)], axis=0)
        rows.append(np.bincount(patch, mean, minlength=len(basis)) / counts)
    return np.array(rows)


def _error_of_patches(found: np.ndarray, truth: np.ndarray) -> float:
    """RMS difference over the mean, by projected solid angle, of patches that were measured."""
    basis = Basis.named("klems-full")
    weight = basis.projected_solid_angles * (basis.limits_deg[:, 1] < pg2.TOP_DEG)
    pairs = np.outer(weight, weight)
    return float(np.sqrt(np.average((found - truth) ** 2, weights=pairs)) / np.average(truth, weights=pairs))


def _trees(files: list[str], home: Path) -> tuple[Pair, tuple[float, float]]:
    ours, theirs = home / "ours.xml", home / "theirs.xml"
    times = (
        seconds(lambda: _ours(files, ours, "tensor4")),
        seconds(lambda: _theirs(files, theirs, ["bsdf2ttree", "-g", "6"])),
    )
    return Pair([times[0]], [times[1]]), (_error(ours), _error(theirs))


def _klems(files: list[str], home: Path) -> tuple[Pair, tuple[float, float]]:
    ours, theirs = home / "ours-klems.xml", home / "theirs-klems.xml"
    times = (
        seconds(lambda: _ours(files, ours, "klems-full")),
        seconds(lambda: _theirs(files, theirs, ["bsdf2klems", "-n", "256"])),
    )
    truth = _true_patches()
    errors = [_error_of_patches(_patches(path), truth) for path in (ours, theirs)]
    return Pair([times[0]], [times[1]]), (errors[0], errors[1])


def report(_: Path) -> str:
    """Text of the section."""
    with tempfile.TemporaryDirectory() as folder:
        home = Path(folder)
        written = write(pg2.measured(SAMPLE), home / "points", "mountain")
        files = sorted(str(path) for path in written.paths)
        made = {"points to tree": _trees(files, home), "points to Klems patches": _klems(files, home)}
    head = ["job", "Clerestory [s]", "Radiance [s]", "ratio", "spread", "error", "Radiance's error"]
    cells = [
        [*row(name, pair, unit=1.0), *(f"{100 * error:.0f} %" for error in errors)]
        for name, (pair, errors) in made.items()
    ]
    return f"""### Measured points to tensor tree and Klems patches

Aim: at least 20 times, and a lower error. {len(files)} scans of a synthetic twill (rotational symmetry; every 10° of
incidence, 15° of azimuth), from the same text files to a tree of rank 4 with 4,096 × 4,096 directions, and to Klems
full: `clerestory measure fit` beside `pabopto2bsdf -s up`, `bsdf2ttree -g 6` and `bsdf2klems -n 256`, process start
included, one run of each. The error of a tree is the RMS difference to the known truth over its mean, at {CHECKED}
incident directions that were not measured; the narrow peak makes it large. That of patches is the same over all pairs
of patches within 75°.

{table(head, cells)}
"""
