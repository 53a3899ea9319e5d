"""Look-ups and samples from Python beside pyradiance's calls, and from Rust."""

from __future__ import annotations

import statistics
import subprocess
from pathlib import Path

import numpy as np
from pyradiance import bsdf as library

import clerestory
from loading import KEPT
from timing import REPETITIONS, Pair, alternate, row, table

FILES = ("klems/ExtVenetianBlind_17tilt.xml", "tensortree/b30.xml", "tensortree/pyradiance_t3.xml")
COUNT = 1_000_000
THEIR_COUNT = 20_000
TRANSMIT = 2 + 4 + 8
ROOT = Path(__file__).resolve().parent.parent


def _directions(rng: np.random.Generator, sign: float) -> np.ndarray:
    r, phi = 0.9999 * np.sqrt(rng.random(COUNT)), 2 * np.pi * rng.random(COUNT)
    return np.column_stack([r * np.cos(phi), r * np.sin(phi), sign * np.sqrt(1 - r**2)])


def _degrees(directions: np.ndarray) -> list[tuple[float, float]]:
    head = directions[:THEIR_COUNT]
    theta, phi = np.degrees(np.arccos(head[:, 2])), np.degrees(np.arctan2(head[:, 1], head[:, 0]))
    return list(zip(theta.tolist(), phi.tolist(), strict=True))


def _rust() -> list[list[str]]:
    done = subprocess.run(
        ["cargo", "bench", "--quiet", "--locked", "-p", "clerestory", "--bench", "lookups"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    cases = (line.split("\t") for line in done.stdout.splitlines() if "\t" in line)
    return [[name, time, f"{1e3 / float(time):.1f}"] for name, time in cases]


def report(data: Path) -> str:
    """Text of the section."""
    rng = np.random.default_rng(1)
    incident, outgoing, u = _directions(rng, 1), _directions(rng, -1), rng.random((COUNT, 2))
    i_deg, o_deg = _degrees(incident), _degrees(outgoing)
    scale = COUNT / THEIR_COUNT
    free = clerestory.Bsdf.from_models({("interior", "transmission"): clerestory.Model.lambertian(0.5)})
    rows = []
    for name in FILES:
        ours, theirs = clerestory.read(data / name), library.load_file(str(data / name))
        KEPT.append(theirs)

        def look_up(_: int, theirs: object = theirs) -> None:
            for i, o in zip(i_deg, o_deg, strict=True):
                library.query(theirs, *i, *o)

        def sample(_: int, theirs: object = theirs) -> None:
            for i in i_deg:
                library.sample(theirs, *i, 1, TRANSMIT)

        jobs = (
            (
                "look-ups",
                lambda _, b=ours: b.evaluate(incident, outgoing),
                look_up,
                lambda _: free.evaluate(incident, outgoing),
            ),
            (
                "samples",
                lambda _, b=ours: b.sample(incident, u, scatter="transmission"),
                sample,
                lambda _: free.sample(incident, u, scatter="transmission"),
            ),
        )
        for kind, mine, peer, binding in jobs:
            pair = alternate(mine, peer)
            pair = Pair(pair.ours, [t * scale for t in pair.theirs])
            nothing = statistics.median(alternate(binding, binding).ours)
            share = min(nothing / statistics.median(pair.ours), 1.0)
            rows.append([*row(f"{name}: {kind}", pair, digits=0), f"{100 * share:.0f} %"])
    head = ["10⁶ calls", "Clerestory [ms]", "pyradiance [ms]", "ratio", "spread", "share of the binding"]
    return f"""### Look-ups and samples

From Python: {COUNT:,} random directions in one call of Clerestory; pyradiance's calls take one direction each, so
{THEIR_COUNT:,} are timed and scaled. {REPETITIONS} runs in turn. The share of the binding is the time of the same call
on a Lambertian model, which costs next to nothing to look up.

{table(head, rows)}

From Rust, on one thread, over random directions (the time of drawing two random numbers is in the samples'):

{table(["model", "ns", "million a second"], _rust())}
"""
