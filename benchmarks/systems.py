"""Window systems of three layers on Klems full: ours beside pywincalc."""

from __future__ import annotations

import gzip
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pywincalc

import clerestory
from clerestory import Basis, Bsdf
from clerestory.system import Glazing, Layer, Window, read_glass, stack
from timing import Pair, row, seconds, table

if TYPE_CHECKING:
    from collections.abc import Callable

SYSTEMS = 100
REPETITIONS = 3
GLASS, SHADE = "glazing/products/CLEAR_3.json", "klems/2011-SA1.XML.gz"
STANDARD = Path(pywincalc.__file__).parent / "standards" / "W5_NFRC_2003.std"


def _by_wavelength(data: Path) -> Callable[[], float]:
    """Visible transmittance of pane, shade and pane, solved in bins of wavelengths."""
    pane = Layer("pane", pane=read_glass(data / GLASS))
    shade = Layer("shade", bsdf=Bsdf.from_models(clerestory.read(data / SHADE).models["visible"]))
    normal = np.array([0.0, 0.0, -1.0])

    def job() -> float:
        built = Window([pane, shade, pane]).solve(norm="nfrc300")
        return float(built.bsdf.integrate(normal, "transmission"))

    return job


def _in_one_band(data: Path) -> Callable[[], float]:
    """The same with the panes' means over the visible band, in the core."""
    basis = Basis.named("klems-full")
    pane = Bsdf.from_models(Glazing([read_glass(data / GLASS)]).bsdf("nfrc300").models["visible"])
    shade = Bsdf.from_models(clerestory.read(data / SHADE).models["visible"])
    normal = np.array([0.0, 0.0, -1.0])

    def job() -> float:
        system = stack([pane, shade, pane], basis)
        system.absorptance()
        return float(system.bsdf.integrate(normal, "transmission"))

    return job


def _theirs(data: Path) -> Callable[[], float]:
    glass = pywincalc.parse_json_file(str(data / GLASS))
    shade = pywincalc.parse_bsdf_xml_string(gzip.decompress((data / SHADE).read_bytes()).decode("utf-8", "replace"))
    standard = pywincalc.load_standard(str(STANDARD))
    hemisphere = pywincalc.BSDFHemisphere.create(pywincalc.BSDFBasisType.FULL)

    def job() -> float:
        gap = pywincalc.Layers.gap(thickness=0.0127)
        system = pywincalc.GlazingSystem(
            solid_layers=[glass, shade, glass],
            gap_layers=[gap, gap],
            optical_standard=standard,
            bsdf_hemisphere=hemisphere,
        )
        found: Any = system.optical_method_results("PHOTOPIC").system_results.front.transmittance
        return float(found.direct_hemispherical)

    return job


def report(data: Path) -> str:
    """Text of the section."""
    theirs = _theirs(data)
    rows = []
    for name, ours in (("by wavelength", _by_wavelength(data)), ("in one band", _in_one_band(data))):
        values = ours(), theirs()
        times = [(seconds(ours) * SYSTEMS, seconds(theirs) * SYSTEMS) for _ in range(REPETITIONS)]
        pair = Pair([a for a, _ in times], [b for _, b in times])
        rows.append([*row(name, pair, unit=1.0, digits=1), f"{values[0]:.4f}", f"{values[1]:.4f}"])
    head = ["job", "Clerestory [s]", "pywincalc [s]", "ratio", "spread", "T here", "T there"]
    return f"""### Layers to windows on Klems full

Aim: at least 10 times. Time for {SYSTEMS} windows of 3 mm clear glass, a fabric's matrices from a file, and the glass
again, both from data that were read before: the time of one is multiplied. `pywincalc` solves the visible band
wavelength by wavelength; Clerestory solves bins of 40 nm, or the band once. Both give the matrices of both sides and
what each layer absorbs. The transmittances are those of light along the normal.

{table(head, rows)}
"""
