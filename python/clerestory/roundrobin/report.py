"""The report of a round robin: the document that `html` and `pdf` show."""

from __future__ import annotations

from typing import TYPE_CHECKING

from clerestory._core import __version__
from clerestory.counts import counted
from clerestory.report import Box, Cell, Document, Heading, Items, Paragraph, Table
from clerestory.roundrobin import chapters, conclusion
from clerestory.roundrobin.provenance import provenance

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from clerestory.report.document import Block
    from clerestory.roundrobin.run import Found
    from clerestory.roundrobin.study import RoundRobin


def document(
    study: RoundRobin, found: Sequence[Found], *, command: str | None, progress: Callable[[float], object]
) -> Document:
    """The report.

    Parameters
    ----------
    study, found
        The round robin, and what was found of each of its systems.
    command
        Command line that made it.
    progress
        Called with the share that is done, 0 to 1.
    """
    blocks: list[Block] = [*_first_page(study, found)]
    for k, one in enumerate(found):
        blocks += chapters.of_system(one)
        progress((k + 1) / len(found))
    blocks += _provenance(study, command)
    files = sum(len(lab.sources) for one in found for lab in one.system.laboratories)
    subtitle = " · ".join(
        [
            counted(len(found), "system"),
            counted(len(study.laboratories), "laboratory", "laboratories"),
            counted(files, "BSDF file"),
            f"Clerestory {__version__}",
        ]
    )
    return Document(study.recipe.name, subtitle, __version__, tuple(blocks))


def _first_page(study: RoundRobin, found: Sequence[Found]) -> list[Block]:
    """For a busy reader."""
    said = [sentence for one in found for sentence in conclusion.sentences(one)]
    blocks: list[Block] = [Box("In short", (_what(study, found), *said))]
    doubts = [text for one in found for text in conclusion.warnings(one)]
    doubts += chapters.doubts_of_rooms(found[0])
    if doubts:
        blocks.append(Box("Before the numbers are used", tuple(doubts), "note"))
    for one in found:
        blocks += chapters.main_figures(one)
    return blocks


def _what(study: RoundRobin, found: Sequence[Found]) -> str:
    systems = ", ".join(
        f"{one.system.title} (" + ", ".join(lab.name for lab in one.system.laboratories if lab.sources) + ")"
        for one in found
    )
    done = {"transmittance": "transmittances", "moments": "points in time", "year": "a year"}
    parts = [done[a] for a in study.recipe.analyses]
    return f"Compared: {systems}; by {', '.join(parts) or 'inventory alone'}."


def _provenance(study: RoundRobin, command: str | None) -> list[Block]:
    about = provenance(study)
    blocks: list[Block] = [Heading("How this was made")]
    if command:
        blocks.append(Paragraph(command))
    blocks.append(Items(tuple(f"{name}: {value}" for name, value in about["settings"].items())))
    blocks.append(Paragraph("Versions: " + ", ".join(f"{name} {v}" for name, v in about["versions"].items()) + "."))
    rows = tuple((Cell(f["system"]), Cell(f["laboratory"]), Cell(f["file"]), Cell(f["sha256"])) for f in about["files"])
    blocks.append(Table("Files, by the SHA-256 of their bytes.", ("system", "laboratory", "file", "SHA-256"), rows, 4))
    return blocks
