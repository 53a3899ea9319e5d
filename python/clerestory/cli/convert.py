"""`clerestory convert`: another format, basis or set of bands, or a file for another program."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from clerestory.cli.common import (
    TREES,
    JsonOption,
    UsageError,
    about,
    check_bsdf_name,
    note,
    one_of,
    print_json,
    progress,
    read,
    refuse_overwriting,
    say,
    scatter_of,
    side_of,
    table,
)

if TYPE_CHECKING:
    from clerestory.basis import Basis
    from clerestory.bsdf import Bsdf
    from clerestory.convert import ConversionReport
    from clerestory.directions import Scatter, Side
    from clerestory.files import Target
    from clerestory.model import Model
    from clerestory.tree import ReductionReport

TARGETS: tuple[Target, ...] = ("plain", "radiance", "window", "energyplus")


@dataclass(frozen=True)
class Reduced:
    """What `--cull` did to a component."""

    band: str
    side: Side
    scatter: Scatter
    report: ReductionReport


Text = str | None
Number = float | None


def convert(
    inputs: Annotated[
        list[Path],
        typer.Argument(metavar="IN…", help="BSDF files of one sample, of different bands.", show_default=False),
    ],
    output: Annotated[
        Path, typer.Argument(metavar="OUT", help="File to write: .xml, .xml.gz or .bsdf.npz.", show_default=False)
    ],
    *,
    basis: Annotated[
        Text,
        typer.Option(
            metavar="NAME",
            help="klems-full, klems-half, klems-quarter, tregenza, reinhart:N, iea21, or tensor3 or tensor4 for trees.",
        ),
    ] = None,
    resolution: Annotated[
        int | None,
        typer.Option(metavar="N", help="2^N cells an axis at the finest, for tensor3 and tensor4; 6 by default."),
    ] = None,
    samples: Annotated[
        int | None,
        typer.Option(
            metavar="N",
            help="Pairs of directions a cell, where a conversion samples; 256, and 16 for trees, by default.",
        ),
    ] = None,
    cull: Annotated[
        float | None,
        typer.Option(metavar="PCT", help="Percentage of a tree's finest blocks to merge; 90 for a new tree."),
    ] = None,
    target: Annotated[
        str, typer.Option("--for", metavar="PROGRAM", help="Write what radiance, window or energyplus accepts.")
    ] = "plain",
    band_of: Annotated[
        list[str] | None,
        typer.Option(metavar="FILE=BAND", help="Name the band of an input that has one band; repeatable."),
    ] = None,
    mirror: Annotated[bool, typer.Option("--mirror", help="Mirror left to right.")] = False,
    rotate: Annotated[
        float, typer.Option(metavar="DEG", help="Turn in the plane, counter-clockwise as seen from the room.")
    ] = 0.0,
    flip: Annotated[
        bool, typer.Option("--flip", help="Turn about the vertical axis: the interior face becomes the exterior one.")
    ] = False,
    separate_peaks: Annotated[
        bool, typer.Option("--separate-peaks", help="Take the through-beam out as an explicit peak, for .bsdf.npz.")
    ] = False,
    name: Annotated[Text, typer.Option(metavar="TEXT", help="Name of the sample.")] = None,
    product: Annotated[Text, typer.Option(metavar="TEXT", help="Name under which it is sold.")] = None,
    manufacturer: Annotated[Text, typer.Option(metavar="TEXT", help="Who makes it.")] = None,
    device: Annotated[Text, typer.Option(metavar="TEXT", help="Kind of device.")] = None,
    thickness: Annotated[Number, typer.Option(metavar="MM", help="Thickness in millimetres.")] = None,
    width: Annotated[Number, typer.Option(metavar="MM", help="Width in millimetres.")] = None,
    height: Annotated[Number, typer.Option(metavar="MM", help="Height in millimetres.")] = None,
    emissivity_exterior: Annotated[
        Number, typer.Option(metavar="E", help="Long-wave emissivity of the exterior face, 0 to 1.")
    ] = None,
    emissivity_interior: Annotated[
        Number, typer.Option(metavar="E", help="Long-wave emissivity of the interior face, 0 to 1.")
    ] = None,
    tir: Annotated[Number, typer.Option(metavar="T", help="Thermal-infrared transmittance, 0 to 1.")] = None,
    conductivity: Annotated[Number, typer.Option(metavar="K", help="Thermal conductivity in W/(m K).")] = None,
    assume_side: Annotated[
        Text, typer.Option(metavar="SIDE", help="Side that the light comes from, if an input does not tell.")
    ] = None,
    assume_scatter: Annotated[
        Text, typer.Option(metavar="SCATTER", help="transmission or reflection, if an input does not tell.")
    ] = None,
    assume_basis: Annotated[
        Text, typer.Option(metavar="NAME", help="Angle basis, if an input names it wrongly or not at all.")
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Convert to another format, basis or set of bands, or for another program.

    The bands of several inputs are merged. A mirror image is taken first, then the turn in the plane, then the flip.
    The errors of the conversion are printed. The output is written whole or not at all, and never over an input.

    Example: clerestory convert visible.xml solar.xml blind.xml --for window --thickness 80
    """
    _refuse_useless(basis, resolution=resolution, samples=samples, cull=cull)
    if not isfinite(rotate):
        raise UsageError(f"--rotate {rotate:g}: not an angle (give degrees, such as 90)")
    wanted = next(t for t in TARGETS if t == one_of(target, "--for", TARGETS))
    check_bsdf_name(output)
    refuse_overwriting(output, inputs)
    bands = _bands_of(band_of or [], inputs)
    side = None if assume_side is None else side_of(assume_side, "--assume-side")
    scatter = None if assume_scatter is None else scatter_of(assume_scatter, "--assume-scatter")

    import clerestory
    from clerestory.bsdf import Bsdf

    tree = next((rank for rank in TREES if rank == basis), None)
    patches = _basis(basis, "--basis") if tree is None else None
    assumed = _basis(assume_basis, "--assume-basis")
    sets = []
    for path in inputs:
        bsdf = read(path, side=side, scatter=scatter, basis=assumed, band=bands.get(path))
        with about(path):
            sets.append(_renamed(bsdf, path, bands.get(path)))
    with about(output):
        bsdf = sets[0] if len(sets) == 1 else Bsdf.merged(sets)
        bsdf = _moved(bsdf, mirror=mirror, rotate_deg=rotate, flip=flip)
        reports: list[ConversionReport] = []
        reduced: list[Reduced] = []
        with progress("converting") as done:
            if patches is not None:
                bsdf = bsdf.to_matrix(patches, samples=256 if samples is None else samples, progress=done)
                reports = bsdf.conversion
            elif tree is not None:
                bsdf = bsdf.to_tree(
                    tree,
                    resolution=6 if resolution is None else resolution,
                    samples=16 if samples is None else samples,
                    reduce=90.0 if cull is None else cull,
                    progress=done,
                )
                reports = bsdf.conversion
            elif cull is not None:
                bsdf, reduced = _culled(bsdf, cull)
        if separate_peaks:
            bsdf = bsdf.separate_peaks()
        fields = {
            "name": name,
            "product_name": product,
            "manufacturer": manufacturer,
            "device_type": device,
            "thickness_m": _metres(thickness),
            "width_m": _metres(width),
            "height_m": _metres(height),
            "emissivity_exterior": emissivity_exterior,
            "emissivity_interior": emissivity_interior,
            "tir": tir,
            "thermal_conductivity": conductivity,
        }
        given = {field: value for field, value in fields.items() if value is not None}
        if given:
            bsdf = bsdf.with_metadata(**given)
        notes = bsdf.write(output, target=wanted)
        # A target may leave bands out.
        written = bsdf.bands if wanted == "plain" or not output.is_file() else clerestory.read(output).bands
    if as_json:
        print_json({"output": output, "bands": written, "conversion": reports, "reduction": reduced, "notes": notes})
        return
    for text in notes:
        note(f"note: {output}: {text}")
    if reports:
        say(_report(reports))
    if reduced:
        say(_reductions(reduced))
    say(f"wrote {output}: {', '.join(written)}")


