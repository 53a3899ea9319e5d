"""Models of measurements as tables: matrices of patches, or trees."""

from __future__ import annotations

from typing import TYPE_CHECKING

from clerestory.cli.common import TREES

if TYPE_CHECKING:
    from collections.abc import Callable

    from clerestory.bsdf import Bsdf


def as_table(bsdf: Bsdf, basis: str, resolution: int, done: Callable[[float], object], *, cull: float = 90.0) -> Bsdf:
    """On the patches of a basis; or, for `tensor3` and `tensor4`, as a tree of which a percentage is merged."""
    from clerestory.basis import Basis

    for rank in TREES:
        if rank == basis:
            return bsdf.to_tree(rank, resolution=resolution, reduce=cull, progress=done)
    return bsdf.to_matrix(Basis.named(basis), progress=done)
