"""What a picture of measured points is of: one channel of the scans from one direction, and the words for it."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, get_args

import numpy as np

from clerestory._core import ClerestoryError, MissingDataError
from clerestory.counts import counted
from clerestory.directions import SCATTERS, SIDES, incident_in_words, outgoing_in_words
from clerestory.integrals import continued
from clerestory.plot import style
from clerestory.plot.view import component_words

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from matplotlib.colors import Normalize
    from numpy.typing import NDArray

    from clerestory.directions import Scatter, Side
    from clerestory.measure.delaunay import Integral, Interpolated
    from clerestory.measure.scan import Scan

    Floats = NDArray[np.float64]

_SAME_DEG = 0.5
"""Scans whose incident directions differ by less belong together."""
_DECADES = 6
"""A logarithmic scale of measured points reaches this far down from the largest; noise lies lower."""


@dataclass(frozen=True)
class Subject:
    """One channel of the scans of light from one direction, as BSDF."""

    scan: Scan
    label: str
    parts: int
    """Scans that were put together."""

    @property
    def bsdf(self) -> Floats:
        """BSDF [1/sr] (points,)."""
        return self.scan.values[:, 0]

    def values(self, quantity: style.Quantity) -> Floats:
        """BSDF or DSF [1/sr] (points,)."""
        if quantity not in get_args(style.Quantity):
            raise ClerestoryError(f"quantity {quantity!r} is not known (give bsdf or dsf)")
        return self.bsdf * np.cos(np.radians(self.scan.theta_deg)) if quantity == "dsf" else self.bsdf

    @property
    def through(self) -> Floats:
        """Outgoing direction (3,) of light that goes straight through, or is mirrored."""
        return continued(self.scan.incident, self.scan.scatter)

    @property
    def plane_azimuth_deg(self) -> float:
        """Azimuth [°] of the end of the plane of scattering where such light arrives; downward along the normal."""
        x, y, _ = self.through
        return 270.0 if np.hypot(x, y) < 1e-6 else float(np.degrees(np.arctan2(y, x)))

    @property
    def through_words(self) -> str:
        """Straight through: downward, 30°."""
        name = "straight through" if self.scan.scatter == "transmission" else "mirrored"
        return f"{name}: {outgoing_in_words(self.through)}"

    @property
    def incident_words(self) -> str:
        """From above, 30°."""
        return incident_in_words(self.scan.incident)

    def title(self, integral: Integral | None = None) -> str:
        """Whose data, which component from where, how many points, and what they come to."""
        component = component_words(self.scan.channels[0], self.scan.incident_side, self.scan.scatter)
        points = counted(len(self.scan), "point") + (f" of {self.parts} scans" if self.parts > 1 else "")
        lines = [*textwrap.wrap(self.label, 60), component, f"incident {self.incident_words};  {points}"]
        if integral is not None:
            letter = "T" if self.scan.scatter == "transmission" else "R"
            symbol = f"${letter}_{{\\mathrm{{d\u2010h}}}}$"
            total, beyond = integral.total[0], integral.extrapolated[0]
            lines.append(f"{symbol} = {style.figures(total)}, of which {style.figures(beyond, 2)} was not measured")
        return "\n".join(lines)

    def below_words(self) -> str:
        """How many values have no logarithm; empty if all have one."""
        count = int((self.bsdf <= 0.0).sum())
        return f"{counted(count, 'value')} of 0 or less" if count else ""


def components(scans: Iterable[Scan]) -> list[tuple[Side, Scatter]]:
    """Sides and kinds of scatter that scans of a sample hold, in the order exterior, interior, transmission first."""
    held = {(scan.incident_side, scan.scatter) for scan in scans if scan.purpose == "sample"}
    return [(side, scatter) for side in SIDES for scatter in SCATTERS if (side, scatter) in held]


def chosen(scans: Iterable[Scan], side: Side | None = None, scatter: Scatter | None = None) -> list[Scan]:
    """The scans of one component: the asked one, or the first that there is.

    Raises
    ------
    MissingDataError
        There is none.
    """
    kept = [scan for scan in scans if scan.purpose == "sample"]
    held = [pair for pair in components(kept) if side in (None, pair[0]) and scatter in (None, pair[1])]
    if not held:
        there = "; ".join(f"{s} from the {side}" for side, s in components(kept)) or "none of a sample"
        raise MissingDataError(
            f"no scan of {scatter or 'light'} from the {side or 'exterior or interior'} (there is: {there})"
        )
    return [scan for scan in kept if (scan.incident_side, scan.scatter) == held[0]]


def by_direction(scans: Sequence[Scan]) -> list[list[Scan]]:
    """Scans of one component, those from the same direction together, by angle and azimuth."""
    groups: list[list[Scan]] = []
    for scan in sorted(scans, key=lambda s: (round(s.incident_theta_deg, 3), round(s.incident_phi_deg % 360.0, 3))):
        near = [g for g in groups if float(g[0].incident @ scan.incident) > np.cos(np.radians(_SAME_DEG))]
        if near:
            near[0].append(scan)
        else:
            groups.append([scan])
    return groups


def subject(
    scans: Iterable[Scan],
    *,
    incident: tuple[float, float] | None = None,
    side: Side | None = None,
    scatter: Scatter | None = None,
    channel: str | None = None,
    label: str = "",
) -> Subject:
    """The scans of one incident direction, put together.

    Parameters
    ----------
    incident
        Angle to the normal and azimuth of the direction to the source [°]; may be left out if there is only one.
    side, scatter
        Where the light comes from and where it is seen; by default the first that there is.
    channel
        Name of a channel; the visible band, Y, or the first by default.

    Raises
    ------
    MissingDataError
        There is no such scan or channel.
    ClerestoryError
        There are several directions and none was named, or the values are a detector's signal.
    """
    groups = by_direction(chosen(scans, side, scatter))
    if incident is None:
        if len(groups) > 1:
            raise ClerestoryError(f"there are {len(groups)} incident directions: {_listed(groups)} (name one of them)")
        members = groups[0]
    else:
        from clerestory.directions import direction

        toward = direction(*incident, side=groups[0][0].incident_side)
        nearest = max(groups, key=lambda g: float(g[0].incident @ toward))
        if float(nearest[0].incident @ toward) < np.cos(np.radians(_SAME_DEG)):
            asked = f"{incident[0]:g},{incident[1]:g}"
            raise MissingDataError(f"no scan of light from {asked} (there are {_listed(groups)})")
        members = nearest
    return together(members, channel=channel, label=label)


def together(members: Sequence[Scan], *, channel: str | None = None, label: str = "") -> Subject:
    """Scans from one direction as one."""
    name = channel or next((n for n in ("visible", "Y") if n in members[0].channels), members[0].channels[0])
    kept = [scan.as_bsdf() for scan in members if name in scan.channels]
    if not kept:
        raise MissingDataError(f"no channel {name!r} (there are {', '.join(members[0].channels)})")
    one = replace(
        kept[0],
        theta_deg=np.concatenate([scan.theta_deg for scan in kept]),
        phi_deg=np.concatenate([scan.phi_deg for scan in kept]),
        values=np.concatenate([scan.channel(name) for scan in kept])[:, None],
        channels=(name,),
        standard_errors=None,
    )
    if not len(one):
        raise MissingDataError("the scan holds no points")
    return Subject(one, label, len(kept))


def interpolation(scale: style.Scale) -> Interpolated:
    """What is linear between points on a scale: a peak's flanks are straight where the scale is logarithmic."""
    return "log" if scale == "log" else "bsdf"


def scale_of(values: Floats, scale: style.Scale, limits: tuple[float, float] | None = None) -> Normalize:
    """A scale for measured points: logarithmic ones end where the lowest hundredth begins, or after six decades."""
    if scale == "log" and limits is None:
        positive = values[np.isfinite(values) & (values > 0.0)]
        if not positive.size:
            raise ClerestoryError("no value is above 0, which a logarithmic scale needs (take a linear one)")
        top = float(positive.max())
        low = max(float(np.quantile(positive, 0.01)), top * 10.0**-_DECADES)
        limits = (min(low, top / 10.0), top)
    return style.norm(values, scale, limits)


def _listed(groups: Sequence[Sequence[Scan]]) -> str:
    words = [f"{g[0].incident_theta_deg:g},{g[0].incident_phi_deg:g}" for g in groups]
    return " ".join(words[:12]) + (" …" if len(words) > 12 else "")
