"""Layered systems against results of LBNL's WinCalc: 3 mm clear glass before a woven shade, and the glass alone.

WinCalc solves the stack wavelength by wavelength and weights by D65 and the photopic observer afterwards; so does the
test. The pane is rebuilt from its spectral normal-incidence data.
"""

import gzip
import json
from pathlib import Path

import numpy as np
import pytest

import clerestory
from clerestory import Basis, Bsdf
from clerestory.system import System, pane_from_normal, stack

RESULTS = "2_layers__nfrc_102_air_bsdf_xml__thermal_openness_0.01_top_and_bottom__full_basis__photopic.json.gz"
BASIS = Basis.named("klems-full")
AREA = BASIS.projected_solid_angles
# Reflectances of the real pane's faces differ by up to 0.001; ours has the mean of both. Transmission agrees to 3e-6.
TOLERANCE = 5e-5


def columns(path: Path) -> np.ndarray:
    rows = (line.split() for line in path.read_text().splitlines() if not line.startswith("{"))
    rows = [row for row in rows if len(row) >= 2 and row[0].replace(".", "", 1).isdigit()]
    return np.array(rows, dtype=float)


@pytest.fixture(scope="module")
def expected(sample_data):
    text = gzip.decompress((sample_data / "glazing/expected_wincalc/matrices" / RESULTS).read_bytes())
    return json.loads(text)


@pytest.fixture(scope="module")
def spectral(sample_data) -> list[tuple[float, System]]:
    """Photopic weights and systems of glass and shade."""
    glass = columns(sample_data / "glazing/products/CLEAR_3.DAT")
    source = columns(sample_data / "glazing/standards/ASTM_E308_Illuminant_D65.ssp")
    eye = columns(sample_data / "glazing/standards/ASTM_E308_1931_Y.dsp")
    shade = clerestory.read(sample_data / "klems/2011-SA1.XML.gz")
    shade = Bsdf.from_models(shade.models["visible"])
    # 20 nm steps are enough for so flat a spectrum.
    wavelengths = np.arange(0.40, 0.75, 0.02)
    weights = np.interp(wavelengths, source[:, 0], source[:, 1]) * np.interp(wavelengths, eye[:, 0], eye[:, 1])
    weights /= weights.sum()
    t = np.interp(wavelengths, glass[:, 0], glass[:, 1])
    r = np.interp(wavelengths, glass[:, 0], glass[:, 2:].mean(axis=1))
    panes = [pane_from_normal(*values) for values in zip(t, r, strict=True)]
    return [(w, stack([pane, shade], BASIS)) for w, pane in zip(weights, panes, strict=True)]


def matrix(system: Bsdf, side: str, scatter: str) -> np.ndarray:
    """Scattered light and beams as one matrix [1/sr] (outgoing, incident)."""
    incident = BASIS.incident_centres(side)
    opposite = "interior" if side == "exterior" else "exterior"
    outgoing = BASIS.outgoing_centres(side if scatter == "reflection" else opposite)
    beams = system.integrate(incident, scatter, part="direct")
    return system.evaluate(incident[None, :, :], outgoing[:, None, :]) + np.diag(beams / AREA)


@pytest.mark.parametrize("scatter", ["transmission", "reflection"])
@pytest.mark.parametrize("side", ["exterior", "interior"])
def test_system_matrices(spectral, expected, side, scatter):
    ours = sum(w * matrix(system.bsdf, side, scatter) for w, system in spectral)
    word = {"transmission": "transmittance", "reflection": "reflectance"}[scatter]
    theirs = np.array(expected["system_results"][{"exterior": "front", "interior": "back"}[side]][word]["matrix"])
    flux = AREA[:, None] * (ours - theirs)
    assert np.abs(flux).max() < TOLERANCE
    assert np.abs(flux.sum(axis=0)).max() < TOLERANCE


@pytest.mark.parametrize("side", ["exterior", "interior"])
def test_layer_absorptances(spectral, expected, side):
    ours = sum(w * system.absorptance(side=side) for w, system in spectral)
    for k in range(2):
        theirs = expected["layer_results"][f"layer {k}"][{"exterior": "front", "interior": "back"}[side]]["absorptance"]
        assert ours[k, 0] == pytest.approx(theirs["total_direct"], abs=TOLERANCE)
        diffuse = ours[k] @ AREA / AREA.sum()
        assert diffuse == pytest.approx(theirs["total_diffuse"], abs=TOLERANCE)
