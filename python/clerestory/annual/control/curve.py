"""The cut-off control curve of a venetian blind: the tilt that keeps the sun out, by its profile angle.

Exact for curved slats; see `clerestory.annual.control.slats`.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.annual.control.cut_off import needed_tilt_deg
from clerestory.annual.control.slats import Slats
from clerestory.plot import style
from clerestory.system.product import Curve
from clerestory.trace.kinds.blind import VenetianBlind

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from clerestory.trace import Sample

    Floats = NDArray[np.float64]


@dataclass(frozen=True)
class ControlCurve:
    """Tilts by profile angle."""

    name: str
    slats: Slats
    """[mm]."""
    profile_deg: Floats
    """Height of the sun in the section across the slats (n,) [°]."""
    exact_deg: Floats
    """Least tilt that keeps the sun out (n,) [°]; NaN where none does, −∞ where any does."""
    tilt_deg: Floats
    """Tilt of the drive (n,) [°]: with safety, in its steps, within its range; NaN where none keeps the sun out."""
    safety_deg: float
    step_deg: float
    range_deg: tuple[float, float]

    def csv(self) -> str:
        """A row a profile angle; without a tilt where none keeps the sun out."""
        rows = ["profile_deg,least_tilt_deg,tilt_deg"]
        for profile, exact, tilt in zip(self.profile_deg, self.exact_deg, self.tilt_deg, strict=True):
            least = "" if not math.isfinite(exact) else f"{exact:.3f}"
            rows.append(f"{profile:g},{least},{'' if math.isnan(tilt) else f'{tilt:g}'}")
        return "\n".join(rows) + "\n"

    def json(self) -> str:
        """The same with the slats and the choices."""
        return json.dumps(self.as_dict(), indent=1) + "\n"

    def as_dict(self) -> dict[str, Any]:
        """Of plain values; null where there is no tilt."""
        return {
            "name": self.name,
            "slats_mm": {"width": self.slats.width, "pitch": self.slats.pitch, "crown": self.slats.crown},
            "tilt": "0 level, positive with the outer edge below the inner one",
            "safety_deg": self.safety_deg,
            "step_deg": self.step_deg,
            "range_deg": list(self.range_deg),
            "profile_deg": self.profile_deg.tolist(),
            "least_tilt_deg": [float(v) if math.isfinite(v) else None for v in self.exact_deg],
            "tilt_deg": [None if math.isnan(v) else float(v) for v in self.tilt_deg],
        }

    def as_product(self) -> Curve:
        """As data sets carry it in XML."""
        return Curve(
            tuple(self.profile_deg.tolist()),
            tuple(None if math.isnan(v) else round(float(v), 4) for v in self.tilt_deg),
            (self.slats.width, self.slats.pitch, self.slats.crown),
            self.safety_deg,
            self.step_deg,
        )

    @style.styled
    def figure(self) -> Figure:
        """Both tilts over the profile angle."""
        axes = style.new_figure(6.0, 4.0).add_subplot()
        exact = np.where(np.isfinite(self.exact_deg), self.exact_deg, np.nan)
        axes.plot(self.profile_deg, exact, label="least tilt that keeps the sun out")
        axes.step(self.profile_deg, self.tilt_deg, where="mid", label="tilt of the drive")
        open_ = np.isnan(self.tilt_deg)
        if open_.any():
            low, high = self.profile_deg[open_].min(), self.profile_deg[open_].max()
            axes.axvspan(low, high, alpha=0.15, label="no tilt keeps it out")
        axes.set_xlabel("profile angle of the sun [°]")
        axes.set_ylabel("tilt [°]")
        axes.set_title(self.name)
        axes.legend()
        return style.figure_of(axes)


def control_curve(
    slats: Slats,
    *,
    name: str = "",
    safety_deg: float = 0.0,
    step_deg: float = 0.0,
    range_deg: tuple[float, float] = (0.0, 90.0),
    profile_step_deg: float = 1.0,
) -> ControlCurve:
    """Tilts for profile angles of 0 to 89°.

    Parameters
    ----------
    slats
        Their geometry [mm].
    name
        Of the blind.
    safety_deg
        That is added.
    step_deg
        Of the drive; any tilt by default.
    range_deg
        Most open and most closed tilt.
    profile_step_deg
        Of the curve.

    Raises
    ------
    ClerestoryError
        The range is not one from open to closed, or a step is not possible.
    """
    low, high = range_deg
    if not -90.0 <= low < high <= 90.0:
        raise ClerestoryError(f"tilts from {low:g} to {high:g}° are no range (give open,closed within ±90°)")
    if not 0.01 <= profile_step_deg <= 45.0 or safety_deg < 0.0 or step_deg < 0.0:
        raise ClerestoryError("steps and safety are 0 or more, and the step of the curve 0.01 to 45°")
    profile = np.arange(0.0, 90.0, profile_step_deg)
    radians = np.radians(profile)
    exact = np.degrees(slats.cut_off(radians))
    tilt = needed_tilt_deg(slats, radians, safety_deg=safety_deg, step_deg=step_deg, least_deg=low)
    return ControlCurve(
        name,
        slats,
        profile,
        exact,
        np.where(np.isfinite(tilt) & (tilt <= high), tilt, np.nan),
        safety_deg,
        step_deg,
        range_deg,
    )


def slats_of(sample: Sample) -> Slats:
    """Slats [mm] of a recipe of a venetian blind.

    Raises
    ------
    ClerestoryError
        The sample is another kind.
    """
    kind = sample.recipe.sample
    if not isinstance(kind, VenetianBlind):
        raise ClerestoryError(f"{sample.name}: a {kind.kind} has no slats to tilt (give a recipe of a venetian-blind)")
    return Slats(kind.slat.width_mm, kind.pitch_mm, kind.slat.crown_mm)
