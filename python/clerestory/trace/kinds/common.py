"""What all kinds of samples share."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING

from clerestory.trace.keys import Keys, Number

if TYPE_CHECKING:
    from collections.abc import Sequence

    from clerestory.trace.shapes import Shape
    from clerestory.trace.workshop import Workshop


class Kind(Keys, ABC):
    """A kind of sample, or of a layer of one."""

    name: str | None = None
    """Name of the sample, for people."""
    z_mm: Number = 0.0
    """Where the plane that its own lengths are counted from lies [mm]; negative towards the exterior."""

    @abstractmethod
    def shapes(self, shop: Workshop, key: str) -> Sequence[Shape]:
        """Its shapes, z counted from its own plane [m].

        Raises
        ------
        RecipeError
            It cannot be; the text names the key.
        """

    def placed(self, shop: Workshop, key: str) -> list[Shape]:
        """Its shapes, shifted to its plane and put in order from the exterior to the interior."""
        moved = [shape.moved(self.z_mm / 1000.0) for shape in self.shapes(shop, key)]
        return sorted(moved, key=lambda shape: shape.depth())

    def _warn_of_size(self, shop: Workshop, key: str, value: float, unit: str, most: float) -> None:
        """Warn of lengths that look as if they were in another unit."""
        if value > most or value < most / 1e4:
            shop.warnings.append(f"{key}: {value:g} {unit} is unusual (check the unit)")
