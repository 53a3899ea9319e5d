"""The virtual goniophotometer: from a sample's geometry and materials to its BSDF, with standard errors.

A sample comes from a recipe, a TOML file (`load`), or from a function named after its kind, such as `venetian_blind`;
`measure` traces rays through it, `scan` looks at listed directions only.
"""

from clerestory.trace.export import write_rays
from clerestory.trace.instrument import Balance, Measured, Seen, Settings, Value, measure, run, scan
from clerestory.trace.keys import RecipeError
from clerestory.trace.make import perforated_screen, prismatic_film, venetian_blind, woven_fabric
from clerestory.trace.sample import Sample, load
from clerestory.trace.shipped import names
from clerestory.trace.state import State

__all__ = [
    "Balance",
    "Measured",
    "RecipeError",
    "Sample",
    "Seen",
    "Settings",
    "State",
    "Value",
    "load",
    "measure",
    "names",
    "perforated_screen",
    "prismatic_film",
    "run",
    "scan",
    "venetian_blind",
    "woven_fabric",
    "write_rays",
]
