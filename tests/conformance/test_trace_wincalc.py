"""Slats, holes and yarns against LBNL's WinCalc, which solves them by view factors.

It takes light from the middle of each Klems patch, so light is sent from there. Its slats are five strips, each evenly
bright, and have no thickness. Its screens and cloths are formulas for what goes straight on; all other light meets one
surface once, and is spread evenly.
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


PITCH, HOLE, SHEET = 0.004, 0.002, 0.0005
SPACING, YARN = 0.0005, 0.0003


def screen(reflectance: float) -> dict:
    """Round holes in a square pattern."""
    return {
        "sample": {
            "kind": "perforated-screen",
            "pitch_mm": 1000 * PITCH,
            "hole_mm": 1000 * HOLE,
            "thickness_mm": 1000 * SHEET,
            "exterior": "sheet",
        },
        "materials": {"sheet": {"kind": "lambertian", "reflectance": reflectance}},
    }


def cloth(reflectance: float) -> dict:
    """A plain weave of round yarns."""
    yarn = {"per_cm": 0.01 / SPACING, "width_mm": 1000 * YARN, "thickness_mm": 1000 * YARN, "material": "yarn"}
    return {
        "sample": {"kind": "woven-fabric", "weave": "plain", "warp": yarn, "weft": yarn},
        "materials": {"yarn": {"kind": "lambertian", "reflectance": reflectance}},
    }


def slopes(side: str) -> np.ndarray:
    """Tangents of the profile angles to the side and upwards (2, patches)."""
    incident = BASIS.incident_centres(side)[PATCHES]
    return np.abs(incident[:, :2] / incident[:, 2:]).T


def test_holes_in_a_black_sheet():
    """What passes are two discs' overlap; WinCalc takes it to shrink evenly with the shift of one against the other."""
    layer = wincalc.perforated(pitch_m=PITCH, diameter_m=HOLE, reflectance=0.0)
    shift = np.hypot(*slopes("exterior")) * SHEET / HOLE
    hole = np.pi / 4.0 * (HOLE / PITCH) ** 2
    overlap = 2.0 / np.pi * (np.arccos(shift) - shift * np.sqrt(1.0 - shift**2))
    np.testing.assert_allclose(theirs(layer, "exterior", "transmission"), hole * (1.0 - shift), rtol=1e-9)
    values, errors = ours(screen(0.0), "exterior", "transmission")
    np.testing.assert_allclose(values, hole * overlap, atol=4.5 * errors.max())
    assert errors.max() < 1e-3


def test_straight_through_a_black_cloth():
    """Shadows of round yarns; WinCalc has them right for light from the sides, and too wide from above or below."""

    def open_share(slope: np.ndarray, diameter: float) -> np.ndarray:
        return np.clip(1.0 - diameter / SPACING * np.hypot(1.0, slope), 0.0, None)

    layer = wincalc.woven(diameter_m=YARN, pitch_m=SPACING, reflectance=0.0)
    aside, above = slopes("exterior")
    # Its profile angle upwards is atan(tan α / cos α), with the altitude α where the azimuth belongs.
    sine = np.abs(BASIS.incident_centres("exterior")[PATCHES][:, 1])
    wrong = sine / (1.0 - sine**2)
    expected = open_share(aside, YARN) * open_share(wrong, YARN)
    np.testing.assert_allclose(theirs(layer, "exterior", "transmission"), expected, atol=1e-9)
    assert (open_share(aside, YARN) * open_share(above, YARN) - expected).max() > 0.02
    # Yarns that go over and under each other cast wider shadows where they climb; ours have sixteen corners, which
    # makes them narrower by 0 to 2 %.
    climb = 0.5 * np.pi * YARN / SPACING * np.sin(np.pi * (np.arange(100) + 0.5) / 100)[:, None]
    bounds = [
        np.prod([open_share(slope * np.hypot(1.0, climb), width).mean(axis=0) for slope in (aside, above)], axis=0)
        for width in (YARN, YARN * np.cos(np.pi / 16.0))
    ]
    values, errors = ours(cloth(0.0), "exterior", "transmission")
    level = (aside < 1e-9) | (above < 1e-9)
    assert (bounds[0] - 4.5 * errors.max() < values)[level].all()
    # Farther off, shadows of neighbours at different heights overlap, and more passes.
    near = level & (np.hypot(aside, above) < 0.2)
    assert near.sum() == 5
    assert (values < bounds[1] + 4.5 * errors.max())[near].all()
    assert errors.max() < 2e-3


@pytest.mark.slow
def test_holes_of_a_thin_sheet():
    """Straight through the holes alike; WinCalc's sheet is 0.5 mm thick, as is ours."""
    layer = wincalc.perforated(pitch_m=PITCH, diameter_m=HOLE, reflectance=0.5)
    for side in SIDES:
        values, errors = ours(screen(0.5), side, "transmission")
        difference = np.abs(values - theirs(layer, side, "transmission"))
        assert difference[0] < 1e-3 + 4.0 * errors[0]
        assert difference.max() < 0.02 + 4.0 * errors.max()


@pytest.mark.slow
def test_a_grey_cloth():
    """Its scattered light is a formula fitted to traced cloths, and what is reflected is all else that is not absorbed.

    Of light that meets yarns a share equal to their reflectance goes on in WinCalc, as if none of it met a second yarn.
    """
    layer = wincalc.woven(diameter_m=YARN, pitch_m=SPACING, reflectance=0.5)
    sent = theirs(layer, "exterior", "transmission") + theirs(layer, "exterior", "reflection")
    black = theirs(wincalc.woven(diameter_m=YARN, pitch_m=SPACING, reflectance=0.0), "exterior", "transmission")
    np.testing.assert_allclose(sent - black, 0.5 * (1.0 - black), atol=1e-9)
    for scatter, low, high in (("transmission", -0.025, 0.025), ("reflection", 0.08, 0.14)):
        values, errors = ours(cloth(0.5), "exterior", scatter)
        more = theirs(layer, "exterior", scatter) - values
        assert (more > low - 4.0 * errors).all()
        assert (more < high + 4.0 * errors).all()
