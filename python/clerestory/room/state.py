"""What is found of a picture so far: kept in a file when it is interrupted, and taken up again."""

from __future__ import annotations

import hashlib
import io
import json
import zipfile
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from clerestory import _core
from clerestory.room.picture import options
from clerestory.whole import write_whole

if TYPE_CHECKING:
    import os

    from clerestory.room import recipe as keys
    from clerestory.room.world import Room


class State:
    """The paths of a picture so far."""

    def __init__(self, core: _core.RoomPicture, fingerprint: str) -> None:
        self.core = core
        self.fingerprint = fingerprint

    @classmethod
    def new(cls, room: Room, view: keys.View, *, seed: int = 1) -> State:
        """No path is followed yet."""
        width, height = view.size_px
        core = _core.RoomPicture(room._core, options(view), width, height, seed)
        return cls(core, fingerprint(room, view, seed))

    @classmethod
    def load(cls, path: str | os.PathLike[str], room: Room, view: keys.View, *, seed: int = 1) -> State:
        """What `save` kept of the same picture.

        Raises
        ------
        ClerestoryError
            It is of another scene, view, size, seed or version, or the file is damaged.
        OSError
            The file cannot be read.
        """
        made = cls.new(room, view, seed=seed)
        data = Path(path).read_bytes()
        try:
            with np.load(io.BytesIO(data), allow_pickle=False) as kept:
                found, samples = str(kept["fingerprint"]), int(kept["samples"])
                sums, squares = (np.ascontiguousarray(kept[name], dtype=np.float64) for name in ("sums", "squares"))
        except (ValueError, TypeError, KeyError, OSError, EOFError, zipfile.BadZipFile) as error:
            raise _core.ClerestoryError(
                f"{path}: not what an interrupted picture leaves ({error}; start anew)"
            ) from None
        if found != made.fingerprint:
            raise _core.ClerestoryError(
                f"{path}: it is of another scene, view, size, seed or version (go on with those, or start anew)"
            )
        try:
            made.core.restore(sums, squares, samples)
        except (_core.ClerestoryError, TypeError, OverflowError) as error:
            raise _core.ClerestoryError(f"{path}: not what an interrupted picture leaves ({error})") from None
        return made

    def save(self, path: str | os.PathLike[str]) -> None:
        """Keep it in a file, which is written whole or not at all."""
        sums, squares = self.core.sums()
        buffer = io.BytesIO()
        np.savez_compressed(
            buffer, fingerprint=np.array(self.fingerprint), samples=np.array(self.samples), sums=sums, squares=squares
        )
        write_whole(path, buffer.getvalue())

    @property
    def samples(self) -> int:
        """Paths of every pixel so far."""
        return self.core.samples()


def fingerprint(room: Room, view: keys.View, seed: int) -> str:
    """What stands for all that the paths of a picture depend on."""
    told = [_core.__version__, options(view), view.size_px, seed, room.content()]
    mark = hashlib.sha256(json.dumps(told, default=str).encode())
    for path in room.files:
        mark.update(path.read_bytes())
    return mark.hexdigest()
