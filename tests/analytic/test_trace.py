"""Samples whose scattering has a closed form, measured by the virtual goniophotometer.

Every value is compared in units of its own standard error. All scores of the suite together must pass at 1 % (Šidák),
and their variance must lie in 0.7 to 1.4, so that errors that are too large fail too.
"""

from __future__ import annotations

import math
from statistics import NormalDist

import numpy as np
import pytest

from clerestory import Basis, trace
from clerestory.annual.control.slats import Slats
from clerestory.directions import SIDES

BASIS = Basis.named("klems-full")
# Points a patch for the mean of a closed form over it.
GRID = 300
SAMPLES = 65536
#: All scores, to be judged together.
SCORES: list[np.ndarray] = []

PITCH, WIDTH = 72.0, 80.0


def black(tilt_deg: float) -> dict:
    """Flat slats that absorb everything."""
    return blind({"kind": "black"}, tilt_deg)


def blind(material: dict, tilt_deg: float = 0.0) -> dict:
    """Flat slats."""
    return {
        "sample": {
            "kind": "venetian-blind",
            "pitch_mm": PITCH,
            "tilt_deg": tilt_deg,
            "slat": {"width_mm": WIDTH, "upper": "slat"},
        },
        "materials": {"slat": material},
    }


def mean_over_patches(function, side: str) -> np.ndarray:
    """Mean of a function of incident directions over each patch, light evenly spread by projected solid angle."""
    u = (np.arange(GRID) + 0.5) / GRID
    u = np.stack(np.meshgrid(u, u, indexing="ij"), axis=-1).reshape(-1, 2)
    return np.array([function(BASIS.sample_incident(k, u, side=side)).mean() for k in range(len(BASIS))])


def profile_slope(incident: np.ndarray, side: str) -> np.ndarray:
    """Tangent of the profile angle Ω, positive for light from above (methods of shading calculation)."""
    del side
    return incident[:, 1] / np.abs(incident[:, 2])


def scores(recipe, expected, scatter: str = "transmission", samples: int = SAMPLES) -> None:
    """Compares direct-hemispherical values from all patches of both sides, and keeps the scores."""
    bsdf = trace.measure(recipe, samples=samples, seed=11)
    for side in SIDES:
        values, errors = bsdf.integrate_with_error(BASIS.incident_centres(side), scatter)
        truth = expected(side)
        # Where few paths or all of them pass there is no score, but there is the truth.
        few = np.minimum(truth, 1.0 - truth) < 20.0 / SAMPLES
        assert np.abs(values - truth)[few].max(initial=0.0) < 20.0 / SAMPLES
        assert errors.max() < 1e-3
        SCORES.append((values - truth)[~few] / errors[~few])


@pytest.mark.parametrize("tilt_deg", [0.0, 15.0, 45.0, -30.0, 80.0])
def test_black_slats(tilt_deg):
    """τ = 1 − W |sin(φ + Ω)| / (S cos Ω), and nothing is scattered."""

    def transmittance(side):
        def of(incident):
            slope = profile_slope(incident, side)
            omega = np.arctan(slope)
            towards = 1.0 if side == "exterior" else -1.0
            across = np.abs(np.sin(math.radians(tilt_deg) + towards * omega)) / np.cos(omega)
            return np.maximum(0.0, 1.0 - WIDTH / PITCH * across)

        return mean_over_patches(of, side)

    scores(black(tilt_deg), transmittance)


@pytest.mark.parametrize(("tilt_deg", "crown"), [(0.0, 10.0), (35.0, -10.0)])
def test_black_curved_slats(tilt_deg, crown):
    """What passes is what the geometry of control curves says."""
    slats = Slats(WIDTH, PITCH, crown)

    def transmittance(side):
        towards = 1.0 if side == "exterior" else -1.0

        def of(incident):
            omega = np.arctan(profile_slope(incident, side))
            return slats.passed(towards * math.radians(tilt_deg), omega)

        return mean_over_patches(of, side)

    recipe = black(tilt_deg)
    recipe["sample"]["slat"]["crown_mm"] = crown
    scores(recipe, transmittance)


