"""How window systems scatter light, and what that does in a room."""

from clerestory._core import (
    ClerestoryError,
    FileFormatError,
    MissingDataError,
    UnsupportedError,
    __version__,
)
from clerestory.basis import Basis
from clerestory.bsdf import Bsdf
from clerestory.model import Model

__all__ = [
    "Basis",
    "Bsdf",
    "ClerestoryError",
    "FileFormatError",
    "MissingDataError",
    "Model",
    "UnsupportedError",
    "__version__",
]
