"""Files that a TOML file names: errors that say which of its keys names them."""

from __future__ import annotations

import errno
import os
import re
from contextlib import contextmanager
from typing import TYPE_CHECKING

from clerestory._core import ClerestoryError
from clerestory.trace.keys import RecipeError

if TYPE_CHECKING:
    from collections.abc import Iterator

_MISSING = "does not exist (check it; in a TOML file paths are relative to that file)"
_FORBIDDEN = "may not be read (check its permissions)"
_FAULTS = {
    errno.ENOENT: _MISSING,
    errno.ENOTDIR: _MISSING,
    errno.EISDIR: "is a folder (give a file)",
    errno.EACCES: _FORBIDDEN,
    errno.EPERM: _FORBIDDEN,
}
# The core tells a path and the system's number in the text alone.
_OF_THE_CORE = re.compile(r"(.+): [^:]+ \(os error (\d+)\)", re.DOTALL)


@contextmanager
def reading(key: str) -> Iterator[None]:
    """Around what reads a file that a key names.

    Parameters
    ----------
    key
        What names the file, as errors say it: `systems.glass.file`, or `layer 2 (blind)`.

    Raises
    ------
    RecipeError
        In place of any error of the file: the key, the path, what is wrong and the remedy.
    """
    try:
        yield
    except OSError as error:
        raise RecipeError(f"{key}: {_words(error)}") from None
    except ClerestoryError as error:
        raise RecipeError(f"{key}: {error}") from None


def _words(error: OSError) -> str:
    path, number = error.filename, error.errno
    if number is None and (found := _OF_THE_CORE.fullmatch(str(error))) is not None:
        path, number = found[1], int(found[2])
    if path is None or number is None:
        return str(error)
    if number in _FAULTS:
        return f"{path} {_FAULTS[number]}"
    what = os.strerror(number)
    return f"{path}: {what[:1].lower()}{what[1:]} (check the file)"
