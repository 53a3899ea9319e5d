"""Data sets and scans scaled to what an integrating sphere measured."""

from clerestory.measure.calibrate.agreement import Agreement, Row, of_model, of_scans
from clerestory.measure.calibrate.models import SCALINGS, Calibration, Factor, Scaling, calibrated
from clerestory.measure.calibrate.scans import ScanCalibration, calibrated_scans

__all__ = [
    "SCALINGS",
    "Agreement",
    "Calibration",
    "Factor",
    "Row",
    "Scaling",
    "ScanCalibration",
    "calibrated",
    "calibrated_scans",
    "of_model",
    "of_scans",
]
