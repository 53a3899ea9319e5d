"""LBNL's WinCalc as peer for shading layers of one homogeneous, diffuse material."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pywincalc

#: The materials are grey.
WAVELENGTHS_UM = (0.3, 2.5)
EMISSIVITY, CONDUCTIVITY = 0.9, 160.0
#: Clear glass of 3 mm, as if grey; along the normal.
PANE = {"transmittance": 0.834, "reflectance": 0.075}
STANDARD = Path(pywincalc.__file__).parent / "standards" / "W5_NFRC_2003.std"


@dataclass(frozen=True)
class Layer:
    """Visible values of a layer on the Klems full basis."""

    transmission: dict[str, np.ndarray]
    """BSDF by side of incidence [1/sr] (outgoing, incident)."""
    reflection: dict[str, np.ndarray]
    product: Any
    """The layer itself."""


@dataclass(frozen=True)
class Heat:
    """Of a window with a layer in the room behind two clear panes, on the Klems quarter basis."""

    u: float
    """NFRC's winter [W/(m² K)]."""
    g: float
    """NFRC's summer, along the normal."""
    g_above: float
    """The same for the sun 54° above the normal, the middle of a patch."""


def _grey(transmittance: float, reflectance: float, emissivity: float, thickness_m: float, conductivity: float) -> Any:
    points = [
        pywincalc.WavelengthData(
            w,
            direct_component=pywincalc.OpticalMeasurementComponent(
                transmittance, transmittance, reflectance, reflectance
            ),
        )
        for w in WAVELENGTHS_UM
    ]
    optical = pywincalc.ProductDataOpticalNBand(
        material_type=pywincalc.MaterialType.MONOLITHIC,
        thickness_meters=thickness_m,
        wavelength_data=points,
        ir_transmittance_front=0.0,
        ir_transmittance_back=0.0,
        emissivity_front=emissivity,
        emissivity_back=emissivity,
        coated_side=pywincalc.CoatedSide.NEITHER,
    )
    return optical, pywincalc.ProductDataThermal(conductivity, thickness_m)


def _material(reflectance: float) -> Any:
    return _grey(0.0, reflectance, EMISSIVITY, 0.0005, CONDUCTIVITY)


def behind_panes(layer: Layer) -> Heat:
    """Heat through two panes as `PANE` has them, 12.7 mm of air, the layer 12.7 mm behind them."""
    pane = pywincalc.ProductDataOpticalAndThermal(*_grey(*PANE.values(), 0.84, 0.003, 1.0))
    gap = pywincalc.Layers.gap(thickness=0.0127)
    system = pywincalc.GlazingSystem(
        solid_layers=[pane, pane, layer.product],
        gap_layers=[gap, gap],
        optical_standard=pywincalc.load_standard(str(STANDARD)),
        bsdf_hemisphere=pywincalc.BSDFHemisphere.create(pywincalc.BSDFBasisType.QUARTER),
        environment=pywincalc.nfrc_u_environments(),
    )
    u = system.u()
    system.environments(pywincalc.nfrc_shgc_environments())
    return Heat(u, system.shgc(), system.shgc(theta=54.0, phi=270.0))


def _solved(product: Any) -> Layer:
    system = pywincalc.GlazingSystem(
        solid_layers=[product],
        optical_standard=pywincalc.load_standard(str(STANDARD)),
        bsdf_hemisphere=pywincalc.BSDFHemisphere.create(pywincalc.BSDFBasisType.FULL),
    )
    found = system.optical_method_results("PHOTOPIC").system_results
    sides = {"exterior": found.front, "interior": found.back}
    return Layer(
        {side: np.array(values.transmittance.matrix) for side, values in sides.items()},
        {side: np.array(values.reflectance.matrix) for side, values in sides.items()},
        product,
    )


def venetian(*, width_m: float, pitch_m: float, tilt_deg: float, reflectance: float, segments: int = 5) -> Layer:
    """Flat slats, their tilt positive with the outer edge down."""
    geometry = pywincalc.VenetianGeometry(
        tilt_deg,
        width_m,
        pitch_m,
        0.0,
        True,
        pywincalc.DistributionMethodType.DIRECTIONAL_DIFFUSE,
        segments,
    )
    return _solved(pywincalc.create_venetian_blind(geometry, *_material(reflectance)))


def woven(*, diameter_m: float, pitch_m: float, reflectance: float) -> Layer:
    """Round yarns, as many up as across. The model takes no notice of the cloth's thickness."""
    geometry = pywincalc.WovenGeometry(diameter_m, pitch_m, 2.0 * diameter_m)
    return _solved(pywincalc.create_woven_shade(geometry, *_material(reflectance)))


def perforated(*, pitch_m: float, diameter_m: float, reflectance: float) -> Layer:
    """Round holes in a square pattern in a sheet of 0.5 mm. WinCalc takes radii for dimensions."""
    geometry = pywincalc.PerforatedGeometry(
        pitch_m, pitch_m, diameter_m / 2.0, diameter_m / 2.0, pywincalc.PerforatedGeometry.Type.CIRCULAR
    )
    return _solved(pywincalc.create_perforated_screen(geometry, *_material(reflectance)))
