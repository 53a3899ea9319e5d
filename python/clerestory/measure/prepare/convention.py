"""How laboratories count sides and azimuths, and turning their scans to the frame of this program.

A laboratory's azimuths are turned so that what it calls up comes to 90°, and those that it counts clockwise as seen
from the room are counted the other way. What no rule can tell (is "counter-clockwise" seen from outside or from the
room?) is found with a sample that is like no mirror image of itself: a prism that throws light up and to the right does
so in the data too, or the convention is another.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from clerestory._core import ClerestoryError
from clerestory.counts import counted
from clerestory.directions import angles, direction
from clerestory.integrals import continued
from clerestory.measure.prepare.step import Step, same_light

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from numpy.typing import NDArray

    from clerestory.directions import Side
    from clerestory.measure.scan import Measurement, Scan

    Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Convention:
    """What a laboratory's angles mean."""

    words: str
    up_deg: float = 90.0
    """The laboratory's azimuth of the sample's up [°]."""
    seen_from: Side = "interior"
    """From where its azimuths run counter-clockwise."""
    incident: Literal["source", "travel"] = "source"
    """Whether an incident azimuth is that of the source, or of the light's way through the sample."""
    flipped: bool = False
    """Whether its front is the interior face, so that sides change places."""

    def azimuth(self, phi_deg: float | Floats) -> Floats:
        """An azimuth in the frame of the sample [°], from the laboratory's."""
        turned = np.asarray(phi_deg, dtype=np.float64) - self.up_deg
        return np.asarray((90.0 + (turned if self.seen_from == "interior" else -turned)) % 360.0)


CONVENTIONS: dict[str, Convention] = {
    "clerestory": Convention(
        "this program's own: up is 90°, counter-clockwise as seen from the room, toward the source"
    ),
    "hslu": Convention(
        "HSLU: up is 0°, the normal of the outer surface is θ = 0, counter-clockwise as seen from outside "
        "(which way round the report does not say: try an asymmetric sample)",
        up_deg=0.0,
        seen_from="exterior",
    ),
    "window": Convention(
        "WINDOW: up is 90°, counter-clockwise as seen from the room, and an incident azimuth is that of the light's"
        " way, so that straight transmission keeps it (a sun above is 270°)",
        incident="travel",
    ),
    "pab": Convention(
        "pab Mountain without #upphi: up is 0°, counter-clockwise as seen from the front, which is the exterior",
        up_deg=0.0,
        seen_from="exterior",
    ),
    "pab-up-90": Convention(
        "pab Mountain with #upphi 90: up is 90°, counter-clockwise as seen from the front, which is the exterior",
        up_deg=90.0,
        seen_from="exterior",
    ),
}
"""Presets; IEA SHC Task 61 report C.2.2 (2021), section 2.2, and the manual pages of WINDOW's and pab's files."""

FOUND_DEG = 10.0
"""Angle [°] within which a peak is taken to stand where straight or mirrored light goes."""
_OBLIQUE_DEG = 7.5
"""Incident angle [°] from which on a peak tells azimuths apart."""
_PROMINENT = 5.0
"""Brightest point over the median of a scan from which on it is a peak."""


def converted(measurement: Measurement, convention: Convention) -> tuple[Measurement, Step]:
    """Scans whose angles stand as the laboratory wrote them, turned to the frame of this program.

    Parameters
    ----------
    measurement
        With angles taken from the file as they are.
    convention
        What they mean; one of `CONVENTIONS`, or one's own.
    """
    made = [_converted(scan, convention) for scan in measurement.scans]
    step = Step(
        "convention",
        f"angles of {counted(len(made), 'scan')} taken as {convention.words}",
        {
            "up_deg": convention.up_deg,
            "seen_from": convention.seen_from,
            "incident": convention.incident,
            "flipped": convention.flipped,
        },
    )
    return replace(measurement, scans=tuple(made)), step


def _converted(scan: Scan, convention: Convention) -> Scan:
    incident = float(convention.azimuth(scan.incident_phi_deg))
    outgoing = convention.azimuth(scan.phi_deg)
    side = scan.incident_side
    if convention.flipped:
        side = "interior" if side == "exterior" else "exterior"
    turned = replace(scan, incident_side=side, incident_phi_deg=incident, phi_deg=outgoing)
    return from_travel(turned) if convention.incident == "travel" else turned


def from_travel(scan: Scan) -> Scan:
    """With the azimuth of the source, where that of the light's way through the sample stands."""
    return replace(scan, incident_phi_deg=(scan.incident_phi_deg + 180.0) % 360.0)


@dataclass(frozen=True)
class PeakCheck:
    """Whether the brightest light stands where straight or mirrored light goes."""

    scans: int
    """Scans of oblique light with a peak, which can tell."""
    apart_deg: float
    """Median angle between the brightest point and the direction of straight or mirrored light [°]; NaN without any."""
    better: str | None
    """Another way of counting angles that would put the peaks there, in words; None if none does, or none is needed."""
    better_deg: float
    """The median angle with it [°]."""


