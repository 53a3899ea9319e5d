"""Results on disk, found again by all that they depend on."""

from __future__ import annotations

import hashlib
import io
import json
import os
import time
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.whole import write_whole

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping

    from numpy.typing import NDArray

    Arrays = dict[str, NDArray[Any]]

VERSION = 1
"""Of the files and of what is computed: a file of another version is not found."""
FOLDERS = {"family": "family.json"}
"""Kinds that are folders of files, with the file in each that is written last: without it a folder is not whole."""


def default_folder() -> Path:
    """`$CLERESTORY_CACHE`, or `clerestory` in the user's folder for such files."""
    if named := os.environ.get("CLERESTORY_CACHE"):
        return Path(named)
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "clerestory"


def digest(*parts: object) -> str:
    """SHA-256 of parts: bytes, arrays, and what JSON can write."""
    found = hashlib.sha256()
    for part in parts:
        if isinstance(part, np.ndarray):
            data = repr((part.shape, part.dtype.str)).encode() + np.ascontiguousarray(part).tobytes()
        elif isinstance(part, bytes):
            data = part
        else:
            data = json.dumps(part, sort_keys=True).encode()
        found.update(len(data).to_bytes(8, "little"))
        found.update(data)
    return found.hexdigest()


@contextmanager
def in_use(folder: Path, *, alone: bool = False) -> Iterator[bool]:
    """Hold a folder that exists, together with others or alone; whether it could be had.

    What is held is let go when the process ends, however it does.

    Raises
    ------
    ClerestoryError
        It is asked for alone on a system that does not tell who else uses it.
    """
    try:
        import fcntl
    except ImportError:
        if alone:
            raise ClerestoryError(
                f"{folder}: this system does not tell whether a study uses it (remove files by hand when none runs)"
            ) from None
        yield True
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        try:
            fcntl.flock(handle, (fcntl.LOCK_EX if alone else fcntl.LOCK_SH) | fcntl.LOCK_NB)
            is_free = True
        except BlockingIOError:
            is_free = False
        yield is_free
    finally:
        os.close(handle)


class Cache:
    """Arrays by name in files whose names say what they depend on.

    A file that is damaged, or of another version, counts as missing: its arrays are computed again and it is replaced.
    While it lives, its folder is in use (`in_use`), so that nothing is removed from it.
    """

    def __init__(self, folder: str | os.PathLike[str] | None = None) -> None:
        self.folder = Path(folder) if folder is not None else default_folder()
        self.warnings: list[str] = []
        """What was found damaged."""
        self.computed: list[str] = []
        """Kinds of what was not found, in order."""
        self.found: list[str] = []
        """Kinds of what was found."""
        self._held = ExitStack()
        self._is_held = False
        self._hold()

    def _hold(self) -> None:
        if not self._is_held and self.folder.is_dir():
            # Where another removes what is old, all of this is still to be read.
            self._held.enter_context(in_use(self.folder))
            self._is_held = True

    def path_of(self, kind: str, key: Mapping[str, object]) -> Path:
        """Where something is, or would be."""
        return self.folder / f"{kind}-{digest(VERSION, kind, dict(key))[:40]}.npz"

    def get(self, kind: str, key: Mapping[str, object], compute: Callable[[], Arrays]) -> Arrays:
        """Arrays of this kind and key, computed if they are not there.

        Raises
        ------
        OSError
            The folder cannot be made, or the disk is full; nothing is left half-written.
        """
        path = self.path_of(kind, key)
        known = self._read(path)
        if known is not None:
            self.found.append(kind)
            _mark_used(path)
            return known
        made = compute()
        self.computed.append(kind)
        buffer = io.BytesIO()
        np.savez(buffer, allow_pickle=False, **made, checksum=np.array(_checksum(made)))
        self.folder.mkdir(parents=True, exist_ok=True)
        self._hold()
        write_whole(path, buffer.getvalue())
        return made

    def folder_of(self, kind: str, parts: Iterable[object], make: Callable[[Path], object]) -> Path:
        """A folder of files that belong together, made if it is not there whole.

        Parameters
        ----------
        kind
            One of `FOLDERS`.
        parts
            All that it depends on, as `digest` takes them.
        make
            Called with the folder to be made.

        Raises
        ------
        OSError
            It cannot be made.
        """
        home = self.folder / f"{kind}-{digest(*parts)[:40]}"
        last = home / FOLDERS[kind]
        if last.is_file():
            self.found.append(kind)
            _mark_used(last)
            return home
        self.folder.mkdir(parents=True, exist_ok=True)
        self._hold()
        make(home)
        self.computed.append(kind)
        return home

    def _read(self, path: Path) -> Arrays | None:
        if not path.is_file():
            return None
        try:
            with np.load(io.BytesIO(path.read_bytes()), allow_pickle=False) as stored:
                arrays = {name: stored[name] for name in stored.files}
            if str(arrays.pop("checksum")) == _checksum(arrays):
                return arrays
            what = "its content has changed"
        except Exception as error:
            what = str(error) or type(error).__name__
        self.warnings.append(f"{path}: {what}; it is computed again")
        return None


def _mark_used(path: Path) -> None:
    """Note when a file was last read, which file systems do not always do; not in a cache that others keep."""
    if os.access(path, os.W_OK):
        with suppress(PermissionError):  # the owner alone sets times
            os.utime(path, ns=(time.time_ns(), path.stat().st_mtime_ns))


def _checksum(arrays: Arrays) -> str:
    return digest(*(part for name in sorted(arrays) for part in (name, arrays[name])))
