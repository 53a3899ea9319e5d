"""Files that are written whole or not at all."""

from __future__ import annotations

import errno
import os
import tempfile
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator


def write_whole(path: str | os.PathLike[str], content: bytes) -> None:
    """Write a file under a name of its own in the same folder, then give it the name that was asked for.

    A pipe or a device, such as /dev/stdout, is written to directly.

    Raises
    ------
    OSError
        The folder does not exist, the name is a folder's, or the disk is full; an older file stays as it was.
    """
    path = Path(path)
    if path.exists() and not path.is_file() and not path.is_dir():
        path.write_bytes(content)
        return
    with whole_file(path) as temporary:
        temporary.write_bytes(content)


@contextmanager
def whole_file(path: str | os.PathLike[str]) -> Iterator[Path]:
    """A file to write to, which gets the name that was asked for when that is done.

    Raises
    ------
    OSError
        The folder does not exist, the name is a folder's, or the disk is full; an older file stays as it was.
    """
    path = Path(path)
    if path.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    target = path.resolve()  # a link stays a link, and what it points to is replaced
    try:
        handle, name = tempfile.mkstemp(prefix=f".{path.name}.", dir=target.parent)
        os.close(handle)
        temporary = Path(name)
        try:
            yield temporary
            mask = os.umask(0)
            os.umask(mask)
            temporary.chmod(0o666 & ~mask)
            temporary.replace(target)
        except BaseException:
            temporary.unlink(missing_ok=True)
            raise
    except OSError as error:
        # Not the temporary name, which nobody has asked for; a full disk names none.
        raise OSError(error.errno, error.strerror, str(path)) from error
