"""Integra's specular distributions: SDR (reflection) and SDT (transmission) text, shares by the angle of incidence."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import FileFormatError
from clerestory.measure.contents import Contents
from clerestory.measure.formats.choices import lit_side, sample_of
from clerestory.measure.formats.integra import COMMENTS, SOURCES, channel_of, colours_of, suffix_scatter
from clerestory.measure.formats.tokens import Words, head_of, lines_of
from clerestory.measure.source import Source, digest
from clerestory.measure.sphere import SphereValues

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

NAME = "Integra SDR/SDT"


def recognises(data: bytes, name: str) -> bool:
    """Whether the keywords of its header are there, and none of the scatter angles that a DDR has."""
    starts = {line.split(None, 1)[0] for line in head_of(data) if line}
    return {"typecolormodel", "sigma"} <= starts and not {"typesym", "phi", "theta"} & starts


def read(data: bytes, name: str, **choices: object) -> Contents:
    """Specular reflectances or transmittances of a file, one set for each angle of incidence.

    Parameters
    ----------
    data
        The file's bytes.
    name
        Its name, whose end tells reflection (.sdr) from transmission (.sdt).
    choices
        `scatter` where the name does not tell; `side` that the light comes from (exterior); `sample`.

    Raises
    ------
    FileFormatError
        A keyword, a count or a number is wrong, with its line.
    """
    scatter, side = suffix_scatter(choices, name, ".sdr", ".sdt"), lit_side(choices)
    lines = lines_of(data)
    words = Words(lines, COMMENTS)
    colours, incidences = _header(words)
    source = Source(
        name,
        digest(data),
        NAME,
        tuple(lines[: words.line - 1]),
        f"sigma from the normal of the {side}; shares of the light",
    )
    found: dict[str, Floats] = {}
    for _ in range(colours):
        channel, line = channel_of(words)
        if channel in found:
            raise FileFormatError(f"line {line}: a second channel {channel} (keep one)")
        if words.peek() == "def":
            words.take("def")
        found[channel] = words.numbers(len(incidences), "shares")
    if len(words):
        raise FileFormatError(f"line {words.line}: {words.peek()[:40]!r} after the last channel (do the counts hold?)")
    values = np.stack(list(found.values()), axis=-1)
    spectral = all(channel.endswith(" nm") for channel in found)
    wavelengths = np.array([float(channel.removesuffix(" nm")) for channel in found]) if spectral else None
    if wavelengths is not None and not (np.diff(wavelengths) > 0.0).all():
        raise FileFormatError("wavelengths of the channels do not rise (sort them)")
    return Contents(
        (),
        tuple(
            SphereValues(
                sample_of(choices, name),
                side,
                scatter,
                float(theta),
                row,
                "direct",
                wavelengths,
                () if spectral else tuple(found),
                source=source,
            )
            for theta, row in zip(incidences, values, strict=True)
        ),
    )


def _header(words: Words) -> tuple[int, Floats]:
    """Number of channels and angles of incidence [°]."""
    colours, incidences = 0, None
    while not (colours and incidences is not None):
        line = words.line
        word = words.take("sigma and TypeColorModel").lower()
        if word == "sigma":
            incidences = words.angles("angles of sigma", 0.0, 90.0)
        elif word == "typecolormodel":
            colours = colours_of(words, line)
        elif word == "source":
            if words.take("the value of Source").lower() not in SOURCES:
                raise FileFormatError(f"line {line}: Source is not one of {', '.join(SOURCES)} (correct it)")
        else:
            raise FileFormatError(f"line {line}: {word[:40]!r} is no keyword of Integra's text (do the counts hold?)")
    if words.peek() == "source":
        words.take("Source")
        words.take("the value of Source")
    return colours, incidences
