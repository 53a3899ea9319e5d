"""`clerestory query`: one pair of directions, and the light from one direction into regions."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from clerestory.cli.common import (
    BandOption,
    FileArgument,
    JsonOption,
    SideOption,
    UsageError,
    about,
    angle_pair,
    numbers,
    print_json,
    read,
    say,
    side_of,
    table,
)

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from clerestory.basis import Basis
    from clerestory.bsdf import Bsdf, Region
    from clerestory.directions import Scatter, Side


@dataclass(frozen=True)
class Place:
    """A direction as it is read out."""

    theta_deg: float
    phi_deg: float
    side: Side
    words: str
    patch: str


@dataclass(frozen=True)
class Share:
    """Light into a region of outgoing directions."""

    region: str
    value: float
    standard_error: float


@dataclass(frozen=True)
class Beam:
    """A peak."""

    outgoing: Place
    value: float
    extent_deg: float


@dataclass(frozen=True)
class Answer:
    """What `query` prints."""

    file: Path
    band: str
    scatter: Scatter
    model: str
    by_reciprocity: bool
    incident: Place
    outgoing: Place
    bsdf_per_sr: float
    resolution_deg: float
    integrals: list[Share]
    peaks: list[Beam]


def query(
    file: FileArgument,
    *,
    incident: Annotated[
        str,
        typer.Option(
            "--incident",
            metavar="T,P",
            help="Where the light comes from: angle to the normal and azimuth in degrees; above is 90.",
            show_default=False,
        ),
    ],
    outgoing: Annotated[
        str | None,
        typer.Option("--outgoing", metavar="T,P", help="Where it leaves to; straight on, or mirrored, by default."),
    ] = None,
    band: BandOption = None,
    side: SideOption = "exterior",
    outgoing_side: Annotated[
        str | None,
        typer.Option("--outgoing-side", metavar="SIDE", help="Side that it leaves to; the other side by default."),
    ] = None,
    cone: Annotated[
        list[float] | None,
        typer.Option("--cone", metavar="A", help="Integrate within A degrees of the outgoing direction; repeatable."),
    ] = None,
    ring: Annotated[
        list[str] | None,
        typer.Option("--ring", metavar="A,B", help="Integrate between A and B degrees of it; repeatable."),
    ] = None,
    patch: Annotated[
        list[int] | None,
        typer.Option("--patch", metavar="N", help="Integrate over an outgoing patch, counted from 1; repeatable."),
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Say how much light from one direction leaves in another, and into regions around it.

    The first angle is that to the normal of the side in question. The azimuth is counted counter-clockwise from the
    right as seen from the room, on both sides: a sun above has azimuth 90.

    Example: clerestory query blind.xml --incident 40,90 --outgoing 30,270 --cone 5
    """
    from_side = side_of(side)
    other: Side = "interior" if from_side == "exterior" else "exterior"
    to_side = side_of(outgoing_side, "--outgoing-side") if outgoing_side else other
    scatter: Scatter = "reflection" if to_side == from_side else "transmission"
    toward = angle_pair(incident, "--incident")
    away = None if outgoing is None else angle_pair(outgoing, "--outgoing")
    rings = [(0.0, _angle(a)) for a in cone or []] + [_between(text) for text in ring or []]

    from clerestory.directions import direction
    from clerestory.integrals import continued
    from clerestory.words import band_name

    bsdf = read(file)
    with about(file):
        name = band_name(bsdf, band)
        model, by_reciprocity = bsdf.model(from_side, scatter, name)
        i = direction(*toward, side=from_side)
        o = continued(i, scatter) if away is None else direction(*away, side=to_side)
        bases = _bases(bsdf, from_side, scatter, name)
        answer = Answer(
            file,
            name,
            scatter,
            model.kind,
            by_reciprocity,
            _place(i, from_side, bases[0], leaving=False),
            _place(o, to_side, bases[1], leaving=True),
            float(bsdf.evaluate(i, o, name)),
            float(bsdf.resolution_deg(i, scatter, name)),
            [
                Share(words, *(float(x) for x in bsdf.integrate_with_error(i, scatter, region, name)))
                for words, region in _regions(o, rings, bases[1], patch or [])
            ],
            [
                Beam(_place(peak.outgoing, to_side, bases[1], leaving=True), peak.value, peak.extent_deg)
                for peak in bsdf.peaks(i, scatter, name)
            ],
        )
    if as_json:
        print_json(asdict(answer))
    else:
        _say(answer)


