"""Flat screens: where a pixel's point lies, and which light of the sample it shows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from clerestory.measure.camera.rig import Pinhole, ScreenTable

    Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Screen:
    """A convex screen in the sample's frame [mm], and the perspective in which it is seen."""

    name: str
    origin: Floats
    """A point of it (3,)."""
    axes: Floats
    """Two unit vectors in it (2, 3)."""
    corners: Floats
    """In its own coordinates, counter-clockwise (n, 2)."""
    to_plane: Floats
    """From pixels to its coordinates, a homography (3, 3)."""
    reflectance: float

    @property
    def normal(self) -> Floats:
        """Unit vector (3,) across it."""
        return np.asarray(np.cross(self.axes[0], self.axes[1]))

    def edge_distance(self, places: Floats) -> Floats:
        """Distance [mm] of places (n, 2) from the nearest edge, negative outside."""
        distances = []
        for a, b in zip(self.corners, np.roll(self.corners, -1, axis=0), strict=True):
            along = (b - a) / np.linalg.norm(b - a)
            distances.append(along[0] * (places[:, 1] - a[1]) - along[1] * (places[:, 0] - a[0]))
        return np.asarray(np.min(distances, axis=0))

    @property
    def size(self) -> float:
        """Twice the largest distance from the edges that a point of it has, about [mm]."""
        return 2.0 * float(self.edge_distance(self.corners.mean(axis=0)[None])[0])

    def at(self, places: Floats) -> Floats:
        """Points (n, 3) of places (n, 2)."""
        return np.asarray(self.origin + places @ self.axes)

    def hit(self, directions: Floats) -> Floats:
        """Places (n, 2) where light from the sample's middle along directions (n, 3) meets its plane, or NaN."""
        toward = directions @ self.normal
        with np.errstate(divide="ignore", invalid="ignore"):
            far = (self.origin @ self.normal) / toward
        points = np.where(far > 0.0, far, np.nan)[:, None] * directions - self.origin
        return np.asarray(points @ self.axes.T)

    def places(self, pixels: Floats) -> tuple[Floats, Floats]:
        """Places (n, 2) of pixels (n, 2), NaN beyond the vanishing line, and the area [mm²] of a pixel there (n,)."""
        scaled = pixels[:, :1] * self.to_plane[:, 0] + pixels[:, 1:] * self.to_plane[:, 1] + self.to_plane[:, 2]
        w = scaled[:, 2] * np.sign(self._sign)
        with np.errstate(divide="ignore", invalid="ignore"):
            found = np.where(w[:, None] > 0.0, scaled[:, :2] / scaled[:, 2:], np.nan)
            area = np.abs(np.linalg.det(self.to_plane)) / np.abs(scaled[:, 2]) ** 3
        return found, area

    def pixels(self, places: Floats) -> Floats:
        """Pixels (n, 2) in which places (n, 2) are seen."""
        scaled = np.column_stack([places, np.ones(len(places))]) @ np.linalg.inv(self.to_plane).T
        return np.asarray(scaled[:, :2] / scaled[:, 2:])

    @property
    def _sign(self) -> float:
        """Sign of the third coordinate on the side of the vanishing line on which the screen is."""
        centre = self.pixels(self.corners.mean(axis=0)[None])[0]
        return float((self.to_plane @ [*centre, 1.0])[2])

    def factor(self, places: Floats) -> tuple[Floats, Floats, Floats]:
        """What the screen's luminance must be multiplied by, of unit lit area [mm²], to be that of the sample.

        A Lambertian screen of reflectance ρ at distance r shows L = ρ/π · E, and a lit area A that sends the luminance
        L₂ there gives it E = L₂ A cos θ₂ cos θ_screen / r², so that L₂ = L · π r² / (ρ A cos θ₂ cos θ_screen).

        Returns
        -------
        The factor (n,) [mm²], directions from the sample (n, 3), and solid angles per area of the screen [1/mm²] (n,).
        """
        points = self.at(places)
        r = np.linalg.norm(points, axis=1)
        d = points / r[:, None]
        on_screen = np.abs(d @ self.normal)
        leaving = np.abs(d[:, 2])
        with np.errstate(divide="ignore"):
            factor = np.pi * r**2 / (self.reflectance * leaving * on_screen)
        return factor, d, on_screen / r**2


def screens_of(tables: list[ScreenTable]) -> list[Screen]:
    """All positions of all screens, in order.

    Raises
    ------
    ClerestoryError
        Corners or marks do not lie in a plane, or do not tell the perspective.
    """
    made = []
    for n, table in enumerate(tables, start=1):
        for turn in table.turned_deg:
            name = f"screen {n}" + (f" turned by {turn:g}°" if len(table.turned_deg) > 1 else "")
            made.append(_screen(name, table, turn))
    return made


