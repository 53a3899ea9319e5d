"""A fitted model and how far it is to be believed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory.counts import counted

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from clerestory.bsdf import Bsdf
    from clerestory.directions import Scatter, Side
    from clerestory.measure.prepare.symmetry import Symmetry

    Floats = NDArray[np.float64]


@dataclass(frozen=True)
class HeldOut:
    """What a model says of measured incident directions when each is left out of it in turn.

    Twice as far from its neighbours as a direction of the whole model ever is, so the errors are upper bounds.
    """

    theta_deg: Floats
    """Of the incident directions that lie among the others [°] (n,)."""
    phi_deg: Floats
    measured: Floats
    """Direct-hemispherical values (n,)."""
    found: Floats
    """Those of the model without them (n,)."""
    misplaced: Floats
    """Share of the scattered light that is in another place (n,)."""
    peak_deg: Floats
    """Angle between the brightest directions [°] (n,)."""

    def __len__(self) -> int:
        return len(self.theta_deg)

    @property
    def total_error(self) -> float:
        """RMS difference of direct-hemispherical values; NaN where nothing could be left out."""
        return float(np.sqrt(np.mean((self.found - self.measured) ** 2))) if len(self) else float("nan")

    @property
    def misplaced_mean(self) -> float:
        """Mean share of the scattered light that is in another place."""
        return float(np.mean(self.misplaced)) if len(self) else float("nan")

    @property
    def peak_median_deg(self) -> float:
        """Median angle between the brightest directions [°]."""
        return float(np.median(self.peak_deg)) if len(self) else float("nan")


@dataclass(frozen=True)
class Component:
    """One model of a fit: light from one side, transmitted or reflected, in one band."""

    band: str
    side: Side
    scatter: Scatter
    symmetry: Symmetry
    symmetry_reason: str
    incident: int
    """Measured incident directions."""
    points: int
    lobes: int
    """Radial basis functions that the points became, over all measured directions."""
    theta_limit_deg: float
    """Largest measured incident angle [°]; beyond it the model is extrapolated."""
    outgoing_limit_deg: float
    """Largest measured outgoing angle [°]."""
    held_out: HeldOut

    def lines(self) -> list[str]:
        """What it is and how good, in sentences."""
        found = [
            f"{self.band}, {self.scatter} from {self.side}: {counted(self.points, 'point')} of"
            f" {counted(self.incident, 'incident direction')} as {counted(self.lobes, 'lobe')};"
            f" symmetry {self.symmetry} ({self.symmetry_reason})",
            f"measured up to {self.theta_limit_deg:.0f}° of incidence and {self.outgoing_limit_deg:.0f}° out;"
            " beyond, values are extrapolated",
        ]
        held = self.held_out
        if len(held):
            found.append(
                f"left out one by one, {counted(len(held), 'incident direction')} came back with a"
                f" direct-hemispherical value off by {held.total_error:.4f} (RMS), {100 * held.misplaced_mean:.1f} % of"
                f" the light misplaced, and the brightest direction off by {held.peak_median_deg:.2f}° (median)"
            )
        else:
            found.append("too few incident directions to leave one out: the error between them is not known")
        return found


@dataclass(frozen=True)
class Fit:
    """A data set of interpolants, and what it was made of."""

    bsdf: Bsdf
    sample: str
    method: str
    components: tuple[Component, ...]
    warnings: tuple[str, ...] = ()

    def lines(self) -> list[str]:
        """What was made and how good, in sentences."""
        return [line for component in self.components for line in component.lines()]
