"""Measurements: what instruments saw, from their files to models of the sample."""

from clerestory.measure.contents import Contents
from clerestory.measure.files import read, write
from clerestory.measure.interpolant import Fit, fit
from clerestory.measure.scan import Measurement, Scan
from clerestory.measure.source import Source
from clerestory.measure.sphere import SphereValues

__all__ = ["Contents", "Fit", "Measurement", "Scan", "Source", "SphereValues", "fit", "read", "write"]
