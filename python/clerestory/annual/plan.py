"""What a study would compute, about how long, and how much disk: without computing it."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from clerestory.annual.study import Study

# Seconds of one core, measured on the shipped office with the machine of docs/validation.md; they are for orientation.
_PATH = 4e-6
"""Of a path in the room."""
_SKY = 1e-3
"""Of a step with a sky."""
_PREPARED = 1.5
"""Of a data set, once for points and once for eyes."""
_CELLS = 6e-4
"""Of a step and group of windows, for all points."""
_POINT = 1e-6
"""Of a step and point."""
_EYE = 2.5e-3
"""Of a step and eye."""
_SURFACES = 4.5
"""Of what an eye sees of the room, once."""
_PIXELS = 96**2
"""Of what an eye sees of the room."""
_SEEN = 1000
"""Cells that a point sees, about."""


@dataclass(frozen=True)
class Plan:
    """What a study would compute."""

    parts: int
    """Of the year, by data set and points or views; data sets with states are counted once."""
    missing: int
    """Of these not in the cache."""
    seconds: float
    """About so long."""
    disk_mb: float
    """About so much in the cache, all parts and matrices together [MB]."""


def plan(study: Study) -> Plan:
    """Of a study. Which states a law chooses is not known before it is run: their steps count once."""
    arrivals_lit = int(np.count_nonzero(study.sky(study.recipe.patches).is_lit))
    groups, patches = len(study.matrices), len(study.matrices.basis)
    parts = missing = 0
    seconds = 0.0
    disk = 0.0
    for block in study.blocks:
        year = study.year(block)
        points, eyes = block.points.stop - block.points.start, len(block.views)
        unknown = 0
        for name in study.names:
            left = len(year.chunks) if name not in study.data_sets else len(year.missing(study.data_sets[name]))
            parts += len(year.chunks)
            missing += left
            unknown += left
            share = left / len(year.chunks)
            by_step = _CELLS * groups + _POINT * points if points else _EYE * eyes
            seconds += (left > 0) * _PREPARED + share * arrivals_lit * by_step
            disk += arrivals_lit * (8.0 * points + 40.0 * eyes)
        if unknown:
            seconds += _PATH * study.recipe.paths * points + _SURFACES * eyes
        disk += groups * (12.0 * patches * (points + _PIXELS * eyes) + 28.0 * _SEEN * (points + eyes))
    if missing:
        seconds += _SKY * arrivals_lit + _PATH * groups * patches * 2.0 * 4096
    return Plan(parts, missing, seconds / (os.cpu_count() or 1), 1e-6 * disk)
