"""The uncertainty of a fitted model, for light from any direction."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.bsdf import Bsdf
from clerestory.directions import angles, outgoing_side
from clerestory.measure.interpolant.fitting import distributions_of
from clerestory.measure.interpolant.residual import Residual
from clerestory.measure.prepare.step import same_light
from clerestory.measure.scan import Measurement
from clerestory.measure.uncertainty.between import LeftOut, by_chance, contrast, nearness, per_gap, pooled, shrunk
from clerestory.measure.uncertainty.budget import Budget
from clerestory.measure.uncertainty.cone import blurred, cone_of
from clerestory.measure.uncertainty.halves import split
from clerestory.measure.uncertainty.neighbours import SAME_DEG, Neighbours, spread_out
from clerestory.measure.uncertainty.patches import Patches
from clerestory.measure.uncertainty.reach import beyond_points
from clerestory.model import Model

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from numpy.typing import NDArray

    from clerestory.basis import Basis
    from clerestory.directions import Scatter, Side
    from clerestory.measure.interpolant.fitted import Component, Fit
    from clerestory.measure.scan import Scan
    from clerestory.measure.uncertainty.budget import Cause
    from clerestory.measure.uncertainty.neighbours import Between

    Floats = NDArray[np.float64]

_FEWEST = 4
"""Incident directions of which half can be left out."""
_RECTANGLE = np.sqrt(3.0)
_MEASURED_DEG2 = 1e-6
_NORMAL_DEG = 0.5


@dataclass(frozen=True)
class Settings:
    """What is known of the instrument beside the points."""

    cone_deg: float | None = None
    """Full angle of a cone that blurs as those of source and detector do together [°]; the scans' own by default."""
    level: float = 0.0
    """Relative standard uncertainty of the level of all values: of the reference beam or of a sphere."""

    def __post_init__(self) -> None:
        if self.cone_deg is not None and not 0.0 <= self.cone_deg < 90.0:
            raise ClerestoryError(f"a cone of {self.cone_deg:g}° is none (give degrees from 0 to 90)")
        if not 0.0 <= self.level < 1.0:
            raise ClerestoryError(f"a level known to {self.level:g} makes no sense (give a share, 0 to 1)")


@dataclass(frozen=True)
class _Half:
    """A model of half of the incident directions."""

    bsdf: Bsdf
    neighbours: Neighbours
    per_gap: float
    """Of `between`, for the direct-hemispherical value."""


