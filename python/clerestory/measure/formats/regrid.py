"""Scans on the tables that optics programs read: polar angles by azimuths, the same for every incident direction."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.counts import counted
from clerestory.directions import direction
from clerestory.measure.formats.specular import seen_from, to_specular

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from clerestory.measure.scan import Measurement, Scan

    Floats = NDArray[np.float64]

_SAME = 1e-4
"""Distance of unit vectors up to which a measured point is a point of the table."""
_DENSEST = 4
"""A table of more than so many times the points of a scan is not the one that they were measured on."""
_MOST_GUESSED = 0.5
"""Share of a table's directions that may lie outside of the measured ones."""
_RADIALS_DEG = (0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.5, 10.0, 12.5)
_STEP_DEG = 5.0
_PLANE_DEG = 1e-3


@dataclass(frozen=True)
class Table:
    """Values of a scan on a table."""

    values: Floats
    """BSDF [1/sr] (azimuths, polar angles, channels), 0 below the horizon."""
    totals: Floats
    """Integrals of the table, the direct-hemispherical values (channels,)."""
    guessed: int
    """Directions that lie outside of the measured ones and repeat the nearest of them."""


def table(
    scan: Scan,
    channels: Sequence[str],
    theta_deg: Floats,
    phi_deg: Floats,
    above: NDArray[np.bool_],
    *,
    polar_deg: Floats,
    azimuth_deg: Floats,
    half: bool,
) -> Table:
    """Values of a scan of BSDF in the directions of a table.

    Parameters
    ----------
    theta_deg, phi_deg
        Of the table's directions in the sample's frame [°] (azimuths, polar angles).
    above
        Which of them lie above the horizon.
    polar_deg, azimuth_deg
        The table's own polar angles (polar angles,) and azimuths (azimuths,) [°], for its integral.
    half
        The table is half of one that is symmetric to the plane of incidence.

    Raises
    ------
    ClerestoryError
        There are no points, or most of the table lies outside of them.
    """
    from scipy.spatial import KDTree

    columns = [scan.channels.index(channel) for channel in channels]
    measured = scan.values[:, columns]
    if not len(measured):
        raise ClerestoryError(f"a scan of light from {scan.incident_theta_deg:g}° has no points (leave it out)")
    asked = direction(theta_deg[above], phi_deg[above], side=scan.side)
    away, nearest = KDTree(scan.outgoing).query(asked)
    found = measured[nearest]
    between = away > _SAME
    guessed = 0
    if between.any():
        linear = _linear(scan.outgoing[:, :2], measured, asked[between, :2])
        known = np.isfinite(linear).all(axis=1)
        found[np.flatnonzero(between)[known]] = linear[known]
        guessed = int((~known).sum())
        if guessed > _MOST_GUESSED * len(asked):
            raise ClerestoryError(
                f"the {counted(len(scan), 'point')} of light from {scan.incident_theta_deg:g}° cover less than half of"
                " a table of directions (leave the scan out, or complete it first)"
            )
    values = np.zeros((*theta_deg.shape, len(columns)))
    values[above] = found
    weighted = values * (np.cos(np.radians(theta_deg)) * np.sin(np.radians(polar_deg)))[..., None]
    by_azimuth = np.trapezoid(weighted, np.radians(polar_deg), axis=1)
    totals = np.trapezoid(by_azimuth, np.radians(azimuth_deg), axis=0) * (2.0 if half else 1.0)
    stated = scan.conditions.get("hemispherical")
    if stated is not None:
        totals[list(channels).index("Y") if "Y" in channels else 0] = float(stated)
    return Table(values, totals, guessed)


