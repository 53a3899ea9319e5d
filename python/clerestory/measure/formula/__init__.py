"""Formulas with a few parameters, such as ABg, fitted to scans.

After IEA SHC Task 61 report C.2.2 (2021), sections 2.7 and 2.9: functional models, whose delta functions are told apart
by the instrument's own beam.
"""

from clerestory.measure.formula.dataset import data_set
from clerestory.measure.formula.fitting import fit_formula
from clerestory.measure.formula.found import Fitted, Number
from clerestory.measure.formula.shapes import FORMULAS, Formula

__all__ = ["FORMULAS", "Fitted", "Formula", "Number", "data_set", "fit_formula"]
