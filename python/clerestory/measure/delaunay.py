"""Surfaces through scattered points: Delaunay's triangles on the hemisphere, for pictures, integrals and other grids.

Points of the hemisphere are projected from the opposite pole onto the plane (stereographic): circles stay circles, so
Delaunay's triangles in the plane are those of the sphere. Between the outermost points and the horizon, where nothing
was measured, the BSDF of the nearest point goes on, so that BSDF·cos θ falls to 0 at 90°; what stands on that, or on a
gap between points, is told apart from what was measured.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np
from scipy.spatial import Delaunay, QhullError, cKDTree
from threadpoolctl import threadpool_limits

from clerestory._core import ClerestoryError
from clerestory.counts import counted
from clerestory.directions import direction

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from clerestory.basis import Basis
    from clerestory.directions import Side
    from clerestory.measure.scan import Scan

    Floats = NDArray[np.float64]


class NoSurfaceError(ClerestoryError):
    """Points through which there is no surface: too few, or all on one line."""


Interpolated = Literal["bsdf", "log", "dsf"]
"""What is linear between three points: BSDF, its logarithm, or BSDF·cos θ."""

CLIP_DEG = 5.0
"""Points closer to the horizon than this [°] are left out: their BSDF is noise over a small cosine."""
GAP_DEG = 30.0
"""A triangle with a longer side [°] bridges a gap and is not measured."""
_STEPS = 500
"""A walk from a corner to a place next to it takes a few; one that goes round in a sliver ends."""
_SAME = 1e-6
"""Points of the plane closer than this (0.4 arc-seconds) are one, with the mean of their values."""
_DECADES = 7.0
"""A logarithm is taken of values down to so many decades below the largest, and no less than the smallest above 0."""

# Radon's rule of degree 5 on a triangle (Stroud 1971, T2:5-1): barycentric coordinates and weights.
_R = np.sqrt(15.0)
_A, _B = (6.0 - _R) / 21.0, (6.0 + _R) / 21.0
_NODES = np.array(
    [[1 / 3, 1 / 3, 1 / 3]] + [np.roll([1 - 2 * a, a, a], k).tolist() for a in (_A, _B) for k in range(3)]
)
_WEIGHTS = np.array([9 / 40] + [(155 - _R) / 1200] * 3 + [(155 + _R) / 1200] * 3)


@dataclass(frozen=True)
class Integral:
    """Direct-hemispherical values of a surface through points, one a channel."""

    total: Floats
    """Integral of BSDF·cos θ over the hemisphere [-] (channels,)."""
    extrapolated: Floats
    """The part of it that comes from beyond the outermost points or from gaps (channels,)."""
    covered: float
    """Share of the projected hemisphere that lies between measured points."""


@dataclass(frozen=True)
class Surface:
    """A continuous distribution through the points of a scan."""

    side: Side
    """Side that the light leaves to."""
    channels: tuple[str, ...]
    interpolated: Interpolated
    plane: Delaunay
    """Triangles of the points' places in the plane; the last places are those of the horizon."""
    values: Floats
    """Of what is interpolated, at each place (places, channels)."""
    measured_triangles: NDArray[np.bool_]
    """Whether a triangle lies between measured points that are close enough (triangles,)."""

    def evaluate(self, outgoing: ArrayLike, *, dsf: bool = False, extrapolate: bool = True) -> Floats:
        """BSDF, or BSDF·cos θ, [1/sr] in directions (..., 3), as (..., channels); NaN where a direction is NaN.

        Parameters
        ----------
        outgoing
            Directions along the light.
        dsf
            Whether the cosine is in it.
        extrapolate
            False for NaN where nothing was measured.
        """
        d = np.asarray(outgoing, dtype=np.float64)
        flat = d.reshape(-1, 3)
        known = np.isfinite(flat).all(axis=1)
        made = np.full((len(flat), len(self.channels)), np.nan)
        made[known] = self._at(_onto_plane(flat[known]), dsf=dsf, extrapolate=extrapolate)
        return made.reshape(*d.shape[:-1], len(self.channels))

    def measured(self, outgoing: ArrayLike) -> NDArray[np.bool_]:
        """Whether directions (..., 3) lie between measured points; False where a direction is NaN."""
        d = np.asarray(outgoing, dtype=np.float64)
        flat = d.reshape(-1, 3)
        known = np.isfinite(flat).all(axis=1)
        made = np.zeros(len(flat), dtype=bool)
        made[known] = self.measured_triangles[self._find(_onto_plane(flat[known]))[0]]
        return made.reshape(d.shape[:-1])

    def integrate(self) -> Integral:
        """Direct-hemispherical values, triangle by triangle."""
        corners = self.plane.points[self.plane.simplices]
        a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        areas = 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
        per_triangle = np.zeros((len(areas), len(self.channels)))
        held, projected = self.values[self.plane.simplices], np.zeros(len(areas))
        for node, weight in zip(_NODES, _WEIGHTS, strict=True):
            r2 = (np.einsum("tij,i->tj", corners, node) ** 2).sum(axis=1)
            cosine = (1.0 - r2) / (1.0 + r2)
            dsf = self._from(np.einsum("tic,i->tc", held, node), cosine, dsf=True)
            solid_angles = weight * areas * 4.0 / (1.0 + r2) ** 2
            per_triangle += solid_angles[:, None] * dsf
            projected += solid_angles * cosine
        between = self.measured_triangles
        covered = float(projected[between].sum() / np.pi)
        return Integral(per_triangle.sum(axis=0), per_triangle[~between].sum(axis=0), covered)

    def places(self, outgoing: ArrayLike) -> tuple[NDArray[np.int64], Floats, NDArray[np.bool_]]:
        """The three places around directions (n, 3), their shares (n, 3), and whether each was measured (n,).

        What is interpolated in a direction is the sum of shares times `values` of these places.
        """
        found, weights = self._find(_onto_plane(np.asarray(outgoing, dtype=np.float64)))
        return self.plane.simplices[found].astype(np.int64), weights, self.measured_triangles[found]

    def weights(self) -> Floats:
        """What the value of each place counts for in the integral of BSDF·cos θ where it was measured [sr] (places,).

        For a surface of BSDF: the integral is the sum of weights times values.
        """
        made = np.zeros(len(self.values))
        simplices = self.plane.simplices[self.measured_triangles]
        corners = self.plane.points[simplices]
        areas = 0.5 * np.abs(_areas(corners, corners[:, 0])[:, 0])
        for node, weight in zip(_NODES, _WEIGHTS, strict=True):
            r2 = (np.einsum("tij,i->tj", corners, node) ** 2).sum(axis=1)
            flux = weight * areas * 4.0 / (1.0 + r2) ** 2 * (1.0 - r2) / (1.0 + r2)
            np.add.at(made, simplices, flux[:, None] * node)
        return made

    def onto(self, basis: Basis, *, across: int = 8) -> tuple[Floats, Floats]:
        """Mean BSDF of patches by projected solid angle (patches, channels), and the share of each that was measured.

        Parameters
        ----------
        across
            Directions along each side of a patch.
        """
        at = (np.arange(across) + 0.5) / across
        u = np.stack(np.meshgrid(at, at), axis=-1).reshape(-1, 2)
        directions = np.stack([basis.sample_outgoing(n, u, self.side) for n in range(len(basis))])
        return self.evaluate(directions).mean(axis=1), self.measured(directions).mean(axis=1)

    def _at(self, places: Floats, *, dsf: bool, extrapolate: bool) -> Floats:
        r2 = np.minimum((places**2).sum(axis=1), 1.0)
        found, weights = self._find(places)
        held = np.einsum("nic,ni->nc", self.values[self.plane.simplices[found]], weights)
        values = self._from(held, (1.0 - r2) / (1.0 + r2), dsf=dsf)
        return values if extrapolate else np.where(self.measured_triangles[found][:, None], values, np.nan)

    def _find(self, places: Floats) -> tuple[NDArray[np.int64], Floats]:
        """The triangle of each place (n,), and the place's barycentric coordinates in it (n, 3).

        A walk from a triangle of the nearest corner across the side that the place lies farthest beyond; Qhull's own
        search goes through all triangles wherever one is flat, as those of scans along lines are.
        """
        pulled = _inside(places)
        corners, neighbours = self.plane.points[self.plane.simplices], self.plane.neighbors
        found = self.plane.vertex_to_simplex[cKDTree(self.plane.points).query(pulled)[1]].astype(np.int64)
        weights = np.zeros((len(pulled), 3))
        left = np.arange(len(pulled))
        for _ in range(_STEPS):
            weights[left] = _areas(corners[found[left]], pulled[left])
            worst = weights[left].argmin(axis=1)
            outside = weights[left, worst] < -1e-15
            left, worst = left[outside], worst[outside]
            beyond = neighbours[found[left], worst]
            left, beyond = left[beyond >= 0], beyond[beyond >= 0]
            if not len(left):
                break
            found[left] = beyond
        inside = np.maximum(weights, 0.0)
        total = inside.sum(axis=1, keepdims=True)
        return found, np.divide(inside, total, out=np.full_like(inside, 1.0 / 3.0), where=total > 0.0)

    def _from(self, held: Floats, cosine: Floats, *, dsf: bool) -> Floats:
        if self.interpolated == "dsf":
            return held if dsf else held / np.maximum(cosine, 1e-6)[:, None]
        bsdf = np.exp(held) if self.interpolated == "log" else held
        return bsdf * cosine[:, None] if dsf else bsdf