def _linear(places: Floats, values: Floats, asked: Floats) -> Floats:
    """Values (m, channels) at places (m, 2), linear on the triangles between others (n, 2); NaN outside of them."""
    from matplotlib.tri import Triangulation

    found = np.full((len(asked), values.shape[1]), np.nan)
    try:
        triangles = Triangulation(places[:, 0], places[:, 1])
    except (RuntimeError, ValueError):  # all points in one plane, or fewer than three: there are no triangles
        return found
    which = np.asarray(triangles.get_trifinder()(asked[:, 0], asked[:, 1]), dtype=np.int64)
    inside = which >= 0
    corners = triangles.triangles[which[inside]]
    first = places[corners[:, 0]]
    # Barycentric coordinates from the two edges at the first corner.
    edges = np.stack([places[corners[:, 1]] - first, places[corners[:, 2]] - first], axis=-1)
    offset = asked[inside] - first
    area = edges[:, 0, 0] * edges[:, 1, 1] - edges[:, 0, 1] * edges[:, 1, 0]
    second = (offset[:, 0] * edges[:, 1, 1] - offset[:, 1] * edges[:, 0, 1]) / area
    third = (offset[:, 1] * edges[:, 0, 0] - offset[:, 0] * edges[:, 1, 0]) / area
    weights = np.stack([1.0 - second - third, second, third], axis=-1)
    found[inside] = np.einsum("nk,nkc->nc", weights, values[corners])
    return found


def angular_table(rotations_deg: Sequence[float], scans: Sequence[Scan]) -> Mapping[float, Mapping[float, Scan]]:
    """Scans by their rotation and then their angle of incidence [°], each rotation with the same ones.

    Raises
    ------
    ClerestoryError
        One is there twice, or a rotation lacks an angle that another has.
    """
    found: dict[float, dict[float, Scan]] = {}
    for rotation, scan in zip(rotations_deg, scans, strict=True):
        row = found.setdefault(rotation, {})
        theta = round(scan.incident_theta_deg, 6)
        if theta in row:
            raise ClerestoryError(
                f"two scans of light from {theta:g}° at azimuth {scan.incident_phi_deg:g}° (combine them first)"
            )
        row[theta] = scan
    if 0.0 in {theta for row in found.values() for theta in row} and len(found) > 1:
        # At the normal there is no azimuth: one scan serves every rotation.
        normal = next(row[0.0] for row in found.values() if 0.0 in row)
        for row in found.values():
            row.setdefault(0.0, normal)
        found = {rotation: row for rotation, row in found.items() if set(row) != {0.0}}
    if len({frozenset(row) for row in found.values()}) > 1:
        raise ClerestoryError(
            "incident directions do not form a table: azimuths have different polar angles (choose those that do)"
        )
    return {rotation: dict(sorted(found[rotation].items())) for rotation in sorted(found)}


def specular_grid(scans: Sequence[Scan]) -> tuple[Floats, Floats, bool]:
    """Azimuths and radial angles [°] about the specular direction, and whether they are half of a symmetric table.

    Those that the scans were measured on, where they were measured on one; else a table that is fine near the peak.
    """
    about = [
        to_specular(s.outgoing, s.incident_theta_deg, s.incident_phi_deg, s.incident_side, s.scatter) for s in scans
    ]
    azimuths, radials = _own([(azimuth, radial) for radial, azimuth in about], scans)
    half = all(is_half(scan) for scan in scans)
    if azimuths is not None and radials is not None:
        return _closed(azimuths, half=half), radials, half
    furthest = max(scan.incident_theta_deg for scan in scans) + 90.0
    coarse = np.arange(15.0, furthest + _STEP_DEG, _STEP_DEG)
    return (
        np.arange(0.0, (180.0 if half else 360.0) + _STEP_DEG / 2, _STEP_DEG),
        np.concatenate([_RADIALS_DEG, coarse[coarse <= 180.0]]),
        half,
    )


