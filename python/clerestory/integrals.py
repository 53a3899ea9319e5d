"""Integrated quantities: the figures by which data sets are compared.

Every figure says in words how it was made, since a direct-direct transmittance without its cone, or a hemispherical one
without its sky, is not a number that one can compare.

Definitions after IEA SHC Task 61 report C.2.2 (2021), doi:10.18777/ieashc-task61-2021-0012, and Klems (1994).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.basis import Basis
from clerestory.bsdf import Region
from clerestory.counts import counted
from clerestory.directions import direction, incident_in_words

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from clerestory.bsdf import Bsdf
    from clerestory.directions import Scatter, Side

Sky = Literal["uniform", "overcast"]

# The Klems full patches of a source straight above at 0, 30, 50 and 70° to the normal, by which the field reports.
PROBES_DEG = (0.0, 30.0, 50.0, 70.0)
_STRAIGHT = 1e-6
"""Largest difference of a beam's direction from straight on."""


@dataclass(frozen=True)
class Integral:
    """A figure and how it was made."""

    value: float
    """Transmittance or reflectance, 0 to 1."""
    standard_error: float | None
    """One standard deviation, where the data have one."""
    words: str
    """Method, resolution and treatment."""


@dataclass(frozen=True)
class PatchIntegrals:
    """A figure for each incident patch of a basis."""

    basis: Basis
    """The incident patches."""
    values: NDArray[np.float64]
    """Transmittance or reflectance (n,)."""
    standard_errors: NDArray[np.float64] | None
    """One standard deviation (n,), where the data have one."""
    words: str
    """Method, resolution and treatment."""


@dataclass(frozen=True)
class CutOff:
    """The angle at which direct light ends, with the curve and the threshold that it was read from."""

    angle_deg: float | None
    """Smallest angle of incidence [°] at which direct transmission is at or below the threshold; None if none is."""
    threshold: float
    """Direct transmittance below which light counts as cut off."""
    theta_deg: NDArray[np.float64]
    """Angles of incidence [°] (n,)."""
    values: NDArray[np.float64]
    """Direct transmittance (n,)."""
    words: str
    """Plane, threshold, treatment."""


def continued(incident: ArrayLike, scatter: Scatter) -> NDArray[np.float64]:
    """Directions (..., 3) that light leaves to when it goes straight through or is mirrored.

    Parameters
    ----------
    incident
        Directions (..., 3) toward sources.
    scatter
        Transmission or reflection.
    """
    d = np.asarray(incident, dtype=np.float64)
    return d * (np.array([-1.0, -1.0, 1.0]) if scatter == "reflection" else -1.0)


def straight_through(bsdf: Bsdf, incident: NDArray[np.float64], band: str | None = None) -> NDArray[np.float64]:
    """Transmittance (n) of the beams that go straight on, of incident directions (n, 3) from outside."""
    found = np.zeros(len(incident))
    for row, outgoing, value, _ in bsdf._core.peaks(np.ascontiguousarray(incident), band, "transmission"):
        if np.linalg.norm(np.asarray(outgoing) + incident[row]) < _STRAIGHT:
            found[row] += value
    return found


def own_basis(bsdf: Bsdf, scatter: Scatter, side: Side = "exterior", band: str | None = None) -> Basis | None:
    """The incident patches that a component is tabulated in; None for other models than matrices."""
    model, _ = bsdf.model(side, scatter, band)
    return model.incident_basis if model.kind == "matrix" else None


def patch_directions(
    bsdf: Bsdf,
    patch: int,
    scatter: Scatter = "transmission",
    *,
    side: Side = "exterior",
    band: str | None = None,
    samples: int = 16,
) -> NDArray[np.float64]:
    """Incident directions (n, 3) whose mean stands for a patch of Klems' full basis.

    Parameters
    ----------
    patch
        From 1.
    samples
        Number of directions, a square number; a matrix on Klems full has the one of its own patch.
    """
    klems = Basis.named("klems-full")
    if own_basis(bsdf, scatter, side, band) == klems:
        return klems.incident_centres(side)[patch - 1 : patch]
    return klems.sample_incident(patch - 1, _grid(max(1, round(samples**0.5))), side)


def direct_hemispherical(
    bsdf: Bsdf,
    scatter: Scatter = "transmission",
    *,
    side: Side = "exterior",
    band: str | None = None,
    basis: Basis | None = None,
    samples: int = 16,
) -> PatchIntegrals:
    """Direct-hemispherical transmittance or reflectance of every incident patch.

    Parameters
    ----------
    basis
        Incident patches; the data's own by default, or Klems full where they have none.
    samples
        Directions a patch over which other data than a matrix on `basis` are averaged; a square number.

    Notes
    -----
    X_dh(i) = Σ_o Λ_o M_oi on a matrix; for other data the integral over the outgoing hemisphere, averaged over
    directions of patch i that are spread evenly in projected solid angle.
    """
    points = _Points.of(bsdf, scatter, side, band, basis, samples)
    values, errors = points.means(*bsdf.integrate_with_error(points.directions, scatter, band=band))
    return PatchIntegrals(points.basis, values, errors, f"direct-hemispherical, {points.words}")


