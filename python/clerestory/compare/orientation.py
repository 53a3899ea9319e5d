"""Data sets that were turned, mirrored or flipped by mistake, the field's most expensive one.

A data set that lies further from the others than they do from each other is held against the one in their middle as it
is and after every turn by a quarter, mirror image and flip. If one of these brings it much closer it is reported;
nothing is changed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory import _core
from clerestory._core import MissingDataError
from clerestory.compare.quantities import klems
from clerestory.compare.result import Turn

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from clerestory.bsdf import Bsdf
    from clerestory.compare.result import Distances, Settings

NOTICEABLE_DEG = 3.0
"""A mean distance [°] below this is no reason to look for a turn."""
APART = 1.2
"""Nor one below this many times the median of the other data sets."""
SAME_TOTAL = 0.15
"""Nor one whose hemispherical value, which no turn changes, differs by more than this share: it is another system."""
BETTER = 0.5
"""A turn counts if it brings the distance below this share."""

_ROTATIONS: dict[str, Callable[[Bsdf], Bsdf]] = {
    "turned by 90°": lambda b: b.rotated(90.0),
    "turned by 180°": lambda b: b.rotated(180.0),
    "turned by 270°": lambda b: b.rotated(270.0),
    "mirrored left to right": lambda b: b.mirrored(),
    "mirrored upside down": lambda b: b.mirrored().rotated(180.0),
}
_VARIANTS: dict[str, Callable[[Bsdf], Bsdf]] = {
    **_ROTATIONS,
    "flipped, interior and exterior exchanged": lambda b: b.flipped(),
    "flipped, interior and exterior exchanged, and turned by 180°": lambda b: b.flipped().rotated(180.0),
}


def find_turns(
    sets: Mapping[str, Bsdf], totals: Sequence[float | None], settings: Settings, distances: Sequence[Distances]
) -> tuple[Turn, ...]:
    """Data sets that agree better with the others after a turn or flip.

    Parameters
    ----------
    sets
        Data sets by label.
    totals
        Their hemispherical values.
    distances
        Between all pairs of them, at the patches and at last the mean over all incident directions.
    """
    labels = list(sets)
    # A turn shows at the patches, which lie in one plane of incidence, more than in the mean over all azimuths.
    square = np.mean([np.array(d.transport_deg, dtype=np.float64) for d in distances[:-1]], axis=0)
    if not np.isfinite(square).all():
        return ()
    mean = square.sum(axis=1) / (len(labels) - 1)
    middle = int(np.argmin(mean))
    found = []
    for k, label in enumerate(labels):
        to_middle = square[k, middle]
        others = np.delete(square[middle], [middle, k])
        if k == middle or to_middle < NOTICEABLE_DEG or (others.size and to_middle < APART * np.median(others)):
            continue
        own, its = totals[k] or 0.0, totals[middle] or 0.0
        if abs(own - its) > SAME_TOTAL * max(own, its):
            continue
        found += _better(sets[label], label, sets[labels[middle]], labels[middle], settings)
    return tuple(found)


def _better(bsdf: Bsdf, label: str, reference: Bsdf, its_label: str, settings: Settings) -> list[Turn]:
    names, models = ["as it is"], [reference, bsdf]
    for words, change in _VARIANTS.items():
        names.append(words)
        models.append(change(bsdf))
    cores = []
    kept = []
    for name, model in zip(["reference", *names], models, strict=True):
        try:
            cores.append(model.model(settings.side, settings.scatter, settings.band)[0]._core)
        except MissingDataError:
            continue
        kept.append(name)
    probes = klems().incident_centres(settings.side)[[p - 1 for p in settings.patches]]
    to_reference = np.degrees(_core.distances(cores, 1, probes)[1]).mean(axis=1)
    if not np.isfinite(to_reference).all():
        return []
    best = int(np.argmin(to_reference))
    before, after = float(to_reference[0]), float(to_reference[best])
    if best == 0 or after > BETTER * before:
        return []
    return [Turn(label, kept[1 + best], its_label, before, after)]