def _basis(name: str | None, option: str) -> Basis | None:
    from clerestory import ClerestoryError
    from clerestory.basis import Basis

    if name is None:
        return None
    try:
        return Basis.named(name)
    except ClerestoryError as error:
        raise UsageError(f"{option} {name}: {error}") from None


def _refuse_useless(basis: str | None, *, resolution: int | None, samples: int | None, cull: float | None) -> None:
    """Fail on numbers that make no sense, or that would have no effect."""
    if resolution is not None and not 0 <= resolution <= 10:
        raise UsageError(f"--resolution {resolution}: not one of a tensor tree (give 0 to 10; 4 to 7 are usual)")
    if resolution is not None and basis not in TREES:
        raise UsageError(f"--resolution {resolution}: only new trees have one (give --basis tensor4 too)")
    if samples is not None and samples < 1:
        raise UsageError(f"--samples {samples}: not a number of samples (give 1 or more; 256 are usual)")
    if samples is not None and basis is None:
        raise UsageError(f"--samples {samples}: nothing is sampled without a new basis (give --basis too)")
    if cull is not None and not 0.0 <= cull <= 100.0:
        raise UsageError(f"--cull {cull:g}: not a percentage (give 0 to 100; 90 to 95 are usual)")
    if cull is not None and basis is not None and basis not in TREES:
        raise UsageError(
            f"--cull with --basis {basis}: only trees can be culled (give --basis tensor4, or leave it out)"
        )


