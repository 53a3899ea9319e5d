"""Clerestory's own file, `.bsdf.npz`: a ZIP of NumPy arrays with a header in JSON.

It holds what XML cannot: peaks, sums, turned models, standard errors. `numpy.load` opens it: the arrays by their names,
the header as the bytes of `header.json`. The header lists angle bases, bands, models (kind, numbers, bases, arrays and
the models that they are made of), metadata, warnings and what conversion did. Every array is declared there with its
type and length, and a file that holds anything else is refused.
"""

from __future__ import annotations

import hashlib
import io
import json
import re
import zipfile
import zlib
from dataclasses import astuple
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar
from weakref import WeakKeyDictionary

import numpy as np

from clerestory import _core
from clerestory.bsdf import Bsdf
from clerestory.convert import ConversionReport, Operations
from clerestory.counts import counted
from clerestory.directions import SCATTERS, SIDES
from clerestory.whole import write_whole

if TYPE_CHECKING:
    import os

    from numpy.typing import NDArray

    from clerestory.directions import Scatter, Side

    _Band = tuple[str, str | None, str | None, list[tuple[Side, Scatter, _core.Model]]]

FORMAT = "clerestory-bsdf"
VERSION = 1
HEADER = "header.json"

# Deflate cannot shrink anything by more than 1032 to 1.
MAX_RATIO = 1100
# Room for the headers of the ZIP's members and of the arrays.
SLACK = 1 << 16
MAX_DEPTH = 32
TYPES: dict[str, np.dtype[Any]] = {"float64": np.dtype("<f8"), "uint32": np.dtype("<u4")}
REMEDY = "write the file again with clerestory"

T = TypeVar("T")


def save(bsdf: Operations, path: str | os.PathLike[str]) -> None:
    """Write a data set as a `.bsdf.npz` file, whole or not at all.

    Raises
    ------
    OSError
        The file cannot be written.
    UnsupportedError
        Models within models are nested more than 32 deep.
    """
    write_whole(path, encode(bsdf))


def load(path: str | os.PathLike[str]) -> Bsdf:
    """Read a `.bsdf.npz` file.

    Raises
    ------
    FileFormatError
        The file is damaged, or not of this format; the text names file, array and remedy.
    OSError
        The file cannot be opened.
    """
    path = Path(path)
    data = path.read_bytes()
    try:
        return decode(data)
    except _core.ClerestoryError as error:
        raise _core.FileFormatError(f"{path}: {error}") from error


def decode(data: bytes) -> Bsdf:
    """The data set of a file's content.

    Raises
    ------
    FileFormatError
        It is damaged, or not of this format; the text names array and remedy.
    """
    return _Reader(data).bsdf()


_MARKS: WeakKeyDictionary[Operations, str] = WeakKeyDictionary()
"""Of the data sets that are alive: they do not change, and a large one takes seconds to encode."""


def mark(bsdf: Operations) -> str:
    """SHA-256 of all that a data set holds, as hexadecimal digits."""
    if bsdf not in _MARKS:
        _MARKS[bsdf] = hashlib.sha256(encode(bsdf)).hexdigest()
    return _MARKS[bsdf]


def encode(bsdf: Operations) -> bytes:
    """The content of the file of a data set; the same for the same data."""
    writer = _Writer()
    bands = [
        {
            "name": name,
            "source_spectrum": source,
            "detector_spectrum": detector,
            "components": [
                {
                    "side": side,
                    "scatter": scatter,
                    "model": writer.model(model, f"{_slug(name)}/{side}/{scatter}", 0),
                }
                for side, scatter, model in members
            ],
        }
        for name, source, detector, members in bsdf._core.bands()
    ]
    element_type, material, geometry, comments, other = bsdf._core.metadata_parts()
    header = {
        "format": FORMAT,
        "version": VERSION,
        "provenance": {
            "written_by": f"clerestory {_core.__version__}",
            "conversion": [astuple(report) for report in bsdf.conversion],
        },
        "bases": [{"name": b.name, "rings": b.rings} for b in writer.bases],
        "bands": bands,
        "metadata": {
            "element_type": element_type,
            "material": material,
            "geometry": geometry,
            "comments": comments,
            "other": other,
        },
        "warnings": bsdf._core.warnings,
    }
    text = json.dumps(header, ensure_ascii=False, indent=1, allow_nan=False).encode()
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        # The same data set gives the same bytes: the members have no time of their own.
        archive.writestr(zipfile.ZipInfo(HEADER), text, zipfile.ZIP_DEFLATED)
        for name, array in writer.arrays.items():
            member = io.BytesIO()
            np.lib.format.write_array(member, array, version=(1, 0), allow_pickle=False)
            archive.writestr(zipfile.ZipInfo(f"{name}.npy"), member.getvalue(), zipfile.ZIP_DEFLATED)
    return buffer.getvalue()