def check_peaks(scans: Iterable[Scan]) -> PeakCheck:
    """Compare the brightest point of each scan with where straight or mirrored light goes.

    A sample that redirects all light (a prism) has its peaks elsewhere in any convention, and then nothing is better. A
    mirror image of all azimuths, incident and outgoing, keeps all straight light straight and is not found so.
    """
    telling = [
        (scan, found)
        for group in same_light([s for s in scans if s.incident_theta_deg >= _OBLIQUE_DEG and len(s) >= 3])
        for scan, found in [max(((s, _brightest(s)) for s in group), key=lambda pair: pair[1][2])]
        if found[2] > 0.0 and found[3] >= _PROMINENT
    ]
    if not telling:
        return PeakCheck(0, float("nan"), None, float("nan"))
    apart = {
        words: float(np.median([_apart(scan, *move(scan, found[0], found[1])) for scan, found in telling]))
        for words, move in _OTHERS.items()
    }
    here = apart.pop("")
    words, least = min(apart.items(), key=lambda pair: pair[1])
    if here > FOUND_DEG and least <= FOUND_DEG and least < 0.5 * here:
        return PeakCheck(len(telling), here, words, least)
    return PeakCheck(len(telling), here, None, here)


def _brightest(scan: Scan) -> tuple[float, float, float, float]:
    """Angles [°] and value of the brightest point in DSF, and how much it stands out."""
    dsf = scan.values.max(axis=1) * (1.0 if scan.quantity == "dsf" else np.cos(np.radians(scan.theta_deg)))
    k = int(np.argmax(dsf))
    middle = float(np.median(np.abs(dsf)))
    return float(scan.theta_deg[k]), float(scan.phi_deg[k]), float(dsf[k]), float(dsf[k]) / max(middle, 1e-300)


Angles = tuple[tuple[float, float], tuple[float, float]]


def _as_is(scan: Scan, theta: float, phi: float) -> Angles:
    return (scan.incident_theta_deg, scan.incident_phi_deg), (theta, phi)


def _with(change: Callable[[float], float]) -> Callable[[Scan, float, float], Angles]:
    def moved(scan: Scan, theta: float, phi: float) -> Angles:
        return (scan.incident_theta_deg, scan.incident_phi_deg), (theta, change(phi))

    return moved


def _with_exchanged(scan: Scan, theta: float, phi: float) -> Angles:
    return (scan.incident_theta_deg, scan.incident_phi_deg), (phi % 360.0, theta)


def _swapped(scan: Scan, theta: float, phi: float) -> Angles:
    return (scan.incident_phi_deg % 360.0, scan.incident_theta_deg), (phi % 360.0, theta)


_OTHERS: dict[str, Callable[[Scan, float, float], Angles]] = {
    "": _as_is,
    "with incident azimuths of the light's way instead of the source's (turned by 180°)": _with(lambda p: p + 180.0),
    "with outgoing azimuths counted the other way round (mirrored left to right)": _with(lambda p: 180.0 - p),
    "with outgoing azimuths counted the other way round (mirrored up to down)": _with(lambda p: -p),
    "with θ and φ of outgoing light exchanged": _with_exchanged,
    "with all θ and φ exchanged": _swapped,
}


def _apart(scan: Scan, incident: tuple[float, float], outgoing: tuple[float, float]) -> float:
    if not (0.0 <= incident[0] <= 90.0 and 0.0 <= outgoing[0] <= 90.0):
        return 180.0
    toward = continued(direction(*incident, side=scan.incident_side), scan.scatter)
    cosine = float(np.clip(toward @ direction(*outgoing, side=scan.side), -1.0, 1.0))
    return float(np.degrees(np.arccos(cosine)))


def self_check(measurement: Measurement) -> Step:
    """A step that says whether the peaks stand where they should, and changes nothing."""
    found = check_peaks(measurement.of())
    if found.scans == 0:
        return Step("self-check", "no oblique scan has a peak that would tell azimuths apart")
    words = (
        f"the brightest light of {counted(found.scans, 'oblique scan')} stands {found.apart_deg:.1f}° (median) from"
        " straight or mirrored light"
    )
    warnings: tuple[str, ...] = ()
    if found.better is not None:
        warnings = (f"{words}; {found.better} it would be {found.better_deg:.1f}°",)
    figures = {"scans": found.scans, "apart_deg": found.apart_deg, "better": found.better}
    return Step("self-check", words, {}, figures, warnings)


def moved(scan: Scan, move: Floats, made: str) -> Scan:
    """The scan of a sample that was turned or mirrored in its plane.

    Parameters
    ----------
    move
        Orthogonal matrix (2, 2) of the plane: what it does to x and y of all directions.
    made
        Kept as the condition `made`, so that it is told apart from what was measured.
    """
    if move.shape != (2, 2) or not np.allclose(move @ move.T, np.eye(2), atol=1e-9):
        raise ClerestoryError("a sample is moved in its plane by a turn or a mirror (an orthogonal matrix of 2 by 2)")

    def image(vectors: Floats) -> tuple[Floats, Floats]:
        turned = np.array(vectors, dtype=np.float64)
        turned[..., :2] = vectors[..., :2] @ move.T
        return angles(turned)

    _, incident_phi = image(scan.incident)
    if scan.incident_theta_deg < 1e-6:  # an azimuth at the normal has no direction of its own
        incident_phi = np.array(scan.incident_phi_deg)
    theta, phi = image(scan.outgoing)
    return replace(
        scan,
        incident_phi_deg=float(incident_phi),
        theta_deg=np.minimum(theta, 90.0),
        phi_deg=phi,
        conditions={**scan.conditions, "made": made},
    )
