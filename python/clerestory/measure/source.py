"""Where measured values were read from."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass


@dataclass(frozen=True)
class Source:
    """A file as it was read."""

    name: str
    """Of the file, without its folder."""
    sha256: str
    """Of its bytes as they lie on the disk, as hexadecimal digits."""
    format: str
    """What it was taken for: "pab Mountain", "IEA Task 21", …"""
    header: tuple[str, ...]
    """Every line of its header, as it stands."""
    convention: str
    """How its sides and angles were understood, in words."""


def digest(data: bytes) -> str:
    """SHA-256 of a file's bytes as hexadecimal digits."""
    return hashlib.sha256(data).hexdigest()