class Uncertainty:
    """Of one component of a fit: light from one side, transmitted or reflected, in one band.

    Raises
    ------
    ClerestoryError
        The scans' points make no surface (as those along a line), or incident directions lie on one line.
    """

    def __init__(
        self,
        made: Fit,
        component: Component,
        scans: Sequence[Scan],
        settings: Settings | None = None,
        basis: Basis | None = None,
    ) -> None:
        settings = settings or Settings()
        self.component, self.settings = component, settings
        self.bsdf = Bsdf.from_models(
            {(component.side, component.scatter): made.bsdf.models[component.band][component.side, component.scatter]}
        )
        self.cone_deg = cone_of(scans) if settings.cone_deg is None else settings.cone_deg
        self.patches = Patches.of(outgoing_side(component.side, component.scatter), basis)
        self._groups = same_light(scans)
        self._places = np.array([group[0].incident[:2] for group in self._groups])
        self._neighbours = Neighbours(self._places, component.symmetry)
        named = [[_as_band(scan, component.band) for scan in group] for group in self._groups]
        mirrored = component.symmetry == "isotropic"
        self._residuals = [Residual.of(group, self.bsdf, "visible", mirrored=mirrored) for group in named]
        self._errors: dict[tuple[int, bytes], tuple[Floats, Floats]] = {}
        self._fluxes: dict[bytes, tuple[Floats, Floats]] = {}
        self._near = nearness(self.patches.basis, outgoing_side(component.side, component.scatter))
        self._half = self._half_model(made.method)
        self._split = split(self._groups, component.band, component.symmetry)
        self._split_total = self._split_error()

    def at(self, incident: Floats) -> Budget:
        """The budget of light from one direction (3,) on the component's side."""
        incident = np.asarray(incident, dtype=np.float64)
        around = self._neighbours.around(incident[:2])
        values, fluxes = self._of(self.bsdf, incident)
        total = float(self.bsdf.integrate(incident[None], self.component.scatter)[0])
        of_total: dict[Cause, float] = {}
        of_fluxes: dict[Cause, Floats] = {}
        self._points(around, of_total, of_fluxes)
        if self.cone_deg > 0.0:
            seen, lost = blurred(self.bsdf, incident, self.patches, self.cone_deg, values)
            of_total["cone"], of_fluxes["cone"] = lost, np.abs(seen - fluxes)
        self._coverage(incident, around, values, fluxes, total, of_total, of_fluxes)
        self._between(incident, around, fluxes, total, of_total, of_fluxes)
        if self.settings.level > 0.0:
            of_total["level"] = self.settings.level * total
            of_fluxes["level"] = self.settings.level * fluxes
        theta, phi = angles(incident)
        measured = around.spread_deg2 < _MEASURED_DEG2
        return Budget(float(theta), float(phi), measured, around.beyond, total, fluxes, of_total, of_fluxes)

    def measured_plane(self) -> tuple[Floats, float]:
        """Polar angles [°], and the azimuth [°] at which most of them were measured."""
        theta, phi = angles(np.array([group[0].incident for group in self._groups]))
        oblique = theta > _NORMAL_DEG
        azimuths, counts = np.unique(np.round(phi[oblique], 1), return_counts=True)
        azimuth = float(azimuths[np.argmax(counts)]) if len(azimuths) else 0.0
        here = ~oblique | (np.abs((phi - azimuth + 180.0) % 360.0 - 180.0) < 0.1)
        return np.unique(np.round(theta[here], 6)), azimuth

    def _points(self, around: Between, of_total: dict[Cause, float], of_fluxes: dict[Cause, Floats]) -> None:
        noise, lobes = np.zeros(len(self.patches)), np.zeros(len(self.patches))
        total_noise = total_lobes = 0.0
        for k, (n, image, share) in enumerate(zip(around.scans, around.images, around.shares, strict=True)):
            vertex = self._vertex(around, k)
            own = self._residuals[n].total
            held = float(self.bsdf.integrate(vertex[None], self.component.scatter)[0])
            total_noise += share**2 * float(own.noise[0])
            total_lobes += share * float(own.lobes((self._split_total * held) ** 2)[0])
            key = (int(n), np.round(image, 6).tobytes())
            if key not in self._errors:
                own = self._residuals[n].over(self.patches, image)
                self._errors[key] = own.noise, own.lobes(self._split_patches(vertex))
            noise += share**2 * self._errors[key][0]
            lobes += share * self._errors[key][1]
        of_total["noise"], of_fluxes["noise"] = float(np.sqrt(total_noise)), np.sqrt(noise)
        of_total["lobes"], of_fluxes["lobes"] = float(np.sqrt(total_lobes)), np.sqrt(lobes)

    def _split_error(self) -> float:
        """Relative standard uncertainty of a direct-hemispherical value by the places of the points.

        Told twice: by models of half of the points, and by triangles through all of them. Halves overrate it where
        they alone are too few to see what is narrow; triangles do where they cut off the top of a peak, which lobes
        do not. So the smaller of both holds. Of few directions each is a variable of Student's t, whose variance is
        n / (n − 2) times the mean square (JCGM 101:2008, 6.4.9).
        """
        if not self._split:
            return 0.0
        first = np.array([group[0].incident for group in self._groups])
        held = np.maximum(self.bsdf.integrate(first, self.component.scatter), 1e-12)
        halves = np.array([b.integrate(first, self.component.scatter) / held - 1.0 for b in self._split])
        triangles = np.array([one.by_triangles for one in self._residuals]) / held - 1.0
        each = np.abs(halves).min(axis=0), triangles
        return float(min(np.sqrt(np.sum(off**2) / max(len(first) - 2, 1)) for off in each))

    def _split_patches(self, vertex: Floats) -> Floats:
        """Variance of the fluxes into patches (patches,) by the places of the points, in a measured direction."""
        if not self._split:
            return np.zeros(len(self.patches))
        fluxes = self._of(self.bsdf, vertex)[1]
        off = np.min([np.abs(self._of(b, vertex)[1] - fluxes) for b in self._split], axis=0)
        return pooled(off, fluxes, self._near) ** 2

    def _coverage(
        self,
        incident: Floats,
        around: Between,
        values: Floats,
        fluxes: Floats,
        total: float,
        of_total: dict[Cause, float],
        of_fluxes: dict[Cause, Floats],
    ) -> None:
        nearest = self._vertex(around, int(np.argmax(around.shares)))
        flat = self.patches.directions.reshape(-1, 3)
        model = self.bsdf.models["visible"][self.component.side, self.component.scatter]
        # Asked at a measured direction: light from beyond all of them is told apart below.
        beyond = model.extrapolated(np.broadcast_to(nearest, flat.shape), flat).reshape(values.shape)
        limit = self.component.outgoing_limit_deg
        by_patch, sum_ = beyond_points(self.bsdf, incident, self.patches, values, beyond, limit)
        if around.beyond:
            # The last distribution could as well stay.
            last = float(self.bsdf.integrate(nearest[None], self.component.scatter)[0])
            sum_ = float(np.hypot(sum_, (total - last) / _RECTANGLE))
            by_patch = np.hypot(by_patch, (fluxes - self._of(self.bsdf, nearest)[1]) / _RECTANGLE)
        of_total["coverage"], of_fluxes["coverage"] = sum_, by_patch

    def _between(
        self,
        incident: Floats,
        around: Between,
        fluxes: Floats,
        total: float,
        of_total: dict[Cause, float],
        of_fluxes: dict[Cause, Floats],
    ) -> None:
        if around.beyond or around.spread_deg2 < _MEASURED_DEG2:
            return
        if self._half is None:
            # Nothing could be left out: the neighbours themselves are the limits.
            each = [self._vertex(around, k) for k in range(len(around.shares))]
            ends = [float(self.bsdf.integrate(one[None], self.component.scatter)[0]) for one in each]
            of_total["interpolation"] = float(np.ptp(ends)) / (2.0 * _RECTANGLE)
            of_fluxes["interpolation"] = contrast([self._of(self.bsdf, one)[1] for one in each], around)
            return
        wide = self._half.neighbours.around(incident[:2])
        less = shrunk(around, wide)
        other = float(self._half.bsdf.integrate(incident[None], self.component.scatter)[0])
        of_total["interpolation"] = max(self._half.per_gap * total * around.spread_deg2, less * abs(other - total))
        common = of_total["interpolation"] / total * fluxes if total > 0.0 else 0.0
        off = self._of(self._half.bsdf, incident)[1] - fluxes
        of_fluxes["interpolation"] = np.hypot(common, by_chance(around, wide) * pooled(off, fluxes, self._near))

    def _half_model(self, method: str) -> _Half | None:
        """The model of half of the incident directions, and how well it foretells the others."""
        count, symmetry = len(self._groups), self.component.symmetry
        if count < _FEWEST:
            return None
        kept = spread_out(self._places, symmetry)
        try:
            neighbours = Neighbours(self._places[kept], symmetry)
        except ClerestoryError:
            return None  # half of them lie on one line
        key = (self.component.side, self.component.scatter)
        groups = [self._groups[n] for n in kept]
        distributions = distributions_of(groups, self.component.band, symmetry)
        half = Bsdf.from_models({key: Model(distributions.model(symmetry, method, None))})
        found = []
        for n in sorted(set(range(count)) - set(kept.tolist())):
            around = neighbours.around(self._places[n])
            if not around.beyond and around.spread_deg2 > SAME_DEG**2:
                toward = self._groups[n][0].incident[None]
                foretold, known = (float(b.integrate(toward, self.component.scatter)[0]) for b in (half, self.bsdf))
                found.append(LeftOut(foretold, known, around.spread_deg2))
        error = per_gap(found)
        return None if error is None else _Half(half, neighbours, error)

    def _vertex(self, around: Between, k: int) -> Floats:
        """The direction of a neighbour, as an image under the symmetry."""
        incident = self._groups[around.scans[k]][0].incident.copy()
        incident[:2] = around.images[k] @ incident[:2]
        return np.asarray(incident)

    def _of(self, bsdf: Bsdf, incident: Floats) -> tuple[Floats, Floats]:
        """BSDF along the patches' directions and fluxes into the patches."""
        if bsdf is not self.bsdf:
            values = self.patches.values(bsdf, incident)
            return values, self.patches.fluxes(values)
        key = np.round(incident, 9).tobytes()
        if key not in self._fluxes:
            values = self.patches.values(bsdf, incident)
            self._fluxes[key] = values, self.patches.fluxes(values)
        return self._fluxes[key]


