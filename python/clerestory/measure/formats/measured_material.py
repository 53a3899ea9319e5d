"""A measured reflection in the parametrisation of Dupuy and Jakob, as their tensor files hold it.

The halfway vector, in coordinates of the unit square, is warped by the distribution of visible normals; what was
measured lies on a regular grid of the warped square. Reflection on one side only.

References
----------
J. Dupuy, W. Jakob, An Adaptive Parameterization for Efficient Material Acquisition and Rendering, ACM Trans. Graph.
37 (2018), doi:10.1145/3272127.3275059.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

_TOLERANCE = 1e-4
"""Of azimuths in float32 [rad]."""


@dataclass(frozen=True)
class MeasuredMaterial:
    """What the tensor file holds; angles in radians, azimuths from -π to π."""

    theta_i: Floats
    """(T,), rising"""
    phi_i: Floats
    """(P,), rising; up to two where the reflection does not depend on it."""
    vndf: NDArray[np.floating]
    """Distribution of visible normals (P, T, a, b): azimuth, then polar angle of the halfway vector."""
    spectra: NDArray[np.floating]
    """Values on the warped square (P, T, channels, N, N), times the cosine of the outgoing angle."""
    ndf: Floats | None
    """Distribution of normals (a, b), where values are to be multiplied by ndf / (4 sigma)."""
    sigma: Floats | None
    """Projected area of the microfacets (a, b)."""

    @property
    def isotropic(self) -> bool:
        """Whether the azimuth of the incident light does not matter."""
        return len(self.phi_i) <= 2

    def evaluate(self, incident: Floats, outgoing: Floats) -> Floats:
        """BSDF [1/sr] (n, channels) of light from a direction toward directions (n, 3) with z up.

        Parameters
        ----------
        incident
            Unit vector (3,) to the source, above the horizon.
        outgoing
            Unit vectors above the horizon.

        Notes
        -----
        With m the halfway vector and u = (√(2θ/π), (φ + π) / 2π) of a direction: the values at the warped u(m),
        bilinearly, linear in the incident angles, times ndf(u(m)) / (4 σ(u(incident))) if they are given, over the
        cosine of the outgoing angle. Incident polar angles beyond those of the file take the last of them.
        """
        signs = self._fold(float(np.arctan2(incident[1], incident[0])))
        incident, outgoing = incident * signs, outgoing * signs
        theta, phi = _angles(incident)
        half = incident + outgoing
        theta_m, phi_m = _angles(half / np.linalg.norm(half, axis=-1, keepdims=True))
        u_m = _unit(theta_m, phi_m - phi if self.isotropic else phi_m)
        weights = [
            (p, t, wp * wt)
            for p, wp in _between(self.phi_i, float(phi))
            for t, wt in _between(self.theta_i, float(theta))
            if wp * wt > 0.0
        ]
        density = sum(w * _normalised(self.vndf[p, t].astype(np.float64)) for p, t, w in weights)
        values = sum(w * self.spectra[p, t].astype(np.float64) for p, t, w in weights)
        assert isinstance(density, np.ndarray)
        assert isinstance(values, np.ndarray)
        found = bilinear(values, warped(density, u_m))
        if self.ndf is not None and self.sigma is not None:
            area = bilinear(self.sigma[None], _unit(theta, phi)[None])[0, 0]
            if not area > 0.0:
                return np.zeros_like(found)
            found *= bilinear(self.ndf[None], u_m) / (4.0 * area)
        cosine = outgoing[:, 2:]
        return np.maximum(found, 0.0) / cosine

    def _fold(self, phi: float) -> Floats:
        """Signs (3,) that bring an incident azimuth into the part of the circle that the file covers."""
        if self.isotropic:
            return np.ones(3)
        low, high = self.phi_i[0] - _TOLERANCE, self.phi_i[-1] + _TOLERANCE
        half = ((1.0, 1.0), (-1.0, -1.0))
        candidates = half if high - low > 0.75 * np.pi else (*half, (1.0, -1.0), (-1.0, 1.0))
        for x, y in candidates:
            if low <= np.arctan2(y * np.sin(phi), x * np.cos(phi)) <= high:
                return np.array([x, y, 1.0])
        return np.ones(3)


def warped(density: Floats, at: Floats) -> Floats:
    """Where a warp by a density takes points of the unit square: the inverse of drawing by it.

    Parameters
    ----------
    density
        Values at the nodes of a grid over the square (a, b), bilinear between them: second coordinate, then first.
    at
        Points (n, 2).

    Returns
    -------
    Points (n, 2): the share of the density up to the first coordinate along the second, and up to the second.
    """
    rows, columns = density.shape
    x, fx = _cell(at[:, 0], columns)
    y, fy = _cell(at[:, 1], rows)
    # Sums of trapezoids up to each node, in units of a cell's width.
    along = np.zeros_like(density)
    along[:, 1:] = np.cumsum(0.5 * (density[:, 1:] + density[:, :-1]), axis=1)
    totals = along[:, -1]
    up = np.concatenate([[0.0], np.cumsum(0.5 * (totals[1:] + totals[:-1]))])

    def partial(row: NDArray[np.int64]) -> Floats:
        left, right = density[row, x], density[row, x + 1]
        result: Floats = along[row, x] + fx * (left + 0.5 * fx * (right - left))
        return result

    part = (1.0 - fy) * partial(y) + fy * partial(y + 1)
    whole = (1.0 - fy) * totals[y] + fy * totals[y + 1]
    first = np.divide(part, whole, out=at[:, 0].copy(), where=whole > 0.0)
    second = up[y] + fy * (totals[y] + 0.5 * fy * (totals[y + 1] - totals[y]))
    return np.stack([first, second / up[-1] if up[-1] > 0.0 else at[:, 1]], axis=-1)


def bilinear(grids: Floats, at: Floats) -> Floats:
    """Values (n, channels) of grids (channels, a, b) over the unit square at points (n, 2)."""
    x, fx = _cell(at[:, 0], grids.shape[2])
    y, fy = _cell(at[:, 1], grids.shape[1])
    lower = (1.0 - fx) * grids[:, y, x] + fx * grids[:, y, x + 1]
    upper = (1.0 - fx) * grids[:, y + 1, x] + fx * grids[:, y + 1, x + 1]
    found: Floats = ((1.0 - fy) * lower + fy * upper).T
    return found


def _cell(u: Floats, nodes: int) -> tuple[NDArray[np.int64], Floats]:
    """Cell of coordinates of the unit interval with so many nodes, and the place within it."""
    scaled = np.clip(u, 0.0, 1.0) * (nodes - 1)
    cell = np.minimum(scaled.astype(np.int64), nodes - 2)
    return cell, scaled - cell


def _between(nodes: Floats, value: float) -> list[tuple[int, float]]:
    """Nodes about a value and their weights; the first or the last beyond them."""
    if len(nodes) == 1:
        return [(0, 1.0)]
    k = int(np.clip(np.searchsorted(nodes, value) - 1, 0, len(nodes) - 2))
    share = float(np.clip((value - nodes[k]) / (nodes[k + 1] - nodes[k]), 0.0, 1.0))
    return [(k, 1.0 - share), (k + 1, share)]


def _normalised(density: Floats) -> Floats:
    """A density with an integral of 1 over the square."""
    weights = np.ones_like(density)
    weights[[0, -1], :] *= 0.5
    weights[:, [0, -1]] *= 0.5
    total = float((weights * density).sum()) / ((density.shape[0] - 1) * (density.shape[1] - 1))
    return density / total if total > 0.0 else density


def _angles(directions: Floats) -> tuple[Floats, Floats]:
    theta = np.arctan2(np.hypot(directions[..., 0], directions[..., 1]), directions[..., 2])
    return theta, np.arctan2(directions[..., 1], directions[..., 0])


def _unit(theta: Floats, phi: Floats) -> Floats:
    """Coordinates of the unit square (..., 2) of directions."""
    around = (phi + np.pi) / (2.0 * np.pi)
    return np.stack([np.sqrt(np.maximum(theta, 0.0) * 2.0 / np.pi), around - np.floor(around)], axis=-1)
