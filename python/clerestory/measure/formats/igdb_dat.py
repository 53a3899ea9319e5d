"""Optics' text of a glazing (.DAT): lines of `{ key } value`, then wavelength, transmittance and both reflectances."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import FileFormatError
from clerestory.measure.contents import Contents
from clerestory.measure.formats.choices import sample_of
from clerestory.measure.formats.product_json import product_name
from clerestory.measure.formats.tokens import Words, head_of, lines_of
from clerestory.measure.source import Source, digest
from clerestory.measure.sphere import SphereValues

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from clerestory.directions import Scatter, Side

NAME = "Optics .DAT"

_LINE = re.compile(r"^\s*\{([^}]*)\}\s*(.*?)\s*$")
_COLUMNS: tuple[tuple[Side, Scatter], ...] = (
    ("exterior", "transmission"),
    ("exterior", "reflection"),
    ("interior", "reflection"),
)
_UNITS_NM = {
    "microns": 1000.0,
    "micron": 1000.0,
    "micrometers": 1000.0,
    "nanometers": 1.0,
    "nanometer": 1.0,
    "nm": 1.0,
}
_MEANINGS = {"thickness": "thickness_mm", "manufacturer": "manufacturer", "emissivity, front back": "emissivity"}


def recognises(data: bytes, name: str) -> bool:
    """Whether it begins with a line of a key in braces that gives the units."""
    first = next((line for line in head_of(data) if line), "")
    return first.startswith("{") and "units" in first and not first.endswith(",")


@dataclass(frozen=True)
class Spectra:
    """A file as it is."""

    keys: dict[str, str]
    """Values of the header by their keys."""
    header: tuple[str, ...]
    """Its lines."""
    table: NDArray[np.float64]
    """Wavelength [nm], transmittance, reflectance of front and back (n, 4), by rising wavelength."""

    def key(self, name: str) -> str:
        """A value of the header by its key in any letters; nothing where it is not there."""
        return next((value for key, value in self.keys.items() if key.lower() == name.lower()), "")


def spectra(data: bytes) -> Spectra:
    """The spectra of a file's bytes.

    Raises
    ------
    FileFormatError
        The unit of wavelengths is not known, or a row is not four numbers, with its line.
    """
    lines = lines_of(data)
    keys: dict[str, str] = {}
    first = len(lines)
    for k, line in enumerate(lines):
        match = _LINE.match(line)
        if match:
            # Some keys hold their value within the braces.
            key, _, inside = match[1].partition(":")
            keys[key.strip()] = match[2] or inside.strip()
        elif line.strip():
            first = k
            break
    rows = [k for k in range(first, len(lines)) if lines[k].strip()]
    if not rows:
        raise FileFormatError(f"line {len(lines)}: no spectrum after the header (is the file whole?)")
    units = next((value for key, value in keys.items() if key.lower().startswith("units")), "")
    unit = next((_UNITS_NM[word] for word in units.lower().split() if word in _UNITS_NM), None)
    if unit is None:
        raise FileFormatError(f"line 1: units {units[:40]!r} name no unit of wavelengths (write Microns or nm)")
    for k in rows:
        if len(lines[k].split()) != 4:
            raise FileFormatError(f"line {k + 1}: {len(lines[k].split())} numbers instead of 4 (is the file whole?)")
    words = Words(lines[first:], (), first=first + 1)
    table = words.numbers(4 * len(rows), "values of the spectrum").reshape(-1, 4)
    table[:, 0] = np.round(unit * table[:, 0], 6)
    falls = np.flatnonzero(np.diff(table[:, 0]) <= 0.0)
    if falls.size or table[0, 0] <= 0.0:
        at = rows[falls[0] + 1] if falls.size else rows[0]
        raise FileFormatError(f"line {at + 1}: wavelengths do not rise (sort them)")
    odd = np.argwhere((table[:, 1:] < -0.5) | (table[:, 1:] > 1.5))
    if odd.size:
        raise FileFormatError(
            f"line {rows[odd[0][0]] + 1}: {table[odd[0][0], odd[0][1] + 1]:g} is no share of the light (correct it)"
        )
    return Spectra(keys, tuple(lines[:first]), table)


def read(data: bytes, name: str, **choices: object) -> Contents:
    """Spectra of a glazing at normal incidence.

    Parameters
    ----------
    data
        The file's bytes.
    name
        Its name, for messages.
    choices
        `sample`.

    Raises
    ------
    FileFormatError
        As `spectra`.
    """
    found = spectra(data)
    source = Source(
        name, digest(data), NAME, found.header, "front is the exterior; columns of T, R front and R back; 0°"
    )
    conditions = {_MEANINGS.get(key.lower(), key): value for key, value in found.keys.items() if key and value}
    sample = sample_of(choices, name, product_name(found.key("Product Name"), found.key("NFRC ID")))
    waves = found.table[:, 0]
    return Contents(
        (),
        tuple(
            SphereValues(
                sample,
                side,
                scatter,
                0.0,
                found.table[:, k],
                wavelength_nm=waves,
                conditions=conditions,
                source=source,
            )
            for k, (side, scatter) in enumerate(_COLUMNS, 1)
        ),
    )
