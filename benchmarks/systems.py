"""Window systems of three layers on Klems full, their light and heat: ours beside pywincalc."""

from __future__ import annotations

import gzip
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pywincalc

from clerestory.system.build import load
from clerestory.system.heat import heat
from timing import seconds, table

if TYPE_CHECKING:
    from clerestory.system.build import Specified

SHADE = "klems/2011-SA1.XML.gz"
#: Ten panes: a hundred windows of one outside and one inside of the shade.
PANES = (
    "CLEAR_3.json",
    "igsdb_product_364.json",
    "igsdb_product_7406.json",
    "igsdb_v1_clear_3.json",
    "igsdb_v2_clear_3.json",
    "nfrc_18000.json",
    "nfrc_18100.json",
    "nfrc_2191.json",
    "nfrc_6400.json",
    "generic_pv.json",
)
GAP_MM = 12.7
PEERS = (7, 85)
"""Which of the hundred the peer solves; its time for one is so long that the others are reckoned from these."""
CONDENSED = {"number_visible_bands": 5, "number_solar_bands": 10}
"""The peer's way of fewer wavelengths, as its own tests take it."""
STANDARD = Path(pywincalc.__file__).parent / "standards" / "W5_NFRC_2003.std"


@dataclass
class Values:
    """Of a window along the normal."""

    visible: float = 0.0
    solar: float = 0.0
    u: float = 0.0
    g: float = 0.0


def _specified(data: Path, outer: str, inner: str) -> Specified:
    panes = [{"kind": "glass", "file": str(data / "glazing/products" / name)} for name in (outer, inner)]
    air = {"kind": "gap", "gas": "air", "width_mm": GAP_MM}
    shade = {"kind": "file", "file": str(data / SHADE)}
    return load({"system": {"standard": "nfrc300"}, "layers": [panes[0], air, shade, air, panes[1]]})


def _ours(window: Specified) -> Values:
    """Matrices of visible, solar and near-infrared light, what layers absorb, and g for the sun in every patch."""
    built = window.solve()
    found = heat(window.window, built)
    normal = built.basis.incident_centres("exterior")[0]
    passed = (float(built.bsdf.integrate(normal, "transmission", band=band)) for band in ("visible", "solar"))
    return Values(*passed, found.u, found.g)


def _theirs(layers: list[Any], *, condensed: bool) -> Values:
    """Matrices of visible and solar light, what layers absorb, and g for the sun along the normal."""
    methods = pywincalc.SpectalDataWavelengthRangeMethodType
    fewer: dict[str, Any] = {"spectral_data_wavelength_range_method": methods.CONDENSED, **CONDENSED}
    gap = pywincalc.Layers.gap(thickness=GAP_MM / 1000.0)
    system = pywincalc.GlazingSystem(
        solid_layers=layers,
        gap_layers=[gap, gap],
        optical_standard=pywincalc.load_standard(str(STANDARD)),
        bsdf_hemisphere=pywincalc.BSDFHemisphere.create(pywincalc.BSDFBasisType.FULL),
        environment=pywincalc.nfrc_u_environments(),
        **(fewer if condensed else {}),
    )
    passed = (
        float(system.optical_method_results(name).system_results.front.transmittance.direct_hemispherical)
        for name in ("PHOTOPIC", "SOLAR")
    )
    found = Values(*passed, system.u())
    system.environments(pywincalc.nfrc_shgc_environments())
    found.g = system.shgc()
    return found


def report(data: Path) -> str:
    """Text of the section."""
    names = list(product(PANES, PANES))
    windows = [_specified(data, *pair) for pair in names]
    _ours(windows[0])
    mine = [Values() for _ in windows]

    def all_of_ours() -> None:
        for k, window in enumerate(windows):
            mine[k] = _ours(window)

    ours = seconds(all_of_ours)
    shade = pywincalc.parse_bsdf_xml_string(gzip.decompress((data / SHADE).read_bytes()).decode("utf-8", "replace"))
    jobs, values = [], {k: [mine[k]] for k in PEERS}
    for words, solved, condensed in (("condensed to 10 bands", PEERS, True), ("all wavelengths", PEERS[:1], False)):
        times = []
        for k in solved:
            outer, inner = (pywincalc.parse_json_file(str(data / "glazing/products" / name)) for name in names[k])
            times.append(
                seconds(lambda: values[k].append(_theirs([outer, shade, inner], condensed=condensed)))  # noqa: B023
            )
        ratios = [t * len(windows) / ours for t in times]
        theirs = sum(times) / len(times) * len(windows)
        spread = f"{min(ratios):.0f} to {max(ratios):.0f}"
        jobs.append([words, f"{ours:.1f}", f"{theirs:.0f}", f"**{theirs / ours:.0f}**", spread])
    quantities = (("visible", "T visible"), ("solar", "T solar"), ("u", "U [W/(m² K)]"), ("g", "g"))
    rows = [
        [", ".join(names[k]), what, *([f"{getattr(found, key):.4f}" for found in values[k]] + ["–"])[:3]]
        for k in PEERS
        for key, what in quantities
    ]
    return f"""### Layers to windows on Klems full

Aim: at least 10 times. A hundred windows, of {len(PANES)} panes outside and inside of a fabric's matrices from a file,
all data read before. Both give the matrices of both sides in the visible and solar bands, what each layer absorbs of
light from all 145 patches, U and g by NFRC; Clerestory g for the sun in all patches, `pywincalc` along the normal.
Clerestory solves bins of 40 to 100 nm; `pywincalc` all wavelengths of the data, or bands of its own. Clerestory solved
all hundred; `pywincalc` {len(PEERS)} of them, and one with all wavelengths, from which its time for the hundred is
reckoned.

{table(["pywincalc", "Clerestory [s]", "pywincalc [s]", "ratio", "spread"], jobs)}

Values along the normal of those that both solved:

{table(["panes", "quantity", "Clerestory", "condensed", "all wavelengths"], rows)}
"""
