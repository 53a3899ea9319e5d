"""What a cache holds, and making it smaller: what was not used for longest goes first."""

from __future__ import annotations

import re
import shutil
import stat
from dataclasses import dataclass
from itertools import accumulate
from typing import TYPE_CHECKING

from clerestory._core import ClerestoryError
from clerestory.annual.cache import FOLDERS, in_use

if TYPE_CHECKING:
    from pathlib import Path

_ENTRY = re.compile(r"(?P<kind>[a-z][a-z-]*)-[0-9a-f]{40}\.npz")
_FOLDER = re.compile(rf"(?P<kind>{'|'.join(FOLDERS)})-[0-9a-f]{{40}}")
_UNFINISHED = re.compile(r"\.[a-z][a-z-]*-[0-9a-f]{40}\.npz\..+")
UNFINISHED = "unfinished"
"""Kind of what a program that was killed left half-written."""


@dataclass(frozen=True)
class Entry:
    """A file of a cache, or a folder of files that belong together."""

    path: Path
    kind: str
    size: int
    """Its bytes."""
    used: float
    """When it was last read or written [s since 1970]."""

    def remove(self) -> None:
        """Take it from the disk.

        Raises
        ------
        OSError
            It cannot be removed.
        """
        if not self.path.is_dir():
            self.path.unlink()
            return
        if self.kind in FOLDERS:  # it is not whole without this file, should the rest be interrupted
            (self.path / FOLDERS[self.kind]).unlink()
        shutil.rmtree(self.path)


def entries(folder: Path) -> list[Entry]:
    """What a cache holds, that which was used last first; nothing else that lies there."""
    found = []
    for path in folder.iterdir() if folder.is_dir() else ():
        kind = _kind(path)
        if kind is None:
            continue
        is_folder = path.is_dir()
        try:
            about = [one.stat() for one in ([*path.rglob("*"), path] if is_folder else [path])]
        except FileNotFoundError:  # it has just got its name
            continue
        size = sum(one.st_size for one in about if stat.S_ISREG(one.st_mode))
        # Whoever lists a folder reads it.
        used = max(one.st_mtime if stat.S_ISDIR(one.st_mode) else max(one.st_atime, one.st_mtime) for one in about)
        found.append(Entry(path, kind, size, used))
    return sorted(found, key=lambda entry: -entry.used)


def _kind(path: Path) -> str | None:
    """What something in a cache's folder is; none if it is not the cache's."""
    if entry := _ENTRY.fullmatch(path.name):
        return entry["kind"]
    folder = _FOLDER.fullmatch(path.name)
    if folder and path.is_dir() and not path.is_symlink():
        return folder["kind"] if (path / FOLDERS[folder["kind"]]).is_file() else UNFINISHED
    return UNFINISHED if _UNFINISHED.fullmatch(path.name) else None


def prune(folder: Path, most: int) -> list[Entry]:
    """Remove what a cache holds until it has no more than so many bytes.

    What is unfinished goes first, then what was not used for longest.

    Returns
    -------
    What was removed.

    Raises
    ------
    ClerestoryError
        A program uses the cache: nothing is removed.
    OSError
        Something cannot be removed.
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
            entry.remove()
        return removed
