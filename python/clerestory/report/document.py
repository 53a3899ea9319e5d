"""What a report is made of; `html` and `pdf` show the same document.

Texts are plain; symbols such as `T_d-h` get their subscripts where they are shown. Tables and figures are numbered in
their order.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Iterator


@dataclass(frozen=True)
class Heading:
    """Begins a chapter, or a section of one."""

    text: str
    level: Literal[2, 3] = 2


@dataclass(frozen=True)
class Paragraph:
    """Sentences."""

    text: str


@dataclass(frozen=True)
class Items:
    """A list."""

    items: tuple[str, ...]


@dataclass(frozen=True)
class Box:
    """A list that stands out: what matters most, or what has to be known first."""

    title: str
    items: tuple[str, ...]
    kind: Literal["key", "note"] = "key"


@dataclass(frozen=True)
class Cell:
    """A cell of a table."""

    text: str
    value: float | None = None
    """Its number, by which the column is sorted; by the text without one."""
    note: str = ""
    """What has to be known of it; it is marked."""


@dataclass(frozen=True)
class Table:
    """Rows of cells; the first `left` columns are words."""

    caption: str
    heads: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    left: int = 1


@dataclass(frozen=True)
class Figure:
    """A picture."""

    caption: str
    alt: str
    png: bytes = field(repr=False)


Block: TypeAlias = Heading | Paragraph | Items | Box | Table | Figure


@dataclass(frozen=True)
class Document:
    """A report."""

    title: str
    subtitle: str
    version: str
    """Of Clerestory."""
    blocks: tuple[Block, ...]

    def numbered(self) -> Iterator[tuple[Block, int]]:
        """Its blocks, with the number of a table or figure among its kind from 1; 0 for others."""
        tables = figures = 0
        for block in self.blocks:
            if isinstance(block, Table):
                tables += 1
                yield block, tables
            elif isinstance(block, Figure):
                figures += 1
                yield block, figures
            else:
                yield block, 0
