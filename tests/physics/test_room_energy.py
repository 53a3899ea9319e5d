"""Light that a window sends into a room is what its data set lets through, for every kind of model."""

from __future__ import annotations

import numpy as np
import pytest

from clerestory import Bsdf, room
from clerestory.directions import direction
from registry import CASES, Case

#: Illuminance of an even sky and ground on any plane [lx], for a luminance of 1000 cd/m².
OUTSIDE = np.pi * 1000.0
SENDING = [c for c in CASES.values() if ("exterior", "transmission") in next(iter(c.bsdf.models.values()))]


#: Random models are scaled so that light from the interior is conserved, too.
SHARE = 0.25


def sending(case: Case) -> Bsdf:
    """Its transmission alone: what the window reflects is not asked for."""
    band = next(iter(case.bsdf.models.values()))
    return Bsdf.from_models({("exterior", "transmission"): band["exterior", "transmission"].scaled(SHARE)})


def hemispherical(bsdf: Bsdf) -> float:
    """Diffuse-hemispherical transmittance by 4,096 directions of equal projected solid angle."""
    n = 64
    u, v = ((np.arange(n * n) + 0.5) / n**2, (np.arange(n * n) * 0.5 * (np.sqrt(5.0) - 1.0)) % 1.0)
    theta, phi = np.degrees(np.arcsin(np.sqrt(u))), 360.0 * v
    incident = np.array([direction(t, p, side="exterior") for t, p in zip(theta, phi, strict=True)])
    return float(np.mean(bsdf.integrate(incident, "transmission")))


@pytest.mark.parametrize("case", SENDING, ids=lambda case: case.name)
def test_a_window_sends_what_it_lets_through(case, tmp_path):
    """Irradiance just behind a large window under an even sky: within 0.5 % and four standard errors."""
    path = tmp_path / "window.bsdf.npz"
    bsdf = sending(case)
    bsdf.write(path)
    corners = [[-50.0, 0.0, -50.0], [-50.0, 0.0, 50.0], [50.0, 0.0, 50.0], [50.0, 0.0, -50.0]]
    made = room.load(
        {
            "sky": {"kind": "uniform", "zenith_luminance": 1000.0, "ground_reflectance": 1.0},
            "room": {"width_m": 1.0, "depth_m": 1.0, "height_m": 1.0, "floor": 0.0, "walls": 0.0, "ceiling": 0.0},
            "windows": {"w": {"corners_m": corners, "system": "w"}},
            "systems": {"w": {"file": str(path), "treatment": "high"}},
        }
    )
    # Beside the black box, which is small and far, so that the window fills the view.
    behind = np.array([[20.0, 0.01, 20.0]])
    found = made.illuminance(points=behind, normals=np.array([[0.0, -1.0, 0.0]]), samples=1 << 13)
    expected = OUTSIDE * hemispherical(bsdf)
    assert abs(found.values[0] - expected) <= 0.005 * expected + 4.0 * found.standard_errors[0] + 1e-9
