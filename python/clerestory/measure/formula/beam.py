"""The instrument's beam, which narrow light is seen through: kept apart from what the sample does.

A measured distribution is the sample's, spread by the beam: DSF ⊗ k, and the beam's own image where light passes
unscattered. So a formula is spread before it is compared, and nothing is deconvolved.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.directions import direction
from clerestory.measure.formula.shapes import DIFFUSE, SPECULAR, Geometry
from clerestory.measure.prepare.signature import signatures

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from clerestory.measure.formula.shapes import Formula
    from clerestory.measure.prepare.signature import Signature
    from clerestory.measure.scan import Measurement

    Floats = NDArray[np.float64]

_NEAR = 3.0
"""Points within so many full widths of the middle see a spread distribution."""
_BESIDE = 12.0
"""Between `_NEAR` and so many full widths a distribution is smooth over the beam, and seven directions stand for it."""
_CORE = 1.5
"""Full widths about a point that are spread over it."""
_STEPS = 5.0
"""Nodes a full width."""
_LEAST = 1e-6
"""Share of the maximum below which a ring is dark."""
_FINEST = 1e-3
"""Of a full width: radius of the innermost nodes, so that a lobe much narrower than the beam is still seen."""


@dataclass(frozen=True)
class Beam:
    """A beam that is alike all around: its profile over the angle from its middle."""

    words: str
    width: float
    """Full width at half maximum [rad]."""
    radius: Floats
    """Angles [rad], rising from 0 (n,)."""
    profile: Floats
    """Density [1/sr] (n,); the integral over all directions is 1."""
    signature: Signature | None
    """What was measured of it."""

    @classmethod
    def gaussian(cls, width_deg: float) -> Beam:
        """One of a full width at half maximum [°] that a person knows.

        Raises
        ------
        ClerestoryError
            The width is no angle from 0 to 30°.
        """
        if not 0.0 < width_deg <= 30.0:
            raise ClerestoryError(f"a beam {width_deg:g}° wide is not possible (give more than 0 and at most 30°)")
        width = float(np.radians(width_deg))
        radius = np.linspace(0.0, 4.0 * width, 400)
        profile = np.exp(-4.0 * np.log(2.0) * (radius / width) ** 2)
        return cls(f"a Gaussian {width_deg:g}° wide, as was said", width, radius, _unit(radius, profile), None)

    @classmethod
    def measured(cls, measurement: Measurement, channel: str) -> Beam | None:
        """That of the first scan of it; None where there is none.

        Raises
        ------
        ClerestoryError
            The scan does not reach down to half of the maximum.
        """
        scans = [s for s in measurement.of(purpose="beam") if channel in s.channels and len(s) >= 3]
        if not scans:
            return None
        scan = scans[0]
        found = next(s for s in signatures(scan) if s.channel == channel)
        if found.widths_deg[0] is None:
            raise ClerestoryError("the scan of the beam does not reach down to half of its maximum (scan more of it)")
        width = float(np.radians(found.widths_deg[0]))
        axis = direction(found.theta_deg, found.phi_deg, side=scan.side)
        apart = 2.0 * np.arcsin(np.clip(0.5 * np.linalg.norm(scan.outgoing - axis, axis=1), 0.0, 1.0))
        # Rings of an eighth of a width, wider where it falls to its wings; a Gaussian is straight in r² and ln.
        edges = np.concatenate([np.arange(0.0, 4.0, 0.125), np.geomspace(4.0, 400.0, 40)]) * width
        which = np.digitize(apart, edges) - 1
        values = scan.channel(channel)
        rings = [r for r in np.unique(which) if values[which == r].mean() > _LEAST * found.peak]
        r2 = np.array([np.mean(apart[which == r] ** 2) for r in rings])
        log = np.log([values[which == r].mean() for r in rings])
        if len(rings) < 3:
            raise ClerestoryError("the scan of the beam has points in fewer than three rings about it (scan it finer)")
        middle = log[0] - (log[1] - log[0]) * r2[0] / (r2[1] - r2[0])
        radius = np.sqrt(np.concatenate([[0.0], r2]))
        return cls(found.words, width, radius, _unit(radius, np.exp(np.concatenate([[middle], log]))), found)

    @property
    def deviation(self) -> float:
        """Standard deviation along an axis [rad], of what lies within the core."""
        fine = np.linspace(0.0, _CORE * self.width, 2001)
        ring = self.density(fine) * np.sin(fine)
        return float(np.sqrt(0.5 * np.trapezoid(ring * fine**2, fine) / np.trapezoid(ring, fine)))

    def density(self, apart: Floats) -> Floats:
        """Density [1/sr] at angles from its middle [rad]; 0 beyond what was measured."""
        return _between(apart, self.radius, self.profile)


def _between(apart: Floats, radius: Floats, profile: Floats) -> Floats:
    """A profile at angles: its logarithm is linear in their squares."""
    log = np.interp(apart**2, radius**2, np.log(profile))
    return np.where(apart <= radius[-1], np.exp(log), 0.0)


def _unit(radius: Floats, profile: Floats) -> Floats:
    """A profile whose integral over directions is 1."""
    fine = np.linspace(0.0, float(radius[-1]), 20_001)
    ring = _between(fine, radius, profile) * np.sin(fine)
    return np.asarray(profile / (2.0 * np.pi * np.trapezoid(ring, fine)))


@dataclass(frozen=True)
class Spread:
    """How the beam spreads light of one incident direction over points near its middle."""

    near: NDArray[np.intp]
    """Points that see more than their own direction (n,)."""
    nodes: Floats
    """Directions (m, 3), folded, at which the formula is needed for them."""
    cosines: Floats
    """Of the nodes; 0 below the horizon (m,)."""
    mean: Floats
    """Weights (n, m) of the nodes' DSF; each row sums to 1."""
    beside: NDArray[np.intp]
    """Points farther out (b,)."""
    ring: Floats
    """Six directions about each of them (b, 6, 3), folded, that count a twelfth each beside the point's own half: a
    rule of degree 5 for a Gaussian (Stroud 1971, E₂^(r²): 5-2).
    """

    @classmethod
    def of(cls, beam: Beam, middle: Floats, outgoing: Floats) -> Spread:
        """About a direction (3,), for folded points (n, 3)."""
        apart = apart_from(outgoing, middle)
        near = np.flatnonzero(apart < _NEAR * beam.width)
        step = beam.width / _STEPS
        inner = np.geomspace(_FINEST * beam.width, step, 16)
        edges = np.concatenate([[0.0], inner, np.arange(2.0 * step, (_NEAR + _CORE) * beam.width + step, step)])
        at, areas = [], []
        for low, high in pairwise(edges):
            count = max(8, int(np.ceil(2.0 * np.pi * high / step)))
            turn = 2.0 * np.pi * (np.arange(count) + 0.5) / count
            radius = np.sqrt(0.5 * (low**2 + high**2))
            at.append(np.stack([np.full(count, radius), turn], axis=1))
            areas.append(np.full(count, 2.0 * np.pi * (np.cos(low) - np.cos(high)) / count))
        rings, area = np.concatenate(at), np.concatenate(areas)
        across = np.cross(middle, [0.0, 1.0, 0.0] if abs(middle[1]) < 0.9 else [1.0, 0.0, 0.0])
        across /= np.linalg.norm(across)
        beside = np.cross(middle, across)
        sin, cos = np.sin(rings[:, 0]), np.cos(rings[:, 0])
        nodes = cos[:, None] * middle + sin[:, None] * (
            np.cos(rings[:, 1])[:, None] * across + np.sin(rings[:, 1])[:, None] * beside
        )
        weights = np.zeros((len(near), len(nodes)))
        for row, point in enumerate(outgoing[near]):
            far = apart_from(nodes, point)
            weights[row] = np.where(far < _CORE * beam.width, beam.density(far) * area, 0.0)
        weights /= np.maximum(weights.sum(axis=1, keepdims=True), 1e-300)
        beside_these = np.flatnonzero((apart >= _NEAR * beam.width) & (apart < _BESIDE * beam.width))
        ring = _ring(outgoing[beside_these], 2.0 * beam.deviation)
        return cls(near, nodes, np.maximum(nodes[:, 2], 0.0), weights, beside_these, ring)


