"""The round robin's blind: diffuse transmittance over the reflectance of its slats."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib as mpl
import numpy as np

from clerestory import Basis, trace
from timing import table

if TYPE_CHECKING:
    from typing import Any

mpl.use("Agg")
import matplotlib.pyplot as plt

PICTURE = Path(__file__).resolve().parent.parent / "docs" / "images" / "round-robin-blind.png"
#: T_h-h of the blind as the laboratories of the report found it.
BAND = (0.478, 0.503)
REFLECTANCES = np.linspace(0.3, 0.7, 9)
SAMPLES = 16_384


def _recipe(reflectance: float, crown_mm: float) -> dict[str, Any]:
    return {
        "sample": {
            "kind": "venetian-blind",
            "pitch_mm": 72.0,
            "slat": {"width_mm": 81.0, "crown_mm": crown_mm, "upper": "paint"},
        },
        "materials": {"paint": {"kind": "lambertian", "reflectance": reflectance}},
    }


def _transmittance(reflectance: float, crown_mm: float) -> tuple[float, float]:
    """T_h-h and its standard error."""
    basis = Basis.named("klems-full")
    bsdf = trace.measure(_recipe(reflectance, crown_mm), sides=("exterior",), samples=SAMPLES, seed=2)
    values, errors = bsdf.integrate_with_error(basis.incident_centres("exterior"), "transmission")
    weights = basis.projected_solid_angles / np.pi
    return float(weights @ values), float(np.sqrt(weights**2 @ errors**2))


def report(data: Path) -> str:
    """Text of the section; the picture is made anew."""
    del data
    rows, words = [], []
    figure, axes = plt.subplots(figsize=(6.4, 4.0), layout="constrained")
    axes.axhspan(*BAND, color="0.88", label="round robin, 47.8 % to 50.3 %")
    for name, crown_mm in (("flat", 0.0), ("curved", 9.0)):
        found = [_transmittance(float(r), crown_mm) for r in REFLECTANCES]
        values = np.array([value for value, _ in found])
        rows += [
            [name, f"{r:.2f}", f"{100 * v:.2f} %", f"{100 * e:.2f} %"]
            for r, (v, e) in zip(REFLECTANCES, found, strict=True)
        ]
        axes.plot(REFLECTANCES, values, marker="o", markersize=3.5, label=f"{name} slats")
        low, high = np.interp(BAND, values, REFLECTANCES)
        words.append(f"{name} slats cross it at a reflectance of {low:.2f} to {high:.2f}")
    axes.set(xlabel="reflectance of the slats", ylabel="diffuse-hemispherical transmittance T$_{h-h}$")
    axes.yaxis.set_major_formatter(mpl.ticker.PercentFormatter(1.0, decimals=0))
    axes.legend(frameon=False)
    axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(PICTURE, dpi=150)
    plt.close(figure)
    return f"""### The blind of the round robin

Slats 81 mm deep, 72.0 mm apart, level, Lambertian on both sides, no thickness; the curved ones with a crown of 9 mm.
The laboratories of the round robin found T_h-h of 47.8 % to 50.3 %; {"; ".join(words)}.

![Transmittance over the reflectance of the slats](images/{PICTURE.name})

{table(["slats", "reflectance", "T_h-h", "standard error"], rows)}
"""
