"""The files of a round robin: report, numbers, labelled arrays."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from clerestory.annual.dataset import save
from clerestory.compare.result import plain
from clerestory.report.html import html
from clerestory.report.pdf import pdf
from clerestory.roundrobin.labelled import labelled
from clerestory.roundrobin.results import results
from clerestory.whole import write_whole

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from clerestory.report import Document
    from clerestory.roundrobin.run import Found
    from clerestory.roundrobin.study import RoundRobin

NAMES = ("report.html", "report.pdf", "results.json", "results.nc")


def write(study: RoundRobin, found: Sequence[Found], document: Document, folder: Path) -> list[Path]:
    """Write them into a folder, which is made; their paths."""
    folder.mkdir(parents=True, exist_ok=True)
    numbers = json.dumps(plain(results(study, found)), indent=1, ensure_ascii=False, allow_nan=False)
    write_whole(folder / "report.html", html(document).encode())
    write_whole(folder / "report.pdf", pdf(document))
    write_whole(folder / "results.json", numbers.encode())
    save(labelled(study, found), folder / "results.nc")
    return [folder / name for name in NAMES]
