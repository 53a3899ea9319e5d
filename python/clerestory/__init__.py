"""How window systems scatter light, and what that does in a room.

Names are loaded when they are first used, so that the command line answers at once.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from clerestory._core import (
        ClerestoryError,
        FileFormatError,
        MissingDataError,
        UnsupportedError,
        __version__,
    )
    from clerestory.basis import Basis
    from clerestory.bsdf import Bsdf, Region
    from clerestory.directions import direction
    from clerestory.files import read
    from clerestory.metadata import Metadata
    from clerestory.model import Model

__all__ = [
    "Basis",
    "Bsdf",
    "ClerestoryError",
    "FileFormatError",
    "Metadata",
    "MissingDataError",
    "Model",
    "Region",
    "UnsupportedError",
    "__version__",
    "direction",
    "read",
]

# Every name above and the module that it lives in.
_HOMES = {
    "Basis": "basis",
    "Bsdf": "bsdf",
    "ClerestoryError": "_core",
    "FileFormatError": "_core",
    "Metadata": "metadata",
    "MissingDataError": "_core",
    "Model": "model",
    "Region": "bsdf",
    "UnsupportedError": "_core",
    "__version__": "_core",
    "direction": "directions",
    "read": "files",
}


def __getattr__(name: str) -> object:
    from importlib import import_module

    home = _HOMES.get(name)
    if home is None:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value: object = getattr(import_module(f"{__name__}.{home}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
