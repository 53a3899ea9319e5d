"""Tensor files: named arrays of numbers behind a table of their places, as Mitsuba and RGL's database write them."""

from __future__ import annotations

import math
import struct

import numpy as np
from numpy.typing import NDArray

from clerestory._core import FileFormatError

MAGIC = b"tensor_file\0"

_VERSION = (1, 0)
_TYPES = {
    1: "<u1",
    2: "<i1",
    3: "<u2",
    4: "<i2",
    5: "<u4",
    6: "<i4",
    7: "<u8",
    8: "<i8",
    9: "<f2",
    10: "<f4",
    11: "<f8",
}
_MOST_DIMENSIONS = 16


def arrays(data: bytes) -> dict[str, NDArray[np.generic]]:
    """Arrays of a file by their names, as views of its bytes.

    Raises
    ------
    FileFormatError
        The table or an array does not lie within the file.
    """
    if not data.startswith(MAGIC):
        raise FileFormatError("byte 0: no title of a tensor file (is it one?)")
    version = _unpack("<BB", data, len(MAGIC), "the version")
    if version != _VERSION:
        raise FileFormatError(f"byte 12: version {version[0]}.{version[1]} is not 1.0 (export it in that version)")
    (count,) = _unpack("<I", data, 14, "the count of fields")
    at = 18
    found: dict[str, NDArray[np.generic]] = {}
    for _ in range(count):
        (length,) = _unpack("<H", data, at, "the length of a name")
        if at + 2 + length > len(data):
            raise FileFormatError(f"byte {at}: a name of {length} letters, but the file ends before (is it whole?)")
        name = data[at + 2 : at + 2 + length].decode("utf-8", errors="replace")
        at += 2 + length
        dimensions, kind, offset = _unpack("<HBQ", data, at, f"the description of {name[:40]}")
        if kind not in _TYPES or dimensions > _MOST_DIMENSIONS:
            raise FileFormatError(
                f"byte {at}: field {name[:40]!r} has no known type or too many dimensions (is it whole?)"
            )
        at += 11
        shape = _unpack(f"<{dimensions}Q", data, at, f"the shape of {name[:40]}")
        at += 8 * dimensions
        size = math.prod(shape) * np.dtype(_TYPES[kind]).itemsize
        if offset + size > len(data):
            raise FileFormatError(
                f"byte {at}: field {name[:40]!r} of {size} bytes from {offset} goes beyond the file's {len(data)}"
                " (is it whole?)"
            )
        values = np.frombuffer(data, dtype=_TYPES[kind], count=math.prod(shape), offset=offset)
        found[name] = values.reshape(shape)
    return found


def _unpack(layout: str, data: bytes, at: int, what: str) -> tuple[int, ...]:
    if at + struct.calcsize(layout) > len(data):
        raise FileFormatError(f"byte {len(data)}: the file ends where {what} should be (is it whole?)")
    return struct.unpack_from(layout, data, at)