@pytest.mark.parametrize("reflectance", [0.9, 0.4])
def test_mirror_slats(reflectance):
    """Between level mirrors a ray is reflected ⌊x⌋ or ⌊x⌋ + 1 times, x = W tan Ω / S, and always passes."""

    def transmittance(side):
        def of(incident):
            x = WIDTH / PITCH * np.abs(profile_slope(incident, side))
            whole = np.floor(x)
            return reflectance**whole * (1.0 - (x - whole) * (1.0 - reflectance))

        return mean_over_patches(of, side)

    scores(blind({"kind": "mirror", "reflectance": reflectance}), transmittance, samples=2 * SAMPLES)


def test_diffuse_slats_are_what_radiosity_says():
    """Diffuse-hemispherical transmittance of level slats, by radiosity on 2,000 strips a face."""
    reflectance = 0.7
    bsdf = trace.measure(blind({"kind": "lambertian", "reflectance": reflectance}), samples=SAMPLES, seed=3)
    expected = _radiosity(reflectance)
    weights = BASIS.projected_solid_angles / np.pi
    for side in SIDES:
        values, errors = bsdf.integrate_with_error(BASIS.incident_centres(side), "transmission")
        error = math.sqrt(weights**2 @ errors**2)
        assert error < 2e-4
        assert weights @ values == pytest.approx(expected, abs=4 * error)


def _radiosity(reflectance: float, strips: int = 2000) -> float:
    """Transmittance for even light; two equal faces see each other and both openings (crossed strings)."""
    z = np.linspace(0.0, WIDTH, strips + 1)
    step = WIDTH / strips

    def string(a, b):
        return np.hypot(a - b, PITCH)

    a0, a1, b0, b1 = z[:-1, None], z[1:, None], z[None, :-1], z[None, 1:]
    between = (string(a0, b1) + string(a1, b0) - string(a0, b0) - string(a1, b1)) / (2.0 * step)
    # From an opening to each strip of one face.
    near, far = z[:-1], z[1:]
    entry = (far + np.hypot(near, PITCH) - near - np.hypot(far, PITCH)) / (2.0 * PITCH)
    flux = np.linalg.solve(np.eye(strips) - reflectance * between, reflectance * entry * PITCH / step)
    direct = (math.hypot(WIDTH, PITCH) - WIDTH) / PITCH
    return float(direct + 2.0 * (flux * entry[::-1]).sum())


@pytest.mark.parametrize("absorption", [0.0, 30.0])
def test_glass_plate(absorption):
    """The series of inner reflections of each polarisation, with the absorbed share of each passage."""
    index, thickness = 1.52, 0.006
    recipe = {
        "sample": {"kind": "pane", "thickness_mm": 1000.0 * thickness, "medium": "glass"},
        "media": {"glass": {"index": index, "absorption_per_m": absorption}},
    }

    def both(incident):
        cos = np.abs(incident[:, 2])
        inside = np.sqrt(1.0 - (1.0 - cos**2) / index**2)
        passed = np.exp(-absorption * thickness / inside)
        t, r = [], []
        for ratio in ((cos - index * inside) / (cos + index * inside), (index * cos - inside) / (index * cos + inside)):
            face = ratio**2
            through = (1.0 - face) ** 2 * passed / (1.0 - (face * passed) ** 2)
            t.append(through)
            r.append(face + face * passed * through)
        return np.mean(t, axis=0), np.mean(r, axis=0)

    for k, scatter in enumerate(("transmission", "reflection")):
        scores(recipe, lambda side, k=k: mean_over_patches(lambda i: both(i)[k], side), scatter)


def test_all_scores_together():
    """Runs last in this file: no score is too large, and the errors are neither too small nor too large."""
    found = np.concatenate(SCORES)
    assert len(found) > 1000
    limit = NormalDist().inv_cdf(0.5 * (1.0 + 0.99 ** (1.0 / len(found))))
    # With 16 replications a score follows Student's distribution of 15 degrees of freedom.
    worst = np.abs(_as_normal(found, 15)).max()
    assert worst < limit, (worst, limit)
    assert 0.7 < found.var() < 1.4


def _as_normal(t: np.ndarray, freedom: int) -> np.ndarray:
    """Scores of Student's distribution as normal ones (Wallace 1959, equation 5.7)."""
    n = float(freedom)
    return np.sign(t) * (8.0 * n + 1.0) / (8.0 * n + 3.0) * np.sqrt(n * np.log1p(t**2 / n))