def hemispherical(
    bsdf: Bsdf,
    scatter: Scatter = "transmission",
    *,
    side: Side = "exterior",
    band: str | None = None,
    sky: Sky = "uniform",
    ground_reflectance: float = 0.2,
    basis: Basis | None = None,
    samples: int = 16,
) -> Integral:
    """Hemispherical-hemispherical transmittance or reflectance.

    Parameters
    ----------
    sky
        `uniform`: equal radiance from the whole hemisphere, T_hh of the field. `overcast`: a vertical façade under the
        CIE overcast sky (upper half), with a ground that reflects its light evenly (lower half).
    ground_reflectance
        Of the ground before the façade, for `overcast`.
    basis, samples
        As for `direct_hemispherical`.

    Notes
    -----
    Σ_i Λ_i L_i X_dh(i) / Σ_i Λ_i L_i with the radiance L_i of `sky_radiance`, which is averaged over 256 directions a
    patch, so that patches across the horizon are split.
    """
    points = _Points.of(bsdf, scatter, side, band, basis, samples)
    values, errors = bsdf.integrate_with_error(points.directions, scatter, band=band)
    weights = points.weights(sky, ground_reflectance)
    weights /= weights.sum()
    # Directions of one patch of a matrix are one value; elsewhere too, errors of one patch are taken as one.
    per_patch = np.sqrt(np.sum((weights * errors).reshape(len(points.basis), -1).sum(axis=1) ** 2))
    light = (
        "uniform radiance"
        if sky == "uniform"
        else f"CIE overcast sky before a vertical façade, ground reflectance {ground_reflectance:g}"
    )
    return Integral(
        float(weights @ values),
        float(per_patch) if np.isfinite(per_patch) else None,
        f"hemispherical-hemispherical, {light}, {points.words}",
    )


def sky_radiance(incident: ArrayLike, sky: Sky, ground_reflectance: float = 0.2) -> NDArray[np.float64]:
    """Radiance from directions, in units of the zenith's.

    Parameters
    ----------
    incident
        Directions (..., 3) toward sky and ground, before a vertical façade.
    sky
        `uniform`, or `overcast`: (1 + 2 sin γ)/3 at elevation γ (CIE traditional overcast sky), and below the horizon
        the ground in the sky's full horizontal illuminance, 7π/9 of the zenith's radiance.
    ground_reflectance
        Of the ground, for `overcast`.
    """
    if sky not in get_args(Sky):
        raise ClerestoryError(f"sky {sky!r} is not known (give uniform or overcast)")
    height = np.asarray(incident, dtype=np.float64)[..., 1]
    if sky == "uniform":
        return np.ones_like(height)
    return np.where(height >= 0.0, (1.0 + 2.0 * height) / 3.0, ground_reflectance * 7.0 / 9.0)


def direct_direct(
    bsdf: Bsdf,
    incident: ArrayLike,
    scatter: Scatter = "transmission",
    *,
    band: str | None = None,
    cone_deg: float | None = None,
) -> Integral:
    """Direct-direct transmittance or reflectance for one incident direction (3,).

    Parameters
    ----------
    cone_deg
        Half angle [°] of a cone about the continued direction. By default the light into the outgoing patch that
        continues the incident direction is taken, of the data's own basis or, for other data than a matrix, of Klems
        full.

    Notes
    -----
    On a matrix X_dd(i) = Λ_i M_ii, as the Task 61 report tabulates it; it contains the scattered light that falls into
    that patch.
    """
    d = np.asarray(incident, dtype=np.float64)
    if d.shape != (3,):
        raise ClerestoryError(f"one incident direction is asked for, not an array of shape {d.shape} (give x, y, z)")
    side: Side = "exterior" if d[2] < 0.0 else "interior"
    outgoing = continued(d, scatter)
    if cone_deg is not None:
        region, words = Region.cone(outgoing, cone_deg), f"within {cone_deg:g}° of the continued direction"
    else:
        model, _ = bsdf.model(side, scatter, band)
        basis = model.outgoing_basis if model.kind == "matrix" else Basis.named("klems-full")
        patch = int(basis.index_of_outgoing(outgoing))
        region = Region.patches(basis, [patch])
        words = f"into the outgoing patch that continues the direction, {basis.name} {patch + 1}"
    value, error = bsdf.integrate_with_error(d, scatter, region, band)
    return Integral(float(value), float(error) if np.isfinite(error) else None, f"direct-direct, {words}")


