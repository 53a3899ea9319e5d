"""Window systems of three layers on Klems full: ours beside pywincalc."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pywincalc

from clerestory import Basis, Bsdf, Model
from clerestory.system import pane_from_normal, stack
from timing import Pair, row, seconds, table

SYSTEMS = 100
REPETITIONS = 5
STANDARD = Path(pywincalc.__file__).parent / "standards" / "W5_NFRC_2003.std"
PANE = (0.85, 0.08)
SIDES = ("exterior", "interior")


def _shade(number: int) -> tuple[float, float]:
    """Transmittance and reflectance of a diffuser."""
    return 0.05 + 0.003 * number, 0.3 + 0.003 * number


def _ours(basis: Basis) -> float:
    """Visible transmittances along the normal of all systems, summed."""
    pane = pane_from_normal(*PANE)
    incident = basis.incident_centres("exterior")[:1]
    total = 0.0
    for number in range(SYSTEMS):
        t, r = _shade(number)
        n = len(basis)
        models = {
            (side, scatter): Model.matrix(np.full((n, n), value / np.pi), basis)
            for side in SIDES
            for scatter, value in (("transmission", t), ("reflection", r))
        }
        system = stack([pane, Bsdf.from_models(models), pane], basis)  # type: ignore[arg-type]
        system.absorptance()
        total += float(system.bsdf.integrate(incident, "transmission")[0])
    return total


def _layer(material: Any, points: list[Any], **component: Any) -> Any:
    return pywincalc.ProductDataOpticalNBand(
        material_type=material,
        thickness_meters=0.003,
        wavelength_data=points,
        ir_transmittance_front=0.0,
        ir_transmittance_back=0.0,
        emissivity_front=0.84,
        emissivity_back=0.84,
        **component,
    )


def _point(wavelength: float, t: float, r: float) -> Any:
    component = pywincalc.OpticalMeasurementComponent(t, t, r, r)
    return pywincalc.WavelengthData(wavelength, direct_component=component)


def _theirs(hemisphere: Any, standard: Any) -> float:
    """The same; the visible band of grey layers, so that few wavelengths are enough."""
    wavelengths = (0.38, 0.55, 0.78)
    thermal = pywincalc.ProductDataThermal(1.0, 0.003)
    optical = _layer(pywincalc.MaterialType.MONOLITHIC, [_point(w, *PANE) for w in wavelengths])
    glass = pywincalc.ProductDataOpticalAndThermal(optical, thermal)
    total = 0.0
    for number in range(SYSTEMS):
        points = [_point(w, *_shade(number)) for w in wavelengths]
        scatterer = _layer(pywincalc.MaterialType.MONOLITHIC, points)
        shade = pywincalc.create_perfectly_diffuse_shade(scatterer, thermal)
        system = pywincalc.GlazingSystem(
            solid_layers=[glass, shade, glass],
            gap_layers=[pywincalc.Gap(pywincalc.PredefinedGasType.AIR, 0.0127)] * 2,
            optical_standard=standard,
            bsdf_hemisphere=hemisphere,
        )
        found = system.optical_method_results("PHOTOPIC").system_results.front.transmittance
        total += float(np.sum(np.array(found.matrix)[:, 0] * np.array(hemisphere_lambdas(hemisphere))))
    return total


def hemisphere_lambdas(_: Any) -> np.ndarray:
    """Projected solid angles of the patches."""
    return Basis.named("klems-full").projected_solid_angles


def report(_: Path) -> str:
    """Text of the section."""
    basis = Basis.named("klems-full")
    hemisphere = pywincalc.BSDFHemisphere.create(pywincalc.BSDFBasisType.FULL)
    standard = pywincalc.load_standard(str(STANDARD))
    ours, theirs = [], []
    found = _ours(basis), _theirs(hemisphere, standard)
    for _repetition in range(REPETITIONS):
        ours.append(seconds(lambda: _ours(basis)))
        theirs.append(seconds(lambda: _theirs(hemisphere, standard)))
    rows = [row(f"{SYSTEMS} systems", Pair(ours, theirs), unit=1.0, digits=2)]
    difference = abs(found[0] - found[1]) / SYSTEMS
    return f"""### Layers to windows on Klems full

Aim: at least 10 times. {SYSTEMS} windows of a pane, a diffuser and a pane, each with 145 × 145 matrices of both sides and
with what each layer absorbs; one band here, the visible band of grey layers at three wavelengths there. The mean
transmittance along the normal differs by {difference:.1e}.

{table(["job", "Clerestory [s]", "pywincalc [s]", "ratio", "spread"], rows)}
"""
