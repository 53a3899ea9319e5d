"""Slats and holes against LBNL's WinCalc, which solves them by view factors.

It takes light from the middle of each Klems patch, so light is sent from there. Its slats are five strips, each evenly
bright, and have no thickness; its screens keep the light that meets the walls of a hole only in part, and spread what
they reflect evenly.
"""

from __future__ import annotations

import numpy as np
import pytest

from clerestory import Basis, trace
from clerestory.directions import SIDES

wincalc = pytest.importorskip("wincalc", reason="pywincalc is not installed")

BASIS = Basis.named("klems-full")
AREA = BASIS.projected_solid_angles
#: Normal, and four directions round each of three rings.
PATCHES = np.array([0, 1, 3, 5, 7, 25, 30, 35, 40, 69, 75, 81, 87])
SLATS = {"width_m": 0.08, "pitch_m": 0.072}


def ours(recipe, side: str, scatter: str) -> tuple[np.ndarray, np.ndarray]:
    """Direct-hemispherical values for light from the middles of the patches, and their standard errors."""
    incident = BASIS.incident_centres(side)[PATCHES]
    seen, _ = trace.scan(recipe, incident, trace.Settings(samples=16_384, seed=4))
    return np.array([s.total for s in seen if s.scatter == scatter]).T


def theirs(layer, side: str, scatter: str) -> np.ndarray:
    """The same by the other program."""
    return (AREA @ getattr(layer, scatter)[side])[PATCHES]


def blind(tilt_deg: float, reflectance: float) -> dict:
    """Flat, thin, diffuse slats."""
    return {
        "sample": {
            "kind": "venetian-blind",
            "pitch_mm": 72.0,
            "tilt_deg": tilt_deg,
            "slat": {"width_mm": 80.0, "upper": "slat"},
        },
        "materials": {"slat": {"kind": "lambertian", "reflectance": reflectance}},
    }


@pytest.mark.slow
@pytest.mark.parametrize(("tilt_deg", "reflectance", "most"), [(0.0, 0.0, 1e-6), (0.0, 0.5, 0.018), (45.0, 0.5, 0.018)])
def test_slats(tilt_deg, reflectance, most):
    """Black slats to the last digit; five strips a slat change what diffuse ones do by up to 1.6 %."""
    layer = wincalc.venetian(**SLATS, tilt_deg=tilt_deg, reflectance=reflectance)
    recipe = blind(tilt_deg, reflectance)
    for side in SIDES:
        for scatter in ("transmission", "reflection"):
            values, errors = ours(recipe, side, scatter)
            assert np.abs(values - theirs(layer, side, scatter)).max() < most + 4.0 * errors.max()
            assert errors.max() < 2e-3


@pytest.mark.slow
def test_holes_of_a_thin_sheet():
    """Straight through the holes alike; WinCalc's sheet is 0.5 mm thick, as is ours."""
    pitch, diameter, thickness = 0.004, 0.002, 0.0005
    layer = wincalc.perforated(pitch_m=pitch, diameter_m=diameter, reflectance=0.5)
    recipe = {
        "sample": {
            "kind": "perforated-screen",
            "pitch_mm": 1000 * pitch,
            "hole_mm": 1000 * diameter,
            "thickness_mm": 1000 * thickness,
            "exterior": "sheet",
        },
        "materials": {"sheet": {"kind": "lambertian", "reflectance": 0.5}},
    }
    for side in SIDES:
        values, errors = ours(recipe, side, "transmission")
        difference = np.abs(values - theirs(layer, side, "transmission"))
        assert difference[0] < 1e-3 + 4.0 * errors[0]
        assert difference.max() < 0.02 + 4.0 * errors.max()
