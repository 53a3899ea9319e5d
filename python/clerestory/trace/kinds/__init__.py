"""The kinds of samples, a file a family."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from clerestory.trace.keys import RecipeError
from clerestory.trace.kinds.blind import Louvre, VenetianBlind
from clerestory.trace.kinds.common import Kind
from clerestory.trace.kinds.film import PrismaticFilm, Profile, ScannedProfile
from clerestory.trace.kinds.height import HeightMap
from clerestory.trace.kinds.panel import Honeycomb, LaserCutPanel, LightShelf, Pane
from clerestory.trace.kinds.scene import SceneSample
from clerestory.trace.kinds.screen import ExpandedMetal, PerforatedScreen
from clerestory.trace.kinds.weave import WovenFabric

if TYPE_CHECKING:
    from clerestory.trace.shapes import Shape
    from clerestory.trace.workshop import Workshop

Single = Annotated[
    VenetianBlind
    | Louvre
    | LightShelf
    | Pane
    | LaserCutPanel
    | PrismaticFilm
    | ScannedProfile
    | Profile
    | Honeycomb
    | WovenFabric
    | PerforatedScreen
    | ExpandedMetal,
    Field(discriminator="kind"),
]
"""A sample of one kind."""


class Layers(Kind):
    """Several samples at depths, such as slats before a pane."""

    kind: Literal["layers"]
    layers: list[Single] = Field(min_length=1)
    """The samples, each with its z_mm; their depths must not overlap."""

    def shapes(self, shop: Workshop, key: str) -> list[Shape]:
        """The shapes of all layers, from the exterior to the interior."""
        placed = [
            (shape, k + 1)
            for k, layer in enumerate(self.layers)
            for shape in layer.placed(shop, f"{key}.layers[{k + 1}]")
        ]
        placed.sort(key=lambda pair: pair[0].depth())
        for (before, i), (after, j) in pairwise(placed):
            ends, begins = before.depth()[1], after.depth()[0]
            if begins < ends:
                raise RecipeError(
                    f"{key}.layers[{j}].z_mm: the layer begins at {1000.0 * begins:g} mm, within layer {i}, which ends "
                    f"at {1000.0 * ends:g} mm (set them apart)"
                )
        period = next((s.period for s, _ in placed if not getattr(s, "everywhere", False)), None)
        return [shape.repeated(period) if period is not None else shape for shape, _ in placed]


AnySample = Annotated[
    VenetianBlind
    | Louvre
    | LightShelf
    | Pane
    | LaserCutPanel
    | PrismaticFilm
    | ScannedProfile
    | Profile
    | Honeycomb
    | WovenFabric
    | PerforatedScreen
    | ExpandedMetal
    | HeightMap
    | SceneSample
    | Layers,
    Field(discriminator="kind"),
]
"""A sample of any kind."""
