"""Conditions in the comments and headers of optics programs: lines of `key: value`."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from clerestory.measure.formats.header import condition_key

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

_MEANINGS = {
    "scatterometer": "instrument",
    "date(s) measured": "date",
    "point of contact": "operator",
}
"""More words for the keys of `clerestory.measure.scan.CONDITIONS`."""

_PAIR = re.compile(r"^[\s#;!'-]*([^:]{1,80}?)\s*:\s*(\S.*?)\s*$")
_WAVELENGTH = re.compile(r"(\d{3,5}(?:\.\d+)?) ?nm\b")
_RESERVED = ("sample", "incident side")


def pairs(lines: Iterable[str]) -> dict[str, str]:
    """Values by their keys, as both stand in lines of `key: value`; the first of a key counts."""
    found: dict[str, str] = {}
    for line in lines:
        match = _PAIR.match(line)
        if match:
            found.setdefault(match[1], match[2])
    return found


def conditions_of(stated: Mapping[str, str]) -> dict[str, str]:
    """What pairs say of the measurement, by the keys of `CONDITIONS` where known, and the wavelength of the lamp."""
    conditions = {
        _MEANINGS.get(key.lower()) or condition_key(key): value
        for key, value in stated.items()
        if key.lower() not in _RESERVED
    }
    if "wavelength_nm" not in conditions:
        named = _WAVELENGTH.search(conditions.get("lamp", ""))
        if named:
            conditions["wavelength_nm"] = named[1]
    return conditions


def stated(pairs_of_file: Mapping[str, str], key: str) -> str:
    """The value of a key in any case of letters, or nothing."""
    return next((value for name, value in pairs_of_file.items() if name.lower() == key), "")
