"""What a data set holds, as text and as a table for notebooks."""

from __future__ import annotations

from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING

import numpy as np

from clerestory.counts import counted
from clerestory.directions import direction
from clerestory.integrals import hemispherical

if TYPE_CHECKING:
    from clerestory.bsdf import Bsdf
    from clerestory.directions import Scatter, Side
    from clerestory.model import Model


@dataclass(frozen=True)
class Block:
    """One component of a data set."""

    band: str
    side: Side
    """Side of incidence."""
    scatter: Scatter
    kind: str
    """Kind of the model."""
    basis: str | None
    """Names of the incident and outgoing bases of a matrix."""
    shape: tuple[int, int] | None
    """Number of outgoing and incident patches of a matrix."""
    tree: tuple[int, int] | None
    """Rank of a tensor tree and its finest number of cells an axis."""
    resolution_deg: float
    """Full angle [°] below which detail is not resolved, for light along the normal; 0 without a grid."""
    hemispherical: float
    """Hemispherical-hemispherical transmittance or reflectance under uniform radiance."""

    @property
    def words(self) -> str:
        """Kind and resolution in words."""
        if self.shape is not None:
            return f"{self.kind} {self.shape[0]} × {self.shape[1]}, {self.basis}"
        if self.resolution_deg <= 0.0:
            return self.kind
        tree = "" if self.tree is None else f" of rank {self.tree[0]}, {self.tree[1]} cells an axis"
        return f"{self.kind}{tree}, {self.resolution_deg:.{0 if self.resolution_deg >= 10.0 else 1}f}° at normal"


def blocks(bsdf: Bsdf) -> list[Block]:
    """The components that a data set holds, band by band."""
    return [
        _block(bsdf, band, side, scatter, model)
        for band, members in bsdf.models.items()
        for (side, scatter), model in members.items()
    ]


def _block(bsdf: Bsdf, band: str, side: Side, scatter: Scatter, model: Model) -> Block:
    basis = shape = None
    if model.kind == "matrix":
        incident, outgoing = model.incident_basis, model.outgoing_basis
        basis = incident.name if incident == outgoing else f"{incident.name} to {outgoing.name}"
        shape = (len(outgoing), len(incident))
    resolution = float(np.max(bsdf.resolution_deg(direction(0.0, 0.0, side=side), scatter, band)))
    total = hemispherical(bsdf, scatter, side=side, band=band, samples=1).value
    tree = (model.tree_rank, 2**model.tree_depth) if model.kind == "tensor tree" else None
    return Block(band, side, scatter, model.kind, basis, shape, tree, resolution, total)


def as_text(bsdf: Bsdf) -> str:
    """Bands, components and hemispherical values, a line each."""
    lines = ["Bsdf"]
    for block in blocks(bsdf):
        letter = "T" if block.scatter == "transmission" else "R"
        lines.append(
            f"  {block.band}: {block.side} {block.scatter}, {block.words}, {letter}_hh {block.hemispherical:.4f}"
        )
    if bsdf.warnings:
        lines.append(f"  {_warnings(bsdf)} (see .warnings)")
    return "\n".join(lines)


def as_html(bsdf: Bsdf) -> str:
    """The same as a table."""
    head = "".join(f"<th>{h}</th>" for h in ("band", "side of incidence", "scatter", "model", "hemispherical"))
    rows = "".join(
        "<tr>"
        + "".join(
            f"<td>{escape(cell)}</td>"
            for cell in (block.band, block.side, block.scatter, block.words, f"{block.hemispherical:.4f}")
        )
        + "</tr>"
        for block in blocks(bsdf)
    )
    notes = (
        f"<details><summary>{_warnings(bsdf)}</summary><ul>"
        + "".join(f"<li>{escape(text)}</li>" for text in bsdf.warnings)
        + "</ul></details>"
        if bsdf.warnings
        else ""
    )
    return f"<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>{notes}"


def _warnings(bsdf: Bsdf) -> str:
    return counted(len(bsdf.warnings), "warning")
