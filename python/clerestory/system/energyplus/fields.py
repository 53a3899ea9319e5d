"""Fields of EnergyPlus' objects in the order of its data dictionary (`Energy+.idd`, 25.2), and their JSON names.

JSON names are those of `Energy+.schema.epJSON`: the words of the field in lower case, joined by underscores.
"""

from __future__ import annotations

import re

VERSION = "25.2"
"""Of EnergyPlus."""
LAYERS = 5
"""Solid layers that a state can have."""

_STATE = [
    "Basis Type",
    "Basis Symmetry Type",
    "Window Thermal Model",
    "Basis Matrix Name",
    "Solar Optical Complex Front Transmittance Matrix Name",
    "Solar Optical Complex Back Reflectance Matrix Name",
    "Visible Optical Complex Front Transmittance Matrix Name",
    "Visible Optical Complex Back Transmittance Matrix Name",
    "Outside Layer Name",
    "Outside Layer Directional Front Absorptance Matrix Name",
    "Outside Layer Directional Back Absorptance Matrix Name",
]
for _gap in range(1, LAYERS):
    _first = "CFS " if _gap == 1 else ""
    _STATE += [
        f"Gap {_gap} Name",
        f"{_first}Gap {_gap} Directional Front Absorptance Matrix Name",
        f"{_first}Gap {_gap} Directional Back Absorptance Matrix Name",
        f"Layer {_gap + 1} Name",
        f"Layer {_gap + 1} Directional Front Absorptance Matrix Name",
        f"Layer {_gap + 1} Directional Back Absorptance Matrix Name",
    ]

FIELDS: dict[str, tuple[str, ...]] = {
    "Construction:ComplexFenestrationState": tuple(_STATE),
    "WindowThermalModel:Params": ("standard", "Thermal Model", "SDScalar", "Deflection Model"),
    "Matrix:TwoDimension": ("Number of Rows", "Number of Columns"),
    "WindowMaterial:Glazing": (
        "Optical Data Type",
        "Window Glass Spectral Data Set Name",
        "Thickness",
        "Solar Transmittance at Normal Incidence",
        "Front Side Solar Reflectance at Normal Incidence",
        "Back Side Solar Reflectance at Normal Incidence",
        "Visible Transmittance at Normal Incidence",
        "Front Side Visible Reflectance at Normal Incidence",
        "Back Side Visible Reflectance at Normal Incidence",
        "Infrared Transmittance at Normal Incidence",
        "Front Side Infrared Hemispherical Emissivity",
        "Back Side Infrared Hemispherical Emissivity",
        "Conductivity",
    ),
    "WindowMaterial:ComplexShade": (
        "Layer Type",
        "Thickness",
        "Conductivity",
        "IR Transmittance",
        "Front Emissivity",
        "Back Emissivity",
        "Top Opening Multiplier",
        "Bottom Opening Multiplier",
        "Left Side Opening Multiplier",
        "Right Side Opening Multiplier",
        "Front Opening Multiplier",
    ),
    "WindowMaterial:Gap": ("Thickness", "Gas (or Gas Mixture)", "Pressure"),
    "WindowMaterial:Gas": ("Gas Type", "Thickness"),
    "WindowMaterial:GasMixture": (
        "Thickness",
        "Number of Gases in Mixture",
        *(f"Gas {k} {what}" for k in range(1, 5) for what in ("Type", "Fraction")),
    ),
}
"""Words of the fields after the name, by object; a matrix goes on with its values."""


def json_name(field: str) -> str:
    """A field's name in epJSON."""
    return re.sub(r"[^0-9a-z]+", "_", field.lower())
