"""Rooms that come with Clerestory."""

from __future__ import annotations

from pathlib import Path

FOLDER = Path(__file__).parent / "recipes"


def names() -> list[str]:
    """The names of all rooms."""
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


def path_of(name: str) -> Path | None:
    """The file of a room by its name."""
    return FOLDER / f"{name}.toml" if name in names() else None


def about(name: str) -> str:
    """What a room is, in one line: the comment at its head."""
    first = (FOLDER / f"{name}.toml").read_text(encoding="utf-8").splitlines()[0]
    return first.removeprefix("#").strip().rstrip(".")
