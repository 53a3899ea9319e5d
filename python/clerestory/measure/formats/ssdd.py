"""Surface Scattering Distribution Data (.ssdd), the public text format of libbsdf, version 0.2.

Up to four blocks: BRDF, BTDF, specular reflectance and specular transmittance, each on a table of up to four angles.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import FileFormatError
from clerestory.counts import counted
from clerestory.measure.contents import Contents
from clerestory.measure.formats.choices import ABOVE_DEG, lit_side, sample_of
from clerestory.measure.formats.evaluated import hemisphere, incident_angles
from clerestory.measure.formats.half_difference import HalfDifference
from clerestory.measure.formats.specular import HORIZON, distinct, from_specular, seen_from
from clerestory.measure.formats.tokens import Words, head_of, lines_of, within
from clerestory.measure.scan import Measurement, Scan
from clerestory.measure.source import Source, digest
from clerestory.measure.sphere import SphereValues

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from clerestory.directions import Scatter, Side

    Floats = NDArray[np.float64]

NAME = "SSDD"

_TYPES: dict[str, tuple[Scatter, bool]] = {
    "brdf": ("reflection", False),
    "btdf": ("transmission", False),
    "specular_reflectance": ("reflection", True),
    "specular_transmittance": ("transmission", True),
}
_COLOURS = {"monochrome": ("visible",), "rgb": ("red", "green", "blue"), "xyz": ("X", "Y", "Z")}
_PARAMETERS = tuple(f"param{k}_list" for k in range(5))
_TEXTS = {
    "name": "description",
    "device": "instrument",
    "measurement_date": "date",
    "creation_date": "creation date",
    "source_type": "source type",
}
_FILE = ("version", "software", "api", "date")
_LIMITS = {
    "spherical_coordinate_system": ((0, 90), (-360, 360), (0, 90), (-360, 360)),
    "specular_coordinate_system": ((0, 90), (-360, 360), (0, 180), (-360, 360)),
    "half_difference_coordinate_system": ((0, 90), (-360, 360), (0, 90), (-360, 360)),
    "": ((0, 90), (-360, 360), (0, 0), (0, 0)),
}


def recognises(data: bytes, name: str) -> bool:
    """Whether it begins with a version and the type of a block follows."""
    head = [line for line in _text_before_data(data) if line and not line.startswith("#")]
    return bool(head) and head[0].startswith("version ") and any(line.startswith("data_type ") for line in head)


def _text_before_data(data: bytes) -> list[str]:
    # A binary table may follow within the first bytes.
    return head_of(data[:4096].split(b"DATA binary")[0])


@dataclass
class _Block:
    line: int
    scatter: Scatter
    specular: bool
    channels: tuple[str, ...] = ()
    parameters: str = ""
    reduced: tuple[str, ...] = ()
    lists: dict[int, Floats] = field(default_factory=dict)
    conditions: dict[str, str] = field(default_factory=dict)
    values: Floats = field(default_factory=lambda: np.zeros(0))
    """(param3, param2, param1, param0, channels)"""


def read(data: bytes, name: str, **choices: object) -> Contents:
    """Scans and specular values of a file.

    A table of half and difference angles has no scans of its own: it is interpolated at `incident_theta_deg` (0 to 80
    by 10 without it) and, if it is anisotropic, at `incident_phi_deg` (0 to 315 by 45).

    Parameters
    ----------
    data
        The file's bytes.
    name
        Its name, for messages.
    choices
        `side` that the light comes from (exterior), `sample`, and the incident angles above [°].

    Raises
    ------
    FileFormatError
        An entry, a count or a number is missing or wrong, with its line.
    """
    blocks, header = _Reader(data).blocks()
    side = lit_side(choices)
    source = Source(name, digest(data), NAME, tuple(header), _convention(side))
    scans: list[Scan] = []
    spheres: list[SphereValues] = []
    notes: list[str] = []
    sample = sample_of(choices, name)
    for block in blocks:
        if block.specular:
            spheres += _spheres(block, side, sample, source)
        elif block.parameters.startswith("half"):
            found = _from_half_difference(block, side, source, choices)
            scans += found
            notes.append(f"{name}: half and difference angles interpolated at {len(found)} incident directions")
        else:
            found, dropped = _from_table(block, side, source)
            scans += found
            notes += [f"{name}: {counted(dropped, 'value')} at or beyond the horizon left out"] if dropped else []
    measurements = (Measurement(sample, tuple(scans)),) if scans else ()
    return Contents(measurements, tuple(spheres), tuple(notes))


class _Reader:
    """Lines and tables of the file's bytes, one after the other."""

    def __init__(self, data: bytes) -> None:
        lines_of(data.split(b"DATA binary")[0])  # what is no text is said so at once
        self._data = data
        self._at = 0
        self._line = 0
        self._raw = ""

    def _next(self) -> str | None:
        """The next line without its comment, or none at the end."""
        if self._at >= len(self._data):
            return None
        ends = [k for k in (self._data.find(mark, self._at) for mark in (b"\n", b"\r")) if k >= 0]
        end = min(ends, default=len(self._data))
        text = self._data[self._at : end].decode("utf-8", errors="replace")
        self._at = end + (2 if self._data[end : end + 2] == b"\r\n" else 1)
        self._line += 1
        self._raw = text
        return "" if text.strip() == "#" else text.split("# ", 1)[0].strip()

    def blocks(self) -> tuple[list[_Block], list[str]]:
        """All blocks with their tables, and the lines that describe them."""
        blocks: list[_Block] = []
        header: list[str] = []
        block: _Block | None = None
        while (line := self._next()) is not None:
            header += [self._raw] if self._raw.strip() else []
            if not line:
                continue
            key, _, value = line.partition(" ")
            key, value = key.lower(), value.strip()
            if key == "data_type":
                if value not in _TYPES:
                    raise FileFormatError(
                        f"line {self._line}: DATA_TYPE {value[:40]!r} is not known ({', '.join(_TYPES)})"
                    )
                block = _Block(self._line, *_TYPES[value])
            elif block is None:
                if key not in _FILE:
                    raise FileFormatError(f"line {self._line}: {key[:40]!r} before the first DATA_TYPE (is it whole?)")
            elif key == "data":
                self._table(block, value)
                blocks.append(block)
                block = None
            else:
                self._entry(block, key, value)
        if block is not None or not blocks:
            raise FileFormatError(f"line {self._line}: the file ends without DATA of a block (is it whole?)")
        return blocks, header

    def _entry(self, block: _Block, key: str, value: str) -> None:
        place = f"line {self._line}"
        if key == "color_model":
            if value not in (*_COLOURS, "spectrum"):
                raise FileFormatError(
                    f"{place}: COLOR_MODEL {value[:40]!r} is not known ({', '.join(_COLOURS)}, spectrum)"
                )
            block.channels = _COLOURS.get(value, ())
        elif key == "wavelength_list":
            waves = self._numbers(value, "wavelengths")
            if not ((np.diff(waves) > 0.0).all() and (waves > 0.0).all()):
                raise FileFormatError(f"{place}: wavelengths do not rise (sort them)")
            block.channels = tuple(f"{wave:.10g} nm" for wave in waves)
        elif key == "param_type":
            if value not in _LIMITS:
                raise FileFormatError(
                    f"{place}: PARAM_TYPE {value[:60]!r} is not known ({', '.join(k for k in _LIMITS if k)})"
                )
            block.parameters = value
        elif key == "reduction_type":
            block.reduced = tuple(value.lower().split())
            if not set(block.reduced) <= {"bilateral_symmetry", "reciprocity"}:
                raise FileFormatError(
                    f"{place}: REDUCTION_TYPE {value[:60]!r} is not known (bilateral_symmetry, reciprocity)"
                )
        elif key in _PARAMETERS:
            angles = self._numbers(value, key.upper())
            rising = np.diff(angles) > 0.0
            if key != "param4_list" and not rising.all():
                raise FileFormatError(f"{place}: angles of {key.upper()} do not rise (sort them)")
            block.lists[_PARAMETERS.index(key)] = angles
        elif key in _TEXTS:
            block.conditions[_TEXTS[key]] = value
        else:
            raise FileFormatError(f"{place}: {key[:40]!r} is no entry of an SSDD file (correct it)")

    def _numbers(self, value: str, what: str) -> Floats:
        words = Words([value], (), first=self._line)
        if not len(words):
            raise FileFormatError(f"line {self._line}: {what} without numbers (add them)")
        return words.numbers(len(words), what)

    def _table(self, block: _Block, mode: str) -> None:
        needed = (0,) if block.specular else (0, 2, 3)
        missing = [f"PARAM{k}_LIST" for k in needed if k not in block.lists]
        missing += [] if block.channels else ["COLOR_MODEL, or WAVELENGTH_LIST of its spectrum"]
        missing += [] if block.specular or block.parameters else ["PARAM_TYPE"]
        if missing:
            raise FileFormatError(f"line {self._line}: DATA without {', '.join(missing)} before it (add them)")
        for k, limits in enumerate(_LIMITS["" if block.specular else block.parameters]):
            if k in block.lists and not (block.specular and k > 1):
                within(block.lists[k], f"PARAM{k}_LIST", *limits, self._line)
        if 4 in block.lists and len(block.lists[4]) != len(block.lists[0]):
            raise FileFormatError(
                f"line {self._line}: PARAM4_LIST has not as many offsets as PARAM0_LIST angles (add them)"
            )
        sizes = [len(block.lists[k]) if k in block.lists else 1 for k in ((0, 1) if block.specular else (0, 1, 2, 3))]
        shape = (*[*sizes, 1, 1][3::-1], len(block.channels))
        count = math.prod(shape)
        if mode == "binary":
            size = 4 * count
            if size > len(self._data) - self._at:
                raise FileFormatError(
                    f"line {self._line}: {len(self._data) - self._at} bytes left where a table of {size} should be"
                    " (is the file whole?)"
                )
            values = np.frombuffer(self._data, dtype="<f4", count=count, offset=self._at).astype(np.float64)
            self._at += size
            if not (np.abs(values) <= 1e30).all():
                raise FileFormatError(
                    f"line {self._line}: the binary table below has values that are no numbers (export it again)"
                )
        elif mode == "ascii":
            values = self._ascii(count)
        else:
            raise FileFormatError(f"line {self._line}: DATA {mode[:40]!r} is not ascii or binary (correct it)")
        block.values = values.reshape(shape)

    def _ascii(self, count: int) -> Floats:
        first, texts, words = self._line + 1, [], 0
        while words < count:
            line = self._next()
            if line is None:
                raise FileFormatError(
                    f"line {self._line}: {counted(words, 'number')} where {count} of a table should be (is it whole?)"
                )
            texts.append(line)
            words += len(line.split())
        if words > count:
            raise FileFormatError(f"line {self._line}: the table of {count} numbers ends within this line (correct it)")
        return Words(texts, (), first=first).numbers(count, "values of the table")


