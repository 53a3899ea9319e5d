"""Where a lens puts a direction in the picture."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np

from clerestory._core import ClerestoryError

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

Projection = Literal["equisolid", "equidistant", "orthographic", "stereographic", "perspective"]
PROJECTIONS: tuple[Projection, ...] = get_args(Projection)

# Radius over focal length by the angle θ from the axis, the inverse, and the largest θ [rad].
_RADII: dict[str, tuple[Callable[..., NDArray[np.float64]], Callable[..., NDArray[np.float64]], float]] = {
    "equisolid": (lambda t: 2.0 * np.sin(0.5 * t), lambda r: 2.0 * np.arcsin(0.5 * r), np.pi),
    "equidistant": (lambda t: t, lambda r: r, np.pi),
    "orthographic": (np.sin, np.arcsin, 0.5 * np.pi),
    "stereographic": (lambda t: 2.0 * np.tan(0.5 * t), lambda r: 2.0 * np.arctan(0.5 * r), np.pi),
    "perspective": (np.tan, np.arctan, 0.5 * np.pi),
}
_STEPS = 4096


@dataclass(frozen=True)
class Lens:
    """A lens with its picture: the axis, the scale and how the radius grows with the angle.

    The frame of the camera has x to the right, y up and z along the line of sight.
    """

    projection: Projection | None
    """Law of the radius; None with `table`."""
    centre: tuple[float, float]
    """Pixel of the axis: column and row from the upper left corner of the picture, where the first pixel's centre is
    0.5, 0.5."""
    radius: float
    """Radius [pixels] at the angle `edge_deg`."""
    edge_deg: float = 90.0
    """Angle from the axis [°]: half of the field of view over the circle."""
    table: tuple[tuple[float, float], ...] = ()
    """Pairs of θ [°] and relative radius, of a lens that follows no law; scaled so that `radius` is met."""

    def __post_init__(self) -> None:
        if (self.projection is None) != bool(self.table):
            raise ClerestoryError("a lens follows a projection or a table (give one of them)")
        if not (np.isfinite([*self.centre, self.radius]).all() and self.radius > 0.0):
            raise ClerestoryError(f"a radius of {self.radius:g} pixels is not possible (give one above 0)")
        most = self._most_deg
        # At the ends of these laws the radius is infinite, or ceases to grow.
        open_end = self.projection in ("perspective", "stereographic")
        if not 0.0 < self.edge_deg <= most or (open_end and self.edge_deg == most):
            raise ClerestoryError(
                f"{'a table' if self.table else 'an ' if self.projection[0] in 'aeio' else 'a '}"  # type: ignore[index]
                f"{self.projection or ''} lens does not reach {self.edge_deg:g}° from its axis "
                f"(it ends {'before' if open_end else 'at'} {most:g}°; give the angle at the circle's border)"
            )

    @property
    def _most_deg(self) -> float:
        return self.table[-1][0] if self.table else float(np.degrees(_RADII[str(self.projection)][2]))

    @classmethod
    def of_table(cls, points: ArrayLike, centre: tuple[float, float], radius: float, edge_deg: float = 90.0) -> Lens:
        """A lens by measured pairs (n, 2) of θ [°] and radius in any unit; between them the radius follows a line."""
        p = np.asarray(points, dtype=np.float64)
        p = p[np.argsort(p[:, 0])]
        if p[0, 0] > 0.0:
            p = np.concatenate([[[0.0, 0.0]], p])
        if p[0, 1] != 0.0 or (np.diff(p, axis=0) <= 0.0).any() or not np.isfinite(p).all():
            raise ClerestoryError("the radius of a lens begins at 0 and grows with the angle (correct the table)")
        return cls(None, centre, radius, edge_deg, tuple((float(t), float(r)) for t, r in p))

    @property
    def words(self) -> str:
        """Such as equisolid, radius 1832.0 pixels at 90° about 2808.0, 1872.0."""
        x, y = self.centre
        name = self.projection or f"table of {len(self.table)} angles"
        return f"{name}, radius {self.radius:.1f} pixels at {self.edge_deg:g}° about {x:.1f}, {y:.1f}"

    def radius_at(self, theta: ArrayLike) -> NDArray[np.float64]:
        """Radius [pixels] of angles θ from the axis [rad]; NaN where the lens sees nothing."""
        t = np.asarray(theta, dtype=np.float64)
        with np.errstate(invalid="ignore"):
            made = self._scale * np.where(t <= np.radians(self._most_deg) * (1.0 + 1e-12), self._law(t), np.nan)
        return np.asarray(made)

    def theta_at(self, radius: ArrayLike) -> NDArray[np.float64]:
        """Angle from the axis [rad] of radii [pixels]; NaN where the lens sees nothing."""
        r = np.asarray(radius, dtype=np.float64) / self._scale
        if self.table:
            angles, radii = (np.array(v) for v in zip(*self.table, strict=True))
            return np.asarray(np.interp(r, radii, np.radians(angles), right=np.nan))
        with np.errstate(invalid="ignore"):
            return np.asarray(_RADII[str(self.projection)][1](r))

    def _law(self, theta: NDArray[np.float64]) -> NDArray[np.float64]:
        if self.table:
            angles, radii = zip(*self.table, strict=True)
            return np.asarray(np.interp(theta, np.radians(angles), radii))
        return _RADII[str(self.projection)][0](theta)

    @property
    def _scale(self) -> float:
        return self.radius / float(self._law(np.array(np.radians(self.edge_deg))))

    def locate(self, directions: ArrayLike) -> NDArray[np.float64]:
        """Columns and rows (..., 2) [pixels] where directions (..., 3) of the camera's frame are seen; NaN for none."""
        d = np.asarray(directions, dtype=np.float64)
        across = np.hypot(d[..., 0], d[..., 1])
        radius = self.radius_at(np.arctan2(across, d[..., 2]))
        share = np.divide(radius, across, out=np.zeros_like(radius), where=across > 0.0)
        share = np.where(np.isnan(radius), np.nan, share)
        return np.stack([self.centre[0] + share * d[..., 0], self.centre[1] - share * d[..., 1]], axis=-1)

    def directions(self, pixels: ArrayLike) -> NDArray[np.float64]:
        """Directions (..., 3) of the camera's frame at columns and rows (..., 2) [pixels]; NaN for none."""
        p = np.asarray(pixels, dtype=np.float64)
        x, y = p[..., 0] - self.centre[0], self.centre[1] - p[..., 1]
        radius = np.hypot(x, y)
        theta = self.theta_at(radius)
        sine = np.divide(np.sin(theta), radius, out=np.zeros_like(radius), where=radius > 0.0)
        made = np.stack([x * sine, y * sine, np.cos(theta)], axis=-1)
        return np.where(np.isnan(theta)[..., None], np.nan, made)

    def thetas(self, shape: tuple[int, int]) -> NDArray[np.float32]:
        """Angle from the axis [rad] of the centres of all pixels of a picture (height, width); NaN beyond the lens."""
        height, width = shape
        x = np.arange(width, dtype=np.float64) + 0.5 - self.centre[0]
        y = np.arange(height, dtype=np.float64) + 0.5 - self.centre[1]
        # Along a fine table, since the laws' own functions would take as long as all the rest.
        most = float(np.hypot(np.abs(x).max(), np.abs(y).max()))
        radii = np.linspace(0.0, most, _STEPS)
        made = np.empty(shape, dtype=np.float32)
        thetas = self.theta_at(radii)
        last = int(np.argmax(np.isnan(thetas))) if np.isnan(thetas).any() else _STEPS
        for row in range(height):
            made[row] = np.interp(np.hypot(x, y[row]), radii[:last], thetas[:last], right=np.nan)
        return made