def _slug(name: str) -> str:
    return re.sub(r"[^a-z0-9.-]+", "-", name).strip(".") or "band"


class _Writer:
    """Gathers the arrays and bases of all models."""

    def __init__(self) -> None:
        self.arrays: dict[str, NDArray[Any]] = {}
        self.bases: list[_core.Basis] = []

    def model(self, model: _core.Model, place: str, depth: int) -> dict[str, Any]:
        if depth > MAX_DEPTH:
            raise _core.UnsupportedError(
                f"models are nested more than {MAX_DEPTH} deep (convert the data set to matrices first)"
            )
        kind, numbers, bases, arrays, models = model.to_parts()
        return {
            "kind": kind,
            "numbers": dict(numbers),
            "bases": [self.basis(b) for b in bases],
            "arrays": {name: self.array(array, f"{place}/{name}") for name, array in arrays},
            "models": [self.model(m, f"{place}/{k}", depth + 1) for k, m in enumerate(models)],
        }

    def basis(self, basis: _core.Basis) -> int:
        for k, other in enumerate(self.bases):
            if other.name == basis.name and other.rings == basis.rings:
                return k
        self.bases.append(basis)
        return len(self.bases) - 1

    def array(self, array: NDArray[Any], name: str) -> dict[str, Any]:
        unique, k = name, 1
        while unique in self.arrays:
            unique, k = f"{name}-{k}", k + 1
        dtype = next(name for name, dtype in TYPES.items() if dtype == array.dtype)
        self.arrays[unique] = array.astype(TYPES[dtype])
        return {"name": unique, "dtype": dtype, "length": len(array)}


