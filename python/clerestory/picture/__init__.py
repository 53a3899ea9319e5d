"""Pictures of a room: what an eye sees, read and written as Radiance HDR and OpenEXR, and shown to people.

What draws is loaded when it is first used: glare needs no drawing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from clerestory.picture.image import Picture
from clerestory.picture.view import View

if TYPE_CHECKING:
    from clerestory.picture.display import falsecolour, tone_map, tone_mapped

__all__ = ["Picture", "View", "falsecolour", "tone_map", "tone_mapped"]


def __getattr__(name: str) -> object:
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from clerestory.picture import display

    value: object = getattr(display, name)
    globals()[name] = value
    return value
