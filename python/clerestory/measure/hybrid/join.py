"""A measured and a simulated data set as one, without a seam."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from clerestory._core import ClerestoryError, MissingDataError, __version__
from clerestory.bsdf import Bsdf
from clerestory.directions import SCATTERS, SIDES
from clerestory.measure.calibrate.factors import PLAUSIBLE
from clerestory.measure.hybrid.tables import table
from clerestory.words import percent

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import NDArray

    from clerestory.directions import Scatter, Side
    from clerestory.measure.hybrid.reach import Key, Reach
    from clerestory.measure.hybrid.tables import Table
    from clerestory.model import Model

    Floats = NDArray[np.float64]

Scale = Literal["seam", "overlap", "none"]
"""The simulated light is scaled so that both carry as much along the seam, or wherever was measured; or stays."""
SCALES: tuple[Scale, ...] = ("seam", "overlap", "none")
BLEND_DEG = 10.0
"""About a Klems patch: the share of the simulation grows from 0 to 1 over this depth [°] within what was measured."""
_APART = 0.25
"""Share of the light along the seam that may be in another place before the shapes do not fit together."""
_ENERGY = 1e-3
_LEAST = 0.5
"""Share of the measured model that some pair of directions must have."""


@dataclass(frozen=True)
class Part:
    """One component of a hybrid model, and what it was made of."""

    band: str
    side: Side
    scatter: Scatter
    reach: str
    """How far was measured, in words."""
    limit_deg: float
    """Largest incident angle that was measured [°]; 0 where none was."""
    factor: float
    """What the simulated light was multiplied by."""
    factor_seam: float | None
    """Measured over simulated light along the seam; None where there is no seam or no light."""
    factor_overlap: float | None
    """Measured over simulated light wherever was measured."""
    apart: float | None
    """Share of the light along the seam that the simulation, scaled, has in another place."""
    measured_incident: float
    """Share of the incident directions that were measured, by projected solid angle; the rest is simulated."""
    measured_solid_angle: float
    """Share of the pairs of directions whose value is measured, by projected solid angle on both sides."""
    measured_flux: float
    """Share of the light, under even light from all directions, that was measured."""

    @property
    def where(self) -> str:
        """The component in words."""
        return f"{self.band}, {self.scatter} from the {self.side}"

    @property
    def words(self) -> str:
        """Shares and factor as a sentence."""
        if self.measured_solid_angle == 0.0:
            return f"{self.where}: {self.reach}, all of it simulated"
        parts = (
            f"{percent(self.measured_flux)} of the light measured and {percent(1.0 - self.measured_flux)} simulated"
            f" ({percent(self.measured_incident)} of the incident directions and"
            f" {percent(self.measured_solid_angle)} of all pairs of directions measured)"
        )
        fits = "" if self.apart is None else f", {percent(self.apart)} of the light along the seam in another place"
        return f"{self.where}: {parts}; simulated light times {self.factor:.3g}{fits}"


@dataclass(frozen=True)
class Hybrid:
    """A hybrid data set, what it was made of, and the two that it was made of, in the same cells."""

    bsdf: Bsdf
    parts: tuple[Part, ...]
    measured: Bsdf
    simulated: Bsdf
    """Scaled."""
    warnings: tuple[str, ...]


def joined(
    measured: Bsdf,
    reaches: Mapping[Key, Reach],
    simulated: Bsdf,
    *,
    basis: str = "klems-full",
    resolution: int = 6,
    reduce: float | None = 90.0,
    blend_deg: float = BLEND_DEG,
    scale: Scale = "seam",
    name: str = "",
    simulation: str = "a simulation",
    progress: Callable[[float], object] | None = None,
) -> Hybrid:
    """The measured data set where it was measured, the simulated one elsewhere.

    Parameters
    ----------
    measured
        A model of a measurement.
    reaches
        How far each of its components was measured.
    simulated
        Any data set of the same sample. Components that it alone holds are taken as they are, unscaled.
    basis
        Patches, or `tensor3` or `tensor4` for a tree.
    resolution, reduce
        Of a tree: 2^resolution cells an axis, and the percentage of its finest blocks to merge.
    blend_deg
        Width [°] of the band within the border of what was measured in which one passes into the other.
    scale
        What makes both agree: their light along that band (`seam`), or wherever was measured (`overlap`); or nothing.
    name, simulation
        Of the sample and of the simulated data, for the file.
    progress
        Called with the share that is done, 0 to 1.

    Raises
    ------
    MissingDataError
        The simulation lacks a band or a side that was measured.
    ClerestoryError
        Nothing was measured over an area as wide as the band, or the simulation is dark where light was measured.
    """
    if scale not in SCALES:
        raise ClerestoryError(f"scale {scale!r} is not known (give {', '.join(SCALES)})")
    if not 0.0 < blend_deg <= 45.0:
        raise ClerestoryError(f"a band of {blend_deg:g}° is not possible (give more than 0 and at most 45°)")
    cells = table(basis, resolution, reduce)
    warnings: list[str] = []
    needed = _both(measured, simulated, warnings)
    tell = progress or (lambda _share: None)
    from_scans = cells.converted(measured, lambda share: tell(0.4 * share))
    from_rays = cells.converted(needed, lambda share: tell(0.4 + 0.3 * share))
    keys = [(b, s, c) for b in needed.bands for s in SIDES for c in SCATTERS if (s, c) in needed.models[b]]
    models: dict[str, dict[tuple[Side, Scatter], Model]] = {}
    scaled: dict[str, dict[tuple[Side, Scatter], Model]] = {}
    parts = []
    for number, key in enumerate(keys):
        band, side, scatter = key
        members = from_rays.models[band]
        if key not in reaches:
            part = Part(band, side, scatter, "not measured", 0.0, 1.0, None, None, None, 0.0, 0.0, 0.0)
            made = members[side, scatter]
        else:
            made, part = _component(cells, from_scans, from_rays, key, reaches[key], blend_deg, scale)
            warnings += _doubts(part, scale)
        parts.append(part)
        models.setdefault(band, {})[side, scatter] = made
        scaled.setdefault(band, {})[side, scatter] = members[side, scatter].scaled(part.factor)
        tell(0.7 + 0.3 * (number + 1) / len(keys))
    result = _recorded(Bsdf.from_models(models), simulated, parts, name, simulation, blend_deg)
    warnings += _energy(result, cells)
    return Hybrid(result, tuple(parts), from_scans, Bsdf.from_models(scaled), tuple(dict.fromkeys(warnings)))


def _both(measured: Bsdf, simulated: Bsdf, warnings: list[str]) -> Bsdf:
    """The components of the simulation that the hybrid model needs."""
    found: dict[str, dict[tuple[Side, Scatter], Model]] = {}
    names = {name.lower(): name for name in simulated.bands}
    for band, members in measured.models.items():
        if band.lower() not in names:
            raise MissingDataError(
                f"the simulation has no band {band!r}, which was measured (it has: {', '.join(simulated.bands)}; trace"
                " that band too, or choose a channel that both have)"
            )
        own = names.pop(band.lower())
        here = dict(simulated.models[own])
        for side, scatter in members:
            if (side, scatter) in here:
                continue
            try:
                here[side, scatter], _ = simulated.model(side, scatter, own)
            except MissingDataError:
                raise MissingDataError(
                    f"the simulation has no {scatter} from the {side} in {band}, which was measured (trace that side"
                    " too, or leave those scans out)"
                ) from None
            warnings.append(f"{band}, {scatter} from the {side}: simulated from the other side, by reciprocity")
        found[band] = here
    if names:
        warnings.append(f"simulated but not measured, so left out: {', '.join(names.values())}")
    return Bsdf.from_models(found)


def _component(
    cells: Table, from_scans: Bsdf, from_rays: Bsdf, key: Key, reach: Reach, blend_deg: float, scale: Scale
) -> tuple[Model, Part]:
    band, side, scatter = key
    columns, rows = len(cells.incident_areas), len(cells.outgoing_areas)
    kept = np.empty((3, columns, rows), dtype=np.float32)
    reached = np.empty(columns)
    for k in range(columns):
        kept[0, k] = cells.column(from_scans, band, side, scatter, k)
    for k in range(columns):
        kept[1, k] = cells.column(from_rays, band, side, scatter, k)
        kept[2, k], reached[k] = cells.weights(reach, side, scatter, k, blend_deg)
    m, s, w = kept

    def light(values: NDArray[np.float32]) -> float:
        return float(cells.incident_areas @ (values @ cells.outgoing_areas))

    where = f"{band}, {scatter} from the {side}"
    if w.max() < _LEAST:
        raise ClerestoryError(
            f"{where}: no area that was measured is deep enough for a blend of {blend_deg:g}°, {reach.words} (scans"
            " along lines cover none; a narrower blend needs less)"
        )
    seam = 4.0 * w * (1.0 - w)
    along, over = (light(seam * m), light(seam * s)), (light(w * m), light(w * s))
    factors = [_ratio(*pair, where) if scale != "none" else _known_ratio(*pair) for pair in (along, over)]
    factor = {"seam": factors[0], "overlap": factors[1], "none": 1.0}[scale] or 1.0
    misplaced = light(seam * np.abs(m - np.float32(factor) * s))
    both = along[0] + factor * along[1]
    made = w * m + (1.0 - w) * np.float32(factor) * s
    total = light(made)
    pairs = float(cells.incident_areas.sum() * cells.outgoing_areas.sum())
    return cells.model(made), Part(
        band,
        side,
        scatter,
        reach.words,
        reach.limit_deg,
        float(factor),
        factors[0],
        factors[1],
        misplaced / both if both > 0.0 else None,
        float(cells.incident_areas @ reached / cells.incident_areas.sum()),
        light(w) / pairs,
        light(w * m) / total if total > 0.0 else light(w) / pairs,
    )


def _known_ratio(measured: float, simulated: float) -> float | None:
    return measured / simulated if simulated > 0.0 else None


def _ratio(measured: float, simulated: float, where: str) -> float | None:
    """Measured over simulated light; None where both are dark."""
    if simulated > 0.0 and measured > 0.0:
        return measured / simulated
    if simulated <= 0.0 < measured:
        raise ClerestoryError(f"{where}: the simulation is dark where light was measured (is it of this sample?)")
    return None


def _doubts(part: Part, scale: Scale) -> list[str]:
    found = []
    factor = part.factor if scale != "none" else part.factor_seam or 1.0
    if not PLAUSIBLE[0] <= factor <= PLAUSIBLE[1]:
        found.append(
            f"{part.where}: measured light is {factor:.3g} times the simulated, outside of {PLAUSIBLE[0]:g} to"
            f" {PLAUSIBLE[1]:g}: rather a wrong side, band, unit or sample than a wrong level"
        )
    if part.apart is not None and part.apart > _APART:
        found.append(
            f"{part.where}: along the seam {percent(part.apart)} of the light is in another place: both do not fit"
            " together (compare them, and their frames, first)"
        )
    return found


def _energy(bsdf: Bsdf, cells: Table) -> list[str]:
    """Where more light leaves than arrives."""
    found = []
    for band, members in bsdf.models.items():
        for side in SIDES:
            scatters = [c for c in SCATTERS if (side, c) in members]
            columns = range(len(cells.incident_areas))
            totals = np.zeros(len(cells.incident_areas))
            for scatter in scatters:
                totals += [cells.column(bsdf, band, side, scatter, k) @ cells.outgoing_areas for k in columns]
            if scatters and totals.max() > 1.0 + _ENERGY:
                found.append(
                    f"{band}, light from the {side}: {percent(float(totals.max()))} of it leaves at the worst, more"
                    " than arrives (calibrate the scans, or look at their reference beam)"
                )
    return found


def _recorded(bsdf: Bsdf, simulated: Bsdf, parts: list[Part], name: str, simulation: str, blend_deg: float) -> Bsdf:
    """With the simulated sample's data, and with what was measured and what was not."""
    element_type, material, geometry, _, other = simulated._core.metadata_parts()
    comments = [
        f"clerestory {__version__} measure hybrid: measured within {blend_deg:g}° of the border of what was measured,"
        f" beyond it {simulation}",
        *(part.words for part in parts),
    ]
    made = Bsdf(bsdf._core.with_metadata_parts((element_type, material, geometry, comments, other)))
    return made.with_metadata(name=name) if name else made
