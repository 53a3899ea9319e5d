"""What a cache holds, and making it smaller: what was not used for longest goes first."""

from __future__ import annotations

import re
from dataclasses import dataclass
from itertools import accumulate
from typing import TYPE_CHECKING

from clerestory._core import ClerestoryError
from clerestory.annual.cache import in_use

if TYPE_CHECKING:
    from pathlib import Path

_ENTRY = re.compile(r"(?P<kind>[a-z][a-z-]*)-[0-9a-f]{40}\.npz")
_UNFINISHED = re.compile(r"\.[a-z][a-z-]*-[0-9a-f]{40}\.npz\..+")
UNFINISHED = "unfinished"
"""Kind of what a program that was killed left half-written."""


@dataclass(frozen=True)
class Entry:
    """A file of a cache."""

    path: Path
    kind: str
    size: int
    """Its bytes."""
    used: float
    """When it was last read or written [s since 1970]."""


def entries(folder: Path) -> list[Entry]:
    """The files of a cache, that which was used last first; nothing else that lies there."""
    found = []
    for path in folder.iterdir() if folder.is_dir() else ():
        entry = _ENTRY.fullmatch(path.name)
        kind = entry["kind"] if entry else UNFINISHED if _UNFINISHED.fullmatch(path.name) else None
        if kind is None:
            continue
        try:
            about = path.stat()
        except FileNotFoundError:  # it has just got its name
            continue
        found.append(Entry(path, kind, about.st_size, max(about.st_atime, about.st_mtime)))
    return sorted(found, key=lambda entry: -entry.used)


def prune(folder: Path, most: int) -> list[Entry]:
    """Remove files of a cache until it has no more than so many bytes.

    What is unfinished goes first, then what was not used for longest.

    Returns
    -------
    What was removed.

    Raises
    ------
    ClerestoryError
        A program uses the cache: nothing is removed.
    OSError
        A file cannot be removed.
    """
    if not folder.is_dir():
        return []
    with in_use(folder, alone=True) as is_free:
        if not is_free:
            raise ClerestoryError(f"{folder}: a study that runs uses it (wait until it is done)")
        found = entries(folder)
        finished = [entry for entry in found if entry.kind != UNFINISHED]
        whole = accumulate(entry.size for entry in finished)
        removed = [entry for entry in found if entry.kind == UNFINISHED]
        removed += [entry for entry, size in zip(finished, whole, strict=True) if size > most]
        for entry in removed:
            entry.path.unlink()
        return removed
