"""From Radiance's three channels to luminance."""

from __future__ import annotations

import numpy as np

EFFICACY = 179.0
"""Lumens of a visible watt in Radiance's pictures."""
LUMINANCE = np.array([0.265074126, 0.670114631, 0.064811243])
"""Share of luminance of Radiance's red, green and blue."""
