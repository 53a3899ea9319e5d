"""Agreement with Radiance on real files: the comparisons of the tests, with their figures."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
import pyradiance

import clerestory
from clerestory.directions import SIDES, direction
from conformance.test_separate_peaks import DIRECTIONS, KLEMS, TREES, agree, beams, radiance_beams
from radiance import RadianceError, compare
from samples import find_samples
from timing import table


def _look_ups() -> str:
    rows = []
    for kind in ("klems", "tensortree"):
        for path in find_samples(kind):
            with tempfile.TemporaryDirectory() as folder:
                try:
                    found = compare(path, Path(folder))
                except RadianceError as error:
                    rows.append([f"{kind}/{path.name}", f"not loaded by Radiance: {_last_words(error)}", "", "", ""])
                    continue
            hemispherical = f"{found.hemispherical.max():.1e}" if len(found.hemispherical) else ""
            rows.append(
                [
                    f"{kind}/{path.name}",
                    str(found.pairs),
                    str(found.set_aside),
                    f"{found.relative.max():.1e}",
                    hemispherical,
                ]
            )
    return table(["file", "pairs", "set aside", "largest difference", "largest hemispherical difference"], rows)


def _last_words(error: RadianceError) -> str:
    return str(error).rsplit(": ", 1)[-1]


def _beams() -> str:
    rows = []
    for path in find_samples("klems") + find_samples("tensortree"):
        if path.name not in KLEMS | TREES:
            continue
        rng = np.random.default_rng(20)
        r, phi = np.sqrt(rng.random(DIRECTIONS)) * 0.999, rng.random(DIRECTIONS) * 360
        separated = clerestory.read(path).separate_peaks()
        equal = with_beam = 0
        largest = 0.0
        for side in SIDES:
            incident = direction(np.degrees(np.arcsin(r)), phi, side=side)
            with tempfile.TemporaryDirectory() as folder:
                theirs = radiance_beams(pyradiance, path, incident, Path(folder))
            ours = beams(separated, incident)
            equal += int(agree(ours, theirs).sum())
            with_beam += int(np.count_nonzero(theirs))
            largest = max(largest, float(np.abs(ours - theirs).max()))
        rows.append([path.name, str(2 * DIRECTIONS), str(with_beam), str(equal), f"{largest:.1e}"])
    return table(["file", "directions", "with a beam", "equal", "largest difference"], rows)


def report(data: Path) -> str:
    """Text of the section."""
    del data
    return f"""### Look-ups against Radiance's BSDF library

Visible band, random pairs of directions of which a quarter goes nearly straight through or is mirrored and an eighth
comes from about the normal. Directions are handed over as they are, so sides and azimuths are compared too.
Differences of values are relative, with 1e-6/sr taken off; Radiance perturbs its values on purpose, each cell by up to
3e-4, and 5e-4 is allowed. Pairs within 1e-6 of the border of a cell are set aside. Direct-hemispherical values may
differ by 5e-3; Radiance has none for an isotropic tree by reciprocity.

{_look_ups()}

### Separated peaks against rtrace with aBSDF

Transmittance of the through-beam for random directions from both sides. Equal means within 1e-3 relative and 2e-4
absolute.

{_beams()}
"""
