"""Zemax's tabular BSDF, which Radiant Imaging calls the BSDF data interchange file format.

A table of scatter angles about the specular direction for each angle of incidence and rotation of the sample, with
total integrated scatter; for one wavelength or the tristimulus values.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError, FileFormatError
from clerestory.counts import counted
from clerestory.measure.contents import Contents
from clerestory.measure.formats.choices import ABOVE_DEG, lit_side, sample_of
from clerestory.measure.formats.comments import conditions_of, pairs, stated
from clerestory.measure.formats.header import one_line, writable
from clerestory.measure.formats.names import plain
from clerestory.measure.formats.regrid import angular_table, is_half, left_out, specular_grid, table, whole
from clerestory.measure.formats.specular import distinct, from_specular, seen_from
from clerestory.measure.formats.tokens import Words, head_of, lines_of
from clerestory.measure.scan import Measurement, Scan
from clerestory.measure.source import Source, digest

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from clerestory.directions import Scatter, Side

    Floats = NDArray[np.float64]

NAME = "Zemax BSDF"
SUFFIX = ".bsdf"

_SYMMETRIES = {
    "planesymmetrical": "PlaneSymmetrical: one side of the plane of incidence is given and stands for both",
    "asymmetrical": "ASymmetrical",
    "asymmetrical4d": "ASymmetrical4D",
}
_ANGLES = (
    ("SampleRotation", -360.0, 360.0),
    ("AngleOfIncidence", 0.0, 90.0),
    ("ScatterAzimuth", -360.0, 360.0),
    ("ScatterRadial", 0.0, 180.0),
)
_BLOCKS = {"monochrome": "", "tristimulusx": "X", "tristimulusy": "Y", "tristimulusz": "Z"}
_CHANNELS = {"monochrome": ("",), "xyz": ("X", "Y", "Z")}


def recognises(data: bytes, name: str) -> bool:
    """Whether the keywords of the header are there; LightTools shares some of them."""
    head = head_of(data)
    starts = {line.split(None, 1)[0] for line in head if line}
    return {"scattertype", "symmetry"} <= starts and bool(starts & {"angleofincidence", "samplerotation"})


@dataclass(frozen=True)
class _Header:
    symmetry: str
    scatter: Scatter
    channels: tuple[str, ...]
    rotations: Floats
    incidences: Floats
    azimuths: Floats
    radials: Floats


def read(data: bytes, name: str, **choices: object) -> Contents:
    """Scans of a file, one for each angle of incidence and rotation of the sample.

    Parameters
    ----------
    data
        The file's bytes.
    name
        Its name, for messages.
    choices
        `side` that the light comes from (exterior), unless a comment `Incident side:` says it; `sample`.

    Raises
    ------
    FileFormatError
        A keyword, a count or a number is wrong, with its line.
    """
    lines = lines_of(data)
    begin = next((k for k, line in enumerate(lines) if line.strip().lower() == "databegin"), len(lines))
    words = Words(lines)
    header = _header(words)
    comments = pairs(line for line in lines[: begin + 1] if line.lstrip().startswith("#"))
    side = lit_side({"side": stated(comments, "incident side") or None, **{k: v for k, v in choices.items() if v}})
    conditions = conditions_of(comments)
    channels = header.channels
    if channels == ("",):
        channels = (f"{conditions['wavelength_nm']} nm" if "wavelength_nm" in conditions else "visible",)
    values, scattered = _blocks(words, header)
    source = Source(name, digest(data), NAME, tuple(lines[: begin + 1]), _convention(header, side))
    scans, dropped, zeros = [], 0, 0
    for r, rotation in enumerate(header.rotations):
        for i, incidence in enumerate(header.incidences):
            phi = float(seen_from(side, ABOVE_DEG - rotation))
            theta_deg, phi_deg, above = from_specular(
                header.radials, header.azimuths[:, None], float(incidence), phi, side, header.scatter
            )
            dropped += int((~above).sum())
            theta_deg, phi_deg, points = theta_deg[above], phi_deg[above], values[r, i][above]
            zeros += int((points == 0.0).all(axis=1).sum())
            kept = distinct(theta_deg, phi_deg, points)
            total = scattered[r, i, header.channels.index("Y") if "Y" in header.channels else 0]
            scans.append(
                Scan(
                    side,
                    header.scatter,
                    float(incidence),
                    phi,
                    theta_deg[kept],
                    phi_deg[kept],
                    points[kept],
                    channels=channels,
                    conditions=conditions | {"hemispherical": f"{total:.10g}", "symmetry": header.symmetry},
                    source=source,
                )
            )
    notes = []
    if dropped:
        notes.append(f"{name}: {counted(dropped, 'value')} at or beyond the horizon left out")
    if zeros:
        notes.append(f"{name}: {counted(zeros, 'value')} above the horizon are 0, perhaps not measured")
    measurement = Measurement(sample_of(choices, name, stated(comments, "sample")), tuple(scans))
    return Contents((measurement,), (), tuple(notes))


def _header(words: Words) -> _Header:
    """Keywords up to the first block."""
    texts: dict[str, str] = {}
    angles: dict[str, Floats] = {}
    limits = {key.lower(): (key, low, high) for key, low, high in _ANGLES}
    while words.peek() not in _BLOCKS and words.peek() != "databegin":
        line = words.line
        word = words.take("a keyword").lower()
        if word in limits:
            key, low, high = limits[word]
            angles[word] = words.angles(f"angles of {key}", low, high)
        elif word in ("source", "symmetry", "spectralcontent", "scattertype"):
            texts[word] = words.take(f"the value of {word}").lower()
        else:
            raise FileFormatError(
                f"line {line}: {word[:40]!r} is no keyword of a Zemax BSDF (do the counts before it hold?)"
            )
    missing = [key for key in ("symmetry", "spectralcontent", "scattertype") if key not in texts]
    missing += [key for key in limits if key not in angles]
    if missing:
        raise FileFormatError(f"line {words.line}: the data begin without {', '.join(missing)} (is the header whole?)")
    if texts["symmetry"] not in _SYMMETRIES:
        raise FileFormatError(f"Symmetry {texts['symmetry']!r} is not one of {', '.join(_SYMMETRIES)} (correct it)")
    if texts["spectralcontent"] not in _CHANNELS:
        raise FileFormatError(f"SpectralContent {texts['spectralcontent']!r} is not Monochrome or XYZ (correct it)")
    if texts["scattertype"] not in ("brdf", "btdf"):
        raise FileFormatError(f"ScatterType {texts['scattertype']!r} is not BRDF or BTDF (correct it)")
    return _Header(
        _SYMMETRIES[texts["symmetry"]],
        "reflection" if texts["scattertype"] == "brdf" else "transmission",
        _CHANNELS[texts["spectralcontent"]],
        *(angles[key] for key in limits),
    )


def _blocks(words: Words, header: _Header) -> tuple[Floats, Floats]:
    """Values (rotations, incidences, azimuths, radials, channels) and TIS (rotations, incidences, channels)."""
    size = len(header.azimuths) * len(header.radials)
    outer = (len(header.rotations), len(header.incidences))
    found: dict[str, tuple[list[Floats], list[float]]] = {}
    while len(words):
        line = words.line
        word = words.take("a block").lower()
        if word not in _BLOCKS or _BLOCKS[word] not in header.channels:
            raise FileFormatError(
                f"line {line}: {word[:40]!r} where a block of "
                f"{'Tristimulus' if len(header.channels) > 1 else 'Monochrome'} should be (do the counts hold?)"
            )
        channel = _BLOCKS[word]
        if channel in found:
            raise FileFormatError(f"line {line}: a second block of {word} (keep one)")
        _expect(words, "DataBegin")
        tables: list[Floats] = []
        totals: list[float] = []
        for _ in range(outer[0] * outer[1]):
            _expect(words, "TIS")
            totals.append(words.number("total integrated scatter"))
            tables.append(words.numbers(size, "values of the table"))
        _expect(words, "DataEnd")
        found[channel] = (tables, totals)
    missing = [channel or "Monochrome" for channel in header.channels if channel not in found]
    if missing:
        raise FileFormatError(f"line {words.line}: no block of {', '.join(missing)} (is the file whole?)")
    shape = (*outer, len(header.azimuths), len(header.radials))
    values = [np.array(found[channel][0]).reshape(shape) for channel in header.channels]
    scattered = [np.array(found[channel][1]).reshape(outer) for channel in header.channels]
    return np.stack(values, axis=-1), np.stack(scattered, axis=-1)


def _expect(words: Words, keyword: str) -> None:
    line = words.line
    word = words.take(keyword)
    if word.lower() != keyword.lower():
        raise FileFormatError(f"line {line}: {word[:40]!r} where {keyword} should be (do the counts hold?)")


def _convention(header: _Header, side: Side) -> str:
    text = (
        "scatter angles about the specular direction, azimuth 0 toward the normal, counter-clockwise against it; "
        f"light on the {side}, from above at sample rotation 0, the sample turned counter-clockwise as seen from there"
    )
    if header.scatter == "transmission":
        text += "; AngleOfIncidence is the angle of the straight beam behind the sample, taken as that of incidence too"
        text += " (a thin sheet; light refracted into a body would come at another)"
    return text


def write(measurement: Measurement, **choices: object) -> dict[str, bytes]:
    """Files of a measurement, one for each lit side, scatter and set of channels.

    Scans that lie on one table about their specular directions are written as they are. Others are interpolated
    linearly onto one; directions outside of what was measured take the nearest value there, as a comment says.

    Parameters
    ----------
    measurement
        Scans of BSDF or DSF with one channel, or X, Y and Z.
    choices
        None.

    Returns
    -------
    Content by name of file.

    Raises
    ------
    ClerestoryError
        There are no scans of a sample, a signal is not prepared, or incident directions do not form a table.
    """
    groups: dict[tuple[Side, Scatter, tuple[str, ...]], list[Scan]] = {}
    for scan in measurement.of():
        writable(scan, NAME)
        bsdf = scan.as_bsdf()
        names = (bsdf.channels,) if set(bsdf.channels) == {"X", "Y", "Z"} else tuple((c,) for c in bsdf.channels)
        for channels in names:
            groups.setdefault((bsdf.incident_side, bsdf.scatter, channels), []).append(bsdf)
    if not groups:
        raise ClerestoryError(f"no scan of the sample {measurement.sample} to write (prepare it first)")
    files = {}
    for (side, scatter, channels), scans in groups.items():
        kind = "BRDF" if scatter == "reflection" else "BTDF"
        words = [measurement.sample, side, kind.lower()]
        if len({names for s, t, names in groups if (s, t) == (side, scatter)}) > 1:
            words.append("".join(channels))
        files[f"{plain('_'.join(words))}{SUFFIX}"] = _text(measurement.sample, side, scatter, channels, scans).encode()
    return files


def notes(measurement: Measurement) -> list[str]:
    """What the format cannot hold of a measurement."""
    return left_out(measurement, NAME)


def _text(sample: str, side: Side, scatter: Scatter, channels: tuple[str, ...], scans: Sequence[Scan]) -> str:
    rotations = [float(np.round((ABOVE_DEG - seen_from(side, scan.incident_phi_deg)) % 360.0, 6)) for scan in scans]
    if not all(is_half(scan) for scan in scans):
        scans = [whole(scan) for scan in scans]
    by_place = angular_table(rotations, scans)
    azimuths, radials, half = specular_grid(scans)
    symmetry = "PlaneSymmetrical" if half else "ASymmetrical" if len(by_place) == 1 else "ASymmetrical4D"
    incidences = sorted(next(iter(by_place.values())))
    tables = {
        (rotation, incidence): table(
            scan,
            channels,
            *from_specular(radials, azimuths[:, None], incidence, scan.incident_phi_deg, side, scatter),
            polar_deg=radials,
            azimuth_deg=azimuths,
            half=half,
        )
        for rotation, row in by_place.items()
        for incidence, scan in row.items()
    }
    guessed = sum(found.guessed for found in tables.values())
    out = [f"# Sample: {one_line(sample)}", f"# Incident side: {side}"]
    out += [f"# {one_line(key)}: {one_line(value)}" for key, value in _kept(scans[0].conditions, channels).items()]
    if guessed:
        out.append(f"# Values outside of the measured directions, which repeat the nearest measured one: {guessed}")
    out += ["Source\tMeasured", f"Symmetry\t{symmetry}"]
    out.append(f"SpectralContent\t{'XYZ' if len(channels) == 3 else 'Monochrome'}")
    out.append(f"ScatterType\t{'BRDF' if scatter == 'reflection' else 'BTDF'}")
    lists = (np.array(list(by_place)), np.array(incidences), azimuths, radials)
    for (key, _, _), angles in zip(_ANGLES, lists, strict=True):
        out += [f"{key}\t{len(angles)}", "\t".join(f"{angle:.10g}" for angle in angles)]
    out.append("")
    for k, channel in enumerate(channels):
        out += [f"Tristimulus{channel}" if len(channels) == 3 else "Monochrome", "DataBegin"]
        for rotation in by_place:
            for incidence in incidences:
                found = tables[rotation, incidence]
                out.append(f"TIS\t{found.totals[k]:.6g}")
                out += ["\t".join(f"{value:.6e}" for value in row) for row in found.values[..., k]]
        out.append("DataEnd")
    return "\n".join(out) + "\n"


def _kept(conditions: Mapping[str, str], channels: tuple[str, ...]) -> dict[str, str]:
    """What the header keeps of a scan's conditions; TIS and Symmetry are said by keywords."""
    kept = {key: value for key, value in conditions.items() if key not in ("hemispherical", "symmetry")}
    if len(channels) == 1 and channels[0].endswith(" nm"):
        kept["wavelength_nm"] = channels[0].removesuffix(" nm")
    return kept