def _as_band(scan: Scan, band: str) -> Scan:
    """One channel of a scan, under the name of the only band of a data set."""
    from dataclasses import replace

    column = scan.channels.index(band)
    errors = scan.standard_errors
    return replace(
        scan,
        values=scan.values[:, column : column + 1],
        channels=("visible",),
        standard_errors=None if errors is None else errors[:, column : column + 1],
    )


def uncertainties(
    measurement: Measurement | Iterable[Scan],
    made: Fit,
    settings: Settings | None = None,
    *,
    basis: Basis | None = None,
    progress: Callable[[float], object] | None = None,
) -> dict[tuple[str, Side, Scatter], Uncertainty]:
    """The uncertainty of every component of a fit, by band, side and scatter.

    Parameters
    ----------
    measurement
        What the model was made of.
    basis
        Whose outgoing patches fluxes are told of; Klems' full basis by default.
    progress
        Called with the share that is done, 0 to 1.
    """
    scans = [scan.as_bsdf() for scan in (measurement.of() if isinstance(measurement, Measurement) else measurement)]
    found = {}
    for k, component in enumerate(made.components):
        here = [
            scan
            for scan in scans
            if (scan.incident_side, scan.scatter) == (component.side, component.scatter)
            and component.band in scan.channels
        ]
        found[component.band, component.side, component.scatter] = Uncertainty(made, component, here, settings, basis)
        if progress is not None:
            progress((k + 1) / len(made.components))
    return found
