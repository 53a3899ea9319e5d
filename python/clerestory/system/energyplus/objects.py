"""A solved window as EnergyPlus' objects.

Conventions of EnergyPlus, as its source has them (`WindowComplexManager.cc`, `MatrixDataManager.cc`) and runs confirm:

- A matrix is read row by row. For the sun's beam a row is an outgoing patch and a column an incident one, as in XML,
  and so it is written here. In its sums over the diffuse light of sky and ground EnergyPlus takes a row for an incident
  patch instead (`GetMatrixInput` stores a row and column as Mat2D(column, row); IntegratedFtTrans sums
  SolFrtTrans(incident, outgoing), WinSkyTrans SolFrtTrans(outgoing, incident)), so no order suits both. What it finds
  for diffuse light is that of the reversed paths: the same for panes and all that is alike from above and below.
- Values are BSDF [1/sr]: direct-hemispherical transmittance is Σ λ(outgoing) f, with λ the projected solid angles.
- The basis is that of WINDOW: a matrix of rows with a ring's nominal angle [°] and its number of patches. Borders of
  rings follow from these angles: a ring is centred on its angle, and the last one ends at 90°. So Klems bases only.
- Patches are counted by the azimuth of the light's travel from +x, which is right as seen from the room, as in XML.
- Front is the exterior. Absorptances are those of solar light, one a patch, in one row. Layers are counted from the
  exterior for light from either side.
- The field `Visible Optical Complex Back Transmittance` takes the transmittance of light from the room, as its name
  says and WINDOW writes it; EnergyPlus sums it up as the reflectance of the window's back in its daylighting.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError, MissingDataError
from clerestory.basis import Basis
from clerestory.system.energyplus.fields import LAYERS
from clerestory.system.heat import thermal_layer

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from clerestory.system.layer import Gap, Layer
    from clerestory.system.window import Built, Window

    Floats = NDArray[np.float64]

LONGEST = 100
"""Letters of a name that EnergyPlus takes."""
_GASES = {"air": "Air", "argon": "Argon", "krypton": "Krypton", "xenon": "Xenon"}


@dataclass(frozen=True)
class Object:
    """An object of EnergyPlus."""

    kind: str
    """Its class, such as `WindowMaterial:Gap`."""
    name: str
    fields: dict[str, str | float | int]
    """By the words of the data dictionary."""
    values: tuple[float, ...] = ()
    """Of a matrix, row by row."""


def fenestration(window: Window, built: Built, name: str) -> tuple[list[Object], list[str]]:
    """A window as one state of a complex fenestration, with all objects that it refers to.

    Parameters
    ----------
    window, built
        The window, and what `Window.solve` made of it on a Klems basis.
    name
        Of the state; those of the other objects begin with it.

    Returns
    -------
    Objects, the state last, and what was assumed.

    Raises
    ------
    MissingDataError
        There is no solar or visible band, no gas, or a layer lacks a thermal property; the text names the layer.
    ClerestoryError
        The basis, the number of layers or a value is none that EnergyPlus takes.
    """
    label = name_of(name)
    _check(window, built)
    assumed: list[str] = []
    state: dict[str, str | float | int] = {
        "Basis Type": "LBNLWINDOW",
        "Basis Symmetry Type": "None",
        "Window Thermal Model": f"{label}_Thermal",
        "Basis Matrix Name": f"{label}_Basis",
    }
    made = [
        Object(
            "WindowThermalModel:Params",
            f"{label}_Thermal",
            {
                "standard": "ISO15099",
                "Thermal Model": "ISO15099",
                "SDScalar": 1.0,
                "Deflection Model": "NoDeflection",
            },
        ),
        matrix(f"{label}_Basis", np.array([[ring[2], ring[3]] for ring in built.basis.rings])),
    ]
    models = built.matrices.models
    for words, short, band, side, scatter in (
        ("Solar Optical Complex Front Transmittance Matrix Name", "TfSol", "solar", "exterior", "transmission"),
        ("Solar Optical Complex Back Reflectance Matrix Name", "RbSol", "solar", "interior", "reflection"),
        ("Visible Optical Complex Front Transmittance Matrix Name", "TfVis", "visible", "exterior", "transmission"),
        ("Visible Optical Complex Back Transmittance Matrix Name", "TbVis", "visible", "interior", "transmission"),
    ):
        state[words] = f"{label}_{short}"
        values = np.clip(models[band][side, scatter].values, 0.0, None)  # type: ignore[index]
        made.append(matrix(f"{label}_{short}", values))
    front, back = (built.absorptance("solar", side) for side in ("exterior", "interior"))
    for k, layer in enumerate(window.layers):
        place = "Outside Layer" if k == 0 else f"Layer {k + 1}"
        own = f"{label}_Layer{k + 1}"
        state[f"{place} Name"] = own
        for words, short, absorbed in (("Front", "fAbs", front), ("Back", "bAbs", back)):
            state[f"{place} Directional {words} Absorptance Matrix Name"] = f"{own}_{short}"
            made.append(matrix(f"{own}_{short}", np.clip(absorbed[k : k + 1], 0.0, None)))
        made.append(_solid(own, layer, k + 1, window.gaps[max(0, k - 1) : k + 1], assumed))
        if k < len(window.gaps):
            state[f"Gap {k + 1} Name"] = f"{label}_Gap{k + 1}"
            made += _gap(f"{label}_Gap{k + 1}", window.gaps[k])
    return [*made, Object("Construction:ComplexFenestrationState", label, state)], assumed


def name_of(text: str) -> str:
    """A name as EnergyPlus takes it: without what separates fields, and not too long."""
    kept = " ".join("".join(" " if c in ",;!\n\r\t" else c for c in text).split())
    return kept[: LONGEST - len("_Layer1_fAbs")].strip() or "window"


def matrix(name: str, rows: Floats) -> Object:
    """A matrix, whose rows are written one after another."""
    shape = {"Number of Rows": rows.shape[0], "Number of Columns": rows.shape[1]}
    return Object("Matrix:TwoDimension", name, dict(shape), tuple(rows.ravel().tolist()))


def _check(window: Window, built: Built) -> None:
    known = [Basis.named(f"klems-{size}") for size in ("full", "half", "quarter")]
    if built.basis not in known:
        raise ClerestoryError(
            f"EnergyPlus takes Klems bases, not {built.basis.name} (set system.basis to klems-full, -half or -quarter)"
        )
    if len(window.layers) == 1 and window.layers[0].pane is None:
        raise ClerestoryError(
            f"{window.layers[0].called(1)}: EnergyPlus takes no shading layer alone (add a pane, and a gap between)"
        )
    if len(window.layers) > LAYERS:
        raise ClerestoryError(
            f"EnergyPlus takes {LAYERS} solid layers, the window has {len(window.layers)} (join some)"
        )
    if len(window.layers) > 1 and not window.gaps:
        raise MissingDataError("the gaps between the layers are not given (add them with their gas)")
    for band in ("solar", "visible"):
        if band not in built.absorbed:
            raise MissingDataError(
                f"EnergyPlus needs solar and visible light, and the window has no band {band!r} (it has "
                f"{', '.join(built.absorbed)}; give layers that have it)"
            )


def _solid(name: str, layer: Layer, number: int, gaps: Sequence[Gap], assumed: list[str]) -> Object:
    heat = thermal_layer(layer, number, assumed)
    if layer.pane is not None:
        # Below 1 by its data dictionary.
        front, back = (min(e, 0.999) for e in (heat.emissivity_exterior, heat.emissivity_interior))
        return Object(
            "WindowMaterial:Glazing",
            name,
            {
                "Optical Data Type": "BSDF",
                "Thickness": heat.thickness_m,
                "Infrared Transmittance at Normal Incidence": heat.ir_transmittance,
                "Front Side Infrared Hemispherical Emissivity": front,
                "Back Side Infrared Hemispherical Emissivity": back,
                "Conductivity": heat.conductivity,
            },
        )
    openings = heat.openings
    # EnergyPlus counts gaps at edges in widths of the gap beside the layer, the narrower one of two.
    width = min((gap.width_m for gap in gaps), default=math.inf)
    return Object(
        "WindowMaterial:ComplexShade",
        name,
        {
            "Layer Type": "BSDF",
            "Thickness": heat.thickness_m,
            "Conductivity": heat.conductivity,
            "IR Transmittance": heat.ir_transmittance,
            "Front Emissivity": heat.emissivity_exterior,
            "Back Emissivity": heat.emissivity_interior,
            "Top Opening Multiplier": min(1.0, openings.top_m / width),
            "Bottom Opening Multiplier": min(1.0, openings.bottom_m / width),
            "Left Side Opening Multiplier": min(1.0, openings.left_m / width),
            "Right Side Opening Multiplier": min(1.0, openings.right_m / width),
            "Front Opening Multiplier": min(1.0, openings.front),
        },
    )


def _gap(name: str, gap: Gap) -> list[Object]:
    gas = f"{name}_Gas"
    fill = Object("WindowMaterial:Gas", gas, {"Gas Type": _GASES[next(iter(gap.gas))], "Thickness": gap.width_m})
    if len(gap.gas) > 1:
        shares: dict[str, str | float | int] = {
            "Thickness": gap.width_m,
            "Number of Gases in Mixture": len(gap.gas),
        }
        for k, (gas_name, share) in enumerate(gap.gas.items(), 1):
            shares |= {f"Gas {k} Type": _GASES[gas_name], f"Gas {k} Fraction": share}
        fill = Object("WindowMaterial:GasMixture", gas, shares)
    width: dict[str, str | float | int] = {
        "Thickness": gap.width_m,
        "Gas (or Gas Mixture)": gas,
        "Pressure": 101325.0,
    }
    return [fill, Object("WindowMaterial:Gap", name, width)]