def _screen(name: str, table: ScreenTable, turn_deg: float) -> Screen:
    a = np.radians(turn_deg)
    turned = np.array([[np.cos(a), -np.sin(a), 0.0], [np.sin(a), np.cos(a), 0.0], [0.0, 0.0, 1.0]])
    corners = np.array(table.corners_mm) @ turned.T
    origin = corners[0]
    right = corners[1] - corners[0]
    normal = np.cross(right, corners[2] - corners[0])
    if np.linalg.norm(normal) < 1e-9 * max(float(np.linalg.norm(right)) ** 2, 1e-12):
        raise ClerestoryError(f"{name}: its first three corners lie on one line (give its corners in order)")
    right, normal = right / np.linalg.norm(right), normal / np.linalg.norm(normal)
    axes = np.stack([right, np.cross(normal, right)])
    _in_plane(name, "corner", corners, origin, normal)
    flat = (corners - origin) @ axes.T
    if table.camera is not None:
        seen, pixels = corners, _pinhole(name, table.camera, corners, turned)
    else:
        seen = np.array([mark.mm for mark in table.marks]) @ turned.T
        pixels = np.array([mark.pixel for mark in table.marks])
        _in_plane(name, "mark", seen, origin, normal)
    if table.camera is not None and len(corners) < 4:  # a perspective has four points
        extra = corners.mean(axis=0)[None]
        seen = np.vstack([corners, extra])
        pixels = _pinhole(name, table.camera, seen, turned)
    to_plane = homography(pixels, (seen - origin) @ axes.T, name)
    screen = Screen(name, origin, axes, flat, to_plane, table.reflectance)
    if not (screen.edge_distance(flat.mean(axis=0)[None]) > 0.0).all():
        raise ClerestoryError(f"{name}: it is not convex (give its corners in order, or two screens)")
    if abs(origin @ normal) < 1e-6:
        raise ClerestoryError(f"{name}: its plane goes through the sample, whose light never meets it (check corners)")
    return screen


def homography(pixels: ArrayLike, places: ArrayLike, name: str = "screen") -> Floats:
    """The perspective (3, 3) from pixels to places in a plane, by four pairs (n, 2) or more and least squares.

    Raises
    ------
    ClerestoryError
        Three of four pairs lie on a line.
    """
    p, q = np.asarray(pixels, np.float64), np.asarray(places, np.float64)

    def normalised(points: Floats) -> tuple[Floats, Floats]:
        middle = points.mean(axis=0)
        size = float(np.sqrt(((points - middle) ** 2).sum(axis=1).mean())) or 1.0
        return (points - middle) / size, np.array([[size, 0, middle[0]], [0, size, middle[1]], [0, 0, 1.0]])

    (u, from_u), (v, from_v) = normalised(p), normalised(q)
    ones, zeros = np.ones(len(u)), np.zeros((len(u), 3))
    at = np.column_stack([u, ones])
    rows = np.vstack([np.hstack([at, zeros, -v[:, :1] * at]), np.hstack([zeros, at, -v[:, 1:] * at])])
    _, sizes, basis = np.linalg.svd(rows)
    if sizes[7] < 1e-6 * sizes[0]:
        raise ClerestoryError(f"{name}: its marks do not tell the perspective (three of four lie on one line)")
    made = from_v @ basis[-1].reshape(3, 3) @ np.linalg.inv(from_u)
    return np.asarray(made / np.linalg.norm(made))


def _pinhole(name: str, camera: Pinhole, points: Floats, turned: Floats) -> Floats:
    """Pixels (n, 2) of points (n, 3) [mm]."""
    eye, target = turned @ camera.position_mm, turned @ camera.target_mm
    forward = target - eye
    right = np.cross(forward, turned @ camera.up)
    if np.linalg.norm(right) < 1e-9:
        raise ClerestoryError(f"{name}: up is along the camera's axis, or that has no direction (change `up`)")
    forward, right = forward / np.linalg.norm(forward), right / np.linalg.norm(right)
    down = np.cross(forward, right)
    from_eye = points - eye
    depth = from_eye @ forward
    if (depth <= 0.0).any():
        raise ClerestoryError(f"{name}: a corner is behind the camera (check its position and target)")
    width, height = camera.size_pixels
    return np.column_stack(
        [
            0.5 * width + camera.focal_pixels * (from_eye @ right) / depth,
            0.5 * height + camera.focal_pixels * (from_eye @ down) / depth,
        ]
    )


def _in_plane(name: str, what: str, points: Floats, origin: Floats, normal: Floats) -> None:
    away = np.abs((points - origin) @ normal)
    size = float(np.abs(points - origin).max()) or 1.0
    if away.max() > 1e-3 * size:
        raise ClerestoryError(
            f"{name}: {what} {int(away.argmax()) + 1} is {away.max():.3g} mm out of its plane (a screen is flat)"
        )
