"""Workbooks of spreadsheets, which instruments' programs write beside their text: refused, with what to export."""

from __future__ import annotations

from typing import TYPE_CHECKING

from clerestory.measure.formats import UnknownFormatError

if TYPE_CHECKING:
    from clerestory.measure.contents import Contents

NAME = "workbook"

_OLD = b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"
_NEW = b"PK\x03\x04"


def recognises(data: bytes, name: str) -> bool:
    """Whether it begins as a workbook does."""
    return data.startswith(_OLD) or (data.startswith(_NEW) and b"xl/workbook.xml" in data)


def read(data: bytes, name: str, **choices: object) -> Contents:
    """Refuse it.

    Raises
    ------
    UnknownFormatError
        Always, with what to do.
    """
    raise UnknownFormatError(
        "a spreadsheet's workbook is not read: export text from its program"
        " (.jdv or for LightTools from an RT-300S, CSV from any other)"
    )
