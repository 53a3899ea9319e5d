"""Endings of the names of BSDF files."""

from __future__ import annotations

from pathlib import PurePath
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import os

_ENDINGS = (".xml", ".xml.gz", ".npz")


def is_bsdf(path: str | os.PathLike[str]) -> bool:
    """Whether a name is that of a BSDF file: XML, gzipped or not, or Clerestory's own file."""
    return PurePath(path).name.lower().endswith(_ENDINGS)


def stem_of(path: str | os.PathLike[str]) -> str:
    """The name of a file without its folder and without the ending of a BSDF file."""
    name = PurePath(path).name
    for suffix in (".gz", ".xml", ".npz", ".bsdf"):
        if name.lower().endswith(suffix) and len(name) > len(suffix):
            name = name[: -len(suffix)]
    return name
