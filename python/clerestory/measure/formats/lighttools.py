"""LightTools' BSDF text: absolute scatter angles about the normal, a block for each incident direction and channel.

Its containers of optical properties (.opr) and its binary scatter data (.bsd) have no public layout.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar, cast

import numpy as np

from clerestory._core import ClerestoryError, FileFormatError
from clerestory.counts import counted
from clerestory.directions import SIDES
from clerestory.measure.contents import Contents
from clerestory.measure.formats import reflectances
from clerestory.measure.formats.choices import ABOVE_DEG, lit_side, sample_of
from clerestory.measure.formats.comments import conditions_of, pairs, stated
from clerestory.measure.formats.header import one_line, writable
from clerestory.measure.formats.names import plain
from clerestory.measure.formats.regrid import absolute_grid, left_out, table, whole
from clerestory.measure.formats.specular import HORIZON, distinct, seen_from
from clerestory.measure.formats.tokens import Words, head_of, lines_of
from clerestory.measure.scan import Measurement, Scan
from clerestory.measure.source import Source, digest

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from clerestory.directions import Scatter, Side

    Floats = NDArray[np.float64]

T = TypeVar("T")

NAME = "LightTools BSDF"
SUFFIX = ".bsdf"

_SYMMETRIES = {
    "planesymmetrical": "PlaneSymmetrical: one side of the plane of incidence is given and stands for both",
    "asymmetric": "Asymmetric",
    "asymmetrical": "Asymmetric",
}
_CHANNELS = {"trisx": "X", "trisy": "Y", "trisz": "Z"}
_TYPES: dict[str, Scatter] = {"brdf": "reflection", "btdf": "transmission"}


def recognises(data: bytes, name: str) -> bool:
    """Whether the keywords of the header and of the first block are there."""
    starts = {line.split(None, 1)[0] for line in head_of(data) if line}
    return {"symmetry", "scatterradial"} <= starts and not {"angleofincidence", "samplerotation"} & starts


@dataclass
class _Block:
    line: int
    incidence: float | None = None
    azimuth: float = 0.0
    front: bool = True
    wavelength: float | None = None
    scatter: Scatter | None = None
    channel: str = ""


def read(data: bytes, name: str, **choices: object) -> Contents:
    """Scans of a file, one for each incident direction, side and scatter.

    Parameters
    ----------
    data
        The file's bytes.
    name
        Its name, for messages.
    choices
        `side` that its front is (exterior), unless a comment `Front side:` says it; `sample`.

    Raises
    ------
    FileFormatError
        A keyword, a count or a number is wrong, with its line.
    """
    lines = lines_of(data)
    begin = next((k for k, line in enumerate(lines) if line.strip().lower() == "databegin"), len(lines))
    header = tuple(lines[: begin + 1])
    comments = pairs(line for line in header if line.lstrip().startswith("#"))
    front = lit_side({"side": stated(comments, "front side") or None, **{k: v for k, v in choices.items() if v}})
    band = stated(comments, "band")
    words = Words(lines)
    symmetry, colour, azimuths, polars = _header(words)
    found: dict[tuple[bool, Scatter, float, float], dict[str, tuple[Floats, float]]] = {}
    notes = []
    while words.peek() != "dataend":
        block, total, values = _block(words, len(azimuths) * len(polars), colour=colour)
        scatter, incidence = cast("Scatter", block.scatter), cast("float", block.incidence)
        if incidence > 90.0:
            notes.append(f"{name}: AOI {incidence:g}° on the back is taken as {180.0 - incidence:g}° from its normal")
            incidence = 180.0 - incidence
        channel = block.channel or band or (f"{block.wavelength:.10g} nm" if block.wavelength else "visible")
        group = found.setdefault((block.front, scatter, incidence, block.azimuth), {})
        if channel in group:
            raise FileFormatError(f"line {block.line}: a second block of {channel} for this direction (keep one)")
        group[channel] = (values, total)
    words.take("DataEnd")
    if len(words):
        raise FileFormatError(f"line {words.line}: {words.peek()[:40]!r} after DataEnd (keep one set of data a file)")
    source = Source(name, digest(data), NAME, header, _convention(front))
    conditions = conditions_of({k: v for k, v in comments.items() if k.lower() not in ("front side", "band")})
    scans, dropped = [], 0
    for (is_front, scatter, incidence, azimuth), group in found.items():
        side = front if is_front else SIDES[1 - SIDES.index(front)]
        # Some tables of transmission go on to 180° behind the sample.
        behind = scatter == "transmission" and polars.max() > 90.0
        theta = np.where(polars > 90.0, 180.0 - polars, polars)
        above = ((polars > 90.0) == behind) & (np.cos(np.radians(theta)) > HORIZON)
        dropped += int((~above).sum()) * len(azimuths)
        theta_deg, phi_deg = (a.ravel() for a in np.broadcast_arrays(theta[above], azimuths[:, None]))
        values = np.stack([v.reshape(len(azimuths), -1)[:, above].ravel() for v, _ in group.values()], axis=-1)
        kept = distinct(theta_deg, phi_deg, values)
        totals = {channel: total for channel, (_, total) in group.items()}
        stated_total = totals.get("Y", next(iter(totals.values())))
        scans.append(
            Scan(
                side,
                scatter,
                incidence,
                float(seen_from(front, ABOVE_DEG + azimuth)),
                theta_deg[kept],
                seen_from(front, phi_deg[kept]),
                values[kept],
                channels=tuple(group),
                conditions=conditions | {"hemispherical": f"{stated_total:.10g}", "symmetry": symmetry},
                source=source,
            )
        )
    if dropped:
        notes.append(f"{name}: {counted(dropped, 'value')} at or beyond the horizon left out")
    measurement = Measurement(sample_of(choices, name, stated(comments, "sample")), tuple(scans))
    return Contents((measurement,), (), tuple(dict.fromkeys(notes)))


def _header(words: Words) -> tuple[str, bool, Floats, Floats]:
    """Symmetry in words, whether there is colour, azimuths and polar angles [°]."""
    symmetry, colour = "", None
    angles: dict[str, Floats] = {}
    while words.peek() != "databegin":
        line = words.line
        word = words.take("DataBegin").lower()
        if word == "symmetry":
            value = words.take("the value of Symmetry")
            symmetry = _SYMMETRIES.get(value.lower(), "")
            if not symmetry:
                raise FileFormatError(
                    f"line {line}: Symmetry {value!r} is not PlaneSymmetrical or Asymmetric (correct it)"
                )
        elif word == "spectralcontent":
            value = words.take("the value of SpectralContent").lower()
            if value not in ("monochrome", "xyz"):
                raise FileFormatError(f"line {line}: SpectralContent {value!r} is not Monochrome or XYZ (correct it)")
            colour = value == "xyz"
        elif word == "scatterazimuth":
            angles[word] = words.angles("angles of ScatterAzimuth", -360.0, 720.0)
        elif word == "scatterradial":
            angles[word] = words.angles("angles of ScatterRadial", 0.0, 180.0)
        elif word in ("source", "version"):
            words.rest_of_line()
        else:
            raise FileFormatError(
                f"line {line}: {word[:40]!r} is no keyword of a LightTools BSDF (do the counts before it hold?)"
            )
    missing = [key for key in ("scatterazimuth", "scatterradial") if key not in angles]
    missing += [key for key, value in (("symmetry", symmetry), ("spectralcontent", colour)) if value in ("", None)]
    if missing:
        raise FileFormatError(f"line {words.line}: the data begin without {', '.join(missing)} (is the header whole?)")
    words.take("DataBegin")
    return symmetry, bool(colour), angles["scatterazimuth"], angles["scatterradial"]


def _block(words: Words, size: int, *, colour: bool) -> tuple[_Block, float, Floats]:
    """A block up to its last value: its head, total integrated scatter and values (size,)."""
    block = _Block(words.line)
    while (word := words.peek()) != "tis":
        line = words.line
        words.take("TIS")
        if word == "aoi":
            block.incidence = words.number("AOI")
            if not 0.0 <= block.incidence <= 180.0:
                raise FileFormatError(f"line {line}: AOI {block.incidence:g} is not an angle of 0 to 180° (correct it)")
        elif word == "poi":
            block.azimuth = words.number("POI")
            if not abs(block.azimuth) <= 360.0:
                raise FileFormatError(f"line {line}: POI {block.azimuth:g} is not an angle up to 360° (correct it)")
        elif word == "side":
            block.front = _known(words, "Side", {"front": True, "back": False})
        elif word == "wavelength":
            block.wavelength = words.number("Wavelength")
        elif word == "scattertype":
            block.scatter = _known(words, "ScatterType", _TYPES)
        elif word == "tristimulusvalue":
            block.channel = _known(words, "TristimulusValue", _CHANNELS)
        else:
            raise FileFormatError(f"line {line}: {word[:40]!r} is no keyword of a block (do the counts hold?)")
    missing = [key for key, value in (("AOI", block.incidence), ("ScatterType", block.scatter)) if value is None]
    if colour and not block.channel:
        missing.append("TristimulusValue")
    if missing:
        raise FileFormatError(f"line {words.line}: a block without {', '.join(missing)} (add it)")
    words.take("TIS")
    return block, words.number("total integrated scatter"), words.numbers(size, "values of the table")


def _known(words: Words, key: str, known: Mapping[str, T]) -> T:
    line = words.line
    value = words.take(f"the value of {key}")
    if value.lower() not in known:
        raise FileFormatError(f"line {line}: {key} {value[:40]!r} is not known ({', '.join(known)})")
    return known[value.lower()]


def _convention(front: Side) -> str:
    return (
        f"polar angles from the normal, azimuths counter-clockwise from the right as seen from the front, the {front}; "
        "light of POI 0 from above (azimuth 90°), that of another POI turned from there by it"
    )


def write(measurement: Measurement, **choices: object) -> dict[str, bytes]:
    """The set of files of a measurement: its scatter data, and its direct-hemispherical values if there is an interior.

    Scans of one table of absolute angles are written as they are. Others are interpolated linearly onto one;
    directions outside of what was measured take the nearest value there, as a comment says. Scans that hold one side
    of a plane of symmetry are mirrored at it.

    Parameters
    ----------
    measurement
        Scans of BSDF or DSF, all of one wavelength or band, or of X, Y and Z.
    choices
        None.

    Returns
    -------
    Content by name of file: the scatter data, and a table of AOI, transmittance and reflectance for each lit side.

    Raises
    ------
    ClerestoryError
        There are no scans of a sample, a signal is not prepared, or a direction is there twice.
    """
    for scan in measurement.of():
        writable(scan, NAME)
    scans = [whole(scan.as_bsdf()) for scan in measurement.of()]
    if not scans:
        raise ClerestoryError(f"no scan of the sample {measurement.sample} to write (prepare it first)")
    if len({frozenset(scan.channels) for scan in scans}) > 1:
        raise ClerestoryError("scans of several sets of channels do not fit one LightTools file (choose one set)")
    colour = set(scans[0].channels) == {"X", "Y", "Z"}
    if not colour and len(scans[0].channels) > 1 and not all(c.endswith(" nm") for c in scans[0].channels):
        raise ClerestoryError(
            f"LightTools has X, Y and Z or wavelengths, not {', '.join(scans[0].channels)} (choose one channel)"
        )
    azimuths, polars = absolute_grid(scans)
    names = {"X": "TrisX", "Y": "TrisY", "Z": "TrisZ"}
    blocks: list[str] = []
    totals: dict[tuple[Side, Scatter, float], float] = {}
    seen: set[tuple[Side, Scatter, float, float]] = set()
    guessed = 0
    for scan in scans:
        side, azimuth = scan.incident_side, _plane(scan)
        key = (side, scan.scatter, round(scan.incident_theta_deg, 6), azimuth)
        if key in seen:
            raise ClerestoryError(
                f"two scans of light from {key[2]:g}° at azimuth {scan.incident_phi_deg:g}° (combine them)"
            )
        seen.add(key)
        theta, phi = np.broadcast_arrays(polars, seen_from(SIDES[0], azimuths)[:, None])
        above = np.cos(np.radians(theta)) > HORIZON
        found = table(scan, scan.channels, theta, phi, above, polar_deg=polars, azimuth_deg=azimuths, half=False)
        guessed += found.guessed
        totals[key[:3]] = float(found.totals[scan.channels.index("Y") if colour else 0])
        for k, channel in enumerate(scan.channels):
            blocks += [f"AOI {scan.incident_theta_deg:.10g}", f"POI {azimuth:.10g}"]
            blocks += [f"Side {'Front' if side == SIDES[0] else 'Back'}", f"Wavelength {_wavelength(scan, channel)}"]
            blocks.append(f"ScatterType {'BRDF' if scan.scatter == 'reflection' else 'BTDF'}")
            blocks += [f"TristimulusValue {names[channel]}"] if colour else []
            blocks.append(f"TIS {found.totals[k]:.6g}")
            blocks += [" ".join(f"{value:.6e}" for value in row) for row in found.values[..., k]]
    out = [f"# Sample: {one_line(measurement.sample)}", f"# Front side: {SIDES[0]}"]
    kept = {k: v for k, v in scans[0].conditions.items() if k not in ("hemispherical", "symmetry", "wavelength_nm")}
    out += [f"# {one_line(key)}: {one_line(value)}" for key, value in kept.items()]
    if guessed:
        out.append(f"# Values outside of the measured directions, which repeat the nearest measured one: {guessed}")
    if not colour and not scans[0].channels[0].endswith(" nm"):
        out.append(f"# Band: {scans[0].channels[0]}")
    out += ["Symmetry Asymmetric", f"SpectralContent {'XYZ' if colour else 'Monochrome'}"]
    for key_of, angles in (("ScatterAzimuth", azimuths), ("ScatterRadial", polars)):
        out += [f"{key_of} {len(angles)}", " ".join(f"{angle:.10g}" for angle in angles)]
    stem = plain(measurement.sample)
    files = {f"{stem}{SUFFIX}": ("\n".join([*out, "DataBegin", *blocks, "DataEnd"]) + "\n").encode()}
    for side in SIDES:
        rows = reflectances.text(side, totals)
        if rows:
            files[f"{stem}_{side}_RTfile.txt"] = rows.encode()
    return files


def notes(measurement: Measurement) -> list[str]:
    """What the format cannot hold of a measurement."""
    return left_out(measurement, NAME)


def _plane(scan: Scan) -> float:
    """POI [°]: the azimuth of the light from the one that POI 0 stands for, as seen from the front."""
    return float(np.round((seen_from(SIDES[0], scan.incident_phi_deg) - ABOVE_DEG) % 360.0, 6))


def _wavelength(scan: Scan, channel: str) -> str:
    if channel.endswith(" nm"):
        return channel.removesuffix(" nm")
    return scan.conditions.get("wavelength_nm", "555")
