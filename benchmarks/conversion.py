"""Tensor tree to Klems matrix: ours beside bsdf2klems."""

from __future__ import annotations

import os
import statistics
import subprocess
import tempfile
from pathlib import Path

import numpy as np
import pyradiance

import clerestory
from clerestory.directions import SCATTERS, SIDES
from timing import Pair, row, seconds, table

FILES = ("tensortree/b30.xml", "tensortree/pyradiance_t3.xml")
SAMPLES = 256
REPETITIONS = 5
PACKAGE = Path(pyradiance.__file__).parent


def _bsdf2klems(path: Path, samples: int, target: Path) -> None:
    programs = PACKAGE / "bin"
    environment = {
        **os.environ,
        "RAYPATH": f".:{PACKAGE / 'lib'}",
        "PATH": f"{programs}:{os.environ['PATH']}",
    }
    with target.open("wb") as out:
        subprocess.run(
            [str(programs / "bsdf2klems"), "-n", str(samples), str(path)],
            env=environment,
            stdout=out,
            stderr=subprocess.DEVNULL,
            check=True,
        )


def _all_components(path: Path) -> clerestory.Bsdf:
    """The data set with what the other program converts too: the other side's transmission, by reciprocity."""
    source = clerestory.read(path)
    held = source.models["visible"]
    models = {}
    for side in SIDES:
        for scatter in SCATTERS:
            if (side, scatter) in held or (scatter == "transmission" and any(s == scatter for _, s in held)):
                models[side, scatter] = source.model(side, scatter)[0]
    return clerestory.Bsdf.from_models(models)


def _job(path: Path) -> tuple[Pair, int, float]:
    """Times, number of components that both convert, and RMS difference over the mean."""
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "klems.xml"
        _bsdf2klems(path, SAMPLES, target)
        theirs_result = clerestory.read(target)
        held = theirs_result.models["visible"]
        source = _all_components(path)
        both = {key: model for key, model in source.models["visible"].items() if key in held}
        source = clerestory.Bsdf.from_models(both)
        ours, theirs = [], []
        source.to_matrix("klems-full")
        for _ in range(REPETITIONS):
            ours.append(seconds(lambda: source.to_matrix("klems-full")))
            # Start of the process, reading and writing take as long with one sample: they are taken off.
            start = seconds(lambda: _bsdf2klems(path, 1, target))
            theirs.append((seconds(lambda: _bsdf2klems(path, SAMPLES, target)) - start) * SAMPLES / (SAMPLES - 1))
        result = source.to_matrix("klems-full")
    weights = clerestory.Basis.named("klems-full").projected_solid_angles
    weights = np.outer(weights, weights)
    errors = []
    for side, scatter in both:
        a, b = result.model(side, scatter)[0].values, theirs_result.model(side, scatter)[0].values
        mean = (weights * b).sum() / weights.sum()
        if mean > 0:
            errors.append(np.sqrt((weights * (a - b) ** 2).sum() / weights.sum()) / mean)
    return Pair(ours, theirs), len(both), statistics.median(errors)


def report(data: Path) -> str:
    """Text of the section."""
    rows = []
    for name in FILES:
        pair, components, difference = _job(data / name)
        rows.append([*row(name, pair, unit=1.0, digits=3), str(components), f"{difference:.3f}"])
    head = ["file", "Clerestory [s]", "bsdf2klems [s]", "ratio", "spread", "components", "difference"]
    return f"""### Tensor tree to Klems full

Aim: at least 20 times. The same components on both sides, {REPETITIONS} runs in turn. `bsdf2klems` takes {SAMPLES}
samples a patch pair; Clerestory sums the overlaps of cells and patches, which is what many samples would tend to. Start
of the process, reading and writing are taken off: for `bsdf2klems` by a run with one sample a pair. Clerestory works on
all processors, `bsdf2klems` on one. The difference is the RMS over all patch pairs, weighted by projected solid angle,
over the mean: it is the other side's sampling noise, which is large where a patch holds a narrow beam.

{table(head, rows)}
"""
