"""`clerestory info`: what a file holds, its integrals, and what is suspicious in it."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING

from clerestory.cli.common import FileArgument, JsonOption, about, print_json, read, say, table

if TYPE_CHECKING:
    from pathlib import Path

    from clerestory.bsdf import Bsdf
    from clerestory.describe import Block
    from clerestory.integrals import CutOff
    from clerestory.metadata import Metadata
    from clerestory.system.product import ProductData


def info(file: FileArgument, *, as_json: JsonOption = False) -> None:
    """Say what a file holds, its integrals, and what is suspicious in it.

    Hemispherical values are those under uniform radiance. Direct-hemispherical values are for light from straight above
    at 0, 30, 50 and 70° to the normal. The cut-off angle is that of light from straight above.

    Example: clerestory info blind.xml
    """
    from clerestory.check import check
    from clerestory.describe import blocks
    from clerestory.system.product import product_of

    bsdf = read(file, show_warnings=False)
    with about(file):
        product = product_of(bsdf)
        parts = blocks(bsdf)
        direct = [_direct_hemispherical(bsdf, block) for block in parts]
        cut_offs = [_cut_off(bsdf, block) for block in parts]
        findings = [finding for finding in check(bsdf) if finding.severity != "note"]
    if as_json:
        print_json(
            {
                "file": file,
                "format": _format(file),
                "bands": bsdf.bands,
                "metadata": asdict(bsdf.metadata),
                "product": product,
                "components": [
                    {
                        **asdict(block),
                        "direct_hemispherical": dict(zip(_probes(), values, strict=True)),
                        "cut_off": cut and {"angle_deg": _angle(cut), "threshold": cut.threshold, "words": cut.words},
                    }
                    for block, values, cut in zip(parts, direct, cut_offs, strict=True)
                ],
                "findings": findings,
            }
        )
        return
    say(f"{file}: {_format(file)}")
    for line in _about_sample(bsdf.metadata) + ([] if product is None else _about_product(product)):
        say(f"  {line}")
    say("\nComponents (side is that of the incident light)")
    say(table(["band", "side", "scatter", "model"], [[b.band, b.side, b.scatter, b.words] for b in parts], left=4))
    say("\nIntegrals: hemispherical, and direct-hemispherical for light from above")
    rows = [
        [b.band, b.side, b.scatter, f"{b.hemispherical:.4f}", *(f"{v:.4f}" for v in values)]
        for b, values in zip(parts, direct, strict=True)
    ]
    say(table(["band", "side", "scatter", "hh", *(f"{probe}°" for probe in _probes())], rows, left=3))
    found = [(block, cut) for block, cut in zip(parts, cut_offs, strict=True) if cut]
    if found:
        say("\nCut-off angle")
    for block, cut in found:
        angle = _angle(cut)
        words = "not cut off below 90°" if angle is None else f"{angle:g}°"
        say(f"  {block.band}, light from the {block.side}: {words if cut.values[0] > 0.0 else 'no direct light'}")
        say(f"    {cut.words}")
    say("\nSuspicious" if findings else "\nNothing suspicious")
    for finding in findings:
        say(f"  {finding}")


def _probes() -> list[str]:
    from clerestory.integrals import PROBES_DEG

    return [f"{theta:g}" for theta in PROBES_DEG]


def _direct_hemispherical(bsdf: Bsdf, block: Block) -> list[float]:
    from clerestory.directions import direction
    from clerestory.integrals import PROBES_DEG

    incident = direction(PROBES_DEG, 90.0, side=block.side)
    return [float(value) for value in bsdf.integrate(incident, block.scatter, band=block.band)]


def _cut_off(bsdf: Bsdf, block: Block) -> CutOff | None:
    """Cut-off angle for light from above; None for reflection."""
    from clerestory.integrals import cut_off

    return cut_off(bsdf, side=block.side, band=block.band) if block.scatter == "transmission" else None


def _angle(cut: CutOff) -> float | None:
    """The angle; none where no light passes that could be cut off."""
    return cut.angle_deg if cut.values[0] > 0.0 else None


def _format(file: Path) -> str:
    name = file.name.lower()
    if name.endswith(".npz"):
        return "Clerestory's own file"
    return "BSDF XML, gzip" if name.endswith(".gz") else "BSDF XML"


def _about_sample(metadata: Metadata) -> list[str]:
    """What the file says of the sample, a line each."""
    texts = {
        "name": metadata.name,
        "product": metadata.product_name if metadata.product_name != metadata.name else None,
        "manufacturer": metadata.manufacturer,
        "device": metadata.device_type,
        "thickness": _millimetres(metadata.thickness_m),
        "width": _millimetres(metadata.width_m),
        "height": _millimetres(metadata.height_m),
        "emissivity exterior": _number(metadata.emissivity_exterior),
        "emissivity interior": _number(metadata.emissivity_interior),
        "thermal-infrared transmittance": _number(metadata.tir),
        "openness": _number(metadata.openness),
        "conductivity": None if metadata.thermal_conductivity is None else f"{metadata.thermal_conductivity:g} W/(m K)",
        "geometry": None
        if metadata.geometry is None
        else f"{metadata.geometry_format or 'embedded'} model in the file",
        "comment": " ".join(metadata.comments[0].split())[:100] if metadata.comments else None,
    }
    return [f"{name}: {text}" for name, text in texts.items() if text]


def _about_product(product: ProductData) -> list[str]:
    """What the file says of the product in its own element, a line each."""
    lines = [f"layer or gap {c['number']}: {c['kind']}, {c.get('name', 'no name')}" for c in product.components]
    if product.parameter is not None:
        lines.append(f"state: {product.parameter} {product.value:g}")
    if product.heat is not None:
        heat = product.heat
        lines.append(f"U {heat.u:.2f} W/(m² K), g {heat.shgc:.3f}, for diffuse light {heat.shgc_diffuse:.3f}")
    if product.curve is not None:
        lines.append(f"control curve: {len(product.curve.profile_deg)} profile angles")
    if product.orientation is not None:
        place = product.orientation
        azimuth = "any azimuth" if place.azimuth_deg is None else f"azimuth {place.azimuth_deg:g}°"
        lines.append(f"to be placed: {place.mounting}, {azimuth} within {place.within_deg:g}°")
    return lines


def _millimetres(metres: float | None) -> str | None:
    return None if metres is None else f"{1000.0 * metres:g} mm"


def _number(value: float | None) -> str | None:
    return None if value is None else f"{value:g}"
