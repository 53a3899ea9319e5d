"""Hybrid models: measured where the instrument reached, simulated elsewhere.

After Krehel, Grobe and Wittkopf (2017), "A hybrid data-driven BSDF model to predict light transmission through complex
fenestration systems including high incident directions", and IEA SHC Task 61 report C.2.2 (2021), section 2.2.
"""

from clerestory.measure.hybrid.join import SCALES, Hybrid, Part, Scale, joined
from clerestory.measure.hybrid.reach import Reach, reaches_known, reaches_of

__all__ = ["SCALES", "Hybrid", "Part", "Reach", "Scale", "joined", "reaches_known", "reaches_of"]
