"""The table `family` of a specification: which key of a product changes, and to which values."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Annotated

from pydantic import Field, model_validator

from clerestory.system.product.keys import ProductKeys
from clerestory.system.recipe import TracedKeys
from clerestory.trace.keys import Keys, Number, wrong

if TYPE_CHECKING:
    from typing import Self

HEIGHT = "height"
"""Parameter that is no key of a product: how far it is let down."""


class FamilyKeys(TracedKeys):
    """A product with a parameter."""

    name: str | None = None
    """Its name; that of the product by default."""
    parameter: str
    """A key of the product that has a number, such as tilt_deg; with its place, such as layers[1].tilt_deg, where
    several have it. Or height: the share of the window's height that the product covers."""
    values: Annotated[list[Number], Field(min_length=2, max_length=200)]
    """Its values, that of the most open state first."""
    product: str | None = None
    """Recipe of a sample or specification of a window, by its file or the name under which it comes with Clerestory; or
    its tables stand beside this one."""
    without: str | None = None
    """For height: the window where the product is not, named as a room's data sets are: a BSDF file, a specification,
    a recipe, or a name of one that comes with Clerestory; an opening by default."""

    @model_validator(mode="after")
    def _sound(self) -> Self:
        values = self.values
        if not (all(a < b for a, b in pairwise(values)) or all(a > b for a, b in pairwise(values))):
            raise wrong("values", "they neither rise nor fall all along (give each once, in order)")
        if self.parameter == HEIGHT and not all(0.0 <= v <= 1.0 for v in values):
            raise wrong("values", "a height is a share of the window's, from 0 (drawn up) to 1")
        if self.parameter != HEIGHT and self.without is not None:
            raise wrong("without", f"goes with the parameter {HEIGHT} (leave it out)")
        return self


class Head(Keys):
    """What a specification of a family has beside the tables of its product."""

    family: FamilyKeys
    """What changes."""
    product: ProductKeys = Field(default_factory=ProductKeys)
    """Who makes it, and how it is to be placed."""
