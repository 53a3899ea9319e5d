"""What heat asks of a layer from a recipe of the virtual goniophotometer."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from clerestory.directions import SIDES
from clerestory.integrals import hemispherical
from clerestory.system.glass import Thermal
from clerestory.thermal.layer import permeability_of_slats
from clerestory.trace.kinds.blind import VenetianBlind

if TYPE_CHECKING:
    from clerestory.bsdf import Bsdf
    from clerestory.trace import Sample

BAND = "thermal"
"""Band of a recipe that holds long-wave values of its materials."""


def traced_thermal(sample: Sample, measured: Bsdf) -> Thermal:
    """Thickness and openness by the sample's shape, emissivities and long-wave transmittance by its band thermal.

    Parameters
    ----------
    sample
        The sample.
    measured
        What the virtual goniophotometer found of it. With a band thermal, ε = 1 − T − R of evenly diffuse radiation.
    """
    low, high = sample.depth_m
    found = Thermal(thickness_m=high - low, openness=sample.openness)
    kind = sample.recipe.sample
    if isinstance(kind, VenetianBlind):
        slat = kind.slat
        found = replace(
            found,
            slat_tilt_deg=kind.tilt_deg,
            openness=permeability_of_slats(
                slat.width_mm / 1000.0,
                kind.pitch_mm / 1000.0,
                kind.tilt_deg,
                slat.thickness_mm / 1000.0,
                abs(slat.crown_mm) / 1000.0,
            ),
        )
    if BAND not in measured.bands:
        return found
    passed = hemispherical(measured, "transmission", side=SIDES[0], band=BAND).value
    outer, inner = (1.0 - passed - hemispherical(measured, "reflection", side=side, band=BAND).value for side in SIDES)
    return replace(found, tir=passed, emissivity_exterior=outer, emissivity_interior=inner)
