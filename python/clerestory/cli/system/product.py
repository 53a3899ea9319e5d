"""What `system` commands take: a specification of a window, or a BSDF file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from clerestory.cli.common import about, note, warn

if TYPE_CHECKING:
    from clerestory.system.build import Specified
    from clerestory.system.window import Built


def specified(product: str, *, quiet: bool) -> Specified:
    """A specification with its layers made, told on the way."""
    from clerestory.annual.cache import Cache
    from clerestory.annual.traced import kept
    from clerestory.system.build import load

    return load(product, traced=kept(Cache(), None if quiet else note))


def solved(product: str, made: Specified) -> Built:
    """It on its patches; what was odd is shown on standard error."""
    with about(Path(product)):
        built = made.solve()
    for text in built.warnings:
        warn(product, text)
    return built
