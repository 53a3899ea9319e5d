"""Shading layers beside LBNL's WinCalc, which has formulas and view factors for them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

import wincalc
from clerestory import Basis, trace
from clerestory.directions import direction
from clerestory.system import Gap, Glass, Layer, Thermal, Window
from clerestory.system.heat import heat
from clerestory.system.traced import traced_thermal
from conformance.test_trace_wincalc import HOLE, PITCH, SLATS, SPACING, YARN, blind, cloth, screen
from timing import table

if TYPE_CHECKING:
    from typing import Any

BASIS, QUARTER = Basis.named("klems-full"), Basis.named("klems-quarter")
WEIGHTS = BASIS.projected_solid_angles / np.pi
SAMPLES = 4_096
DIRECTIONS = {"0°": (0.0, 0.0), "30° above": (30.0, 90.0), "60° above": (60.0, 90.0), "60° aside": (60.0, 0.0)}


def _nearest(basis: Basis, theta_deg: float, phi_deg: float) -> int:
    towards = direction(theta_deg, phi_deg, side="exterior")
    return int(np.argmax(basis.incident_centres("exterior") @ towards))


def _ours(recipe: dict[str, Any]) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Direct-hemispherical values by patch for light from the exterior: from patches' middles, and from all over."""
    incident = BASIS.incident_centres("exterior")
    seen, _ = trace.scan(recipe, incident, trace.Settings(samples=SAMPLES, seed=6))
    bsdf = trace.measure(recipe, sides=("exterior",), samples=SAMPLES, seed=6)
    return {
        scatter: (np.array([s.total[0] for s in seen if s.scatter == scatter]), bsdf.integrate(incident, scatter))
        for scatter in ("transmission", "reflection")
    }


def _rows(name: str, recipe: dict[str, Any], layer: wincalc.Layer) -> list[list[str]]:
    mine, lines = _ours(recipe), []
    for scatter, letter in (("transmission", "T"), ("reflection", "R")):
        columns = (BASIS.projected_solid_angles @ getattr(layer, scatter)["exterior"], *mine[scatter])
        for words, at in DIRECTIONS.items():
            patch = _nearest(BASIS, *at)
            lines.append([name, f"{letter} {words}", *(f"{values[patch]:.3f}" for values in columns)])
        lines.append([name, f"{letter} diffuse", *(f"{WEIGHTS @ values:.3f}" for values in columns)])
    return lines


def _heat(recipe: dict[str, Any]) -> wincalc.Heat:
    """Of the same window as WinCalc's, with long-wave values traced too."""
    (name, material), *_ = recipe["materials"].items()
    grey = {"visible": material["reflectance"], "solar": material["reflectance"]}
    materials = {name: material | {"reflectance": grey | {"thermal": 1.0 - wincalc.EMISSIVITY}}}
    sample = trace.load({**recipe, "materials": materials, "bands": {"names": ["visible", "solar", "thermal"]}})
    measured = trace.measure(sample, basis=QUARTER, samples=SAMPLES, seed=6)
    found = traced_thermal(sample, measured)
    thermal = Thermal(**{**vars(found), "conductivity": wincalc.CONDUCTIVITY, "thickness_m": 0.0005})
    wavelength, one = 1000.0 * np.array(wincalc.WAVELENGTHS_UM), np.ones(2)
    t, r = wincalc.PANE["transmittance"] * one, wincalc.PANE["reflectance"] * one
    pane = Layer("pane", pane=Glass("grey", wavelength, t, r, r), thermal=Thermal(0.003, 1.0, 0.84, 0.84, 0.0))
    air = Gap("air", 0.0127, {"air": 1.0})
    window = Window([pane, pane, Layer("shade", bsdf=measured, thermal=thermal)], [air, air])
    solved = heat(window, window.solve(QUARTER, norm="nfrc300"), each=True)
    return wincalc.Heat(solved.u, solved.g, float(solved.gain.shgc[_nearest(QUARTER, 54.0, 90.0)]))


def report(data: Path) -> str:
    """Text of the section."""
    del data
    shades = [
        ("black slats, 0°", blind(0.0, 0.0), wincalc.venetian(**SLATS, tilt_deg=0.0, reflectance=0.0)),
        ("slats, 0°", blind(0.0, 0.5), wincalc.venetian(**SLATS, tilt_deg=0.0, reflectance=0.5)),
        ("slats, 45°", blind(45.0, 0.5), wincalc.venetian(**SLATS, tilt_deg=45.0, reflectance=0.5)),
        ("screen", screen(0.5), wincalc.perforated(pitch_m=PITCH, diameter_m=HOLE, reflectance=0.5)),
        ("cloth", cloth(0.5), wincalc.woven(diameter_m=YARN, pitch_m=SPACING, reflectance=0.5)),
    ]
    optics = [row for name, recipe, layer in shades for row in _rows(name, recipe, layer)]
    warmth = []
    for name, recipe, layer in shades[1:]:
        pair = wincalc.behind_panes(layer), _heat(recipe)
        for words, key, digits in (("U [W/(m² K)]", "u", 2), ("g 0°", "g", 3), ("g 54° above", "g_above", 3)):
            warmth.append([name, words, *(f"{getattr(found, key):.{digits}f}" for found in pair)])
    head = ["layer", "quantity", "WinCalc", "middles of patches", "whole patches"]
    return f"""### Shading layers and WinCalc

Flat slats 80 mm wide at 72 mm; a screen of 0.5 mm with round holes of 2 mm at 4 mm; a plain weave of round yarns of
0.3 mm at 0.5 mm. All are Lambertian, with a reflectance of 0.5 but for the black slats. Direct- and
diffuse-hemispherical values for light from the exterior. WinCalc takes light from the middle of each Klems patch; so
the same is traced, and what whole patches give, as a Klems file should hold it. Why they differ is said in
[systems.md](systems.md#beside-wincalcs-own-models-of-shades).

{table(head, optics)}

The same layers 12.7 mm behind two panes of 3 mm (grey, transmittance 0.834, reflectance 0.075) with 12.7 mm of air
between them, in NFRC's climates, on Klems quarter; long-wave emissivity of the layers' material 0.9.

{table(["layer", "quantity", "WinCalc", "Clerestory"], warmth)}
"""
