"""Shading layers beside LBNL's WinCalc, which solves them by view factors."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

import wincalc
from clerestory import Basis, trace
from conformance.test_trace_wincalc import SLATS, blind
from timing import table

if TYPE_CHECKING:
    from typing import Any

BASIS = Basis.named("klems-full")
WEIGHTS = BASIS.projected_solid_angles / np.pi
SAMPLES = 4_096


def _ours(recipe: dict[str, Any]) -> dict[str, float]:
    """Hemispherical values for light from the exterior, by patches and by their middles."""
    incident = BASIS.incident_centres("exterior")
    seen, _ = trace.scan(recipe, incident, trace.Settings(samples=SAMPLES, seed=6))
    bsdf = trace.measure(recipe, sides=("exterior",), samples=SAMPLES, seed=6)
    found = {}
    for scatter in ("transmission", "reflection"):
        found[f"{scatter} middles"] = float(WEIGHTS @ np.array([s.total[0] for s in seen if s.scatter == scatter]))
        found[f"{scatter} patches"] = float(WEIGHTS @ bsdf.integrate(incident, scatter))
    return found


def _screen(reflectance: float) -> dict[str, Any]:
    return {
        "sample": {
            "kind": "perforated-screen",
            "pitch_mm": 4.0,
            "hole_mm": 2.0,
            "thickness_mm": 0.5,
            "exterior": "sheet",
        },
        "materials": {"sheet": {"kind": "lambertian", "reflectance": reflectance}},
    }


def report(data: Path) -> str:
    """Text of the section."""
    del data
    jobs = [
        (f"flat slats, {tilt:g}°, reflectance {rho:g}", blind(tilt, rho), {"tilt_deg": tilt, "reflectance": rho})
        for tilt, rho in ((0.0, 0.0), (0.0, 0.5), (45.0, 0.5))
    ]
    rows = []
    for name, recipe, keys in jobs:
        rows.append(_row(name, recipe, wincalc.venetian(**SLATS, **keys)))
    screen = wincalc.perforated(pitch_m=0.004, diameter_m=0.002, reflectance=0.5)
    rows.append(_row("screen, holes of 2 mm at 4 mm, reflectance 0.5", _screen(0.5), screen))
    head = ["layer", "quantity", "WinCalc", "middles of patches", "whole patches"]
    return f"""### Shading layers and WinCalc

Diffuse-hemispherical values for light from the exterior. WinCalc takes light from the middle of each Klems patch; so
the same is traced, and what whole patches give, as a Klems file should hold it. Between black slats both are the same.
Diffuse slats, of which it makes five strips each, pass and return less in WinCalc, by 1 % to 8 %; radiosity on 2,000
strips gives the traced value (tests/analytic). The walls of a screen's holes reflect light that WinCalc leaves out of
the transmission.

{table(head, [line for lines in rows for line in lines])}
"""


def _row(name: str, recipe: dict[str, Any], layer: wincalc.Layer) -> list[list[str]]:
    mine = _ours(recipe)
    lines = []
    for scatter in ("transmission", "reflection"):
        theirs = float(WEIGHTS @ (BASIS.projected_solid_angles @ getattr(layer, scatter)["exterior"]))
        values = (theirs, mine[f"{scatter} middles"], mine[f"{scatter} patches"])
        lines.append([name, scatter, *(f"{v:.4f}" for v in values)])
    return lines
