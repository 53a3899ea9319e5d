"""Columns of numbers as bytes: small, and the same numbers when they come back.

Measured angles and values were once written as decimals. A column whose numbers are all n/10^k, with n of 32 bits, is
stored as those n: the quotient rounds to the very number that was read from the text. Else 32-bit floats are tried, and
64-bit ones hold the rest. Bytes of equal rank are put together, which lets deflate find what is alike.
"""

from __future__ import annotations

import struct
import zlib
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

POINTS_A_CHUNK = 1 << 16
_VERSION = 1
_MAX_DECIMALS = 9
_FLOAT64, _FLOAT32 = 100, 101  # 0 to 9 are decimals of integers
_HEAD = struct.Struct("<BBI")  # version, number of columns, number of points
_COLUMN = struct.Struct("<BI")  # kind, bytes
_TRIED = 64


def pack(columns: Sequence[Floats]) -> bytes:
    """Columns of equal length as bytes."""
    count = len(columns[0]) if columns else 0
    parts = [_HEAD.pack(_VERSION, len(columns), count)]
    for column in columns:
        kind, numbers = _smallest(np.ascontiguousarray(column, dtype=np.float64))
        by_rank = numbers.view(np.uint8).reshape(count, numbers.itemsize).T
        data = zlib.compress(np.ascontiguousarray(by_rank).data, 1)
        parts += [_COLUMN.pack(kind, len(data)), data]
    return b"".join(parts)


def unpack(data: bytes) -> list[Floats]:
    """The columns again.

    Raises
    ------
    ClerestoryError
        The bytes are damaged, or of a later version.
    """
    try:
        version, width, count = _HEAD.unpack_from(data)
        if version != _VERSION:
            raise ClerestoryError(f"points are stored in version {version} (update clerestory)")
        at, columns = _HEAD.size, []
        for _ in range(width):
            kind, size = _COLUMN.unpack_from(data, at)
            at += _COLUMN.size
            columns.append(_numbers(kind, data[at : at + size], count))
            at += size
    except (struct.error, zlib.error, ValueError) as error:
        raise ClerestoryError(f"stored points are damaged: {error} (restore the database from a copy)") from error
    return columns


def _smallest(column: Floats) -> tuple[int, NDArray[np.generic]]:
    for decimals in range(_MAX_DECIMALS + 1):
        # A few points tell that a column does not have so few decimals, without a pass over all of them.
        if _as_integers(column[:_TRIED], decimals) is not None:
            integers = _as_integers(column, decimals)
            if integers is not None:
                return decimals, integers
    # Numbers beyond 32 bits become infinite and are not the same.
    with np.errstate(over="ignore", invalid="ignore"):
        short = column.astype("<f4")
        if _same(short.astype(np.float64), column):
            return _FLOAT32, short
    return _FLOAT64, column.astype("<f8", copy=False)


def _as_integers(column: Floats, decimals: int) -> NDArray[np.generic] | None:
    with np.errstate(invalid="ignore", over="ignore"):
        rounded = np.rint(column * 10.0**decimals)
        if not (np.abs(rounded) < 2**31).all():
            return None
        integers = rounded.astype("<i4")
        return integers if _same(integers / 10.0**decimals, column) else None


def _same(a: Floats, b: Floats) -> bool:
    """Bit by bit: −0 and the payload of what is not a number count."""
    return bool((a.view(np.uint64) == b.view(np.uint64)).all())


def _numbers(kind: int, data: bytes, count: int) -> Floats:
    if kind not in (_FLOAT64, _FLOAT32) and kind > _MAX_DECIMALS:
        raise ValueError(f"a column of kind {kind}")
    dtype = np.dtype({_FLOAT64: "<f8", _FLOAT32: "<f4"}.get(kind, "<i4"))
    wanted = count * dtype.itemsize
    expand = zlib.decompressobj()
    raw = expand.decompress(data, wanted + 1)
    if len(raw) != wanted or not (expand.eof or wanted == 0):
        raise ValueError(f"{len(raw)} bytes in place of {wanted}")
    by_rank = np.frombuffer(raw, np.uint8).reshape(dtype.itemsize, count)
    numbers = np.ascontiguousarray(by_rank.T).view(dtype).reshape(count)
    if kind in (_FLOAT64, _FLOAT32):
        return numbers.astype(np.float64)
    return np.asarray(numbers / 10.0**kind, dtype=np.float64)
