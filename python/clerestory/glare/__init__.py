"""Glare: sources in a picture, and what the field's indices say of them."""

from clerestory.glare.classes import DGI_LIMITS, DGP_LIMITS, dgi_class, dgp_class
from clerestory.glare.evaluate import Evaluation, Source, evaluate, rate
from clerestory.glare.settings import PRESETS, Settings

__all__ = [
    "DGI_LIMITS",
    "DGP_LIMITS",
    "PRESETS",
    "Evaluation",
    "Settings",
    "Source",
    "dgi_class",
    "dgp_class",
    "evaluate",
    "rate",
]
