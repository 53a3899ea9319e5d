"""What is finished of a measurement: kept in a file when it is interrupted, and taken up again."""

from __future__ import annotations

import hashlib
import io
import json
import zipfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from clerestory import _core
from clerestory.whole import write_whole

if TYPE_CHECKING:
    import os

    from numpy.typing import NDArray

    from clerestory.trace.instrument import Settings
    from clerestory.trace.sample import Sample

ARRAYS = ("units", "values", "entries", "balance")


class State:
    """What is finished of a measurement."""

    def __init__(self, core: _core.TraceState, fingerprint: str) -> None:
        self.core = core
        self.fingerprint = fingerprint

    @classmethod
    def new(cls, sample: Sample, settings: Settings, incident: NDArray[np.float64] | None = None) -> State:
        """Nothing is finished yet."""
        mark = fingerprint(sample, settings, incident)
        return cls(_core.TraceState(mark), mark)

    @classmethod
    def load(
        cls,
        path: str | os.PathLike[str],
        sample: Sample,
        settings: Settings,
        incident: NDArray[np.float64] | None = None,
    ) -> State:
        """What `save` kept of the same measurement.

        Raises
        ------
        ClerestoryError
            It is of another recipe, of other settings or of another version, or the file is damaged.
        OSError
            The file cannot be read.
        """
        mark = fingerprint(sample, settings, incident)
        data = Path(path).read_bytes()
        try:
            with np.load(io.BytesIO(data), allow_pickle=False) as kept:
                arrays: list[tuple[str, Any]] = [(name, np.ascontiguousarray(kept[name])) for name in ARRAYS]
                found = str(kept["fingerprint"])
        except (ValueError, KeyError, OSError, EOFError, zipfile.BadZipFile) as error:
            raise _core.ClerestoryError(f"{path}: not what an interrupted trace leaves ({error}; start anew)") from None
        try:
            return cls(_core.TraceState.from_arrays(mark, found, arrays), mark)
        except _core.ClerestoryError as error:
            raise _core.ClerestoryError(f"{path}: {error}") from None

    def save(self, path: str | os.PathLike[str]) -> None:
        """Keep it in a file, which is written whole or not at all."""
        buffer = io.BytesIO()
        arrays: dict[str, Any] = {"fingerprint": np.array(self.fingerprint), **dict(self.core.to_arrays())}
        np.savez_compressed(buffer, **arrays)
        write_whole(path, buffer.getvalue())

    @property
    def done(self) -> tuple[int, int]:
        """Finished parts and all parts; (0, 0) before the measurement began."""
        return self.core.done()


def fingerprint(sample: Sample, settings: Settings, incident: NDArray[np.float64] | None = None) -> str:
    """What stands for all that a result depends on."""
    told = dict(vars(settings))
    # Results do not depend on it.
    del told["threads"]
    if not settings.is_tree:
        told["basis"] = settings.patches.rings
    text = json.dumps([_core.__version__, told, sample.source], default=str)
    mark = hashlib.sha256(text.encode())
    for part in sample.content():
        mark.update(part)
    if incident is not None:
        mark.update(incident.tobytes())
    return mark.hexdigest()
