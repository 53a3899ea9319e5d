"""Models of measurements: from scattered points to a BSDF of every pair of directions."""

from clerestory.measure.interpolant.fitted import Component, Fit, HeldOut
from clerestory.measure.interpolant.fitting import METHODS, Method, fit
from clerestory.measure.interpolant.lines import spread_lines

__all__ = ["METHODS", "Component", "Fit", "HeldOut", "Method", "fit", "spread_lines"]
