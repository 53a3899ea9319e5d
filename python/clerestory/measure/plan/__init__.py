"""Plans of measurements: what to measure with an instrument, in which directions, on which paths, and how long."""

from clerestory.measure.plan.instrument import INSTRUMENTS, Instrument, find_instrument
from clerestory.measure.plan.job import Job, Piece, read_job
from clerestory.measure.plan.make import Plan, make_plan
from clerestory.measure.plan.peaks import FoundPeak, find_peaks, fine_paths
from clerestory.measure.plan.tables import write_plan

__all__ = [
    "INSTRUMENTS",
    "FoundPeak",
    "Instrument",
    "Job",
    "Piece",
    "Plan",
    "find_instrument",
    "find_peaks",
    "fine_paths",
    "make_plan",
    "read_job",
    "write_plan",
]