class _Reader:
    """Reads a file that may hold anything."""

    def __init__(self, data: bytes) -> None:
        try:
            self.archive = zipfile.ZipFile(io.BytesIO(data))
        except (zipfile.BadZipFile, OSError, ValueError, RuntimeError, EOFError) as error:
            raise _bad("it is not a sound ZIP file", error) from error
        members = self.archive.infolist()
        self.members = {m.filename: m for m in members}
        if len(self.members) != len(members):
            raise _bad("an array is there twice")
        size = sum(m.file_size for m in members)
        if size > MAX_RATIO * len(data) + SLACK:
            raise _bad(f"{len(data)} bytes claim to hold {size}")
        self.header = self.parse_header()
        self.used = {HEADER}
        bases = self.items(self.header, "bases", "the header")
        self.bases = [self.basis(b, f"angle basis {k}") for k, b in enumerate(bases)]

    def parse_header(self) -> dict[str, Any]:
        text = self.member(HEADER, None)
        try:
            header = json.loads(text, parse_constant=_refuse_constant)
        except (ValueError, RecursionError) as error:
            raise _bad(f"{HEADER} is not JSON", error) from error
        if not isinstance(header, dict) or header.get("format") != FORMAT:
            raise _bad(f"{HEADER} does not say that the format is {FORMAT!r}")
        if header.get("version") != VERSION:
            raise _core.FileFormatError(
                f"{HEADER}: version {header.get('version')!r} is not known, only {VERSION} (use a newer clerestory)"
            )
        return header

    def member(self, name: str, size: int | None) -> bytes:
        """Content of a member, which has to have the size that the header asks for."""
        info = self.members.get(name)
        if info is None:
            raise _bad(f"{name} is missing")
        if size is not None and not size <= info.file_size <= size + 4096:
            raise _bad(f"{name} has {counted(info.file_size, 'byte')} where about {size} belong")
        try:
            with self.archive.open(info) as file:
                content = file.read(info.file_size + 1)
        except (zipfile.BadZipFile, zlib.error, OSError, EOFError, RuntimeError, ValueError) as error:
            raise _bad(f"{name} cannot be unpacked", error) from error
        if len(content) != info.file_size:
            raise _bad(f"{name} has {counted(len(content), 'byte')}, not the {info.file_size} that it claims")
        return content

    def get(self, owner: object, key: str, kind: type[T], place: str) -> T:
        """A value of the header, of the type that belongs there."""
        value = owner.get(key) if isinstance(owner, dict) else None
        if not isinstance(value, kind) or (isinstance(value, bool) and kind is not bool):
            raise _bad(f"{HEADER}: {key!r} of {place} is missing or not {kind.__name__}")
        return value

    def items(self, owner: object, key: str, place: str) -> list[Any]:
        return self.get(owner, key, list, place)

    def optional(self, owner: object, key: str, place: str) -> str | None:
        if isinstance(owner, dict) and owner.get(key) is None:
            return None
        return self.get(owner, key, str, place)

    def basis(self, spec: object, place: str) -> _core.Basis:
        rings = []
        for ring in self.items(spec, "rings", place):
            sound = isinstance(ring, list) and len(ring) == 4 and all(_is_number(v) for v in ring)
            if not sound or not isinstance(ring[3], int) or not 0 < ring[3] <= 1_000_000:
                raise _bad(f"{HEADER}: a ring of {place} is not lower, upper, nominal angle and number of patches")
            rings.append((float(ring[0]), float(ring[1]), float(ring[2]), ring[3]))
        return _core.Basis.from_rings(self.get(spec, "name", str, place), rings)

    def array(self, spec: object, place: str) -> NDArray[Any]:
        name, length = self.get(spec, "name", str, place), self.get(spec, "length", int, place)
        dtype = TYPES.get(self.get(spec, "dtype", str, place))
        if dtype is None or length < 0:
            raise _bad(f"{HEADER}: {place} is of no known type or length")
        member = f"{name}.npy"
        if member in self.used:
            raise _bad(f"{member} is used twice")
        self.used.add(member)
        content = self.member(member, length * dtype.itemsize)
        stream = io.BytesIO(content)
        try:
            if np.lib.format.read_magic(stream) != (1, 0):
                raise _bad(f"{member} is not a NumPy array of format 1.0")
            shape, _, found = np.lib.format.read_array_header_1_0(stream)
        except _core.ClerestoryError:
            raise
        except Exception as error:  # numpy parses this header as Python text: anything may come out of it
            raise _bad(f"{member} is not a NumPy array", error) from error
        if found != dtype or shape != (length,):
            raise _bad(f"{member} has type {found} and shape {shape} where {dtype} and {(length,)} belong")
        room = len(content) - stream.tell()
        if room != length * dtype.itemsize:
            raise _bad(f"{member} has {counted(room, 'byte')} of values where {length * dtype.itemsize} belong")
        values = np.frombuffer(content, dtype, offset=stream.tell())
        if dtype.kind == "f" and not np.isfinite(values).all():
            raise _bad(f"{member} holds {values[~np.isfinite(values)][0]} at place {np.argmin(np.isfinite(values))}")
        return values.astype(dtype.newbyteorder("="))

    def model(self, spec: object, place: str, depth: int) -> _core.Model:
        if depth > MAX_DEPTH:
            raise _bad(f"{HEADER}: {place} is nested more than {MAX_DEPTH} deep")
        numbers = self.get(spec, "numbers", dict, place)
        for name, value in numbers.items():
            if not _is_number(value):
                raise _bad(f"{HEADER}: number {name!r} of {place} is {value!r}")
        bases = self.items(spec, "bases", place)
        if not all(type(b) is int and 0 <= b < len(self.bases) for b in bases):
            raise _bad(f"{HEADER}: {place} names an angle basis that is not there")
        arrays = self.get(spec, "arrays", dict, place)
        models = self.items(spec, "models", place)
        try:
            return _core.Model.from_parts(
                self.get(spec, "kind", str, place),
                [(name, float(value)) for name, value in numbers.items()],
                [self.bases[b] for b in bases],
                [(name, self.array(a, f"{place}/{name}")) for name, a in arrays.items()],
                [self.model(m, f"{place}/{k}", depth + 1) for k, m in enumerate(models)],
            )
        except _core.FileFormatError:
            raise
        except _core.ClerestoryError as error:
            raise _bad(f"{place}: {error}") from error

    def element(self, spec: object, place: str, depth: int = 0) -> _core._Element:
        """Name, attributes, text, children."""
        if isinstance(spec, list) and len(spec) == 4 and depth <= 8 * MAX_DEPTH:
            name, attributes, text, children = spec
            pairs = isinstance(attributes, list) and all(_is_pair(a) for a in attributes)
            if isinstance(name, str) and isinstance(text, str) and pairs and isinstance(children, list):
                below = [self.element(c, place, depth + 1) for c in children]
                return name, [(a[0], a[1]) for a in attributes], text, below
        raise _bad(f"{HEADER}: {place} is not an XML element")

    def texts(self, owner: object, key: str, place: str) -> list[str]:
        texts = self.items(owner, key, place)
        if not all(isinstance(t, str) for t in texts):
            raise _bad(f"{HEADER}: {key!r} of {place} is not a list of texts")
        return texts

    def metadata(self) -> _core._Metadata:
        place = "the metadata"
        spec = self.get(self.header, "metadata", dict, "the header")
        single = {
            key: None if spec.get(key) is None else self.element(spec[key], f"{key!r} of {place}")
            for key in ("material", "geometry")
        }
        other = []
        for item in self.items(spec, "other", place):
            if not (isinstance(item, list) and len(item) == 2 and isinstance(item[0], str)):
                raise _bad(f"{HEADER}: 'other' of {place} is not a list of path and element")
            other.append((item[0], self.element(item[1], f"'other' of {place}")))
        comments = self.texts(spec, "comments", place)
        return self.optional(spec, "element_type", place), single["material"], single["geometry"], comments, other

    def conversion(self) -> list[ConversionReport]:
        provenance = self.get(self.header, "provenance", dict, "the header")
        reports = []
        for row in self.items(provenance, "conversion", "the provenance"):
            kinds = (str, str, str, str, int, float | int | None, float | int | None)
            sound = isinstance(row, list) and len(row) == len(kinds)
            if not sound or not all(
                isinstance(v, k) and (isinstance(v, str) or v is None or _is_number(v))
                for v, k in zip(row, kinds, strict=True)
            ):
                raise _bad(f"{HEADER}: the provenance holds a conversion report that is none")
            reports.append(ConversionReport(*row))
        return reports

    def band(self, spec: object, k: int) -> _Band:
        place = f"band {k}"
        name = self.get(spec, "name", str, place)
        members: list[tuple[Side, Scatter, _core.Model]] = []
        for component in self.items(spec, "components", place):
            words = self.get(component, "side", str, place), self.get(component, "scatter", str, place)
            known = [(side, scatter) for side in SIDES for scatter in SCATTERS if (side, scatter) == words]
            if not known or known[0] in [m[:2] for m in members]:
                raise _bad(f"{HEADER}: {place} has an unknown or second component {' '.join(words)!r}")
            side, scatter = known[0]
            model = self.get(component, "model", dict, place)
            members.append((side, scatter, self.model(model, f"{name}/{side}/{scatter}", 0)))
        source = self.optional(spec, "source_spectrum", place)
        return name, source, self.optional(spec, "detector_spectrum", place), members

    def bsdf(self) -> Bsdf:
        bands = [self.band(b, k) for k, b in enumerate(self.items(self.header, "bands", "the header"))]
        for name in self.members:
            if name not in self.used:
                raise _bad(f"{name} is there, but {HEADER} does not name it")
        core = _core.Bsdf(bands).with_metadata_parts(self.metadata())
        core = core.with_warnings(self.texts(self.header, "warnings", "the header"))
        return Bsdf(core, self.conversion())


def _bad(what: str, cause: Exception | None = None) -> _core.FileFormatError:
    because = "" if cause is None or not str(cause) else f": {' '.join(str(cause).split())}"
    return _core.FileFormatError(f"{what}{because} ({REMEDY})")


def _refuse_constant(name: str) -> float:
    raise ValueError(f"{name} is not a number of JSON")


def _is_number(value: object) -> bool:
    # Comparing leaves integers of any length alone where math.isfinite cannot.
    return isinstance(value, int | float) and not isinstance(value, bool) and -1e300 < value < 1e300


def _is_pair(value: object) -> bool:
    return isinstance(value, list) and len(value) == 2 and all(isinstance(v, str) for v in value)
