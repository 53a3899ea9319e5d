"""Models of half of the points each: how far a model depends on where its points happen to lie.

What lies between points, the top of a narrow peak say, no point tells of. Two models, each of every other
point, differ from the model of all as that one does from the truth, for noise exactly and for what is resolved badly
at least. By noise both differ alike, one up and one down; where half of the points are too few for lobes, one of them
alone goes astray, so that the smaller difference is the one to take.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from clerestory.bsdf import Bsdf
from clerestory.measure.interpolant.fitting import distributions_of
from clerestory.model import Model

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from clerestory.measure.prepare.symmetry import Symmetry
    from clerestory.measure.scan import Scan

_FEWEST = 40
"""Points of a light of which half still make a model."""


def split(groups: Sequence[Sequence[Scan]], band: str, symmetry: Symmetry) -> tuple[Bsdf, ...]:
    """Two models that hold in the measured directions, each of other points; none where points are too few."""
    if min(sum(len(scan) for scan in group) for group in groups) < _FEWEST:
        return ()
    chosen = [[_every_other(scan) for scan in group] for group in groups]
    first = groups[0][0]
    made = []
    for other in (False, True):
        half = [
            [_points(scan, which != other) for scan, which in zip(group, kept, strict=True)]
            for group, kept in zip(groups, chosen, strict=True)
        ]
        model = Model(distributions_of(half, band, symmetry).model(symmetry, "nearest", None))
        made.append(Bsdf.from_models({(first.incident_side, first.scatter): model}))
    return tuple(made)


def _every_other(scan: Scan) -> NDArray[np.bool_]:
    """Every other point of a walk from neighbour to neighbour (Morton's order of places on the disk)."""
    x, y = ((0.5 * (scan.outgoing[:, k] + 1.0) * 0xFFFF).astype(np.uint64) for k in range(2))
    code = np.zeros(len(scan), dtype=np.uint64)
    for bit in range(16):
        one, at = np.uint64(1), np.uint64(bit)
        code |= ((x >> at) & one) << np.uint64(2 * bit) | ((y >> at) & one) << np.uint64(2 * bit + 1)
    made = np.zeros(len(scan), dtype=bool)
    made[np.argsort(code, kind="stable")[::2]] = True
    return made


def _points(scan: Scan, kept: NDArray[np.bool_]) -> Scan:
    errors = scan.standard_errors
    return replace(
        scan,
        theta_deg=scan.theta_deg[kept],
        phi_deg=scan.phi_deg[kept],
        values=scan.values[kept],
        standard_errors=None if errors is None else errors[kept],
    )
