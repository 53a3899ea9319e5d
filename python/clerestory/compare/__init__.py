"""Comparison of laboratories' data sets of one system: numbers, distances, a report.

* `compare` gives every number; `Comparison` holds them.
* `write_report` makes one HTML file of them that opens anywhere.
"""

from clerestory.compare.metrics import compare
from clerestory.compare.report import write_report
from clerestory.compare.result import Comparison

__all__ = ["Comparison", "compare", "write_report"]
