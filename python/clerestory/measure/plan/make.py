"""A plan of a measurement, from the sample, the purpose and the instrument."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from clerestory.directions import direction, outgoing_side
from clerestory.integrals import continued
from clerestory.measure.plan.advice import advice_of
from clerestory.measure.plan.extent import extent_of
from clerestory.measure.plan.incidence import steps, subset
from clerestory.measure.plan.paths import circle_path, hemisphere_path, in_band_path, without_source
from clerestory.measure.plan.route import route_of

if TYPE_CHECKING:
    from clerestory.directions import Scatter, Side
    from clerestory.measure.plan.extent import Extent
    from clerestory.measure.plan.instrument import Instrument
    from clerestory.measure.plan.job import Job
    from clerestory.measure.plan.paths import ScanPath
    from clerestory.measure.plan.route import Route


@dataclass(frozen=True)
class PlannedPath:
    """A path, and the incident direction that it is for."""

    incidence: int | None
    """Number of the incident direction, from 1; None for all."""
    scatter: Scatter
    path: ScanPath


@dataclass(frozen=True)
class Plan:
    """What to measure, with what, how long it takes, and what to know of it."""

    job: Job
    instrument: Instrument
    extent: Extent
    route: Route
    incident: tuple[tuple[Side, float, float], ...]
    """Side, polar angle and azimuth [°] of each incident direction."""
    paths: tuple[PlannedPath, ...]
    """Of a scanning instrument; a camera sees all at once."""
    hours: float
    """For all incident directions and positions: at least this for a scanning instrument."""
    advice: tuple[str, ...]


def make_plan(job: Job, instrument: Instrument) -> Plan:
    """Plan a measurement.

    Where the way is to measure the material and trace the system, the plan is for the material: a flat piece without
    structure of the same size.
    """
    piece = job.sample
    extent = extent_of(piece, instrument)
    route = route_of(piece, extent)
    measured = piece
    if route.way == "material":
        side = min(piece.width_mm, piece.height_mm, *instrument.holders[0].largest_mm)
        flat = {"period_mm": 0.0, "weave": "none", "width_mm": side, "height_mm": side, "prismatic": False}
        # Surfaces of parts are taken for isotropic until a scan shows that they are not.
        measured = piece.model_copy(update={**flat, "symmetry": "isotropic", "cut_off_deg": None})
        extent = extent_of(measured, instrument)
    incident: list[tuple[Side, float, float]] = []
    for incident_side in dict.fromkeys(job.sides):
        if job.directions == "steps":
            found = steps(measured, extent.largest_theta_deg)
        else:
            found = subset(job.directions, measured.symmetry, extent.largest_theta_deg, incident_side)
        incident += [(incident_side, theta, phi) for theta, phi in found]
    seen = [s for s in dict.fromkeys(job.scatter) if s in instrument.scatter]
    paths = (
        _paths(job, instrument, incident, seen, prismatic=measured.prismatic) if instrument.kind == "scanning" else []
    )
    hours = len(incident) * route.positions * instrument.minutes_an_incidence / 60.0
    words = advice_of(job.model_copy(update={"sample": measured}), instrument, extent, route)
    return Plan(job, instrument, extent, route, tuple(incident), tuple(paths), hours, words)


def coarse_step_deg(job: Job, instrument: Instrument) -> float:
    """Step of the scan of the hemisphere: half of the instrument's usual one where peaks matter."""
    return instrument.grid_step_deg * (1.0 if job.purpose == "klems" else 0.5)


def _paths(
    job: Job,
    instrument: Instrument,
    incident: list[tuple[Side, float, float]],
    seen: list[Scatter],
    *,
    prismatic: bool,
) -> list[PlannedPath]:
    made = []
    largest = instrument.largest_outgoing_theta_deg
    step = coarse_step_deg(job, instrument)
    for side in dict.fromkeys(job.sides):
        for scatter in seen:
            leaving = outgoing_side(side, scatter)
            whole = hemisphere_path(leaving, step_deg=step, largest_theta_deg=largest)
            made.append(PlannedPath(None, scatter, whole))
            for n, (from_side, theta, phi) in enumerate(incident, start=1):
                if from_side != side:
                    continue
                toward = direction(theta, phi, side=side)
                # Matrices need no shape of a peak, but its flux: the fine scan stays, with wider steps.
                fine = instrument.resolution_deg / (3.0 if job.purpose == "klems" else 6.0)
                if job.sample.specular and theta <= largest:
                    beam = circle_path(
                        continued(toward, scatter), radius_deg=2.0 * instrument.resolution_deg, step_deg=fine
                    )
                    made.append(PlannedPath(n, scatter, without_source(beam, toward, side, instrument.shield_deg)))
                if prismatic:
                    band = in_band_path(
                        toward,
                        leaving,
                        half_width_deg=2.0 * instrument.resolution_deg,
                        step_deg=0.5 * instrument.resolution_deg,
                    )
                    made.append(PlannedPath(n, scatter, without_source(band, toward, side, instrument.shield_deg)))
    return [planned for planned in made if len(planned.path)]
