"""From what an instrument saw to a BSDF at every measured direction: a file a step, each recorded.

A step is a function of a measurement that gives another one and what it did; raw values are never changed.
`clerestory.measure.prepare.in_order` has them in their order.
"""

from clerestory.measure.prepare.convention import CONVENTIONS, Convention
from clerestory.measure.prepare.in_order import Settings, prepare
from clerestory.measure.prepare.limits import Sector
from clerestory.measure.prepare.step import Prepared, Step
from clerestory.measure.prepare.symmetry import SYMMETRIES, Symmetry

__all__ = ["CONVENTIONS", "SYMMETRIES", "Convention", "Prepared", "Sector", "Settings", "Step", "Symmetry", "prepare"]
