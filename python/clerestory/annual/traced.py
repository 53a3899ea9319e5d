"""Samples that were traced, kept on disk: a recipe in a window is traced once."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from clerestory.npz import decode, encode

if TYPE_CHECKING:
    from collections.abc import Callable

    from clerestory.annual.cache import Arrays, Cache
    from clerestory.bsdf import Bsdf
    from clerestory.system.build import Traced
    from clerestory.trace import Sample


def kept(cache: Cache, tell: Callable[[str], object] | None = None) -> Traced:
    """What traces a sample as `trace.measure` does, and keeps the result by recipe, files and settings.

    Parameters
    ----------
    cache
        Where.
    tell
        Called with words before a sample is traced.
    """

    def measure(sample: Sample, **settings: Any) -> Bsdf:  # noqa: ANN401 (as `trace.measure` takes them)
        from clerestory import trace
        from clerestory.trace.state import fingerprint

        def compute() -> Arrays:
            if tell is not None:
                tell(f"tracing {sample.name}")
            return {"stored": np.frombuffer(encode(trace.measure(sample, **settings)), dtype=np.uint8)}

        key = {"trace": fingerprint(sample, trace.Settings(**settings))}
        return decode(cache.get("trace", key, compute)["stored"].tobytes())

    return measure
