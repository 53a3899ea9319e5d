"""Whether the data of a case are fine enough for glare and direct sun."""

from __future__ import annotations

from typing import TYPE_CHECKING

from clerestory.check.purpose import purpose
from clerestory.roundrobin.pieces import Piece, packed, value_of
from clerestory.words import band_name

if TYPE_CHECKING:
    from clerestory.annual.cache import Arrays
    from clerestory.roundrobin.pieces import Tell
    from clerestory.roundrobin.study import Case, System

CPU_S = 0.3
"""Measured, with making the treatment [s]."""


def piece(system: System, case: Case) -> Piece:
    """The findings of `clerestory check --for glare` on a case."""

    def compute(tell: Tell) -> Arrays:
        bsdf = system.treated(case)
        found = purpose(bsdf, band_name(bsdf, None), "glare")
        tell(1.0)
        return packed([finding.what for finding in found if finding.severity != "note"])

    return Piece("coarseness", {"data_set": system.key(case)}, f"{system.title}: {case}, check", CPU_S, 0.001, compute)


def read(arrays: Arrays) -> str:
    """Why the data are too coarse; empty if they are not."""
    return "; ".join(value_of(arrays))