def seen(
    formula: Formula,
    held: Mapping[str, Floats],
    beam: Beam | None,
    geometry: Geometry,
    apart: Floats,
    spread: Spread | None,
) -> Floats:
    """What the instrument sees of a formula: BSDF [1/sr] of light from one direction at points (n,).

    Parameters
    ----------
    held
        Parameters.
    geometry, apart, spread
        Of the points; their angles from the mirrored or straight direction [rad]; how the beam spreads light over them.
    """
    values = formula.value(geometry, held)
    if beam is not None and spread is not None:
        incident = geometry.incident[0]
        nodes = formula.value(Geometry.of(incident, spread.nodes), held) * spread.cosines
        values = values.copy()
        values[spread.near] = spread.mean @ nodes / geometry.cos_out[spread.near]
        if len(spread.beside):
            around = formula.value(Geometry.of(incident, spread.ring), held) * np.maximum(spread.ring[..., 2], 0.0)
            rim = around.sum(axis=1) / geometry.cos_out[spread.beside]
            values[spread.beside] = 0.5 * values[spread.beside] + rim / 12.0
        values = values + held[SPECULAR.name] * beam.density(apart) / geometry.cos_out
    return np.asarray(values + held[DIFFUSE.name] / np.pi)


def _ring(points: Floats, radius: float) -> Floats:
    """Six directions (n, 6, 3) at an angle [rad] from each point (n, 3)."""
    across = np.cross(points, np.where(np.abs(points[:, 1:2]) < 0.9, [[0.0, 1.0, 0.0]], [[1.0, 0.0, 0.0]]))
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    beside = np.cross(points, across)
    turn = np.arange(6) * np.pi / 3.0
    off = np.cos(turn)[None, :, None] * across[:, None] + np.sin(turn)[None, :, None] * beside[:, None]
    return np.asarray(np.cos(radius) * points[:, None] + np.sin(radius) * off)


def apart_from(directions: Floats, middle: Floats) -> Floats:
    """Angles [rad] between directions (n, 3) and one."""
    return np.asarray(2.0 * np.arcsin(np.clip(0.5 * np.linalg.norm(directions - middle, axis=-1), 0.0, 1.0)))
