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
from numpy.typing import NDArray

import clerestory
import pg2
from clerestory.basis import Basis
from clerestory.directions import angles, direction
from clerestory.measure import write
from timing import Pair, row, seconds, table

SAMPLE = "twill"
CHECKED = 12
#: From the narrow peak, which is smeared over a cell.
AWAY_DEG = 6.0
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


def _frame(bsdf: clerestory.Bsdf) -> NDArray[np.float64]:
    """What takes directions of a data set to those of the sample.

    The files tell azimuths as seen from the lamp, which is outside; pabopto2bsdf takes that side for its front, which
    is inside, so that right and left change places.
    """
    ((side, _),) = bsdf.models["visible"]
    return np.array([1.0, 1.0, 1.0] if side == "exterior" else [-1.0, 1.0, -1.0])


def _errors(path: Path) -> list[float]:
    """RMS differences to the known truth over its mean, of all directions and of those away from the peak, and the
    median relative difference; at incident directions between the measured ones.
    """
    bsdf = clerestory.read(path)
    frame = _frame(bsdf)
    rng = np.random.default_rng(1)
    found = []
    for theta, phi in zip(rng.uniform(5.0, 70.0, CHECKED), rng.uniform(0.0, 360.0, CHECKED), strict=True):
        incident = direction(theta, phi, side="exterior") * frame
        values = bsdf.evaluate(np.tile(incident, (len(pg2.EVEN), 1)), pg2.EVEN * frame)
        travel = pg2.travel(theta, phi)
        truth = pg2.bsdf(SAMPLE, travel, pg2.EVEN)
        off, away = (values - truth) ** 2, pg2.EVEN @ pg2.brightest(SAMPLE, travel)[0] < np.cos(np.radians(AWAY_DEG))
        rms = [np.sqrt(np.mean(off[kept])) / np.mean(truth[kept]) for kept in (slice(None), away)]
        found.append([*rms, np.median(np.abs(values / truth - 1.0))])
    return [float(error) for error in np.mean(found, axis=0)]


def _patches(path: Path) -> NDArray[np.float64]:
    """Klems values [incident, outgoing] (1/sr)."""
    bsdf = clerestory.read(path)
    basis, frame = Basis.named("klems-full"), _frame(bsdf)
    incident = basis.index_of_incident(basis.incident_centres("exterior") * frame)
    outgoing = basis.index_of_outgoing(basis.outgoing_centres("interior") * frame)
    (model,) = bsdf.models["visible"].values()
    return np.asarray(model.values).T[np.ix_(incident, outgoing)]


def _true_patches() -> NDArray[np.float64]:
    """Klems values of the sample [incident, outgoing] (1/sr)."""
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


def _error_of_patches(found: NDArray[np.float64], truth: NDArray[np.float64]) -> float:
    """RMS difference over the mean, by projected solid angle, of patches that were measured."""
    basis = Basis.named("klems-full")
    weight = basis.projected_solid_angles * (basis.limits_deg[:, 1] < pg2.TOP_DEG)
    pairs = np.outer(weight, weight)
    return float(np.sqrt(np.average((found - truth) ** 2, weights=pairs)) / np.average(truth, weights=pairs))


def _timed(files: list[str], home: Path, basis: str, convert: list[str]) -> tuple[Pair, list[Path]]:
    """Both programs once, and the files that they write."""
    written = [home / f"{whose}-{basis}.xml" for whose in ("ours", "theirs")]
    ours = seconds(lambda: _ours(files, written[0], basis))
    return Pair([ours], [seconds(lambda: _theirs(files, written[1], convert))]), written


def _trees(files: list[str], home: Path) -> tuple[Pair, list[str]]:
    pair, written = _timed(files, home, "tensor4", ["bsdf2ttree", "-g", "6"])
    return pair, [" / ".join(f"{100 * error:.1f} %" for error in _errors(path)) for path in written]


def _klems(files: list[str], home: Path) -> tuple[Pair, list[str]]:
    pair, written = _timed(files, home, "klems-full", ["bsdf2klems", "-n", "256"])
    truth = _true_patches()
    return pair, [f"{100 * _error_of_patches(_patches(path), truth):.1f} %" for path in written]


def report(_: Path) -> str:
    """Text of the section."""
    with tempfile.TemporaryDirectory() as folder:
        home = Path(folder)
        written = write(pg2.measured(SAMPLE), home / "points", "mountain")
        files = sorted(str(path) for path in written.paths)
        made = {"points to tree": _trees(files, home), "points to Klems patches": _klems(files, home)}
    head = ["job", "Clerestory [s]", "Radiance [s]", "ratio", "spread", "error", "Radiance's error"]
    cells = [[*row(name, pair, unit=1.0), *errors] for name, (pair, errors) in made.items()]
    return f"""### Measured points to tensor tree and Klems patches

Aim: at least 20 times for the tree, and a lower error. {len(files)} scans of a synthetic twill (rotational symmetry;
every 10° of incidence, 15° of azimuth), from the same text files to a tree of rank 4 with 4,096 × 4,096 directions, and
to Klems full: `clerestory measure fit` beside `pabopto2bsdf -s up`, `bsdf2ttree -g 6` and `bsdf2klems -n 256`, process
start included, one run of each. The errors of a tree are the RMS difference to the known truth over its mean, of all
directions and of those {AWAY_DEG:g}° and more from the narrow peak, which no cell resolves, and the median relative
difference, at {CHECKED} incident directions that were not measured. That of patches is the RMS difference over the mean
of all pairs of patches within 75°.

{table(head, cells)}
"""
