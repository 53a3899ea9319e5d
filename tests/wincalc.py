"""LBNL's WinCalc as peer for shading layers of one homogeneous, diffuse material."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pywincalc

#: Steps of 100 nm: the material is grey.
WAVELENGTHS_UM = np.arange(0.3, 2.51, 0.1)
STANDARD = Path(pywincalc.__file__).parent / "standards" / "W5_NFRC_2003.std"


@dataclass(frozen=True)
class Layer:
    """Visible values of a layer on the Klems full basis."""

    transmission: dict[str, np.ndarray]
    """BSDF by side of incidence [1/sr] (outgoing, incident)."""
    reflection: dict[str, np.ndarray]


def _material(reflectance: float) -> tuple[Any, Any]:
    points = [
        pywincalc.WavelengthData(
            float(w),
            direct_component=pywincalc.OpticalMeasurementComponent(0.0, 0.0, reflectance, reflectance),
        )
        for w in WAVELENGTHS_UM
    ]
    optical = pywincalc.ProductDataOpticalNBand(
        material_type=pywincalc.MaterialType.MONOLITHIC,
        thickness_meters=0.0005,
        wavelength_data=points,
        ir_transmittance_front=0.0,
        ir_transmittance_back=0.0,
        emissivity_front=0.9,
        emissivity_back=0.9,
    )
    return optical, pywincalc.ProductDataThermal(160.0, 0.0005)


def _solved(layer: Any) -> Layer:
    system = pywincalc.GlazingSystem(
        solid_layers=[layer],
        optical_standard=pywincalc.load_standard(str(STANDARD)),
        bsdf_hemisphere=pywincalc.BSDFHemisphere.create(pywincalc.BSDFBasisType.FULL),
    )
    found = system.optical_method_results("PHOTOPIC").system_results
    sides = {"exterior": found.front, "interior": found.back}
    return Layer(
        {side: np.array(values.transmittance.matrix) for side, values in sides.items()},
        {side: np.array(values.reflectance.matrix) for side, values in sides.items()},
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


def perforated(*, pitch_m: float, diameter_m: float, reflectance: float) -> Layer:
    """Round holes in a square pattern in a sheet of 0.5 mm. WinCalc takes radii for dimensions."""
    geometry = pywincalc.PerforatedGeometry(
        pitch_m, pitch_m, diameter_m / 2.0, diameter_m / 2.0, pywincalc.PerforatedGeometry.Type.CIRCULAR
    )
    return _solved(pywincalc.create_perforated_screen(geometry, *_material(reflectance)))
