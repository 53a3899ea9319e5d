"""Layers put together against rays traced through the same stack: panes with blinds, cloth and screens.

Gaps are wide against the period of what scatters, so that a beam that comes back meets it anywhere, as layering takes
it.
"""

import numpy as np
import pytest

from clerestory import Basis, Bsdf, trace
from clerestory.system import Layer, Plate, Sheet, Window

BASIS = Basis.named("klems-full")
PATHS = 1 << 13
MEDIA = {"glass": {"index": 1.52, "absorption_per_m": 8.0}}
MATERIALS = {"paint": {"kind": "lambertian", "reflectance": 0.6}}
YARN = {"per_cm": 10.0, "width_mm": 0.35, "thickness_mm": 0.2, "material": "paint"}
PANE = {"kind": "pane", "thickness_mm": 6.0, "medium": "glass"}
SHADES = {
    "open blind": {
        "kind": "venetian-blind",
        "pitch_mm": 12.0,
        "tilt_deg": 0.0,
        "slat": {"width_mm": 8.0, "upper": "paint", "lower": "paint"},
    },
    "blind": {
        "kind": "venetian-blind",
        "pitch_mm": 12.0,
        "tilt_deg": 25.0,
        "slat": {"width_mm": 16.0, "upper": "paint", "lower": "paint"},
    },
    "cloth": {"kind": "woven-fabric", "weave": "plain", "warp": YARN, "weft": YARN},
    "screen": {
        "kind": "perforated-screen",
        "pitch_mm": 4.0,
        "hole_mm": 3.0,
        "thickness_mm": 0.5,
        "exterior": "paint",
    },
}


def measured(sample: dict, **more: object) -> Bsdf:
    return trace.measure({"sample": sample, "materials": MATERIALS, **more}, basis=BASIS, samples=PATHS, seed=3)


@pytest.fixture(scope="module", params=sorted(SHADES))
def both(request) -> tuple[Bsdf, Bsdf, Bsdf]:
    """The stack traced as one, and from its layers: sharp, and on patches."""
    shade = SHADES[request.param]
    stacked = measured({"kind": "layers", "layers": [PANE, {**shade, "z_mm": 200.0}]}, media=MEDIA)
    wavelength = np.array([250.0, 2600.0])
    glass = Plate("pane", (Sheet(wavelength, 1.52, 8.0 * wavelength * 1e-9 / (4 * np.pi), 0.006),))
    window = Window([Layer("pane", pane=glass), Layer("shade", bsdf=measured(shade))])
    patches = window.solve(BASIS, spectral=False, specular="mean")
    return stacked, window.sharpened(basis=BASIS), patches.bsdf


@pytest.mark.slow
@pytest.mark.parametrize("side", ["exterior", "interior"])
def test_direct_hemispherical_values_and_peaks(both, side):
    traced, sharp, patches = both
    # Beyond, beams change much within a patch: those of the layer are known as means over it.
    chosen = np.flatnonzero(np.repeat([r[2] for r in BASIS.rings], [r[3] for r in BASIS.rings]) < 65.0)
    centres = BASIS.incident_centres(side)[chosen]
    steps = (np.arange(4) + 0.5) / 4
    u = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 2)
    incident = np.stack([BASIS.sample_incident(int(k), u, side) for k in chosen])
    for made in (sharp, patches):
        expected, error = traced.integrate_with_error(centres, "transmission")
        found = made.integrate(incident, "transmission").mean(axis=-1)
        assert (np.abs(found - expected) <= 0.01 * expected + 3.5 * error).all()
        # All directions together know more: within 1 % of the mean, far beyond its error.
        assert found.mean() == pytest.approx(expected.mean(), rel=0.004)
        reflected = traced.integrate(centres, "reflection").mean()
        assert made.integrate(incident, "reflection").mean() == pytest.approx(reflected, rel=0.01)
    beam, error = traced.integrate_with_error(centres, "transmission", part="direct")
    error = np.sqrt(2.0) * error  # of the traced layer too
    found = sharp.integrate(incident, "transmission", part="direct").mean(axis=-1)
    strong = beam > 0.05
    assert beam.max() > 0.35
    assert (np.abs(found - beam) <= 0.01 * beam + 3.5 * error)[strong].all()
    assert found[strong].mean() == pytest.approx(beam[strong].mean(), rel=0.005)