def _symmetry(block: _Block) -> dict[str, str]:
    if "bilateral_symmetry" in block.reduced:
        return {"symmetry": "PlaneSymmetrical: one side of the plane of incidence is given and stands for both"}
    return {}


def _light(block: _Block, side: Side) -> list[float]:
    """Azimuths [°] of the light in the sample's frame: those of the file, or above where it has none."""
    return [float(a) for a in seen_from(side, block.lists.get(1, np.array([ABOVE_DEG])))]


def _from_table(block: _Block, side: Side, source: Source) -> tuple[list[Scan], int]:
    """Scans of a table of outgoing angles about the normal or the specular direction, and points below the horizon."""
    scans, dropped = [], 0
    polars, azimuths = block.lists[2], block.lists[3]
    offsets = block.lists.get(4, np.zeros(len(block.lists[0])))
    for p, phi in enumerate(_light(block, side)):
        for t, theta in enumerate(block.lists[0]):
            if block.parameters.startswith("specular"):
                leaving = float(theta + offsets[t])
                if not 0.0 <= leaving <= 90.0:
                    raise FileFormatError(
                        f"block of line {block.line}: offset {offsets[t]:g}° of {theta:g}° leaves 0 to 90° (correct it)"
                    )
                theta_deg, phi_deg, above = from_specular(polars, azimuths[:, None], leaving, phi, side, block.scatter)
            else:
                # Azimuths without one of the light count from it.
                turned = azimuths if 1 in block.lists else azimuths + ABOVE_DEG
                theta_deg, phi_deg = np.broadcast_arrays(polars, seen_from(side, turned)[:, None])
                above = np.cos(np.radians(theta_deg)) > HORIZON
            dropped += int((~above).sum())
            points = block.values[:, :, p, t][above]
            kept = distinct(theta_deg[above], phi_deg[above], points)
            scans.append(
                Scan(
                    side,
                    block.scatter,
                    float(theta),
                    phi,
                    theta_deg[above][kept],
                    phi_deg[above][kept],
                    points[kept],
                    channels=block.channels,
                    conditions=block.conditions | _symmetry(block),
                    source=source,
                )
            )
    return scans, dropped