def surface(
    scan: Scan, *, interpolated: Interpolated = "bsdf", clip_deg: float = CLIP_DEG, gap_deg: float = GAP_DEG
) -> Surface:
    """A surface through the points of a scan.

    Parameters
    ----------
    scan
        Points of BSDF or DSF.
    interpolated
        What is linear between points; a logarithm takes values of 0 and less as the smallest above it.
    clip_deg
        Points closer to the horizon than this [°] are left out.
    gap_deg
        A triangle with a longer side [°] is not measured.

    Raises
    ------
    NoSurfaceError
        The points are fewer than three, or lie on one line.
    ClerestoryError
        They are a detector's signal.
    """
    if not 0.0 <= clip_deg < 90.0:
        raise ClerestoryError(f"points cannot be clipped {clip_deg:g}° from the horizon (give 0 to 90°)")
    bsdf = scan.as_bsdf()
    kept = bsdf.theta_deg <= min(90.0 - clip_deg, 89.999)
    places, values = _merged(_onto_plane(bsdf.outgoing[kept]), bsdf.values[kept])
    if len(places) < 3:
        raise NoSurfaceError(
            f"{counted(len(places), 'point')} up to {90.0 - clip_deg:g}° make no surface (three are needed)"
        )
    spread = np.linalg.svd(places - places.mean(axis=0), compute_uv=False)
    if spread[1] < 1e-3 * spread[0]:
        raise NoSurfaceError("the points lie on one line, which makes no surface (draw a cut through it)")
    around = np.radians(np.arange(0.0, 360.0, 2.0))
    rim = np.column_stack([np.cos(around), np.sin(around)])
    beside = cKDTree(places).query(rim)[1]
    held = _held(values, places, interpolated)
    at_rim = np.zeros((len(rim), values.shape[1])) if interpolated == "dsf" else held[beside]
    try:
        with threadpool_limits(1):  # LAPACK finds a triangle at a time, and its threads would only wait for each other
            plane = Delaunay(np.vstack([places, rim]))
            _ = plane.transform
    except QhullError as error:
        raise ClerestoryError("the points make no triangles (check their angles)") from error
    corners = _on_sphere(plane.points)[plane.simplices]
    cosines = [np.sum(corners[:, k] * corners[:, k - 1], axis=1) for k in range(3)]
    close = np.min(cosines, axis=0) >= np.cos(np.radians(gap_deg))
    measured = close & (plane.simplices < len(places)).all(axis=1)
    return Surface(scan.side, scan.channels, interpolated, plane, np.vstack([held, at_rim]), measured)


