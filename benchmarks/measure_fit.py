"""Scattered points to a tensor tree: ours beside pabopto2bsdf and bsdf2ttree, with the error against the truth."""

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
from clerestory.directions import direction
from clerestory.measure import write
from timing import Pair, row, seconds, table

SAMPLE = "twill"
#: Theirs takes half an hour.
REPETITIONS = 1
CHECKED = 12
PACKAGE = Path(pyradiance.__file__).parent


def _theirs(files: list[str], target: Path) -> None:
    programs = PACKAGE / "bin"
    environment = {**os.environ, "RAYPATH": f".:{PACKAGE / 'lib'}", "PATH": f"{programs}:{os.environ['PATH']}"}
    middle = target.with_suffix(".sir")
    threads = str(os.cpu_count() or 1)
    for command, out in (
        ([str(programs / "pabopto2bsdf"), "-n", threads, "-s", "up", *files], middle),
        ([str(programs / "bsdf2ttree"), "-g", "6", str(middle)], target),
    ):
        with out.open("wb") as stream:
            subprocess.run(command, env=environment, stdout=stream, stderr=subprocess.DEVNULL, check=True)


def _ours(files: list[str], target: Path) -> None:
    arguments = ["measure", "fit", *files, "-o", str(target), "--symmetry", "rotational", "--basis", "tensor4"]
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


def report(_: Path) -> str:
    """Text of the section."""
    with tempfile.TemporaryDirectory() as folder:
        home = Path(folder)
        written = write(pg2.measured(SAMPLE), home / "points", "mountain")
        files = sorted(str(path) for path in written.paths)
        ours, theirs = home / "ours.xml", home / "theirs.xml"
        times = [
            (seconds(lambda: _ours(files, ours)), seconds(lambda: _theirs(files, theirs))) for _ in range(REPETITIONS)
        ]
        errors = _error(ours), _error(theirs)
    pair = Pair([t[0] for t in times], [t[1] for t in times])
    head = ["job", "Clerestory [s]", "Radiance [s]", "ratio", "spread", "error", "Radiance's error"]
    cells = [*row("points to tree", pair, unit=1.0), *(f"{100 * error:.0f} %" for error in errors)]
    return f"""### Measured points to tensor tree

Aim: at least 20 times, and a lower error. {len(files)} scans of a synthetic twill (rotational symmetry; every 10° of
incidence, 15° of azimuth), from the same text files to a tree of rank 4 with 4,096 × 4,096 directions:
`clerestory measure fit` beside `pabopto2bsdf -s up` and `bsdf2ttree -g 6`, process start included,
one run of each. The error is the RMS difference to the known truth over its mean, at {CHECKED} incident
directions that were not measured.

{table(head, [cells])}
"""
