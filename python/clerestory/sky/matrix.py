"""Sky matrices as text, as Radiance's programs read them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from clerestory._core import __version__

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from clerestory.sky.position import Place
    from clerestory.sky.settings import SkySettings


def text(values: NDArray[np.float64], settings: SkySettings, place: Place | None = None) -> str:
    """A matrix of patches by steps.

    Parameters
    ----------
    values
        Radiance (patches, steps, 3) of R, G and B, the ground first.
    settings, place
        For its head.
    """
    patches, steps, components = values.shape
    head = [
        "#?RADIANCE",
        f"SOFTWARE= Clerestory {__version__}",
        f"SKY= {settings.kind}, preset {settings.preset}, {settings.quantity} watts",
    ]
    if place is not None:
        head.append(f"LATLONG= {place.latitude:g} {place.longitude:g}")
    head += [f"NROWS={patches}", f"NCOLS={steps}", f"NCOMP={components}", "FORMAT=ascii", ""]
    rows = ("\n".join(" ".join(f"{v:.7g}" for v in step) for step in row) + "\n" for row in values)
    return "\n".join(head) + "\n" + "\n".join(rows)
