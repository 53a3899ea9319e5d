"""Pictures of a room: what an eye sees, read and written as Radiance HDR and OpenEXR, and shown to people."""

from clerestory.picture.display import falsecolour, tone_map, tone_mapped
from clerestory.picture.image import Picture
from clerestory.picture.view import View

__all__ = ["Picture", "View", "falsecolour", "tone_map", "tone_mapped"]
