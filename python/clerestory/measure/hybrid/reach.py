"""How far an instrument reached: the depth of pairs of directions within what was measured.

The depth of a direction is its angle to the border of what was measured, 0 or less outside. Incident directions reach
as far as the great circles around the measured ones. Outgoing directions were measured where points are as close to
each other as elsewhere in their scan, so a shadow or a sector that the arm did not reach is a hole, and a gap between
two points is none.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import ConvexHull, Delaunay, QhullError

from clerestory._core import ClerestoryError
from clerestory.directions import angles, outgoing_side
from clerestory.measure.hybrid.field import AT, NODES, at, depth_from, depth_of_points, mirrored, moved, smooth, turned
from clerestory.measure.prepare.step import same_light
from clerestory.measure.prepare.symmetry import MOVES

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from clerestory.bsdf import Bsdf
    from clerestory.directions import Scatter, Side
    from clerestory.measure.interpolant import Fit
    from clerestory.measure.prepare.symmetry import Symmetry
    from clerestory.measure.scan import Measurement, Scan
    from clerestory.model import Model

    Floats = NDArray[np.float64]
    Key = tuple[str, Side, Scatter]

_STEEPEST = np.radians(89.5)
"""Incident angles beyond this have no place in the gnomonic projection."""


@dataclass(frozen=True)
class Reach:
    """What was measured of one component.

    Light is told by where it travels to, as disks of travel are, so that one mirror or turn moves incident and outgoing
    directions alike.
    """

    words: str
    """How far it reaches."""
    limit_deg: float
    """Largest incident angle that was measured [°]."""
    incident: Floats
    """Directions of travel (n, 3), +z forward, of the light that was measured; of an isotropic sample along +x."""
    depths: NDArray[np.float32]
    """Depth of outgoing directions [rad] for each, on the nodes (n, nodes, nodes)."""
    hull: Floats | None
    """Inward normals (m, 3) of the great circles around the incident directions; None for an isotropic sample."""
    mesh: Delaunay | None
    """Triangles between the incident directions in the stereographic plane; None for an isotropic sample."""

    @classmethod
    def of_scans(
        cls, scans: Sequence[Scan], symmetry: Symmetry, *, incident_deg: float = 90.0, outgoing_deg: float = 90.0
    ) -> Reach:
        """That of the scans of one component, completed by a symmetry.

        Parameters
        ----------
        scans
            From one side, transmitted or reflected.
        symmetry
            The one that the model was completed by.
        incident_deg, outgoing_deg
            Angles [°] beyond which measured values are not to be used.

        Raises
        ------
        ClerestoryError
            No incident direction is left.
        """
        groups = [g for g in same_light(scans) if g[0].incident_theta_deg <= incident_deg + 1e-6]
        if not groups:
            raise ClerestoryError(f"nothing was measured up to {incident_deg:g}° of incidence (allow larger angles)")
        incident = np.array([_travel(group[0].incident) for group in groups])
        points = []
        for group in groups:
            outgoing = np.concatenate([scan.outgoing for scan in group])
            sound = np.concatenate([np.isfinite(scan.values).all(axis=1) for scan in group])
            near = np.concatenate([scan.theta_deg for scan in group]) <= outgoing_deg + 1e-6
            points.append(_forward(outgoing[sound & near]))
        limit = max(group[0].incident_theta_deg for group in groups)
        out = max((float(angles(p)[0].max()) for p in points if len(p)), default=0.0)
        words = f"measured up to {limit:.3g}° of incidence and {out:.3g}° out"
        return cls._of(words, incident, [depth_of_points(p) for p in points], symmetry)

    @classmethod
    def of_interpolant(cls, model: Model, side: Side, scatter: Scatter) -> Reach:
        """That which an interpolant remembers: cells of about 9° in which there were points, to the last of them.

        Raises
        ------
        ClerestoryError
            The model is no interpolant.
        """
        kind, numbers, _, arrays, _ = model._core.to_parts()
        if kind != "interpolant":
            raise ClerestoryError(
                f"a {model.kind} model does not know how far it was measured (say up to which angles)"
            )
        rows = dict(arrays)["distributions"].reshape(-1, 7)
        incident = np.stack(
            [rows[:, 0], rows[:, 1], np.sqrt(np.maximum(1.0 - rows[:, 0] ** 2 - rows[:, 1] ** 2, 0))], 1
        )
        ahead = AT[:, 2] > 1e-9
        leaves = 1.0 if outgoing_side(side, scatter) == "interior" else -1.0
        outgoing = AT[ahead] * [1.0, 1.0, leaves]
        depths = []
        for travel in incident:
            toward = [-travel[0], -travel[1], travel[2] * (1.0 if side == "interior" else -1.0)]
            outside = np.ones(len(AT), dtype=bool)
            outside[ahead] = model.extrapolated(np.tile(toward, (len(outgoing), 1)), outgoing)
            depths.append(depth_from(outside, 0.0))
        limit = float(np.degrees(np.arccos(incident[:, 2].min())))
        words = f"measured up to {limit:.3g}° of incidence and {float(np.degrees(rows[:, 5].max())):.3g}° out"
        return cls._of(words, incident, depths, "isotropic" if dict(numbers)["isotropic"] else "none")

    @classmethod
    def within(cls, incident_deg: float, outgoing_deg: float) -> Reach:
        """Everything up to an incident and an outgoing angle [°]."""
        for angle in (incident_deg, outgoing_deg):
            if not 0.0 < angle <= 90.0:
                raise ClerestoryError(f"{angle:g}° is no angle up to which was measured (give more than 0, at most 90)")
        theta = np.arctan2(np.hypot(AT[:, 0], AT[:, 1]), AT[:, 2])
        depth = (np.radians(outgoing_deg) - theta).reshape(NODES, NODES).astype(np.float32)
        top = np.radians(incident_deg)
        incident = np.array([[0.0, 0.0, 1.0], [np.sin(top), 0.0, np.cos(top)]])
        words = f"measured up to {incident_deg:g}° of incidence and {outgoing_deg:g}° out, as was said"
        return cls._of(words, incident, [depth, depth], "isotropic")

    @classmethod
    def _of(cls, words: str, incident: Floats, depths: Sequence[NDArray[np.float32]], symmetry: Symmetry) -> Reach:
        limit = float(np.degrees(np.arccos(np.clip(incident[:, 2].min(), 0.0, 1.0))))
        if symmetry == "isotropic":
            azimuth = np.arctan2(incident[:, 1], incident[:, 0])
            theta = np.arccos(np.clip(incident[:, 2], -1.0, 1.0))
            # A sample that is alike on both sides of the plane of incidence was seen on both if on either.
            fields = [turned(mirrored(d, a), -a) for d, a in zip(depths, azimuth, strict=True)]
            order = np.argsort(theta)
            along = np.stack([np.sin(theta), np.zeros(len(theta)), np.cos(theta)], axis=1)
            return cls(words, limit, along[order], np.stack(fields)[order], None, None)
        every, fields = [*incident], [*depths]
        for _, move in MOVES.get(symmetry, ()):
            for direction, depth in zip(incident, depths, strict=True):
                image = np.array([*(move @ direction[:2]), direction[2]])
                if not any(np.linalg.norm(image - other) < 1e-3 for other in every):
                    every.append(image)
                    fields.append(moved(depth, move))
        places = np.array(every)
        try:
            hull = _hull(places)
            mesh = Delaunay(places[:, :2] / (1.0 + places[:, 2:]))
        except QhullError as error:
            raise ClerestoryError(
                "the incident directions lie on a line (say that the sample is isotropic, or measure other azimuths)"
            ) from error
        return cls(words, limit, places, np.stack(fields), hull, mesh)

    def incident_depth(self, incident: Floats) -> Floats:
        """Angle [rad] of directions toward the source (n, 3) to the border of those measured."""
        travel = np.array([_travel(one) for one in np.atleast_2d(incident)])
        if self.hull is None:
            return np.asarray(np.radians(self.limit_deg) - np.arccos(np.clip(travel[:, 2], -1.0, 1.0)))
        return np.asarray(np.arcsin(np.clip(travel @ self.hull.T, -1.0, 1.0)).min(axis=1))

    def weights(self, incident: Floats, outgoing: Floats, blend_deg: float) -> Floats:
        """Share of the measured model in the BSDF: 1 deep within what was measured, 0 outside (n,).

        Parameters
        ----------
        incident
            Direction toward the source (3,).
        outgoing
            Directions along the light (n, 3).
        blend_deg
            Depth [°] from which on the measured model stands alone.
        """
        band = np.radians(blend_deg)
        over = float(smooth(self.incident_depth(incident[None]) / band)[0])
        if over == 0.0:
            return np.zeros(len(outgoing))
        travel = _travel(incident)
        out = _forward(outgoing)
        if self.mesh is None:
            radius, turn = float(np.hypot(*travel[:2])), float(np.arctan2(travel[1], travel[0]))
            held = float(np.interp(radius, self.incident[:, 0], np.arange(len(self.incident))))
            first = min(int(held), len(self.incident) - 2) if len(self.incident) > 1 else 0
            shares = {first: 1.0 - (held - first)}
            if held > first:
                shares[first + 1] = held - first
            out = _turn(out, -turn)
        else:
            shares = _shares(self.mesh, self.incident, travel)
        field = sum(
            (share * smooth(self.depths[k].astype(np.float64) / band) for k, share in shares.items()),
            start=np.zeros((NODES, NODES)),
        )
        return np.asarray(over * np.clip(at(field, out), 0.0, 1.0))


def reaches_of(
    measurement: Measurement, made: Fit, *, incident_deg: float = 90.0, outgoing_deg: float = 90.0
) -> dict[Key, Reach]:
    """How far the scans reach that a model was fitted to, by band, side and scatter."""
    found = {}
    for one in made.components:
        scans = [s for s in measurement.of(one.side, one.scatter) if one.band in s.channels]
        kept = [
            replace(s, values=s.channel(one.band)[:, None], channels=(one.band,), standard_errors=None) for s in scans
        ]
        found[one.band, one.side, one.scatter] = Reach.of_scans(
            kept, one.symmetry, incident_deg=incident_deg, outgoing_deg=outgoing_deg
        )
    return found


def reaches_known(
    measured: Bsdf, *, incident_deg: float | None = None, outgoing_deg: float | None = None
) -> dict[Key, Reach]:
    """Reaches of a data set: as a person says, or as its interpolants remember.

    Raises
    ------
    ClerestoryError
        Nobody knows.
    """
    if incident_deg is not None and outgoing_deg is not None:
        said = Reach.within(incident_deg, outgoing_deg)
        return {(band, *key): said for band, members in measured.models.items() for key in members}
    return {
        (band, *key): Reach.of_interpolant(model, *key)
        for band, members in measured.models.items()
        for key, model in members.items()
    }


def _travel(incident: Floats) -> Floats:
    """Where light from a direction travels to, with +z forward."""
    return np.array([-incident[0], -incident[1], abs(incident[2])])


def _forward(outgoing: Floats) -> Floats:
    """Directions with +z forward."""
    return np.stack([outgoing[:, 0], outgoing[:, 1], np.abs(outgoing[:, 2])], axis=1)


def _turn(directions: Floats, angle: float) -> Floats:
    c, s = np.cos(angle), np.sin(angle)
    x, y, z = directions.T
    return np.stack([c * x - s * y, s * x + c * y, z], axis=1)


def _hull(travel: Floats) -> Floats:
    """Inward normals of the great circles around directions: sides of their hull in the gnomonic projection."""
    theta = np.minimum(np.arccos(np.clip(travel[:, 2], -1.0, 1.0)), _STEEPEST)
    azimuth = np.arctan2(travel[:, 1], travel[:, 0])
    flat = np.tan(theta)[:, None] * np.stack([np.cos(azimuth), np.sin(azimuth)], axis=1)
    # Qhull's sides are n·p + c ≤ 0 inside, which is −(n, c)·(p, 1) ≥ 0 along (p, 1).
    normals = -ConvexHull(flat).equations
    return np.asarray(normals / np.linalg.norm(normals, axis=1)[:, None])


def _shares(mesh: Delaunay, incident: Floats, travel: Floats) -> dict[int, float]:
    """Numbers and shares of the measured directions around one."""
    place = travel[:2] / (1.0 + travel[2])
    simplex = int(mesh.find_simplex(place[None])[0])
    if simplex < 0:
        return {int(np.argmin(np.linalg.norm(incident - travel, axis=1))): 1.0}
    transform = mesh.transform[simplex]
    two = transform[:2] @ (place - transform[2])
    found = np.maximum([*two, 1.0 - two.sum()], 0.0)
    return {int(k): float(s) for k, s in zip(mesh.simplices[simplex], found / found.sum(), strict=True)}
