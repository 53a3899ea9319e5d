"""Look-ups in BSDF files by Radiance's own library, beside ours; for conformance tests and tables of benchmarks."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from clerestory import MissingDataError, read
from clerestory.directions import SCATTERS, SIDES, outgoing_side
from samples import unpacked

if TYPE_CHECKING:
    from clerestory import Bsdf
    from clerestory.directions import Scatter, Side

#: Look-ups a file, and incident directions for hemispherical values.
PAIRS, INCIDENT = 1000, 100
#: Pairs this near to the border of a cell are set aside: rounding decides on which side they are.
BORDER = 1e-6
#: Allowed: Radiance perturbs its look-ups deliberately, each cell by up to 3e-4.
RELATIVE, ABSOLUTE, HEMISPHERICAL = 5e-4, 1e-6, 5e-3
#: Everything that is transmitted or reflected, in the flags of Radiance's library: specular and diffuse (4 + 8).
FLAGS = {"transmission": 2 + 4 + 8, "reflection": 1 + 4 + 8}


@dataclass
class Component:
    """One side and scatter of a file, looked up by both."""

    side: Side
    scatter: Scatter
    ours: np.ndarray
    theirs: np.ndarray
    near_border: np.ndarray
    """Which pairs are set aside."""
    ours_hemispherical: np.ndarray
    theirs_hemispherical: np.ndarray
    kind: str
    by_reciprocity: bool

    @property
    def relative(self) -> np.ndarray:
        """Relative differences of the pairs that count, the absolute tolerance taken off."""
        ours, theirs = self.ours[~self.near_border], self.theirs[~self.near_border]
        difference = np.maximum(np.abs(ours - theirs) - ABSOLUTE, 0.0)
        return np.divide(difference, theirs, out=np.where(difference > 0, np.inf, 0.0), where=theirs > 0)

    @property
    def hemispherical(self) -> np.ndarray:
        """Relative differences of direct-hemispherical values.

        Radiance has none for an isotropic tree by reciprocity, which it can only look up.
        """
        if self.kind == "reversed":
            return np.empty(0)
        ours, theirs = self.ours_hemispherical, self.theirs_hemispherical
        return np.abs(ours - theirs) / np.maximum(theirs, ABSOLUTE)


@dataclass
class Comparison:
    """A file, looked up by both."""

    path: Path
    kind: str
    components: list[Component] = field(default_factory=list)

    @property
    def pairs(self) -> int:
        return sum(len(c.ours) for c in self.components)

    @property
    def set_aside(self) -> int:
        return sum(int(c.near_border.sum()) for c in self.components)

    @property
    def relative(self) -> np.ndarray:
        return np.concatenate([c.relative for c in self.components])

    @property
    def hemispherical(self) -> np.ndarray:
        return np.concatenate([c.hemispherical for c in self.components])


class RadianceError(Exception):
    """Radiance's library does not load a file; the text is its own."""


def compare(path: Path, folder: Path, seed: int = 1) -> Comparison:
    """Looks up random pairs of directions with both, the visible band.

    A quarter of the pairs goes nearly straight through or is mirrored, so that beams are met, and an eighth comes from
    about the normal.

    Parameters
    ----------
    folder
        For temporary files.
    """
    ours = read(path)
    rng = np.random.default_rng(seed)
    found: list[tuple[Side, Scatter, str, bool]] = []
    for side in SIDES:
        for scatter in SCATTERS:
            try:
                model, by_reciprocity = ours.model(side, scatter)
            except MissingDataError:
                continue
            found.append((side, scatter, model.kind, by_reciprocity))
    count = -(-PAIRS // len(found))
    pairs = [_pairs(rng, count, side, scatter) for side, scatter, *_ in found]
    questions = {}
    for (side, scatter, *_), (incident, outgoing) in zip(found, pairs, strict=True):
        questions[f"{side}.{scatter}.pairs"] = np.column_stack([_degrees(incident), _degrees(outgoing)])
        questions[f"{side}.{scatter}.incident"] = _degrees(incident[:INCIDENT])
        questions[f"{side}.{scatter}.flags"] = np.array(FLAGS[scatter])
    answers = _ask(unpacked(path, folder), folder, questions)
    comparison = Comparison(path, next(m.kind for m in ours.models["visible"].values()))
    for (side, scatter, kind, by_reciprocity), (incident, outgoing) in zip(found, pairs, strict=True):
        values = ours.evaluate(incident, outgoing)
        comparison.components.append(
            Component(
                side,
                scatter,
                values,
                answers[f"{side}.{scatter}.values"],
                _near_border(ours, incident, outgoing, values),
                ours.integrate(incident[:INCIDENT], scatter),
                answers[f"{side}.{scatter}.hemispherical"],
                kind,
                by_reciprocity,
            )
        )
    return comparison


def _ask(path: Path, folder: Path, questions: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    asked, answered = folder / "questions.npz", folder / "answers.npz"
    np.savez(asked, **questions)
    worker = Path(__file__).with_name("radiance_worker.py")
    run = subprocess.run(
        [sys.executable, str(worker), str(path), str(asked), str(answered)],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    if run.returncode:
        raise RadianceError((run.stdout + run.stderr).strip() or f"signal or status {run.returncode}")
    return dict(np.load(answered))


def _degrees(directions: np.ndarray) -> np.ndarray:
    """Angle to +z and azimuth [°]: Radiance's frame is ours, its normal points into the room."""
    theta = np.degrees(np.arctan2(np.hypot(directions[:, 0], directions[:, 1]), directions[:, 2]))
    phi = np.degrees(np.arctan2(directions[:, 1], directions[:, 0]))
    return np.column_stack([theta, phi])


def _pairs(rng: np.random.Generator, count: int, side: Side, scatter: Scatter) -> tuple[np.ndarray, np.ndarray]:
    """Incident and outgoing directions (count, 3), uniform in projected solid angle but for beams and the normal."""
    r, phi = 0.9999 * np.sqrt(rng.random((2, count))), 2 * np.pi * rng.random((2, count))
    r[0, ::8] *= 0.05
    incident, outgoing = np.stack([r * np.cos(phi), r * np.sin(phi)], axis=-1)
    near = slice(None, None, 4)
    outgoing[near] = np.clip(incident[near] + rng.normal(0, 0.01, (len(incident[near]), 2)), -0.7, 0.7)
    return lift(-incident, side), lift(outgoing, outgoing_side(side, scatter))


def lift(points: np.ndarray, side: Side) -> np.ndarray:
    """Directions (n, 3) to a side over points (n, 2) of the disk."""
    z = np.sqrt(np.clip(1 - np.sum(points**2, axis=-1), 0, None))
    return np.column_stack([points, z if side == "interior" else -z])


def _near_border(bsdf: Bsdf, incident: np.ndarray, outgoing: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Pairs whose value changes within a tiny distance in the incident or the outgoing direction."""
    near = np.zeros(len(values), dtype=bool)
    for step in BORDER * np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]]):
        near |= bsdf.evaluate(incident + step, outgoing) != values
        near |= bsdf.evaluate(incident, outgoing + step) != values
    return near
