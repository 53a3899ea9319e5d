"""Luminance from bracketed photographs: response, merging, lens, calibration, and comparison with renderings."""

from clerestory.photo.circle import Circle, find_circle
from clerestory.photo.develop import Developed, develop
from clerestory.photo.exposure import Camera, Exposure, Given, read_table
from clerestory.photo.lens import PROJECTIONS, Lens
from clerestory.photo.merge import Merged, merge
from clerestory.photo.photograph import Photograph
from clerestory.photo.recover import Step, recover_response
from clerestory.photo.resample import resample
from clerestory.photo.response import Response
from clerestory.photo.series import Series, read_series
from clerestory.photo.session import Session
from clerestory.photo.spot import Spot
from clerestory.photo.vignetting import Vignetting

__all__ = [
    "PROJECTIONS",
    "Camera",
    "Circle",
    "Developed",
    "Exposure",
    "Given",
    "Lens",
    "Merged",
    "Photograph",
    "Response",
    "Series",
    "Session",
    "Spot",
    "Step",
    "Vignetting",
    "develop",
    "find_circle",
    "merge",
    "read_series",
    "read_table",
    "recover_response",
    "resample",
]