def _bands_of(texts: list[str], inputs: list[Path]) -> dict[Path, str]:
    """The names of bands by file, from `FILE=BAND`."""
    bands = {}
    for text in texts:
        file, found, band = text.rpartition("=")
        path = next((p for p in inputs if str(p) == file or p == Path(file) or p.name == file), None)
        if not (found and band):
            raise UsageError(f"--band-of {text}: a file and a band are asked for (such as sun.xml=solar)")
        if path is None:
            raise UsageError(f"--band-of {text}: {file} is none of the inputs (give its name as there)")
        bands[path] = band
    return bands


def _renamed(bsdf: Bsdf, path: Path, band: str | None) -> Bsdf:
    if band is None or bsdf.bands == (band.lower(),):
        return bsdf
    if len(bsdf.bands) > 1:
        raise UsageError(f"--band-of {path}={band}: the file has {len(bsdf.bands)} bands, {', '.join(bsdf.bands)}")
    return bsdf.renamed_band(bsdf.bands[0], band)


def _moved(bsdf: Bsdf, *, mirror: bool, rotate_deg: float, flip: bool) -> Bsdf:
    if mirror:
        bsdf = bsdf.mirrored()
    if rotate_deg:
        bsdf = bsdf.rotated(rotate_deg)
    return bsdf.flipped() if flip else bsdf


def _metres(millimetres: float | None) -> float | None:
    return None if millimetres is None else millimetres / 1000.0


def _culled(bsdf: Bsdf, percent: float) -> tuple[Bsdf, list[Reduced]]:
    """Every tensor tree with fewer leaves."""
    models: dict[str, dict[tuple[Side, Scatter], Model]] = {}
    reduced = []
    for band, members in bsdf.models.items():
        for (side, scatter), model in members.items():
            if model.kind == "tensor tree":
                smaller, report = model.reduced(percent=percent)
                models.setdefault(band, {})[side, scatter] = smaller
                reduced.append(Reduced(band, side, scatter, report))
    if not reduced:
        raise UsageError("--cull: there are no tensor trees in the input (give --basis tensor4 too)")
    return bsdf.with_models(models), reduced


def _reductions(reduced: list[Reduced]) -> str:
    from clerestory.words import percent

    rows = [
        [
            r.band,
            r.side,
            r.scatter,
            f"{r.report.leaves_before:,} to {r.report.leaves_after:,}",
            percent(r.report.rms_error),
            f"{r.report.worst_direct_hemispherical:.2g}",
        ]
        for r in reduced
    ]
    headers = ["band", "side", "scatter", "leaves", "RMS error", "worst direct-hemispherical difference"]
    return table(headers, rows, left=3)


def _report(reports: list[ConversionReport]) -> str:
    """The errors of a conversion, a line a component."""
    from clerestory.words import percent

    rows = []
    for r in reports:
        exact = r.samples == 0
        rows.append(
            [
                r.band,
                r.side,
                r.scatter,
                f"from {r.source}",
                "exact" if exact else "unknown" if r.rms_error is None else percent(r.rms_error),
                "" if exact else f"{r.worst_direct_hemispherical:.2g}",
            ]
        )
    headers = ["band", "side", "scatter", "", "sampling error (RMS)", "worst direct-hemispherical difference"]
    return table(headers, rows, left=4)
