"""Rooms that come with Clerestory."""

from __future__ import annotations

from pathlib import Path

from clerestory.trace.shipped import Shelf

ROOMS = Shelf(Path(__file__).parent / "recipes", "room", "render")
names = ROOMS.names