def cut_off(
    bsdf: Bsdf,
    azimuth_deg: float = 90.0,
    *,
    side: Side = "exterior",
    band: str | None = None,
    threshold: float | None = None,
    cone_deg: float | None = None,
    step_deg: float = 1.0,
) -> CutOff:
    """Cut-off angle in the plane of incidence of one azimuth.

    Parameters
    ----------
    azimuth_deg
        Azimuth of the source [°]; 90 is a sun above.
    threshold
        Direct transmittance at or below which light counts as cut off; 1 % of that at 0° by default. Give the
        instrument's floor where that is larger.
    cone_deg
        Half angle [°] of the cone that counts as direct; the continuing patch by default, see `direct_direct`.
    step_deg
        Step of the angle of incidence [°].

    Notes
    -----
    The first angle from the normal at which direct transmission falls to the threshold (EN 14500 measures the curve;
    its own threshold is not public, so curve and threshold are part of the result). The resolution is that of the data:
    on a Klems matrix the angle is the limit of a ring of patches, and scattered light can hide the cut-off.
    """
    if not 0.01 <= step_deg <= 90.0:
        raise ClerestoryError(f"a step of {step_deg:g}° is not possible (give 0.01 to 90)")
    theta = np.arange(0.0, 90.0, step_deg)
    incident = direction(theta, azimuth_deg, side=side)
    figures = [direct_direct(bsdf, d, band=band, cone_deg=cone_deg) for d in incident]
    values = np.array([figure.value for figure in figures])
    limit = 0.01 * float(values[0]) if threshold is None else threshold
    below = np.flatnonzero(values <= limit)
    angle = float(theta[below[0]]) if below.size else None
    source = incident_in_words(direction(45.0, azimuth_deg, side=side)).split(",")[0]
    treatment = (
        f"within {cone_deg:g}° of the continued direction"
        if cone_deg is not None
        else "into the patch that continues the direction"
    )
    resolution = float(np.max(bsdf.resolution_deg(incident, "transmission", band)))
    words = (
        f"direct transmittance {treatment} at or below {limit:.3g}"
        f"{' (1 % of that at 0°)' if threshold is None else ''}, light {source} in steps of {step_deg:g}°"
        + (f", data resolve {resolution:.3g}°" if resolution > 0.0 else "")
    )
    return CutOff(angle, limit, theta, values, words)


@dataclass(frozen=True)
class _Points:
    """Incident directions, the same number in each patch, spread evenly in projected solid angle."""

    basis: Basis
    directions: NDArray[np.float64]
    per_patch: int
    side: Side
    words: str

    @classmethod
    def of(
        cls, bsdf: Bsdf, scatter: Scatter, side: Side, band: str | None, basis: Basis | None, samples: int
    ) -> _Points:
        own = own_basis(bsdf, scatter, side, band)
        chosen = basis or own or Basis.named("klems-full")
        where = f"the {counted(len(chosen), 'patch', 'patches')} of {chosen.name}"
        if own is not None and chosen == own:
            return cls(chosen, chosen.incident_centres(side), 1, side, f"{where}, the data's own")
        root = max(1, round(samples**0.5))
        directions = np.concatenate([chosen.sample_incident(k, _grid(root), side) for k in range(len(chosen))])
        return cls(chosen, directions, root * root, side, f"{counted(root * root, 'direction')} in each of {where}")

    def means(
        self, values: NDArray[np.float64], errors: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64] | None]:
        """Means over the patches; errors of one patch are taken as one."""
        shape = (len(self.basis), self.per_patch)
        error = errors.reshape(shape).mean(axis=1)
        return values.reshape(shape).mean(axis=1), error if np.isfinite(error).all() else None

    def weights(self, sky: Sky, ground_reflectance: float) -> NDArray[np.float64]:
        """Projected solid angle times radiance of each direction's share of its patch."""
        root = round(self.per_patch**0.5)
        fine = root * max(1, 16 // root)
        areas = np.repeat(self.basis.projected_solid_angles / self.per_patch, self.per_patch)
        if sky == "uniform":
            return areas
        radiance = np.empty((len(self.basis), self.per_patch))
        for k in range(len(self.basis)):
            light = sky_radiance(self.basis.sample_incident(k, _grid(fine), self.side), sky, ground_reflectance)
            cells = light.reshape(root, fine // root, root, fine // root)
            radiance[k] = cells.mean(axis=(1, 3)).reshape(-1)
        return areas * radiance.reshape(-1)


def _grid(root: int) -> NDArray[np.float64]:
    """Middles of root × root squares of the unit square."""
    middles = (np.arange(root) + 0.5) / root
    u, v = np.meshgrid(middles, middles, indexing="ij")
    return np.column_stack([u.ravel(), v.ravel()])
