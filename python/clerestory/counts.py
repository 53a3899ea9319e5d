"""Counts in words."""

from __future__ import annotations


def counted(count: int, noun: str, plural: str | None = None) -> str:
    """A count and its noun: `1 patch`, `3 patches`; the plural takes an s if none is given."""
    return f"{count} {noun if count == 1 else plural or noun + 's'}"
