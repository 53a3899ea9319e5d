"""Formats of measurements' files, a file each.

A format is a module with `NAME`, `recognises(data, name)` and `read(data, name, **choices)`; one that can be written
has `write(measurement, **choices)` too, which gives the content of each file by its name; one whose sides and azimuths
a person may say has `FRAMED = True`. A file is told by its content; where several formats recognise it, the first in
`FORMATS` reads it: strict ones stand before tolerant ones.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Protocol

from clerestory._core import FileFormatError

if TYPE_CHECKING:
    from clerestory.measure.contents import Contents

FORMATS: tuple[str, ...] = (
    "workbook",
    "rgl",
    "sir",
    "ssdd",
    "zemax",
    "lighttools",
    "integra",
    "integra_specular",
    "jdv",
    "speos_own",
    "speos",
    "fred",
    "viavi",
    "brf",
    "product_json",
    "igdb_dat",
    "reflet",
    "astm",
    "mountain",
    "iea21",
    "reflectances",
    "sphere_csv",
    "table",
)
"""Modules of this package, in the order in which they are asked."""


class UnknownFormatError(FileFormatError):
    """A file is no measurement that is read; in a folder of mixed files it is left out."""


class Format(Protocol):
    """What a module of a format offers."""

    NAME: str
    """As it stands in `Source.format`."""

    def recognises(self, data: bytes, name: str) -> bool:
        """Whether the bytes of a file are of this format; looks at no more than it must."""

    def read(self, data: bytes, name: str, **choices: object) -> Contents:
        """What a file holds.

        Parameters
        ----------
        data
            Its bytes, unpacked.
        name
            Its name, for messages; its folder is not in it.
        choices
            What a person says of the file where it is silent (`side`, `scatter`, `sample`, …).

        Raises
        ------
        FileFormatError
            Place, what is wrong and what to do; the caller puts the file's path before it.
        """


def all_formats() -> tuple[Format, ...]:
    """Every format, in the order in which they are asked."""
    return tuple(import_module(f"{__name__}.{module}") for module in FORMATS)