def regrid(
    scan: Scan,
    theta_deg: ArrayLike,
    phi_deg: ArrayLike,
    *,
    interpolated: Interpolated = "bsdf",
    clip_deg: float = CLIP_DEG,
    gap_deg: float = GAP_DEG,
    extrapolate: bool = False,
) -> Scan:
    """The same distribution at other directions, as BSDF; those that were not measured are left out.

    Parameters
    ----------
    theta_deg, phi_deg
        Directions [°] of any shapes that broadcast: `theta[:, None]` and `phi[None, :]` make a regular grid.
    extrapolate
        Keep directions beyond the outermost points and in gaps.
    scan, interpolated, clip_deg, gap_deg
        As for `surface`.
    """
    theta, phi = np.broadcast_arrays(np.asarray(theta_deg, np.float64), np.asarray(phi_deg, np.float64))
    outgoing = direction(theta.ravel(), phi.ravel(), side=scan.side)
    through = surface(scan, interpolated=interpolated, clip_deg=clip_deg, gap_deg=gap_deg)
    kept = np.ones(len(outgoing), dtype=bool) if extrapolate else through.measured(outgoing)
    return replace(
        scan,
        theta_deg=theta.ravel()[kept],
        phi_deg=phi.ravel()[kept],
        values=through.evaluate(outgoing[kept]),
        quantity="bsdf",
        standard_errors=None,
    )