def is_half(scan: Scan) -> bool:
    """Whether a scan holds just the side of its plane of symmetry that azimuths of 0 to 180° lie on."""
    if not _is_symmetric(scan):
        return False
    radial, azimuth = to_specular(
        scan.outgoing, scan.incident_theta_deg, scan.incident_phi_deg, scan.incident_side, scan.scatter
    )
    beside = azimuth[(radial > _PLANE_DEG) & (radial < 180.0 - _PLANE_DEG)]
    return bool(((beside <= 180.0 + _PLANE_DEG) | (beside >= 360.0 - _PLANE_DEG)).all())


def _is_symmetric(scan: Scan) -> bool:
    return scan.conditions.get("symmetry", "").startswith("PlaneSymmetrical")


def whole(scan: Scan) -> Scan:
    """A scan of one side of a plane of symmetry mirrored at it; any other as it is."""
    if not _is_symmetric(scan):
        return scan
    mirrored = 2.0 * scan.incident_phi_deg - scan.phi_deg
    inside = np.abs(np.sin(np.radians(scan.phi_deg - scan.incident_phi_deg))) < _SAME
    inside |= scan.theta_deg < _PLANE_DEG
    return replace(
        scan,
        theta_deg=np.concatenate([scan.theta_deg, scan.theta_deg[~inside]]),
        phi_deg=np.concatenate([scan.phi_deg, mirrored[~inside] % 360.0]),
        values=np.concatenate([scan.values, scan.values[~inside]]),
        standard_errors=None,
    )


def absolute_grid(scans: Sequence[Scan]) -> tuple[Floats, Floats]:
    """Azimuths as seen from the lit side and polar angles from the normal [°], as `specular_grid` finds its own."""
    azimuths, polars = _own([(seen_from(s.incident_side, s.phi_deg), s.theta_deg) for s in scans], scans)
    if azimuths is not None and polars is not None:
        return _closed(azimuths, half=False), polars
    near = np.array([sign * radial for radial in _RADIALS_DEG[:8] for sign in (-1.0, 1.0)])
    peaks = np.concatenate([scan.incident_theta_deg + near for scan in scans])
    planes = np.concatenate([(seen_from(s.incident_side, s.incident_phi_deg + 180.0) + near) % 360.0 for s in scans])
    polars = np.concatenate([np.arange(0.0, 90.0, _STEP_DEG), peaks[(peaks >= 0.0) & (peaks < 90.0)]])
    azimuths = np.concatenate([np.arange(0.0, 360.0, _STEP_DEG), planes])
    return _closed(np.unique(np.round(azimuths, 6)), half=False), np.unique(np.round(polars, 6))


def _own(angles: Sequence[tuple[Floats, Floats]], scans: Sequence[Scan]) -> tuple[Floats | None, Floats | None]:
    """Azimuths and polar angles of points (azimuths, polar angles a scan), where few of each make up all points."""
    # Degrees of float32 files differ in the seventh digit; an azimuth at the pole means nothing.
    azimuth = np.concatenate([np.round(a[p > _PLANE_DEG], 4) % 360.0 for a, p in angles])
    polar = np.concatenate([np.round(p, 4) for _, p in angles])
    azimuths, polars = np.unique(azimuth), np.unique(polar)
    if not azimuths.size or len(azimuths) * len(polars) > _DENSEST * max(len(scan) for scan in scans):
        return None, None
    return azimuths, polars


def _closed(azimuths: Floats, *, half: bool) -> Floats:
    """Azimuths with 360° as the repetition of the first, so that a table ends where it begins."""
    if half or not azimuths.size:
        return azimuths
    return np.append(azimuths, azimuths[0] + 360.0)


def left_out(measurement: Measurement, format_name: str) -> list[str]:
    """What tables of a format cannot hold of a measurement, in words."""
    errors = sum(scan.standard_errors is not None for scan in measurement.of())
    others = len(measurement.scans) - len(measurement.of())
    return [
        f"{what} of {counted(count, 'scan')} left out: {format_name} has no place for them"
        for what, count in (("standard errors", errors), ("the beam or the dark", others))
        if count
    ]
