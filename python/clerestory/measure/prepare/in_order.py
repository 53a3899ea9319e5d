"""All steps of a preparation in their order."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

from clerestory._core import ClerestoryError
from clerestory.measure.prepare.channels import as_bands, side_by_side
from clerestory.measure.prepare.convention import CONVENTIONS, converted, self_check
from clerestory.measure.prepare.limits import Sector, within_reach
from clerestory.measure.prepare.noise import with_errors
from clerestory.measure.prepare.positions import averaged
from clerestory.measure.prepare.reciprocity import filled, missing_angles
from clerestory.measure.prepare.reference import as_bsdf, without_dark
from clerestory.measure.prepare.step import Prepared, Step
from clerestory.measure.prepare.symmetry import completed
from clerestory.measure.prepare.together import combined

if TYPE_CHECKING:
    from collections.abc import Mapping

    from clerestory.measure.prepare.symmetry import Symmetry
    from clerestory.measure.prepare.together import Level
    from clerestory.measure.scan import Measurement


@dataclass(frozen=True)
class Settings:
    """What a person says of a preparation."""

    convention: str | None = None
    """One of `CONVENTIONS`, for angles that stand as the laboratory wrote them; the reader has translated them if
    None."""
    detector_cone_deg: float | None = None
    """Full angle of the detector [°], for signals whose beam was measured in one place only."""
    level: Level = "as measured"
    """Whose level holds where a coarse and a fine scan overlap."""
    grazing_deg: float | Literal["auto"] = "auto"
    """Outgoing angle [°] up to which points are kept."""
    shadow_deg: float = 0.0
    """Half angle [°] of the cone about the source where the detector stands in the beam."""
    unreachable: tuple[Sector, ...] = ()
    relative_error: float = 0.0
    """Standard error of a value relative to it, beside the noise."""
    bands: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    """Weights of the detectors' channels by band; channels stay as they are without."""
    symmetry: Symmetry | Literal["auto"] | None = "auto"
    """The sample's; the highest that holds (auto); or no completion (None)."""
    isotropic_step_deg: float = 360.0
    """Azimuths [°] to which scans of an isotropic sample are turned; 360 for none, for a model that knows."""
    fill: bool = False
    """Whether incident directions that were not measured are filled by reversed paths."""


def prepare(measurement: Measurement, settings: Settings | None = None) -> Prepared:
    """Turn what an instrument saw into scans of BSDF, one a light, in the frame of the sample.

    The measurement itself is never changed; every step says what it did. The order: convention, dark signal, beam,
    BSDF, coarse and fine scans together, reach, positions, bands, noise, symmetry, reversed paths.

    Raises
    ------
    ClerestoryError
        There is no scan of the sample, or a step cannot be done; its text says which and what to do.
    """
    s = settings or Settings()
    if not measurement.of():
        raise ClerestoryError(f"{measurement.sample}: there is no scan of the sample to prepare")
    steps: list[Step] = []
    now = measurement

    def after(done: tuple[Measurement, Step]) -> Measurement:
        steps.append(done[1])
        return done[0]

    if s.convention is not None:
        if s.convention not in CONVENTIONS:
            raise ClerestoryError(f"convention {s.convention!r} is not known (give {', '.join(CONVENTIONS)})")
        now = after(converted(now, CONVENTIONS[s.convention]))
    steps.append(self_check(now))
    now = after(without_dark(now))
    now = after(as_bsdf(now, detector_cone_deg=s.detector_cone_deg))
    now = after(combined(now, level=s.level))
    now = after(within_reach(now, grazing_deg=s.grazing_deg, shadow_deg=s.shadow_deg, unreachable=s.unreachable))
    now = after(averaged(now))
    if s.bands:
        now = after(side_by_side(now))
        now = after(as_bands(now, s.bands))
    now = after(with_errors(now, relative=s.relative_error))
    if s.symmetry is not None:
        now = after(completed(now, s.symmetry, isotropic_step_deg=s.isotropic_step_deg))
    if s.fill:
        now = after(filled(now, missing_angles(now)))
    return Prepared(now, tuple(steps))
