"""Data sets scaled to what an integrating sphere measured.

After step 5 of Bartenbach's way and BBRI's (IEA SHC Task 61 report C.2.2, 2021, sections 2.6 and 2.7): the shape comes
from the goniophotometer or the simulation, the level from the sphere.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from clerestory._core import ClerestoryError, UnsupportedError
from clerestory.basis import Basis
from clerestory.directions import SCATTERS, SIDES, angles, direction
from clerestory.integrals import direct_hemispherical
from clerestory.measure.calibrate.agreement import Agreement, of_model
from clerestory.measure.calibrate.errors import with_sphere_errors
from clerestory.measure.calibrate.factors import Factors
from clerestory.measure.calibrate.known import Known, known_values
from clerestory.measure.calibrate.reversible import reversible
from clerestory.measure.calibrate.split import beam_and_rest
from clerestory.model import Model
from clerestory.words import patch_name, percent

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from clerestory.bsdf import Bsdf, Part
    from clerestory.directions import Scatter, Side
    from clerestory.measure.sphere import SphereValues

    Floats = NDArray[np.float64]

Scaling = Literal["all", "scattered", "peak", "both"]
"""All light by one factor; the scattered part or the peak alone, so that the total fits; or each to its own measured
value."""
SCALINGS: tuple[Scaling, ...] = ("all", "scattered", "peak", "both")
ENERGY = 1e-6
_ROUNDS = 4
_SETTLED = 1e-3


@dataclass(frozen=True)
class Factor:
    """What was done to one component."""

    band: str
    side: Side
    scatter: Scatter
    part: str
    """all, scattered or peak."""
    at: Factors
    """Where the sphere measured, and the factor there."""


@dataclass(frozen=True)
class Calibration:
    """A calibrated data set, its factors, and how it agreed with the sphere before and agrees now."""

    bsdf: Bsdf
    factors: tuple[Factor, ...]
    before: Agreement
    after: Agreement
    warnings: tuple[str, ...]


def calibrated(
    bsdf: Bsdf,
    values: Iterable[SphereValues],
    *,
    scaling: Scaling = "all",
    reciprocal: bool = False,
    standard: str = "en410",
) -> Calibration:
    """A data set whose direct-hemispherical values are those of a sphere.

    At every measured angle the integral becomes the measured value; between them the factor is interpolated (linear in
    θ and φ, constant beyond the last). Models of patches have one value a patch, so a patch that holds several measured
    angles gets their mean.

    Parameters
    ----------
    bsdf
        Klems matrices, tensor trees, beams and sums of these.
    values
        Spectra or values of bands. Components without any stay as they are.
    scaling
        What is scaled. `both` needs two of hemispherical, diffuse and direct.
    reciprocal
        Keep reversed paths equal: a factor for each incident and each outgoing patch, both sides' transmission from one
        table. For matrices, with `all`.

    Raises
    ------
    ClerestoryError
        Nothing was measured of this data set, a value makes no sense, or a patch has no light to scale.
    UnsupportedError
        A model cannot be scaled so; the text says what to convert it to.
    """
    if scaling not in SCALINGS:
        raise ClerestoryError(f"scaling {scaling!r} is not known (give {', '.join(SCALINGS)})")
    if reciprocal and scaling != "all":
        raise UnsupportedError("reversed paths are kept equal where all light is scaled (leave the scaling at all)")
    _refuse_interpolants(bsdf)
    given = list(values)
    before = of_model(bsdf, given, standard=standard)
    known, _ = known_values(given, bsdf.bands, standard=standard)
    wrong = next((k for k in known if k.hemispherical is not None and not 0.0 <= k.hemispherical <= 1.0), None)
    if wrong is not None:
        raise ClerestoryError(f"{wrong.where}: {wrong.hemispherical:g} is not a share of light (give 0 to 1)")
    factors: list[Factor] = []
    warnings: list[str] = list(before.warnings)
    targets: dict[tuple[str, Side, Scatter], Floats] = {}
    spheres: dict[tuple[str, Side, Scatter], list[Known]] = {}
    result = bsdf
    for band in bsdf.bands:
        for scatter in SCATTERS:
            for side in SIDES:
                here = [k for k in known if (k.band, k.side, k.scatter) == (band, side, scatter)]
                here = [k for k in here if k.hemispherical is not None]
                if not here or (side, scatter) not in bsdf.models[band]:
                    continue
                work = _Component(bsdf, band, side, scatter)
                wanted, found = work.targets(here, warnings)
                targets[band, side, scatter] = wanted
                spheres[band, side, scatter] = here
                if scaling == "both":
                    result, parts = work.both(result, here)
                    factors += parts
                elif not reciprocal:
                    result, used = work.scaled(result, wanted, scaling, found, here)
                    factors.append(used)
                else:
                    factors.append(Factor(band, side, scatter, "all", found))
    if not targets:
        raise ClerestoryError(
            "no value of the sphere belongs to a component that the data set holds itself (a missing transmission side"
            " is answered by the other's: give its values)"
        )
    if reciprocal:
        result = reversible(result, targets, warnings)
    for (band, side, scatter), here in spheres.items():
        model = with_sphere_errors(result.models[band][side, scatter], here)
        result = result.with_models({band: {(side, scatter): model}})
    for factor in factors:
        warnings.append(
            factor.at.implausible(f"{factor.band}, {factor.scatter} from the {factor.side}, {factor.part} light") or ""
        )
    warnings += _energy(result)
    after = of_model(result, given, standard=standard)
    return Calibration(result, tuple(factors), before, after, tuple(dict.fromkeys(filter(None, warnings))))


def _refuse_interpolants(bsdf: Bsdf) -> None:
    """Before the minutes that integrating one takes."""
    if any(model.kind == "interpolant" for members in bsdf.models.values() for model in members.values()):
        raise UnsupportedError(
            "an interpolant has no patches whose light could be scaled (convert it to klems-full or tensor4 first, or"
            " calibrate its scans and fit them)"
        )


class _Component:
    """One component of a data set with the patches that its values belong to."""

    def __init__(self, bsdf: Bsdf, band: str, side: Side, scatter: Scatter) -> None:
        self.bsdf, self.band, self.side, self.scatter = bsdf, band, side, scatter
        self.model = bsdf.models[band][side, scatter]
        matrix = self.model.kind == "matrix"
        self.basis = self.model.incident_basis if matrix else Basis.named("klems-full")
        self.theta_deg, self.phi_deg = angles(self.basis.incident_centres(side))

    @property
    def where(self) -> str:
        return f"{self.band}, {self.scatter} from the {self.side}"

    def totals(self, part: Part = "all") -> Floats:
        """Direct-hemispherical value of each patch, of all light or a part of it."""
        if self.model.kind == "matrix":
            toward = self.basis.incident_centres(self.side)[:, None]
        else:
            u = (np.stack(np.meshgrid(np.arange(4), np.arange(4)), axis=-1).reshape(-1, 2) + 0.5) / 4.0
            toward = np.stack([self.basis.sample_incident(k, u, self.side) for k in range(len(self.basis))])
        return np.asarray(self.bsdf.integrate(toward, self.scatter, band=self.band, part=part).mean(axis=1))

    def patch(self, one: Known) -> int:
        return int(self.basis.index_of_incident(direction(one.theta_deg, one.phi_deg, side=self.side)))

    def targets(self, here: Sequence[Known], warnings: list[str]) -> tuple[Floats, Factors]:
        """The value that each patch should have, and the factors where the sphere measured."""
        totals = self.totals()
        patches = [self.patch(one) for one in here]
        measured = measured_of(here)
        found = Factors.of(
            [one.theta_deg for one in here],
            [one.phi_deg for one in here],
            _ratios(measured, totals[patches], [one.where for one in here]),
        )
        factors = self._at_patches(found, patches, warnings)
        return factors * totals, found

    def _at_patches(self, found: Factors, patches: Sequence[int], warnings: list[str]) -> Floats:
        """Factors of all patches: the measured one where an angle was measured, else interpolated at their centres.

        With one azimuth measured, the whole ring of that angle has its factor.
        """
        factors = found.at(self.theta_deg, self.phi_deg)
        oblique = found.theta_deg >= 0.5
        rings = len(np.unique(np.round(found.phi_deg[oblique], 3))) <= 1
        limits = self.basis.limits_deg
        held: dict[int, list[float]] = {}
        for patch, value in zip(patches, found.values, strict=True):
            members = np.flatnonzero(np.isclose(limits[:, 0], limits[patch, 0])) if rings else [patch]
            for member in members:
                held.setdefault(int(member), []).append(float(value))
        apart = 0.0
        for patch, several in held.items():
            factors[patch] = float(np.mean(several))
            apart = max(apart, float(np.ptp(several)) / max(factors[patch], 1e-12))
        if apart > 0.01:
            warnings.append(
                f"{self.where}: measured angles that share a patch ask for factors that differ by {percent(apart)}; the"
                " mean is used (a finer model could follow both)"
            )
        return factors

    def scaled(
        self, result: Bsdf, wanted: Floats, scaling: Scaling, found: Factors, here: Sequence[Known]
    ) -> tuple[Bsdf, Factor]:
        """The data set with one part of this component scaled so that the totals are those wanted."""
        if self.model.kind == "matrix" and scaling != "all":
            beam, rest = beam_and_rest(self.model)
            under = self.basis.projected_solid_angles @ rest
            kept, changed = (beam, under) if scaling == "scattered" else (under, beam)
            ratio = _part_ratio(wanted - kept, changed, self.where)
            parts = (beam, rest * ratio) if scaling == "scattered" else (beam * ratio, rest)
            model = self._matrix(*parts)
            models = {self.band: {(self.side, self.scatter): model}}
            shown = Factors.of(self.theta_deg[changed > 0.0], self.phi_deg[changed > 0.0], ratio[changed > 0.0])
            return result.with_models(models), Factor(self.band, self.side, self.scatter, scaling, shown)
        core_part: Part = "all" if scaling == "all" else "direct" if scaling == "peak" else "scattered"
        done = self._normalised(result, wanted, core_part)
        # A patch of another model than a matrix has values of its own within it: a few rounds settle the measured ones.
        for _ in range(_ROUNDS if self.model.kind != "matrix" else 0):
            now = self.at(done, here)
            ratios = np.divide(measured_of(here), now, out=np.ones_like(now), where=now > 0.0)
            if np.max(np.abs(ratios - 1.0)) < _SETTLED:
                break
            nudge = Factors.of([one.theta_deg for one in here], [one.phi_deg for one in here], list(ratios))
            wanted = wanted * self._at_patches(nudge, [self.patch(one) for one in here], [])
            done = self._normalised(result, wanted, core_part)
        return done, Factor(self.band, self.side, self.scatter, scaling, found)

    def at(self, bsdf: Bsdf, here: Sequence[Known]) -> Floats:
        """Direct-hemispherical values in the measured directions."""
        toward = np.stack([direction(one.theta_deg, one.phi_deg, side=self.side) for one in here])
        return bsdf.integrate(toward, self.scatter, band=self.band)

    def _normalised(self, bsdf: Bsdf, wanted: Floats, part: Part) -> Bsdf:
        return bsdf.normalised(wanted, self.side, self.scatter, basis=self.basis, band=self.band, part=part)

    def both(self, result: Bsdf, here: Sequence[Known]) -> tuple[Bsdf, list[Factor]]:
        """Peak and scattered light each to its own measured value."""
        lacking = next((one for one in here if one.direct is None or one.diffuse is None), None)
        if lacking is not None:
            raise ClerestoryError(
                f"{lacking.where}: two of hemispherical, diffuse and direct are needed to scale peak and rest apart"
            )
        matrix = self.model.kind == "matrix"
        if matrix:
            beam, rest = beam_and_rest(self.model)
            under = np.asarray(self.basis.projected_solid_angles @ rest)
        else:
            beam, under = self.totals("direct"), self.totals("scattered")
        patches = [self.patch(one) for one in here]
        found = []
        for held, which in ((beam, "direct"), (under, "diffuse")):
            measured = np.array([getattr(one, which) for one in here], dtype=np.float64)
            ratios = _ratios(measured, held[patches], [f"{one.where}, {which} light" for one in here])
            found.append(Factors.of([o.theta_deg for o in here], [o.phi_deg for o in here], ratios))
        ignored: list[str] = []
        to_beam, to_rest = (self._at_patches(f, patches, ignored) for f in found)
        parts = [
            Factor(self.band, self.side, self.scatter, name, f)
            for name, f in zip(("peak", "scattered"), found, strict=True)
        ]
        if matrix:
            model = self._matrix(beam * to_beam, rest * to_rest)
            return result.with_models({self.band: {(self.side, self.scatter): model}}), parts
        done = self._normalised(result, beam * to_beam + under, "direct")
        return self._normalised(done, beam * to_beam + under * to_rest, "scattered"), parts

    def _matrix(self, beam: Floats, rest: Floats) -> Model:
        made = rest + np.diag(beam / self.basis.projected_solid_angles)
        held, errors = self.model.values, self.model.standard_errors
        if errors is not None:
            errors = errors * np.divide(made, held, out=np.ones_like(made), where=held > 0.0)
        return Model.matrix(made, self.basis, standard_errors=errors)


def measured_of(here: Sequence[Known]) -> Floats:
    """Hemispherical values (n,)."""
    return np.array([one.hemispherical for one in here], dtype=np.float64)


def _ratios(measured: Floats, modelled: Floats, where: Sequence[str]) -> Floats:
    """Measured over modelled; 1 where both are dark."""
    dark = modelled <= 0.0
    lit = np.flatnonzero(dark & (measured > 0.0))
    if len(lit):
        raise ClerestoryError(
            f"{where[int(lit[0])]}: {percent(float(measured[lit[0]]))} was measured where the model has no light"
        )
    return np.divide(measured, modelled, out=np.ones_like(measured), where=~dark)


def _part_ratio(wanted: Floats, held: Floats, where: str) -> Floats:
    short = np.flatnonzero(wanted < -1e-9)
    if len(short):
        raise ClerestoryError(
            f"{where}: the part that is kept has more light than was measured in patch {int(short[0]) + 1} (scale all)"
        )
    dark = np.flatnonzero((held <= 0.0) & (wanted > 1e-9))
    if len(dark):
        raise ClerestoryError(f"{where}: patch {int(dark[0]) + 1} has no such light that could be scaled (scale all)")
    return np.divide(np.maximum(wanted, 0.0), held, out=np.ones_like(held), where=held > 0.0)


def _energy(bsdf: Bsdf) -> list[str]:
    """Where more light leaves than arrives after calibration."""
    found = []
    for band in bsdf.bands:
        for side in SIDES:
            if any((side, scatter) not in bsdf.models[band] for scatter in SCATTERS):
                continue
            totals = [direct_hemispherical(bsdf, s, side=side, band=band) for s in SCATTERS]
            if len(totals[0].values) != len(totals[1].values):
                continue
            both = totals[0].values + totals[1].values
            worst = int(np.argmax(both))
            if both[worst] > 1.0 + ENERGY:
                name = patch_name(totals[0].basis, worst)
                found.append(f"{band}, light from the {side}: {percent(float(both[worst]))} leaves for {name}")
    return found
