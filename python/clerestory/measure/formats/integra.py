"""Integra's diffuse distributions: DDR (reflection) and DDT (transmission) text, about the specular direction."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import numpy as np

from clerestory._core import FileFormatError
from clerestory.counts import counted
from clerestory.measure.contents import Contents
from clerestory.measure.formats.choices import ABOVE_DEG, lit_side, sample_of, scatter_of
from clerestory.measure.formats.specular import distinct, from_specular, seen_from
from clerestory.measure.formats.tokens import Words, head_of, lines_of, within
from clerestory.measure.scan import Measurement, Scan
from clerestory.measure.source import Source, digest

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from clerestory.directions import Scatter, Side
    from clerestory.measure.scan import Quantity

    Floats = NDArray[np.float64]

NAME = "Integra DDR/DDT"
COMMENTS = (";", "#", "//")
CHANNELS = {
    "bw": "visible",
    "red": "red",
    "gre": "green",
    "green": "green",
    "blu": "blue",
    "blue": "blue",
}
"""Names of channels; a spectral one is `wl` with its wavelength [nm]."""
SOURCES = ("measured", "generated", "edited", "morphed")

_SYMMETRIES = {
    "axisymmetrical": "AxiSymmetrical: the same at every azimuth about the specular direction",
    "dirsymmetrical": "DirSymmetrical",
    "planesymmetrical": "PlaneSymmetrical: one side of the plane of incidence is given and stands for both",
    "asymmetrical": "ASymmetrical",
}
_ANGLES = {"psi": (-360.0, 360.0), "sigma": (0.0, 90.0), "phi": (-360.0, 360.0), "theta": (0.0, 180.0)}


def recognises(data: bytes, name: str) -> bool:
    """Whether the keywords of its header are there."""
    starts = {line.split(None, 1)[0] for line in head_of(data) if line}
    return {"typesym", "typecolormodel"} <= starts or {"typesym", "typedata"} <= starts


def suffix_scatter(choices: Mapping[str, object], name: str, reflection: str, transmission: str) -> Scatter:
    """Which scatter a file is of, which only its name's end tells.

    Raises
    ------
    FileFormatError
        Nothing tells.
    """
    said = scatter_of(choices)
    if said:
        return said
    for end, scatter in ((reflection, "reflection"), (transmission, "transmission")):
        if name.lower().endswith(end):
            return cast("Scatter", scatter)
    raise FileFormatError(
        f"the file does not say whether it is reflection or transmission (name it {reflection} or {transmission},"
        " or give scatter)"
    )


@dataclass
class _Header:
    symmetry: str = ""
    colours: int = 0
    intensity: bool = False
    relative: bool = False
    rotations: Floats | None = None
    incidences: Floats | None = None
    exits: Floats | None = None
    azimuths: Floats | None = None
    polars: Floats | None = None


def read(data: bytes, name: str, **choices: object) -> Contents:
    """Scans of a file, one for each angle of incidence and rotation of the sample.

    Parameters
    ----------
    data
        The file's bytes.
    name
        Its name, whose end tells reflection (.ddr) from transmission (.ddt).
    choices
        `scatter` where the name does not tell; `side` that the light comes from (exterior); `sample`.

    Raises
    ------
    FileFormatError
        A keyword, a count or a number is wrong, with its line.
    """
    scatter, side = suffix_scatter(choices, name, ".ddr", ".ddt"), lit_side(choices)
    lines = lines_of(data)
    words = Words(lines, COMMENTS)
    header = _header(words)
    head = tuple(lines[: words.line - 1])
    rotations, incidences, azimuths, polars = (
        cast("Floats", a) for a in (header.rotations, header.incidences, header.azimuths, header.polars)
    )
    shape = (len(rotations), len(incidences), len(azimuths), len(polars))
    values, factors = _channels(words, header.colours, shape)
    # Luminance is the radiance factor, π times the BSDF; intensity is that times the cosine: π/π of the DSF.
    scaled = {c: v if header.relative else v * factors[c][..., None, None] for c, v in values.items()}
    stacked = np.stack(list(scaled.values()), axis=-1) / (1.0 if header.intensity else np.pi)
    quantity: Quantity = "signal" if header.relative else "dsf" if header.intensity else "bsdf"
    source = Source(name, digest(data), NAME, head, _convention(scatter, side, refracted=header.exits is not None))
    scans, dropped = [], 0
    exits = incidences if header.exits is None else header.exits
    for r, rotation in enumerate(rotations):
        for i, incidence in enumerate(incidences):
            phi = float(seen_from(side, ABOVE_DEG + rotation))
            theta_deg, phi_deg, above = from_specular(polars, azimuths[:, None], float(exits[i]), phi, side, scatter)
            dropped += int((~above).sum())
            theta_deg, phi_deg, points = theta_deg[above], phi_deg[above], stacked[r, i][above]
            kept = distinct(theta_deg, phi_deg, points)
            conditions = {"symmetry": header.symmetry}
            if header.relative and factors:
                first = next(iter(factors.values()))
                conditions["hemispherical"] = f"{first[r, i]:.10g}"
            scans.append(
                Scan(
                    side,
                    scatter,
                    float(incidence),
                    phi,
                    theta_deg[kept],
                    phi_deg[kept],
                    points[kept],
                    quantity=quantity,
                    channels=tuple(values),
                    conditions=conditions,
                    source=source,
                )
            )
    notes = [f"{name}: {counted(dropped, 'value')} at or beyond the horizon left out"] if dropped else []
    if header.relative:
        notes.append(f"{name}: values are relative, taken as a signal (scale them to a direct-hemispherical value)")
    return Contents((Measurement(sample_of(choices, name), tuple(scans)),), (), tuple(notes))


def _header(words: Words) -> _Header:
    """Keywords up to the first channel."""
    header, angles = _Header(), {}
    while words.peek() not in CHANNELS and words.peek() != "wl":
        line = words.line
        word = words.take("a channel (bw, red or wl)").lower()
        if word in _ANGLES:
            angles[word] = words.angles(f"angles of {word}", *_ANGLES[word])
        elif word == "sigmat":
            if "sigma" not in angles:
                raise FileFormatError(f"line {line}: sigmaT before sigma, whose angles it goes with (put it after)")
            header.exits = words.numbers(len(angles["sigma"]), "angles of sigmaT")
            within(header.exits, "sigmaT", 0.0, 90.0, line)
        elif word == "source":
            if words.take("the value of Source").lower() not in SOURCES:
                raise FileFormatError(f"line {line}: Source is not one of {', '.join(SOURCES)} (correct it)")
        elif word == "typesym":
            value = words.take("the value of TypeSym").lower()
            if value not in _SYMMETRIES:
                raise FileFormatError(f"line {line}: TypeSym {value[:40]!r} is not known ({', '.join(_SYMMETRIES)})")
            header.symmetry = _SYMMETRIES[value]
            if value == "asymmetrical" and words.peek() == "4d":
                words.take("4D")
        elif word == "typecolormodel":
            header.colours = colours_of(words, line)
        elif word == "typedata":
            kinds = (words.take("the value of TypeData") + " " + words.rest_of_line()).lower().split()
            if kinds[0] not in ("luminance", "intensity") or kinds[1:2] not in ([], ["absolute"], ["relative"]):
                raise FileFormatError(
                    f"line {line}: TypeData {' '.join(kinds)[:40]!r} is not known (Luminance or Intensity Absolute)"
                )
            header.intensity, header.relative = kinds[0] == "intensity", kinds[1:2] == ["relative"]
        else:
            raise FileFormatError(f"line {line}: {word[:40]!r} is no keyword of Integra's text (do the counts hold?)")
    header.rotations = angles.get("psi", np.zeros(1))
    header.incidences, header.azimuths, header.polars = (angles.get(key) for key in ("sigma", "phi", "theta"))
    missing = [key for key in ("sigma", "phi", "theta") if key not in angles]
    missing += [key for key, value in (("TypeSym", header.symmetry), ("TypeColorModel", header.colours)) if not value]
    if missing:
        raise FileFormatError(f"line {words.line}: the data begin without {', '.join(missing)} (is it whole?)")
    return header


def colours_of(words: Words, line: int) -> int:
    """The number of channels that the colour model has.

    Raises
    ------
    FileFormatError
        It is not known.
    """
    value = words.take("the value of TypeColorModel").lower()
    if value == "spectral":
        return words.count("wavelengths")
    if value not in ("bw", "rgb"):
        raise FileFormatError(f"line {line}: TypeColorModel {value[:40]!r} is not BW, RGB or Spectral (correct it)")
    return 1 if value == "bw" else 3


def channel_of(words: Words) -> tuple[str, int]:
    """Name of the channel that begins, and its line.

    Raises
    ------
    FileFormatError
        None begins.
    """
    line = words.line
    word = words.take("a channel (bw, red or wl)").lower()
    if word == "wl":
        return f"{words.number('a wavelength'):.10g} nm", line
    if word not in CHANNELS:
        raise FileFormatError(f"line {line}: {word[:40]!r} where a channel should begin (do the counts hold?)")
    return CHANNELS[word], line


def _channels(
    words: Words, colours: int, shape: tuple[int, int, int, int]
) -> tuple[dict[str, Floats], dict[str, Floats]]:
    """Values (rotations, incidences, azimuths, polar angles) and factors (rotations, incidences) by channel."""
    values: dict[str, Floats] = {}
    factors: dict[str, Floats] = {}
    for _ in range(colours):
        channel, line = channel_of(words)
        if channel in values:
            raise FileFormatError(f"line {line}: a second channel {channel} (keep one)")
        factors[channel] = np.ones(shape[:2])
        if words.peek() == "kbdf":
            words.take("kbdf")
            factors[channel] = words.numbers(shape[0] * shape[1], "factors of kbdf").reshape(shape[:2])
        if words.peek() == "def":
            words.take("def")
        size = shape[0] * shape[1] * shape[2] * shape[3]
        values[channel] = words.numbers(size, "values of the table").reshape(shape)
    if len(words):
        raise FileFormatError(f"line {words.line}: {words.peek()[:40]!r} after the last channel (do the counts hold?)")
    return values, factors


def _convention(scatter: Scatter, side: Side, *, refracted: bool) -> str:
    text = (
        "scatter angles about the specular direction, azimuth 0 toward the normal, counter-clockwise against it; "
        f"light on the {side}, from above at psi 0, turned counter-clockwise by psi as seen from there"
    )
    if scatter == "transmission":
        text += "; the straight beam leaves at sigmaT" if refracted else "; the straight beam is not refracted"
    return text