def _from_half_difference(block: _Block, side: Side, source: Source, choices: Mapping[str, object]) -> list[Scan]:
    """Scans that a table of half and difference angles gives by interpolation."""
    table = HalfDifference(
        block.lists[0],
        block.lists.get(1),
        block.lists[2],
        block.lists[3],
        block.values,
        mirrored="bilateral_symmetry" in block.reduced,
        reciprocal="reciprocity" in block.reduced,
    )
    thetas = incident_angles(choices, "incident_theta_deg", np.arange(0.0, 81.0, 10.0), 0.0, 90.0)
    turned = 1 in block.lists
    default = np.arange(0.0, 360.0, 45.0) if turned else np.array([ABOVE_DEG])
    scans = []
    for phi in incident_angles(choices, "incident_phi_deg", default, -360.0, 360.0):
        for theta in thetas:
            theta_deg, phi_deg = hemisphere(float(theta), float(phi), side, block.scatter)
            values = table.evaluate(float(theta), float(seen_from(side, phi)), theta_deg, seen_from(side, phi_deg))
            known = np.isfinite(values).all(axis=1)
            scans.append(
                Scan(
                    side,
                    block.scatter,
                    float(theta),
                    float(phi),
                    theta_deg[known],
                    phi_deg[known],
                    values[known],
                    channels=block.channels,
                    conditions=block.conditions | {"evaluated": "interpolated linearly in half and difference angles"},
                    source=source,
                )
            )
    return scans


def _spheres(block: _Block, side: Side, sample: str, source: Source) -> list[SphereValues]:
    """Specular shares of a block, a set for each incident direction."""
    spectral = all(channel.endswith(" nm") for channel in block.channels)
    waves = np.array([float(channel.removesuffix(" nm")) for channel in block.channels]) if spectral else None
    return [
        SphereValues(
            sample,
            side,
            block.scatter,
            float(theta),
            block.values[0, 0, p, t],
            "direct",
            waves,
            () if spectral else block.channels,
            phi_deg=phi,
            conditions=block.conditions,
            source=source,
        )
        for p, phi in enumerate(_light(block, side))
        for t, theta in enumerate(block.lists[0])
    ]


def _convention(side: Side) -> str:
    return (
        f"light on the {side}, azimuths counter-clockwise from the right as seen from there, from above where the file"
        " gives none; azimuth 0 about the specular direction toward the normal, counter-clockwise against the light"
    )
