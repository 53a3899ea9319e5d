"""Headers of text files: what their lines say of the measurement, and lines that say it."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError, FileFormatError
from clerestory.measure.scan import CONDITIONS

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from clerestory.measure.scan import Scan

HEAD = 1 << 16
"""A header is looked for in so many bytes at the beginning of a file."""

_MEANINGS = {
    "lab": "laboratory",
    "institute": "laboratory",
    "institution": "laboratory",
    "measured_by": "operator",
    "device": "instrument",
    "goniophotometer": "instrument",
    "measurement_date": "date",
    "material_manufacturer": "manufacturer",
    "sample_description": "description",
    "sample_thickness": "thickness_mm",
    "thickness": "thickness_mm",
    "light_source": "lamp",
    "lamp_type": "lamp",
    "sensor": "detector",
    "wavelength": "wavelength_nm",
    "lambda": "wavelength_nm",
}
"""Other words for the keys of `CONDITIONS`."""

_ESCAPE = "condition "
"""Stands before a condition whose key means something else in the file."""
_PAIR = re.compile(r"^(?P<key>[^:=]{1,80}?)\s*[:=]\s*(?P<value>.*)$|^(?P<word>\S{1,80})\s+(?P<rest>.*)$")
_BEHIND = re.compile(r"$|[\s,;/°%]|(deg|rad|[nmµu]m)", re.IGNORECASE)
"""What may follow a number: nothing, or a unit."""
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")


def text_of(data: bytes) -> str:
    """Text of UTF-8, or else of Windows' Western letters."""
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError:
        return data.decode("cp1252", errors="replace")


def lines_of(data: bytes) -> list[str]:
    """Lines of a text that ends them as any system does."""
    return text_of(data).replace("\r\n", "\n").replace("\r", "\n").split("\n")


def leading(data: bytes, start: int, line: int, mark: bytes = b"#") -> tuple[list[str], int, int]:
    """Lines that begin with a mark, and empty ones, up to the first other one.

    Returns
    -------
    The lines that are not empty, and byte and number of the line behind them.
    """
    found: list[str] = []
    while start < len(data):
        end = line_end(data, start)
        text = data[start:end].strip()
        if text and not text.startswith(mark):
            break
        if text:
            found.append(text_of(text))
        start = end + (2 if data[end : end + 2] == b"\r\n" else 1)
        line += 1
    return found, min(start, len(data)), line


def line_end(data: bytes, start: int) -> int:
    """Where a line ends; looked for nearby first, so that a file without one kind of line end is not searched again."""
    for stop in (start + HEAD, len(data)):
        ends = [end for end in (data.find(b"\n", start, stop), data.find(b"\r", start, stop)) if end >= 0]
        if ends:
            return min(ends)
    return len(data)


def pair_of(line: str) -> tuple[str, str] | None:
    """Key and value of `key: value`, `key=value` or `key value`, behind any marks of comment."""
    match = _PAIR.match(line.strip().lstrip("#").strip())
    if match is None:
        return None
    key, value = (match["key"], match["value"]) if match["key"] else (match["word"], match["rest"])
    return key.strip(), value.strip().strip('"').strip()


def number_of(value: str, what: str, line: int) -> float:
    """The number that a value begins with; units may follow.

    Raises
    ------
    FileFormatError
        There is none.
    """
    match = _NUMBER.match(value.strip())
    number = float(match[0]) if match else np.nan
    if match is None or not np.isfinite(number) or not _BEHIND.match(value.strip()[match.end() :]):
        raise FileFormatError(f"line {line}: {what} {value[:40]!r} does not begin with a number (write it as 30.5)")
    behind = value.strip()[match.end() :]
    if behind[:1] == ",":
        raise FileFormatError(f"line {line}: {what} {value[:40]!r} has a comma (write it with a point, as 30.5)")
    return number


def condition_key(key: str) -> str:
    """The key of `CONDITIONS` that a file's word stands for, or the word itself."""
    plain = re.sub(r"[\s_-]+", "_", key.strip().lower())
    plain = plain if plain in CONDITIONS else _MEANINGS.get(plain, "")
    return plain or key.removeprefix(_ESCAPE)


def conditions_of(pairs: Iterable[tuple[str, str]], reserved: Iterable[str]) -> dict[str, str]:
    """What pairs say of the measurement; keys that mean something else in the file are left out."""
    others = frozenset(reserved)
    return {condition_key(key): value for key, value in pairs if value and key.lower() not in others}


def condition_lines(conditions: Mapping[str, str], reserved: Iterable[str], mark: str = "# ") -> list[str]:
    """Lines of `key: value`, which `conditions_of` reads."""
    others = frozenset(reserved)
    lines = []
    for key, value in conditions.items():
        word = one_line(key).replace(":", " ").replace("=", " ")
        lines.append(f"{mark}{_ESCAPE if word.lower() in others else ''}{word}: {one_line(value)}")
    return lines


def one_line(text: str) -> str:
    """A text that cannot break a line of a header."""
    return " ".join(text.split())


def writable(scan: Scan, format_name: str, *, quantities: tuple[str, ...] = ("bsdf", "dsf")) -> None:
    """Check that a scan can stand in a file.

    Raises
    ------
    ClerestoryError
        Values are a detector's signal, or not all finite.
    """
    if scan.quantity not in quantities:
        raise ClerestoryError(
            f"{format_name} holds BSDF or DSF, not a detector's signal (prepare the measurement, or write CSV)"
        )
    if not np.isfinite(scan.values).all():
        raise ClerestoryError(
            f"a value of the scan at θ = {scan.incident_theta_deg:g}°, φ = {scan.incident_phi_deg:g}° is not a finite "
            "number (take it out first)"
        )
