"""Measurements: what instruments saw, from their files to models of the sample."""

from clerestory.measure.scan import Measurement, Scan
from clerestory.measure.source import Source
from clerestory.measure.sphere import SphereValues

__all__ = ["Measurement", "Scan", "Source", "SphereValues"]
