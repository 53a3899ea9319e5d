"""Window systems: layers put together, and what each of them absorbs.

A layer is a `Bsdf`: a file's, a pane's, a measured one. It is turned round with `Bsdf.flipped` and turned in its plane
with `Bsdf.rotated` before it is put in.

Examples
--------
>>> from clerestory.system import pane_from_normal, stack
>>> glass = pane_from_normal(0.8993, 0.0826)
>>> stack([glass, glass]).absorptance("visible").shape
(2, 145)
"""

from clerestory.system.glass import Glass, Plate, Sheet, Thermal
from clerestory.system.glass_files import read_glass
from clerestory.system.glazing import Glazing
from clerestory.system.layer import Gap, Layer
from clerestory.system.pane import pane, pane_from_normal
from clerestory.system.stack import System, stack
from clerestory.system.window import Built, Window

__all__ = [
    "Built",
    "Gap",
    "Glass",
    "Glazing",
    "Layer",
    "Plate",
    "Sheet",
    "System",
    "Thermal",
    "Window",
    "pane",
    "pane_from_normal",
    "read_glass",
    "stack",
]
