"""Classes of discomfort."""

from __future__ import annotations

from bisect import bisect_left

CLASSES = ("imperceptible", "perceptible", "disturbing", "intolerable")
DGP_LIMITS = (0.35, 0.40, 0.45)
"""Upper limits of the first three classes of the daylight glare probability (Wienold 2009, EN 17037)."""
DGI_LIMITS = (18.0, 24.0, 28.0)
"""The same of the daylight glare index, as IEA SHC Task 61 reports it."""


def dgp_class(dgp: float) -> str:
    """Class of a daylight glare probability."""
    return CLASSES[bisect_left(DGP_LIMITS, dgp)]


def dgi_class(dgi: float) -> str:
    """Class of a daylight glare index."""
    return CLASSES[bisect_left(DGI_LIMITS, dgi)]
