"""Results on disk, found again by all that they depend on."""

from __future__ import annotations

import hashlib
import io
import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from clerestory.whole import write_whole

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import NDArray

    Arrays = dict[str, NDArray[Any]]

VERSION = 1
"""Of the files and of what is computed: a file of another version is not found."""


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


class Cache:
    """Arrays by name in files whose names say what they depend on.

    A file that is damaged, or of another version, counts as missing: its arrays are computed again and it is replaced.
    """

    def __init__(self, folder: str | os.PathLike[str] | None = None) -> None:
        self.folder = Path(folder) if folder is not None else default_folder()
        self.warnings: list[str] = []
        """What was found damaged."""
        self.computed: list[str] = []
        """Kinds of what was not found, in order."""
        self.found: list[str] = []
        """Kinds of what was found."""

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
            return known
        made = compute()
        self.computed.append(kind)
        buffer = io.BytesIO()
        np.savez(buffer, allow_pickle=False, **made, checksum=np.array(_checksum(made)))
        self.folder.mkdir(parents=True, exist_ok=True)
        write_whole(path, buffer.getvalue())
        return made

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


def _checksum(arrays: Arrays) -> str:
    return digest(*(part for name in sorted(arrays) for part in (name, arrays[name])))
