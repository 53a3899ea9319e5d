"""Pieces of a round robin: each is found again by all that it depends on, and knows about what it costs."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from clerestory._core import __version__

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from clerestory.annual.cache import Arrays, Cache

    Tell = Callable[[float], object]


@dataclass(frozen=True)
class Piece:
    """Something that is computed once."""

    kind: str
    key: Mapping[str, object]
    """All that it depends on."""
    words: str
    """What it is."""
    cpu_s: float
    """Estimate of the processor time that it takes [s]."""
    size_mb: float
    """Estimate of its file's size [MB]."""
    compute: Callable[[Tell], Arrays]

    def is_kept(self, cache: Cache) -> bool:
        """Whether its file is there."""
        return cache.path_of(self.kind, self._key).is_file()

    def get(self, cache: Cache, tell: Tell) -> Arrays:
        """Its arrays, computed if they are not kept."""
        return cache.get(self.kind, self._key, lambda: self.compute(tell))

    @property
    def _key(self) -> dict[str, object]:
        # Another version of the program may find other numbers.
        return {**self.key, "program": __version__}


def collect(pieces: Iterable[Piece], cache: Cache, tell: Callable[[float, str], object]) -> list[Arrays]:
    """The arrays of pieces in their order; `tell` is called with the share that is done and what is next."""
    todo = list(pieces)
    missing = [piece for piece in todo if not piece.is_kept(cache)]
    whole = sum(piece.cpu_s for piece in missing) or 1.0
    done = 0.0
    found = []
    for piece in todo:
        cost = piece.cpu_s if piece in missing else 0.0

        def share(part: float, done: float = done, cost: float = cost, words: str = piece.words) -> None:
            tell((done + cost * min(part, 1.0)) / whole, words)

        if cost:
            share(0.0)
        found.append(piece.get(cache, share))
        done += cost
    tell(1.0, "done")
    return found


def packed(value: object, **files: bytes) -> Arrays:
    """A value that JSON knows, and files, as arrays."""
    return {
        "value": _bytes(json.dumps(value, allow_nan=False).encode()),
        **{name: _bytes(data) for name, data in files.items()},
    }


def value_of(arrays: Arrays) -> Any:  # noqa: ANN401 (whatever was packed)
    """The value among packed arrays."""
    return json.loads(arrays["value"].tobytes())


def _bytes(data: bytes) -> np.ndarray[tuple[int, ...], np.dtype[np.uint8]]:
    return np.frombuffer(data, dtype=np.uint8)
