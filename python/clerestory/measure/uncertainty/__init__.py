"""How far a model of measurements is to be believed: standard uncertainties by cause."""

from clerestory.measure.uncertainty.budget import CAUSES, COVERAGE_FACTOR, Budget, Cause
from clerestory.measure.uncertainty.estimate import Settings, Uncertainty, uncertainties

__all__ = ["CAUSES", "COVERAGE_FACTOR", "Budget", "Cause", "Settings", "Uncertainty", "uncertainties"]
