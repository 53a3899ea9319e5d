"""A model beside the points that it was made of, for light from one measured direction.

What is left of the points when the model is taken off is small and without peaks, so that its integral over triangles
is good: it tells how much light the model's lobes lose or add. The points' own noise comes through the same weights.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.measure.delaunay import surface
from clerestory.measure.prepare.noise import noise

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from clerestory.bsdf import Bsdf
    from clerestory.measure.delaunay import Surface
    from clerestory.measure.scan import Scan
    from clerestory.measure.uncertainty.patches import Patches

    Floats = NDArray[np.float64]

_LEAST_COSINE = 0.02
_BRIGHT = 10.0
"""Multiples of the noise in DSF above which a point's own relative noise can be seen."""
_ENOUGH = 20
_MEDIAN_OF_SQUARE = 0.4549
"""Of a normal distribution of variance 1."""


@dataclass(frozen=True)
class Errors:
    """Of integrals of a model over patches, or of one over the hemisphere."""

    off: Floats
    """Points less model, integrated [-] (n,): what the model lacks, with the points' noise in it."""
    noise: Floats
    """Variance of the integral by the points' noise (n,)."""
    scatter: Floats
    """Variance of it by what is left of each point, noise included (n,)."""

    def lobes(self, places: Floats | float) -> Floats:
        """Variance that the model's lobes add to that of the noise (n,).

        Parameters
        ----------
        places
            Variance of the model by where its points happen to lie, noise included (n,).
        """
        return np.maximum(self.off**2 - self.noise, 0.0) + np.maximum(
            np.maximum(self.scatter, places) - self.noise, 0.0
        )


@dataclass(frozen=True)
class Residual:
    """Points of one incident direction less a model."""

    through: Surface
    """Of four values: the difference, the variances of a point by its noise and by the difference [1/sr²], and the
    point itself [1/sr]."""
    total: Errors
    """Of the direct-hemispherical value, where it was measured."""
    by_triangles: float
    """Direct-hemispherical value of the points themselves, linear over triangles."""

    @classmethod
    def of(cls, group: Sequence[Scan], bsdf: Bsdf, band: str, *, mirrored: bool) -> Residual:
        """Of the scans of one light; `mirrored` where the sample is alike on both sides of the plane of incidence.

        Raises
        ------
        ClerestoryError
            The points make no surface.
        """
        parts = []
        for scan in group:
            values = scan.channel(band)
            left = values - bsdf.evaluate(scan.incident, scan.outgoing, band)
            part = np.column_stack([left, standard_errors(scan, band, left) ** 2, left**2, values])
            kept = np.isfinite(part).all(axis=1)
            one = replace(
                scan,
                theta_deg=scan.theta_deg[kept],
                phi_deg=scan.phi_deg[kept],
                values=part[kept],
                channels=("left", "noise", "scatter", "value"),
                standard_errors=None,
            )
            parts += [one, _mirrored(one)] if mirrored and scan.incident_theta_deg > 1e-3 else [one]
        joined = replace(
            parts[0],
            theta_deg=np.concatenate([p.theta_deg for p in parts]),
            phi_deg=np.concatenate([p.phi_deg for p in parts]),
            values=np.concatenate([p.values for p in parts]),
        )
        through = surface(joined)
        by_triangles = float(through.integrate().total[3])
        return cls(through, integral_errors(through.weights(), through.values), by_triangles)

    def over(self, patches: Patches, image: Floats) -> Errors:
        """Errors of the fluxes into patches, with the sample turned or mirrored by what `image` (2, 2) does."""
        directions = patches.directions.reshape(-1, 3).copy()
        directions[:, :2] = directions[:, :2] @ image
        corners, shares, measured = self.through.places(directions)
        each = patches.directions.shape[1]
        weights = shares * (measured * np.repeat(patches.shares, each))[:, None]
        count = len(self.through.values)
        cell = np.repeat(np.arange(len(patches)), each)[:, None] * count + corners
        places, which = np.unique(cell, return_inverse=True)
        sums = np.bincount(which.ravel(), weights.ravel())
        rows, columns = places // count, places % count
        off, noise_, scatter = (
            np.bincount(rows, w * self.through.values[columns, k], minlength=len(patches)).astype(np.float64)
            for k, w in enumerate((sums, sums**2, sums**2))
        )
        return Errors(off, noise_, scatter)


def integral_errors(weights: Floats, values: Floats) -> Errors:
    """Errors of one integral, by the weights (n,) of independent points and their values (n, 3+) as in `Residual`."""
    squared = weights**2
    return Errors(weights @ values[:, :1], squared @ values[:, 1:2], squared @ values[:, 2:3])


def standard_errors(scan: Scan, band: str, left: Floats) -> Floats:
    """Of the points [1/sr]: the scan's own, or noise told by the scan itself, alike in DSF and relative to the value.

    Parameters
    ----------
    left
        Points less a model, by which the part relative to the value is told.

    Raises
    ------
    ClerestoryError
        A standard error of the scan is negative.
    """
    if scan.standard_errors is not None:
        errors = scan.standard_errors[:, scan.channels.index(band)]
        if (errors < 0.0).any():
            raise ClerestoryError(f"a standard error of {errors.min():g} is negative (give 0 or more)")
        return np.asarray(errors)
    cosine = np.maximum(np.cos(np.radians(scan.theta_deg)), _LEAST_COSINE)
    even = noise(scan, band) / cosine
    values = np.abs(scan.channel(band))
    bright = values > _BRIGHT * even
    excess = (left[bright] ** 2 / _MEDIAN_OF_SQUARE - even[bright] ** 2) / values[bright] ** 2
    relative = float(np.sqrt(max(0.0, float(np.median(excess))))) if len(excess) > _ENOUGH else 0.0
    return np.asarray(np.hypot(even, relative * values))


def _mirrored(scan: Scan) -> Scan:
    return replace(scan, phi_deg=2.0 * scan.incident_phi_deg - scan.phi_deg)