def _onto_plane(outgoing: Floats) -> Floats:
    """Places (n, 2) of directions (n, 3); the horizon is the unit circle."""
    return np.asarray(outgoing[:, :2] / (1.0 + np.abs(outgoing[:, 2:])))


def _on_sphere(places: Floats) -> Floats:
    """Directions (n, 3) of places, all toward one side."""
    r2 = (places**2).sum(axis=1)[:, None]
    return np.asarray(np.hstack([2.0 * places, 1.0 - r2]) / (1.0 + r2))


def _inside(places: Floats) -> Floats:
    """Places between the horizon and the chords of its points, pulled in to the chords."""
    r = np.sqrt((places**2).sum(axis=1))[:, None]
    return np.asarray(places * np.minimum(1.0, 0.9998 / np.maximum(r, 0.5)))


def _areas(corners: Floats, places: Floats) -> Floats:
    """Twice the areas (n, 3) between places and the sides opposite to each corner of triangles (n, 3, 2), with sign."""
    made = np.empty((len(places), 3))
    for k in range(3):
        a, b = corners[:, (k + 1) % 3], corners[:, (k + 2) % 3]
        made[:, k] = (b[:, 0] - a[:, 0]) * (places[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (places[:, 0] - a[:, 0])
    return made


def _merged(places: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Points at one place as one, with the mean of their values."""
    _, first, which = np.unique(np.round(places / _SAME), axis=0, return_index=True, return_inverse=True)
    which = which.ravel()
    counts = np.bincount(which)
    means = np.column_stack([np.bincount(which, values[:, c]) / counts for c in range(values.shape[1])])
    return places[first], means


def _held(values: Floats, places: Floats, interpolated: Interpolated) -> Floats:
    if interpolated == "bsdf":
        return values
    if interpolated == "dsf":
        r2 = (places**2).sum(axis=1)
        return np.asarray(values * ((1.0 - r2) / (1.0 + r2))[:, None])
    if interpolated != "log":
        raise ClerestoryError(f"{interpolated!r} cannot be interpolated (give bsdf, log or dsf)")
    largest = values.max(axis=0)
    if not (largest > 0.0).all():
        raise ClerestoryError("no value is above 0, so none has a logarithm (interpolate the BSDF itself)")
    least = np.where(values > 0.0, values, np.inf).min(axis=0)
    return np.asarray(np.log(np.maximum(values, np.maximum(least, largest * 10.0**-_DECADES))))