def _angle(value: float) -> float:
    if not 0.0 < value <= 180.0:
        raise UsageError(f"--cone {value:g}: not the half angle of a cone (give degrees, such as 5)")
    return value


def _between(text: str) -> tuple[float, float]:
    inner, outer = numbers(text, "--ring", 2, "5,15")
    if not 0.0 <= inner < outer <= 180.0:
        raise UsageError(f"--ring {text}: not an inner and a larger outer angle (give degrees, such as 5,15)")
    return inner, outer


def _bases(bsdf: Bsdf, side: Side, scatter: Scatter, band: str) -> tuple[Basis, Basis]:
    """The patches by which directions are named: the data's own, or Klems full."""
    from clerestory.basis import Basis

    model, _ = bsdf.model(side, scatter, band)
    if model.kind == "matrix":
        return model.incident_basis, model.outgoing_basis
    return Basis.named("klems-full"), Basis.named("klems-full")


def _place(d: NDArray[np.float64], side: Side, basis: Basis, *, leaving: bool) -> Place:
    from clerestory.directions import angles, incident_in_words, outgoing_in_words
    from clerestory.words import patch_name

    theta, phi = angles(d)
    index = int(basis.index_of_outgoing(d) if leaving else basis.index_of_incident(d))
    words = outgoing_in_words(d) if leaving else incident_in_words(d)
    return Place(round(float(theta), 6), round(float(phi), 6) % 360.0, side, words, patch_name(basis, index))


def _regions(
    outgoing: NDArray[np.float64], rings: list[tuple[float, float]], basis: Basis, patches: list[int]
) -> list[tuple[str, Region | None]]:
    from clerestory.bsdf import Region
    from clerestory.words import patch_name

    found: list[tuple[str, Region | None]] = [("all directions", None)]
    index = int(basis.index_of_outgoing(outgoing))
    found.append((f"patch {patch_name(basis, index)}", Region.patches(basis, [index])))
    for inner, outer in rings:
        words = f"within {outer:g}°" if inner == 0.0 else f"{inner:g}° to {outer:g}°"
        found.append((words, Region.ring(outgoing, inner, outer)))
    for number in patches:
        if not 1 <= number <= len(basis):
            raise UsageError(f"--patch {number}: {basis.name} has no such patch (give 1 to {len(basis)})")
        found.append((f"patch {patch_name(basis, number - 1)}", Region.patches(basis, [number - 1])))
    return found


def _say(answer: Answer) -> None:
    what = "passes" if answer.scatter == "transmission" else "is reflected"
    say(f"Light {answer.incident.words}, from the {answer.incident.side} ({answer.incident.patch}), in {answer.band}")
    say(f"that {what} and leaves {_leaving(answer.outgoing)}")
    say()
    resolution = f", resolved to {answer.resolution_deg:.2g}°" if answer.resolution_deg > 0.0 else ""
    say(f"  BSDF {answer.bsdf_per_sr:.6g} /sr ({answer.model}{resolution})")
    if answer.by_reciprocity:
        say("  answered by reciprocity: the file holds only the other side's data")
    say()
    errors = any(share.standard_error == share.standard_error for share in answer.integrals)  # not NaN
    rows = [
        [share.region, f"{share.value:.6f}", *([f"± {share.standard_error:.6f}"] if errors else [])]
        for share in answer.integrals
    ]
    say(table(["share of the light into", "", *([""] if errors else [])], rows))
    for peak in answer.peaks:
        width = f"{peak.extent_deg:.2g}° wide" if peak.extent_deg > 0.0 else "an ideal beam"
        say(f"  peak {_leaving(peak.outgoing)}: {peak.value:.6f}, {width}")


def _leaving(place: Place) -> str:
    target = "into the room" if place.side == "interior" else "to the outside"
    return f"{place.words}, {target} ({place.patch})"
